//! Methods and settings that are compared.

use super::row::Row;
use subpixel_shadows::Result;
use subpixel_shadows::light_view::{SplitPlan, Warp};
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::{
    AxisSettings, DeepSettings, DensityRule, DiscFilter, FacetMode, HistorySettings, MethodName, MomentSettings,
    PageRule, PageSettings, PairVariant, PolygonIdSettings, ProjectionVariant, RayTracedSettings,
    ReconstructableSettings, Settings, ShadowMapSettings, SmsrSettings, SmsrShape, SpsmEncoding, SpsmSettings,
};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::stages::compared_depths::DepthRule;

/// Variants to compare.
#[derive(Clone, Debug, PartialEq)]
pub struct Scope {
    /// Methods.
    pub methods: Vec<MethodName>,
    /// Samples a pixel; the reference row has the one nearest to 32.
    pub samples: Vec<u32>,
    /// Map sizes; every number of samples is measured at the first of them, the others at one number of samples.
    pub maps: Vec<u32>,
    /// Image size.
    pub size: [u32; 2],
    /// Settings beyond one and several facets a pixel: mask tables, and whatever else a method has.
    pub all_settings: bool,
}

/// One method with one setting.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportVariant {
    /// The method.
    pub method: MethodName,
    /// Settings beyond samples and map, such as `facets=all`.
    pub setting: String,
    /// Everything that is set. The plan of a scene may leave out more.
    pub settings: Settings,
}

impl ReportVariant {
    /// Whether a row is of it, on whatever scene.
    pub fn made(&self, row: &Row) -> bool {
        let own = (self.settings.map, self.settings.samples.count(), self.method.name(), self.setting.as_str());
        own == (row.map, row.samples, row.method.as_str(), row.setting.as_str())
    }
}

impl Scope {
    /// The number of samples nearest to 32, where one must represent all.
    pub fn usual_samples(&self) -> u32 {
        self.samples.iter().copied().min_by_key(|n| n.abs_diff(32)).unwrap_or(32)
    }

    fn settings(&self, samples: u32, map: u32) -> Result<Settings> {
        let samples = Samples::new(Pattern::LowDiscrepancy, samples)?;
        Ok(Settings { facets: FacetMode::One, cull_back: true, ..Settings::new(self.size, map, samples) })
    }

    /// The row that others are compared with: `facet-masks` with one facet a pixel, the usual samples, the first map.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Config`] for samples, map or image that cannot be.
    pub fn reference(&self) -> Result<ReportVariant> {
        let settings = self.settings(self.usual_samples(), self.maps.first().copied().unwrap_or(512))?;
        settings.check()?;
        Ok(ReportVariant { method: MethodName::FacetMasks, setting: "facets=one".to_owned(), settings })
    }
}

/// Every row of a scope, in a fixed order, the reference first if it is among them.
///
/// # Errors
/// As [`Scope::reference`].
pub fn variants(scope: &Scope) -> Result<Vec<ReportVariant>> {
    let usual = scope.usual_samples();
    let mut found = Vec::new();
    let places = scope.maps.iter().enumerate().flat_map(|(m, &map)| {
        let here = scope.samples.iter().copied().filter(move |&n| m == 0 || n == usual);
        here.map(move |n| (n, map))
    });
    for (samples, map) in places {
        let settings = scope.settings(samples, map)?;
        settings.check()?;
        let usual_place = samples == usual && Some(&map) == scope.maps.first();
        for &method in &scope.methods {
            of_method(method, &settings, scope.all_settings && usual_place, &mut found);
        }
    }
    let reference = scope.reference()?;
    found.sort_by_key(|v| *v != reference);
    Ok(found)
}

/// The settings in which a method is compared.
fn of_method(method: MethodName, settings: &Settings, more: bool, found: &mut Vec<ReportVariant>) {
    let mut add = |setting: &str, settings: Settings| {
        found.push(ReportVariant { method, setting: setting.to_owned(), settings });
    };
    match method {
        MethodName::FacetMasks => {
            let all = Settings { facets: FacetMode::All, ..settings.clone() };
            add("facets=one", settings.clone());
            add("facets=all", all.clone());
            if more {
                add("facets=one validity=off", Settings { validity: false, ..settings.clone() });
                add("facets=one masks=table", Settings { masks: MaskVariant::TABLE, ..settings.clone() });
                add("facets=all masks=table", Settings { masks: MaskVariant::TABLE, ..all });
                let projection = ProjectionVariant::TwoStep;
                add("facets=one projection=two-step", Settings { projection, ..settings.clone() });
                add("facets=one pairs=grouped", Settings { pairs: PairVariant::Grouped, ..settings.clone() });
                add("facets=one pairs=sorted", Settings { pairs: PairVariant::Sorted, ..settings.clone() });
            }
        }
        MethodName::ShadowMap => {
            add("", settings.clone());
            if more {
                for (name, rule) in
                    [("midpoint", DepthRule::Midpoint), ("second", DepthRule::Second), ("dual", DepthRule::DUAL)]
                {
                    let shadow_map = ShadowMapSettings { compared: Some(rule), ..settings.shadow_map };
                    add(&format!("compare={name}"), Settings { shadow_map, ..settings.clone() });
                }
                let history = Some(HistorySettings { frames: 16, ..HistorySettings::default() });
                add("history=16", Settings { history, ..settings.clone() });
            }
        }
        MethodName::Pcf => {
            for kernel in [3, 2, 5, 7] {
                if kernel == 3 || more {
                    let shadow_map = ShadowMapSettings { kernel, ..settings.shadow_map };
                    add(&format!("kernel={kernel}"), Settings { shadow_map, ..settings.clone() });
                }
            }
            for (taps, radius) in [(9, 1.5), (25, 2.5)] {
                if more {
                    let disc = Some(DiscFilter { taps, radius, turned: false });
                    let shadow_map = ShadowMapSettings { disc, ..settings.shadow_map };
                    add(&format!("taps={taps} radius={radius}"), Settings { shadow_map, ..settings.clone() });
                }
            }
        }
        MethodName::Smsr => {
            add("shape=midpoints", settings.clone());
            if more {
                let smsr = SmsrSettings { shape: SmsrShape::Corners, ..settings.smsr };
                add("shape=corners", Settings { smsr, ..settings.clone() });
            }
        }
        MethodName::SilhouetteMap
        | MethodName::Variance
        | MethodName::FourMoments
        | MethodName::Trapezoidal
        | MethodName::Lispsm
        | MethodName::Perspective => {
            add("", settings.clone());
        }
        MethodName::Deep => {
            for (sub_texels, nodes) in [(4, 7), (2, 7), (4, 3), (8, 7), (8, 15)] {
                if (sub_texels, nodes) == (4, 7) || more {
                    let deep = DeepSettings { sub_texels, nodes, ..settings.deep };
                    add(&format!("sub-texels={sub_texels} nodes={nodes}"), Settings { deep, ..settings.clone() });
                }
            }
        }
        MethodName::LayeredVariance => {
            for layers in [4, 2, 8] {
                if layers == 4 || more {
                    let moments = MomentSettings { layers, ..settings.moments };
                    add(&format!("layers={layers}"), Settings { moments, ..settings.clone() });
                }
            }
        }
        MethodName::Convolution => {
            for terms in [16, 8, 4] {
                if terms == 16 || more {
                    let moments = MomentSettings { terms, ..settings.moments };
                    add(&format!("terms={terms}"), Settings { moments, ..settings.clone() });
                }
            }
        }
        MethodName::Exponential | MethodName::ExponentialVariance => {
            for exponent in [40.0, 20.0, 10.0] {
                if exponent == 40.0 || more {
                    let moments = MomentSettings { exponent, ..settings.moments };
                    add(&format!("exponent={exponent}"), Settings { moments, ..settings.clone() });
                }
            }
        }
        MethodName::ParallelSplit => add("splits=3", settings.clone()),
        MethodName::Remix => {
            let with = |splits, warp, moments| {
                let partition = Some(SplitPlan { splits, warp, focus: SplitPlan::FOCUS, ..SplitPlan::default() });
                Settings { partition, moments, ..settings.clone() }
            };
            let moments = settings.moments;
            add("warp=fitted", settings.clone());
            if more {
                add("warp=even", with(3, Warp::Box, moments));
                add("warp=trapezoid grazing=5", with(3, Warp::Trapezoid, MomentSettings { grazing: 5.0, ..moments }));
                add("warp=fitted splits=1", with(1, Warp::Fitted, moments));
                add("warp=fitted bleeding=0.2", with(3, Warp::Fitted, MomentSettings { bleeding: 0.2, ..moments }));
            }
        }
        MethodName::ResolutionMatched => {
            for finer in [0, 1, 2] {
                if finer == 0 || more {
                    let pages = PageSettings { finer, ..settings.pages };
                    add(&format!("finer={finer}"), Settings { pages, ..settings.clone() });
                }
            }
            for (name, rule) in [
                ("edges", PageRule::Edges),
                ("fitted", PageRule::Fitted),
                ("tiled", PageRule::Tiled),
                ("queried", PageRule::Queried),
            ] {
                let pages = PageSettings { rule, ..settings.pages };
                add(&format!("page-rule={name}"), Settings { pages, ..settings.clone() });
            }
        }
        MethodName::Rectilinear => {
            for (name, density) in [("requested", DensityRule::Requested), ("logarithmic", DensityRule::Logarithmic)] {
                let axes = AxisSettings { density, ..settings.axes };
                add(&format!("density={name}"), Settings { axes, ..settings.clone() });
            }
            if more {
                let axes = AxisSettings { stretch: 8, ..settings.axes };
                add("density=requested stretch=8", Settings { axes, ..settings.clone() });
                let axes = AxisSettings { density: DensityRule::Logarithmic, ..settings.axes };
                let plan = SplitPlan { splits: 1, warp: Warp::Fitted, focus: SplitPlan::FOCUS, ..SplitPlan::default() };
                let partition = Some(plan);
                add("density=logarithmic warp=fitted", Settings { axes, partition, ..settings.clone() });
            }
        }
        MethodName::RayTraced => {
            let ray_traced = RayTracedSettings { silhouettes: true };
            for (name, facets) in [("one", FacetMode::One), ("all", FacetMode::All)] {
                let settings = Settings { facets, ..settings.clone() };
                add(&format!("facets={name} rays=all"), settings.clone());
                add(&format!("facets={name} rays=silhouettes"), Settings { ray_traced, ..settings });
            }
        }
        MethodName::Supersampled => {
            add("facets=one", settings.clone());
            add("facets=all", Settings { facets: FacetMode::All, ..settings.clone() });
        }
        MethodName::Reconstructable => {
            for lookups in [5, 1, 3, 7] {
                if lookups == 5 || more {
                    let reconstructable = ReconstructableSettings { lookups, ..settings.reconstructable };
                    add(&format!("lookups={lookups}"), Settings { reconstructable, ..settings.clone() });
                }
            }
        }
        MethodName::PolygonIds => {
            for lookups in [1, 3, 5] {
                if lookups == 1 || more {
                    let polygon_ids = PolygonIdSettings { lookups };
                    add(&format!("lookups={lookups}"), Settings { polygon_ids, ..settings.clone() });
                }
            }
        }
        MethodName::Spsm => {
            add("encoding=lines", settings.clone());
            if more {
                let with = |spsm| Settings { spsm, ..settings.clone() };
                let (paper, lines) = (SpsmEncoding::Paper, SpsmSettings::default());
                add("encoding=paper", with(SpsmSettings { encoding: paper, ..lines }));
                add("encoding=lines search=wide", with(SpsmSettings { radius: 2, stretch: 0, ..lines }));
                add("encoding=lines search=near", with(SpsmSettings { stretch: 0, ..lines }));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_another_and_the_reference_comes_first() {
        let scope = Scope {
            methods: MethodName::ALL.to_vec(),
            samples: vec![1, 32, 128],
            maps: vec![512, 1024],
            size: [64, 48],
            all_settings: true,
        };
        let rows = variants(&scope).unwrap();
        assert_eq!(rows[0], scope.reference().unwrap());
        for (k, row) in rows.iter().enumerate() {
            assert!(!rows[..k].contains(row), "{row:?} twice");
            assert!(row.settings.map == 512 || row.settings.samples.count() == 32, "{row:?}");
        }
        let fewer = variants(&Scope { all_settings: false, ..scope.clone() }).unwrap();
        assert!(fewer.len() < rows.len() && fewer.iter().all(|v| rows.contains(v)));
        assert!(variants(&Scope { samples: vec![7], ..scope.clone() }).is_err());
        assert!(variants(&Scope { maps: vec![0], ..scope }).is_err());
    }
}
