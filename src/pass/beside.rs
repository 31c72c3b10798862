//! Several passes of one frame, each with its method, over the same casters.

use super::casters::CasterSet;
use super::checks::{check_limits, check_shared, settled};
use super::lights::of_light;
use super::{Inputs, LightTarget, PassConfig, ShadowPass};
use crate::gpu::scope::caught;
use crate::gpu::{KeptPrograms, Ledger};
use crate::methods::strip_method::MethodPipelines;
use crate::{Error, Result};

impl ShadowPass {
    /// A pass of the same casters in the same memory, with another method, other settings or another size: nothing of them is prepared or uploaded again.
    /// Those of `config` are not read. Casters that move are brought to their places by each pass that a frame is recorded with, and other ones that
    /// either is [given](ShadowPass::set_casters) later are its own.
    ///
    /// # Errors
    /// As [`ShadowPass::new`]; [`Error::Config`] for casters in [parts](super::Casters::Parts), which come and go, and for casters that move and a
    /// method that takes none.
    pub fn beside(&self, config: &PassConfig) -> Result<Self> {
        // Before any pipeline is made.
        settled(&config.settings, config.method).check()?;
        let casters = self.casters.share()?;
        check_shared(&casters, config.method)?;
        let (device, queue, tested) = (&self.maker.device, &self.maker.queue, casters.are_tested());
        Self::with(device, queue, config, tested, || Ok(casters))
    }

    /// A pass of these casters, some of which may be tested.
    pub(super) fn with(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        config: &PassConfig,
        tested: bool,
        casters: impl FnOnce() -> Result<CasterSet>,
    ) -> Result<Self> {
        check_limits(&device.limits())?;
        let mut settings = settled(&config.settings, config.method);
        settings.check()?;
        // Whether a texel was missed is not known before the frame is shown.
        settings.spsm.seen_only &= !config.keep_last;
        settings.alpha_tested |= tested;
        let programs = config.programs.cloned().unwrap_or_else(KeptPrograms::in_use);
        let make = || {
            let pipelines = MethodPipelines::new(device, config.method, &settings, config.receivers)?;
            Self::made(device, queue, settings, pipelines, casters()?, config)
        };
        let ledger = Ledger::default();
        let within = || ledger.within(|| programs.within(|| KeptPrograms::once(make)));
        match caught(device, wgpu::ErrorFilter::Validation, within) {
            (_, Some(error)) => Err(Error::Gpu(error.to_string().replace('\n', " "))),
            (made, None) => made.map(|pass| Self { ledger, ..pass }),
        }
    }

    /// Appends a frame for each of several lights, each by the pass of that number, as by its [`record_lights`](ShadowPass::record_lights): lights of one pass
    /// share what the camera sees, whatever lies between them. Returns the number of each light's frame in its pass, in the order of the lights. Pictures
    /// are those of each pass alone, to the bit.
    ///
    /// # Errors
    /// As [`ShadowPass::record_lights`], with the number of the light, and [`Error::Config`] for a pass that is not there; checked for all lights before
    /// anything is recorded.
    pub fn record_by_method(
        passes: &mut [&mut Self],
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs,
        lights: &[(usize, LightTarget)],
    ) -> Result<Vec<u64>> {
        let count = passes.len();
        for (k, (of, light)) in lights.iter().enumerate() {
            let Some(pass) = passes.get(*of) else {
                return Err(Error::Config(format!("light {k}: of pass {of}, there are {count}")));
            };
            pass.mapped(&of_light(inputs, light), &light.target).map_err(|e| match e {
                Error::Config(text) => Error::Config(format!("light {k}: {text}")),
                Error::Scene(text) => Error::Scene(format!("light {k}: {text}")),
                e => e,
            })?;
        }
        let of_pass = |k: usize| lights.iter().enumerate().filter(move |(_, (of, _))| *of == k);
        for (k, pass) in passes.iter().enumerate() {
            pass.check_several(of_pass(k).count(), "lights")?;
        }
        let mut numbers = vec![0; lights.len()];
        for (k, pass) in passes.iter_mut().enumerate() {
            let own: Vec<LightTarget> = of_pass(k).map(|(_, (_, light))| *light).collect();
            if own.is_empty() {
                continue;
            }
            let recorded = pass.record_lights(encoder, inputs, &own)?;
            of_pass(k).zip(recorded).for_each(|((light, _), number)| numbers[light] = number);
        }
        Ok(numbers)
    }
}
