//! The pipelines that the library makes.

use crate::Pipeline;
use futures::executor::block_on;
use lab::scene::builtin;
use std::collections::BTreeSet;
use std::sync::Mutex;
use subpixel_shadows::gpu::{Gpu, KeptPrograms, Profile, kernels, program};
use subpixel_shadows::light_view::OmniMaps;
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::facet_masks::Pipelines;
use subpixel_shadows::methods::names::TexelQuery;
use subpixel_shadows::methods::{
    DeepSettings, DensityRule, DiscFilter, FacetMode, MethodName, MomentSettings, PageRule, PairVariant, PixelFilter,
    ProjectionVariant, Settings, SmsrSettings, SmsrShape, SpsmEncoding, SpsmSettings,
};
use subpixel_shadows::pass::{Casters, PassConfig, ShadowPass};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result, wgpu};

/// Samples a pixel: less than a word, one word, the most; and one, of which some methods know a shorter way.
const SAMPLES: [u32; 4] = [1, 8, 32, 128];

/// Keeps what [`program::LOG`] says.
struct Heard(Mutex<Vec<String>>);

static HEARD: Heard = Heard(Mutex::new(Vec::new()));

impl log::Log for Heard {
    fn enabled(&self, metadata: &log::Metadata) -> bool {
        metadata.target() == program::LOG
    }

    fn log(&self, record: &log::Record) {
        if self.enabled(record.metadata())
            && let Ok(mut heard) = self.0.lock()
        {
            heard.push(record.args().to_string());
        }
    }

    fn flush(&self) {}
}

/// The settings that make pipelines of their own, of a method.
fn settings(method: MethodName, plain: &Settings) -> Vec<Settings> {
    let mut all = vec![plain.clone()];
    // Everything that is there so far, and each once more with a change. How pairs meet changes no pipeline of what else is varied.
    let mut vary = |option: &str, changes: &[&dyn Fn(&mut Settings)]| {
        if method.takes(option) {
            let so_far: Vec<_> = all.iter().filter(|s| s.pairs == plain.pairs).cloned().collect();
            for (settings, change) in so_far.iter().flat_map(|s| changes.iter().map(move |c| (s, c))) {
                let mut settings = settings.clone();
                change(&mut settings);
                all.push(settings);
            }
        }
    };
    vary("facets", &[&|s| s.facets = FacetMode::One]);
    vary("pairs", &[&|s| s.pairs = PairVariant::Grouped, &|s| s.pairs = PairVariant::Sorted]);
    if method == MethodName::FacetMasks {
        vary("validity", &[&|s| s.validity = !s.validity]);
    }
    vary("masks", &[&|s| s.masks = MaskVariant::Table { angles: 64, offsets: 64 }]);
    vary("projection", &[&|s| s.projection = ProjectionVariant::TwoStep]);
    vary("filter", &[&|s| s.filter = PixelFilter::Tent, &|s| s.filter = PixelFilter::Mitchell]);
    vary("encoding", &[&|s| s.spsm.encoding = SpsmEncoding::Paper]);
    let search = |radius, stretch| move |s: &mut Settings| s.spsm = SpsmSettings { radius, stretch, ..s.spsm };
    vary("search", &[&search(2, 0), &search(1, 2)]);
    vary("encoding", &[&|s| s.spsm.seen_only = !s.spsm.seen_only]);
    vary("lookups", &[&|s| (s.reconstructable.lookups, s.polygon_ids.lookups) = (7, 7)]);
    vary("rays", &[&|s| s.ray_traced.silhouettes = !s.ray_traced.silhouettes]);
    vary("kernel", &[&|s| s.shadow_map.kernel = 7]);
    vary("taps", &[&|s| s.shadow_map.disc = Some(DiscFilter { turned: true, ..DiscFilter::default() })]);
    let deep = |sub_texels, nodes| move |s: &mut Settings| s.deep = DeepSettings { sub_texels, nodes, ..s.deep };
    vary("sub-texels", &[&deep(2, 3), &deep(8, 15)]);
    vary("shape", &[&|s| s.smsr.shape = SmsrShape::Corners]);
    vary("reach", &[&|s| s.smsr.reach = SmsrSettings::LONGEST]);
    vary("exponent", &[&|s| s.moments.exponent = 8.0]);
    vary("layers", &[&|s| s.moments.layers = 7]);
    vary("terms", &[&|s| s.moments.terms = 5]);
    vary("finer", &[&|s| s.pages.finer = 2]);
    for rule in [PageRule::Fitted, PageRule::Edges, PageRule::Tiled] {
        vary("page-rule", &[&|s| s.pages.rule = rule]);
    }
    vary("changed", &[&|s| s.pages.rule = PageRule::Queried]);
    vary("density", &[&|s| s.axes.density = DensityRule::Logarithmic]);
    vary("bleeding", &[&|s| s.moments = MomentSettings { bleeding: 0.2, grazing: 5.0, ..s.moments }]);
    all.push(Settings { count_pixels: true, ..plain.clone() });
    // Rasterizing on paraboloids is the same for all.
    let curved = |s: &Settings| Settings { omni: OmniMaps::Paraboloids, ..s.clone() };
    if method == MethodName::ShadowMap {
        all.push(curved(plain));
    }
    // Holes add the same code whatever the number of samples.
    if plain.samples.count() != SAMPLES[SAMPLES.len() - 1] {
        return all;
    }
    let tested = Settings { alpha_tested: true, ..plain.clone() };
    if method == MethodName::FacetMasks {
        all.push(Settings { facets: FacetMode::One, ..tested.clone() });
    }
    if method.row().query != TexelQuery::Triangles {
        all.extend((method == MethodName::ShadowMap).then(|| curved(&tested)));
        all.push(tested);
    }
    all
}

/// Makes every pass of [`settings`] on this device; on one without 64-bit atomics, the passes that make others there.
fn make(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<()> {
    let scene = builtin("cage").ok_or_else(|| Error::Scene("no cage".to_owned()))?;
    let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let narrow = !device.features().contains(Gpu::WIDE_ATOMICS);
    let methods = MethodName::ALL.iter().filter(|method| !narrow || **method == MethodName::Spsm);
    for (method, samples) in methods.flat_map(|m| SAMPLES.map(|s| (*m, s))) {
        let plain = Settings::new([16, 16], 16, Samples::new(Pattern::LowDiscrepancy, samples)?);
        // Stages without facets know only how many words the samples are, and whether there is one.
        if method != MethodName::FacetMasks && samples == 8 {
            continue;
        }
        for settings in settings(method, &plain) {
            if narrow && (samples > 1 || SpsmSettings { encoding: plain.spsm.encoding, ..settings.spsm } != plain.spsm)
            {
                continue;
            }
            if method == MethodName::FacetMasks {
                for make in [Pipelines::new, Pipelines::with_receivers, Pipelines::facing] {
                    make(device, &settings);
                }
                if settings != plain {
                    continue;
                }
            }
            let pass = PassConfig { method, keep_last: true, ..PassConfig::new(settings, casters) };
            ShadowPass::new(device, queue, &pass)?;
        }
    }
    Ok(())
}

/// [`make`] on a device with what the library uses where it is there, and on one without.
fn make_on_devices() -> Result<()> {
    let gpu = Gpu::open(None)?;
    let name = gpu.adapter.name.as_str();
    let adapter = Gpu::adapters().into_iter().find(|a| a.get_info().name == name);
    let adapter = adapter.ok_or_else(|| Error::NoAdapter(name.to_owned()))?;
    make(&gpu.device, &gpu.queue)?;
    gpu.check()?;
    let plain = adapter.request_device(&wgpu::DeviceDescriptor::default());
    let (device, queue) = block_on(plain).map_err(|e| Error::Gpu(e.to_string()))?;
    make(&device, &queue)
}

/// Every pipeline that the library makes for a GPU, each once, those of one entry point together; an entry point of which no method makes one,
/// with its defaults. The device makes them, too; what it is does not matter.
///
/// # Errors
/// No adapter; what the device refuses.
pub fn pipelines() -> std::result::Result<Vec<Pipeline>, String> {
    // A second call finds its own logger.
    let _ = log::set_logger(&HEARD);
    log::set_max_level(log::LevelFilter::Debug);
    let made = Profile::Gpu.within(|| KeptPrograms::default().within(make_on_devices));
    made.map_err(|e| e.to_string())?;
    let heard = std::mem::take(&mut *HEARD.0.lock().map_err(|e| e.to_string())?);
    let mut seen = BTreeSet::new();
    let mut all = Vec::new();
    for line in heard.into_iter().filter(|line| seen.insert(line.clone())) {
        all.push(serde_json::from_str::<Pipeline>(&line).map_err(|e| format!("{line}: {e}"))?);
    }
    let mut sorted = Vec::new();
    for entry in kernels::ALL.iter().flat_map(|(_, _, entries)| *entries) {
        let before = sorted.len();
        sorted.extend(all.iter().filter(|p| p.0 == entry.kernel && p.1 == entry.name).cloned());
        if sorted.len() == before {
            sorted.push(Pipeline(entry.kernel.to_owned(), entry.name.to_owned(), Default::default()));
        }
    }
    Ok(sorted)
}
