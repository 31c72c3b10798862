//! Making a failing case smaller: triangles first, then the image, then the settings.

use super::FuzzCase;
use crate::scene::CameraOverride;
use std::time::{Duration, Instant};
use subpixel_shadows::light_view::OmniMaps;
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::{FacetMode, PairVariant, RayTracedSettings, Settings};
use subpixel_shadows::render::Budget;
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{AlphaTested, Mesh};

/// Shrinks with a bound in time.
struct Shrinker<'a> {
    case: FuzzCase,
    fails: &'a mut dyn FnMut(&FuzzCase) -> bool,
    end: Instant,
}

/// The smallest case found within `patience` for which `fails` still holds, as it does for `case`; each question is answered for a case
/// that is smaller than the last that failed.
pub fn shrink(case: &FuzzCase, patience: Duration, fails: &mut dyn FnMut(&FuzzCase) -> bool) -> FuzzCase {
    let mut s = Shrinker { case: case.clone(), fails, end: Instant::now() + patience };
    // The ground follows the bounds of the mesh, so with it nothing can be taken off without moving it.
    s.ground();
    s.holes();
    s.triangles();
    s.image();
    s.settings();
    s.triangles();
    s.image();
    s.case
}

impl Shrinker<'_> {
    /// Takes a smaller case in if it fails as well.
    fn takes(&mut self, smaller: FuzzCase) -> bool {
        let better = smaller != self.case && Instant::now() < self.end && (self.fails)(&smaller);
        if better {
            self.case = smaller;
        }
        better
    }

    fn try_settings(&mut self, change: impl FnOnce(&mut Settings)) -> bool {
        let mut smaller = self.case.clone();
        change(&mut smaller.how.settings);
        self.takes(smaller)
    }

    /// Makes the ground part of the mesh, or leaves it out.
    fn ground(&mut self) {
        if !self.case.world.ground {
            return;
        }
        let mut without = self.case.clone();
        without.world.ground = false;
        let mut within = without.clone();
        if let Some(ground) = within.world.mesh.ground_below() {
            within.world.mesh.add_ground(&ground);
        }
        if !self.takes(without) {
            self.takes(within);
        }
    }

    /// Closes all holes, or one after the other.
    fn holes(&mut self) {
        let mut closed = self.case.clone();
        closed.world.alpha = AlphaTested::default();
        if self.takes(closed) {
            return;
        }
        let mut k = 0;
        while k < self.case.world.alpha.triangles.len() {
            let mut fewer = self.case.clone();
            fewer.world.alpha.triangles.remove(k);
            if !self.takes(fewer) {
                k += 1;
            }
        }
    }

    /// Takes triangles out, in ever smaller parts (Zeller, Hildebrandt 2002).
    fn triangles(&mut self) {
        let mut part = self.case.world.mesh.triangles.len().div_ceil(2);
        while part > 0 {
            let (mut first, mut any) = (0, false);
            while first < self.case.world.mesh.triangles.len() {
                if Instant::now() >= self.end {
                    return;
                }
                let Mesh { positions, triangles } = &self.case.world.mesh;
                let last = (first + part).min(triangles.len());
                let rest: Vec<[u32; 3]> = triangles[..first].iter().chain(&triangles[last..]).copied().collect();
                let mesh = Mesh { positions: positions.clone(), triangles: rest };
                let mut smaller = self.case.clone();
                smaller.world.mesh = mesh;
                smaller.world.alpha.triangles.retain_mut(|of| {
                    let place = of.triangle as usize;
                    if place >= last {
                        of.triangle -= (last - first) as u32;
                    }
                    place < first || place >= last
                });
                match self.takes(smaller) {
                    true => any = true,
                    false => first = last,
                }
            }
            if part == 1 && !any {
                break;
            }
            part = if any { part.min(self.case.world.mesh.triangles.len()) } else { part / 2 };
        }
    }

    /// Fewer pixels.
    fn image(&mut self) {
        loop {
            let [w, h] = self.case.how.settings.size;
            let sizes = [[w / 2, h / 2], [w / 2, h], [w, h / 2], [w - w / 4, h - h / 4], [w - 1, h], [w, h - 1]];
            let tried = sizes.into_iter().filter(|s| s[0] > 0 && s[1] > 0 && *s != [w, h]);
            if !tried.into_iter().any(|size| self.try_settings(|s| s.size = size)) {
                break;
            }
        }
    }

    /// Plainer settings, one at a time.
    fn settings(&mut self) {
        for smaller in [
            FuzzCase { how: super::How { budget: Budget::default(), ..self.case.how.clone() }, ..self.case.clone() },
            FuzzCase { how: super::How { both: false, ..self.case.how.clone() }, ..self.case.clone() },
        ] {
            self.takes(smaller);
        }
        let CameraOverride { eye, target, up, fov, .. } = self.case.world.camera;
        let mut centred = self.case.clone();
        centred.world.camera = CameraOverride { eye, target, up, fov, ..CameraOverride::default() };
        self.takes(centred);
        let plain = FuzzCase { how: super::How { force_all: false, ..self.case.how.clone() }, ..self.case.clone() };
        self.takes(plain);
        self.try_settings(|s| s.partition = None);
        self.try_settings(|s| s.omni = OmniMaps::Planes);
        self.try_settings(|s| s.pairs = PairVariant::Tiled);
        self.try_settings(|s| s.masks = MaskVariant::Exact);
        self.try_settings(|s| s.validity = true);
        self.try_settings(|s| s.ray_traced = RayTracedSettings::default());
        self.try_settings(|s| s.facets = FacetMode::All);
        for pattern in [Pattern::LowDiscrepancy, self.case.how.pattern] {
            let fewer = Samples::COUNTS.into_iter().take_while(|n| *n < self.case.how.settings.samples.count());
            let counts: Vec<u32> = fewer.chain([self.case.how.settings.samples.count()]).collect();
            let found = counts.into_iter().any(|count| {
                let Ok(samples) = Samples::new(pattern, count) else { return false };
                let mut smaller = self.case.clone();
                (smaller.how.pattern, smaller.how.settings.samples) = (pattern, samples);
                self.takes(smaller)
            });
            if found {
                break;
            }
        }
        let now = self.case.how.settings.map;
        for map in [1, 2, 4, 8, 16, 32, 64, 128].into_iter().take_while(|map| *map < now) {
            if self.try_settings(|s| s.map = map) {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;
    use subpixel_shadows::methods::MethodName;

    const LONG: Duration = Duration::from_secs(600);

    /// A case of many triangles.
    fn large() -> FuzzCase {
        let cases = (0..).map(|number| FuzzCase::of(11, number).unwrap());
        let wanted = |c: &FuzzCase| c.world.mesh.triangles.len() > 100 && c.how.method == MethodName::FacetMasks;
        cases.into_iter().find(wanted).unwrap()
    }

    /// A fault that two triangles make together, in images of 5 x 3 pixels and more, with maps of 16 texels and more.
    #[test]
    fn what_makes_the_fault_is_left() {
        let case = large();
        let triangles = &case.world.mesh.triangles;
        let two = [triangles[3], triangles[triangles.len() - 5]];
        let asked = Cell::new(0);
        let mut fails = |c: &FuzzCase| {
            asked.set(asked.get() + 1);
            let s = &c.how.settings;
            let both = two.iter().all(|t| c.world.mesh.triangles.contains(t));
            both && s.size[0] >= 5 && s.size[1] >= 3 && s.map >= 16
        };
        let big = FuzzCase {
            how: super::super::How {
                settings: Settings { size: [40, 31], map: 77, ..case.how.settings.clone() },
                ..case.how.clone()
            },
            ..case.clone()
        };
        assert!(fails(&big));
        let small = shrink(&big, LONG, &mut fails);
        assert_eq!(small.world.mesh.triangles.len(), 2);
        assert!(two.iter().all(|t| small.world.mesh.triangles.contains(t)) && !small.world.ground);
        let s = &small.how.settings;
        assert_eq!((s.size, s.map, s.samples.count()), ([5, 3], 16, 1));
        assert_eq!((s.pairs, s.facets, s.masks), (PairVariant::Tiled, FacetMode::All, MaskVariant::Exact));
        assert!(!small.how.force_all && small.how.budget == Budget::default());
        assert!(asked.get() < 1000, "{} questions", asked.get());
    }

    #[test]
    fn without_time_a_case_stays_as_it_is() {
        let case = large();
        let mut fails = |_: &FuzzCase| panic!("asked");
        assert_eq!(shrink(&case, Duration::ZERO, &mut fails), case);
    }

    /// Each answer costs; no question is begun after the end.
    #[test]
    fn shrinking_ends_in_time() {
        let (case, begin) = (large(), Instant::now());
        let mut fails = |_: &FuzzCase| {
            std::thread::sleep(Duration::from_millis(20));
            true
        };
        shrink(&case, Duration::from_millis(50), &mut fails);
        assert!(begin.elapsed() < Duration::from_secs(5));
    }
}
