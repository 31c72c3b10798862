//! Settings with which a world is rendered.

use super::random::Random;
use crate::report::Promise;
use crate::report::comparison::{Scope, variants};
use subpixel_shadows::Result;
use subpixel_shadows::light_view::{PartBy, SplitPlan, Warp};
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::{FacetMode, MethodName, PairVariant, RayTracedSettings, Settings};
use subpixel_shadows::render::Budget;
use subpixel_shadows::samples::{Pattern, Samples};

/// Cases that follow each other with the same pipelines.
pub const BLOCK: u64 = 10;

/// Settings of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct How {
    /// The method.
    pub method: MethodName,
    /// Of a method of texels, what a report calls its settings (`kernel=5`).
    pub setting: String,
    /// Where samples lie.
    pub pattern: Pattern,
    /// All else, but for what the plan may change.
    pub settings: Settings,
    /// Memory of the lists: whole MiB.
    pub budget: Budget,
    /// Leave nothing out and settle nothing.
    pub force_all: bool,
    /// Also render what `force_all` would, and hold the two pictures against each other.
    pub both: bool,
}

/// Settings that a block of cases shares, because pipelines depend on them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shared {
    samples: u32,
    facets: FacetMode,
    masks: MaskVariant,
    pairs: PairVariant,
}

impl Shared {
    fn of(seed: u64, block: u64) -> Self {
        let r = &mut Random::of(seed ^ 0x5e77_1965, block);
        Self {
            samples: r.pick([1, 8, 8, 16, 16, 32, 32, 32, 64, 128]),
            facets: r.pick([FacetMode::All, FacetMode::All, FacetMode::One]),
            masks: if r.chance(0.12) { MaskVariant::TABLE } else { MaskVariant::Exact },
            pairs: r.pick([PairVariant::Tiled, PairVariant::Tiled, PairVariant::Grouped, PairVariant::Sorted]),
        }
    }
}

/// Map sizes that are likelier than others: small ones, and those around powers of two.
const MAPS: [u32; 24] = [1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 31, 32, 33, 48, 63, 64, 64, 65, 100, 127, 128, 256, 300];

/// Bytes that make some frames take several bands, but not hundreds: triangle-texel pairs grow with the texels of the map, a facet close to
/// the eye may touch most of them, and every band goes through all triangles.
fn small_budget(map: u32, force_all: bool) -> u64 {
    match if force_all { 2 * map } else { map } {
        0..=16 => 1 << 20,
        17..=48 => 6 << 20,
        _ => Budget::default().bytes,
    }
}

impl How {
    /// The settings of case `number`, with numbers of its own for what no pipeline depends on.
    ///
    /// # Errors
    /// None: what is drawn is possible.
    pub fn of(seed: u64, number: u64, r: &mut Random) -> Result<Self> {
        let Shared { samples, facets, masks, pairs } = Shared::of(seed, number / BLOCK);
        let method = match r.whole(0, 99) {
            0..=3 => MethodName::RayTraced,
            4..=9 => MethodName::Supersampled,
            _ => MethodName::FacetMasks,
        };
        let pattern = r.pick([Pattern::LowDiscrepancy, Pattern::LowDiscrepancy, Pattern::Grid, Pattern::Rotated]);
        let most = if samples > 32 { 32 } else { 48 };
        let size = match r.whole(0, 19) {
            0 => [r.whole(1, 3), r.whole(1, 64)],
            1 => [r.whole(1, 96), r.whole(1, 3)],
            2 => [64, 48],
            _ => [r.whole(8, most), r.whole(6, most * 3 / 4)],
        };
        let map = if r.chance(0.4) { r.pick(MAPS) } else { r.whole(1, 300) };
        // Of a stream of its own, so that cases of seeds that were run before stay what they are but for this.
        let slices = &mut Random::of(seed ^ 0x51ce_5000, number);
        let warp = slices.pick([Warp::Box, Warp::Trapezoid, Warp::LightSpace, Warp::Fitted, Warp::Fitted]);
        let (splits, focus) = (slices.whole(1, SplitPlan::MOST), slices.pick([0.1, 0.6, 1.0]));
        let sliced = slices.chance(0.3);
        let warp = if slices.chance(0.2) { Warp::Perspective } else { warp };
        let warp = if Random::of(seed ^ 0x57ab_1e00, number).chance(0.15) { Warp::Stable } else { warp };
        let weight = slices.pick([SplitPlan::WEIGHT, 0.0, 1.0]);
        let faces = warp != Warp::Stable && Random::of(seed ^ 0xface_5000, number).chance(0.2);
        let seen = Random::of(seed ^ 0x5ee_de97, number).chance(0.25);
        let clusters = warp != Warp::Stable && Random::of(seed ^ 0xc105_7e40, number).chance(0.2);
        let (by, splits) = match (faces, seen) {
            _ if clusters => (PartBy::ReceiverClusters, 1),
            (true, _) => (PartBy::FrustumFaces, 1),
            (false, true) => (PartBy::SeenDepth, splits),
            (false, false) => (PartBy::Depth, splits),
        };
        let plan = SplitPlan { by, splits, warp, focus, weight };
        let row = if method == MethodName::FacetMasks && slices.chance(0.12) { Some(texels(slices)?) } else { None };
        let method = row.as_ref().map_or(method, |row| row.0);
        let partition = (sliced && method.takes("splits")).then_some(plan);
        let settings = Settings {
            facets,
            partition,
            validity: r.chance(0.75),
            cull_back: true,
            masks,
            pairs,
            ray_traced: RayTracedSettings { silhouettes: method == MethodName::RayTraced && r.chance(0.5) },
            ..Settings::new(size, map, Samples::new(pattern, samples)?)
        };
        let force_all = r.chance(0.15);
        let small = r.chance(0.3);
        let budget = Budget {
            start: r.chance(0.3).then(|| r.count(1, 5000) as usize),
            bytes: if small { small_budget(map, force_all) } else { Budget::default().bytes },
        };
        let own = method == MethodName::FacetMasks && masks == MaskVariant::Exact;
        let both = r.chance(0.3) && (own || row.is_some()) && !force_all;
        let Some((_, setting, given)) = row else {
            return Ok(Self { method, setting: String::new(), pattern, settings, budget, force_all, both });
        };
        let Settings { size, map, samples, partition, validity, .. } = settings;
        let sliced = setting.contains("splits=") || setting.contains("warp=") || setting.contains("partition=");
        let partition = if sliced { given.partition } else { partition };
        let settings = Settings { size, map, samples, partition, validity, ..given };
        Ok(Self { method, setting, pattern, settings, budget, force_all, both })
    }

    /// The promise for each sample.
    pub fn promise(&self) -> Promise {
        Promise::of(self.method, &self.settings)
    }
}

/// A method of texels, in one of the settings that reports compare.
fn texels(r: &mut Random) -> Result<(MethodName, String, Settings)> {
    let of_texels =
        |m: &MethodName| !matches!(m, MethodName::FacetMasks | MethodName::RayTraced | MethodName::Supersampled);
    let methods: Vec<MethodName> = MethodName::ALL.into_iter().filter(of_texels).collect();
    // The rows of one method, so that those with many are not likelier.
    let methods = vec![methods[r.whole(0, methods.len() as u32 - 1) as usize]];
    let scope = Scope { methods, samples: vec![8], maps: vec![8], size: [8, 8], all_settings: true };
    let mut rows = variants(&scope)?;
    let row = rows.swap_remove(r.whole(0, rows.len() as u32 - 1) as usize);
    Ok((row.method, row.setting, row.settings))
}
