//! Making a failing case smaller: triangles first, then the image, then the settings.

use super::Case;
use crate::mask_table::MaskVariant;
use crate::methods::render::Budget;
use crate::methods::{FacetMode, PairVariant, RayTracedSettings, Settings};
use crate::samples::{Pattern, Samples};
use crate::scene::Mesh;
use std::time::{Duration, Instant};

/// Shrinks with a bound in time.
struct Shrinker<'a> {
    case: Case,
    fails: &'a mut dyn FnMut(&Case) -> bool,
    end: Instant,
}

/// The smallest case found within `patience` for which `fails` still holds, as it does for `case`; each question is answered for a case
/// that is smaller than the last that failed.
pub fn shrink(case: &Case, patience: Duration, fails: &mut dyn FnMut(&Case) -> bool) -> Case {
    let mut s = Shrinker { case: case.clone(), fails, end: Instant::now() + patience };
    // The ground follows the bounds of the mesh, so with it nothing can be taken off without moving it.
    s.ground();
    s.triangles();
    s.image();
    s.settings();
    s.triangles();
    s.image();
    s.case
}

impl Shrinker<'_> {
    /// Takes a smaller case in if it fails as well.
    fn takes(&mut self, smaller: Case) -> bool {
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
            Case { how: super::How { budget: Budget::default(), ..self.case.how.clone() }, ..self.case.clone() },
            Case { how: super::How { both: false, ..self.case.how.clone() }, ..self.case.clone() },
        ] {
            self.takes(smaller);
        }
        let plain = Case { how: super::How { force_all: false, ..self.case.how.clone() }, ..self.case.clone() };
        self.takes(plain);
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
