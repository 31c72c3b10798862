//! Limits of a pipeline, and the entry points that take more.

use crate::families::{FAMILIES, Report};
use crate::{Figures, Pipeline};

/// A figure that has a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// [`Figures::scratch`]: none.
    Scratch,
    /// [`Figures::spilled_vector`]: none.
    SpilledVector,
    /// [`Figures::spilled_scalar`]: none.
    SpilledScalar,
    /// [`Figures::code`]: less than 16 KiB, half of what the instruction cache of two compute units holds.
    Code,
    /// [`Figures::waves`]: 8 on navi21, which are 128 vector registers an invocation, and what these are on vega10, 2; twice as many for those that
    /// hold [most of the time](BUSY).
    Waves,
}

impl Figure {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Scratch, Self::SpilledVector, Self::SpilledScalar, Self::Code, Self::Waves];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scratch => "scratch",
            Self::SpilledVector => "spilled vector registers",
            Self::SpilledScalar => "spilled scalar registers",
            Self::Code => "code",
            Self::Waves => "waves",
        }
    }

    fn of(self, figures: &Figures) -> u64 {
        match self {
            Self::Scratch => figures.scratch,
            Self::SpilledVector => figures.spilled_vector,
            Self::SpilledScalar => figures.spilled_scalar,
            Self::Code => figures.code,
            Self::Waves => figures.waves,
        }
    }

    /// Whether the first is worse than the second.
    fn is_worse(self, value: u64, than: u64) -> bool {
        if self == Self::Waves { value < than } else { value > than }
    }

    /// The limit for an entry point, on each of [`FAMILIES`].
    pub fn limit(self, entry: &str) -> [u64; FAMILIES.len()] {
        match self {
            Self::Scratch | Self::SpilledVector | Self::SpilledScalar => [0; 2],
            Self::Code => [(16 << 10) - 1; 2],
            Self::Waves => [8, 2].map(|waves| if BUSY.contains(&entry) { 2 * waves } else { waves }),
        }
    }
}

/// The entry points that hold most of the time: their stages take 84 % of a frame of `windmill` (`cargo run --release`).
pub const BUSY: [&str; 13] = [
    "candidate_pairs.cull",
    "facet_classify.classify",
    "front_layer.check",
    "light_layers.raster",
    "pixel_texel_pairs.count",
    "pixel_texel_pairs.emit_rest",
    "pixel_triangles.count",
    "pixel_triangles.cover",
    "pixel_triangles.emit_rest",
    "sample_surfaces.nearest",
    "triangle_texel_pairs.count",
    "triangle_texel_pairs.emit_rest",
    "visibility_masks.evaluate",
];

/// An entry point that takes more, of one figure, than [`Figure::limit`] allows.
#[derive(Clone, Copy, Debug)]
pub struct Exception {
    /// Kernel and entry point.
    pub entry: &'static str,
    /// The figure.
    pub figure: Figure,
    /// The figure of its worst pipeline, on each of [`FAMILIES`]: a worse one is a fault, and so is one better by an eighth, as this is then to be
    /// mended.
    pub worst: [u64; FAMILIES.len()],
    /// Why.
    pub why: &'static str,
}

const NEAR: &str = "72 to 84 registers, where 64 would do";
const SAMPLES_4: &str = "128 samples: the code of a word four times";
const BITS_46: &str = "46 bits: a rare run, of what single precision leaves open";
const LIST: &str = "an array that is indexed: the pieces of a border, up to 75";
const TREE: &str = "a walk through a tree, with its ray and its stack in registers";
const RADIUS_2: &str = "a search of 5 x 5 texels, with code for each";
const TWO_STEP: &str = "128 samples by two projections, for comparison";

/// All of them.
pub const EXCEPTIONS: &[Exception] = &[
    except("candidate_pairs.cull", Figure::Waves, [14, 3], NEAR),
    except("facet_classify.classify", Figure::Waves, [12, 3], NEAR),
    except("pixel_coverage.cover", Figure::Code, [20172, 20212], SAMPLES_4),
    except("pixel_coverage.cover with holes", Figure::Code, [22288, 22328], SAMPLES_4),
    except("pixel_texel_pairs.count", Figure::Waves, [14, 3], NEAR),
    except("pixel_texel_pairs.emit_rest", Figure::Waves, [14, 3], NEAR),
    except("sample_bins.refine_all", Figure::SpilledScalar, [2, 12], BITS_46),
    except("sample_bins.refine_all", Figure::Code, [36696, 36952], BITS_46),
    except("sample_bins.refine_all", Figure::Waves, [6, 1], BITS_46),
    except("sample_bins.refine_crowds", Figure::SpilledScalar, [14, 24], BITS_46),
    except("sample_bins.refine_crowds", Figure::Code, [35904, 36160], BITS_46),
    except("sample_bins.refine_all with holes", Figure::SpilledScalar, [2, 12], BITS_46),
    except("sample_bins.refine_all with holes", Figure::Code, [45284, 45540], BITS_46),
    except("sample_bins.refine_all with holes", Figure::Waves, [6, 1], BITS_46),
    except("sample_bins.refine_crowds with holes", Figure::SpilledScalar, [18, 26], BITS_46),
    except("sample_bins.refine_crowds with holes", Figure::Code, [44456, 44700], BITS_46),
    except("shadow_rays.trace", Figure::Waves, [6, 1], TREE),
    except("shadow_rays.refine_all", Figure::Code, [19816, 19920], BITS_46),
    except("shadow_rays.refine_all", Figure::Waves, [4, 1], BITS_46),
    except("shadow_rays.cut_facets", Figure::Code, [17152, 17240], TREE),
    except("shadow_rays.cut_facets", Figure::Waves, [4, 1], TREE),
    except("shadow_rays.trace with holes", Figure::Waves, [4, 1], TREE),
    except("shadow_rays.refine_all with holes", Figure::Code, [24332, 24456], BITS_46),
    except("shadow_rays.refine_all with holes", Figure::Waves, [4, 1], BITS_46),
    except("shadow_rays.cut_facets with holes", Figure::Code, [17204, 17292], TREE),
    except("shadow_rays.cut_facets with holes", Figure::Waves, [4, 1], TREE),
    except("spsm_query.recover", Figure::Scratch, [76800, 76800], LIST),
    except("spsm_query.recover", Figure::Code, [25732, 26364], RADIUS_2),
    except("visibility_masks.evaluate", Figure::Code, [17880, 17880], TWO_STEP),
    except("visibility_masks.evaluate", Figure::Waves, [14, 3], NEAR),
    except("visibility_masks.evaluate with holes", Figure::Code, [17472, 17504], SAMPLES_4),
    except("visibility_masks.refine with holes", Figure::Code, [32036, 32068], BITS_46),
    except("visibility_masks.refine", Figure::Code, [29236, 29252], BITS_46),
];

const fn except(entry: &'static str, figure: Figure, worst: [u64; FAMILIES.len()], why: &'static str) -> Exception {
    Exception { entry, figure, worst, why }
}

/// The worst pipeline of an entry point in one figure.
fn worst<'a>(report: &'a Report, entry: &str, figure: Figure) -> Option<(u64, &'a Pipeline)> {
    let of = report.rows.iter().filter(|row| row.pipeline.name() == entry);
    let values = of.map(|row| (figure.of(&row.figures), &row.pipeline));
    values.reduce(|a, b| if figure.is_worse(b.0, a.0) { b } else { a })
}

/// Faults in reports of [`FAMILIES`], a line each.
pub fn faults(reports: &[Report], exceptions: &[Exception]) -> Vec<String> {
    let mut faults = Vec::new();
    let mut entries: Vec<String> = reports.iter().flat_map(|r| &r.rows).map(|row| row.pipeline.name()).collect();
    entries.sort();
    entries.dedup();
    for (entry, figure) in entries.iter().flat_map(|entry| Figure::ALL.map(|figure| (entry, figure))) {
        let limit = figure.limit(entry);
        let exception = exceptions.iter().find(|e| e.entry == entry && e.figure == figure);
        let most = exception.map_or(limit, |e| e.worst);
        let mut needed = false;
        for ((report, family), (limit, most)) in reports.iter().zip(FAMILIES).zip(limit.into_iter().zip(most)) {
            let Some((value, pipeline)) = worst(report, entry, figure) else { continue };
            let (name, constants) = (figure.name(), pipeline.constants());
            needed |= figure.is_worse(value, limit);
            if figure.is_worse(value, most) {
                faults.push(format!("{family}: {entry} ({constants}): {name} {value}, the limit is {most}"));
            } else if exception.is_some() && value.abs_diff(most) > most / 8 && figure.is_worse(most, limit) {
                faults.push(format!("{family}: {entry}: {name} {value}: its exception says {most}, and may say less"));
            }
        }
        if exception.is_some() && !needed {
            faults.push(format!("{entry}: {}: no exception is needed any more", figure.name()));
        }
    }
    for Exception { entry, .. } in exceptions.iter().filter(|e| !entries.iter().any(|entry| entry == e.entry)) {
        faults.push(format!("{entry}: an exception, and no such entry point"));
    }
    faults
}
