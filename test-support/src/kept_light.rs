//! Cameras that go about random worlds whose light maps one pass keeps: every picture is that of a pass that makes them anew.

use crate::refused::words;
use lab::fuzz::random::Random;
use lab::fuzz::{FuzzCase, view};
use subpixel_shadows::gpu::{Gpu, KeptPrograms};
use subpixel_shadows::methods::{FacetMode, Settings};
use subpixel_shadows::pass::{Casters, FrameStatus, Inputs, PassConfig, Target};
use subpixel_shadows::scene::{Camera, Light};
use subpixel_shadows::{Error, Result, ShadowPass};

/// Cameras of a walk, in the order that they are looked from: the first comes again.
const TURNS: [usize; 6] = [0, 1, 2, 0, 3, 1];
/// Frames in which the lists of a pass must have grown to what a camera needs.
const FRAMES: u32 = 8;

/// How walks went.
#[derive(Clone, Debug, Default)]
pub struct Walks {
    /// Worlds.
    pub worlds: u64,
    /// Of them, those that the pass refuses.
    pub refused: u64,
    /// Pictures held against each other.
    pub pictures: u64,
    /// Of them, those made with light maps of an earlier frame.
    pub kept: u64,
    /// Those in which something is in shadow.
    pub shadowed: u64,
    /// Pictures that differ, with the number of the world.
    pub faults: Vec<String>,
}

impl Walks {
    /// Takes a walk in the world of a case. What is settled early is not compared: with one facet a pixel, lit masks of samples beside it.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device fails.
    pub fn take(&mut self, gpu: &Gpu, programs: &KeptPrograms, case: &FuzzCase) -> Result<()> {
        self.worlds += 1;
        match programs.within(|| self.walk(gpu, case)) {
            Err(Error::Gpu(text)) => Err(Error::Gpu(format!("world {}: {text}", case.number))),
            Err(_) => {
                self.refused += 1;
                Ok(())
            }
            Ok(()) => Ok(()),
        }
    }

    fn walk(&mut self, gpu: &Gpu, case: &FuzzCase) -> Result<()> {
        let (scene, r) = (case.world.scene()?, &mut Random::of(case.seed ^ 0x6b65_7074, case.number));
        let mut cameras = vec![scene.camera];
        for _ in 1..4 {
            cameras.push(view::camera(r, &case.world.mesh).apply(None, &case.world.mesh)?);
        }
        let settings = Settings { partition: None, ..case.how.settings.clone() };
        let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
        let mut passes = Vec::new();
        for keep_maps in [true, false] {
            let config =
                PassConfig { keep_maps, budget: case.how.budget, ..PassConfig::new(settings.clone(), casters) };
            passes.push(ShadowPass::new(&gpu.device, &gpu.queue, &config)?);
        }
        for at in TURNS {
            let mut both = Vec::new();
            for pass in &mut passes {
                both.push(complete(gpu, pass, &cameras[at], &scene.light)?);
            }
            let ([one, anew], certain) = (&both[..], (settings.size[0] * settings.size[1]) as usize) else {
                continue;
            };
            let certain = if settings.facets == FacetMode::One { certain } else { one.0.len() };
            let differ = one.0[..certain].iter().zip(&anew.0[..certain]).filter(|(a, b)| a != b).count();
            if differ > 0 || one.0.len() != anew.0.len() {
                self.faults.push(format!("world {} from camera {at}: {differ} of {certain} words differ", case.number));
            }
            self.pictures += 1;
            self.kept += u64::from(one.1.maps_kept);
            self.shadowed += u64::from(one.1.counts.visibility_evaluations > 0);
        }
        Ok(())
    }
}

/// Visibility and lit masks of the first complete frame.
fn complete(gpu: &Gpu, pass: &mut ShadowPass, camera: &Camera, light: &Light) -> Result<(Vec<u32>, FrameStatus)> {
    for _ in 0..FRAMES {
        let mut encoder = gpu.encoder();
        pass.record(&mut encoder, &Inputs::new(camera, light), &Target::default())?;
        gpu.submit_and_wait(encoder)?;
        let status = crate::status_of(pass);
        if let Some(error) = status.error {
            return Err(Error::Gpu(error));
        }
        if status.complete {
            return Ok((words(gpu, pass.visibility(), pass.lit())?, status));
        }
    }
    // Lists that no budget holds.
    Err(Error::Config(format!("no frame of {FRAMES} was complete")))
}
