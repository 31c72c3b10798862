//! Random worlds, each held against the CPU engine and against truth: what `subpixel-shadows fuzz` runs.
//!
//! A case is a function of a seed and its number: a [`World`] (mesh, ground, camera, light) and [`How`] it is rendered. [`FuzzDevice::render`]
//! renders it, [`judge`](mod@judge) holds the frame against everything there is to hold it against, [`shrink`](shrink::shrink) makes a failing
//! case smaller, and [`write`](files::write) writes it as a scene file with the command that repeats it.

pub mod check;
pub mod files;
mod holes;
pub mod how;
pub mod judge;
pub mod random;
pub mod run;
mod samples;
pub mod shrink;
pub mod summary;
pub mod view;
pub mod worlds;

pub use check::{FuzzDevice, Shot};
pub use how::How;
pub use judge::{Fault, Figures, Verdict, judge};
pub use run::{FuzzProgress, Run, run};
pub use summary::Summary;
pub use worlds::Kind;

use crate::scene::{Base, CameraOverride, Scene};
use random::Random;
use subpixel_shadows::Result;
use subpixel_shadows::light_view::OmniMaps;
use subpixel_shadows::methods::MethodName;
use subpixel_shadows::scene::{AlphaTested, Light, Mesh};

/// Mesh, camera and light.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    /// The mesh, without the ground.
    pub mesh: Mesh,
    /// Its triangles that have holes.
    pub alpha: AlphaTested,
    /// Whether a ground is put under it.
    pub ground: bool,
    /// The camera, all parts given; near and far follow from the mesh.
    pub camera: CameraOverride,
    /// The light.
    pub light: Light,
}

impl World {
    /// The scene, as [`Scene::open`] makes it of a file that holds this world.
    ///
    /// # Errors
    /// As [`Scene::open`].
    pub fn scene(&self) -> Result<Scene> {
        let name = "fuzz";
        let mut mesh = self.mesh.clone();
        mesh.check(name)?;
        self.alpha.check(&mesh)?;
        let camera = self.camera.apply(None, &mesh)?;
        self.light.check()?;
        let ground = if self.ground { mesh.ground_below() } else { None };
        if let Some(ground) = &ground {
            mesh.add_ground(ground);
            mesh.check(name)?;
        }
        let base = Base::Mesh(name.into());
        Ok(Scene { name: name.into(), base, mesh, alpha: self.alpha.clone(), camera, light: self.light, ground })
    }
}

/// One case.
#[derive(Clone, Debug, PartialEq)]
pub struct FuzzCase {
    /// The seed.
    pub seed: u64,
    /// Its number.
    pub number: u64,
    /// Kind of its mesh.
    pub kind: Kind,
    /// World that is seen.
    pub world: World,
    /// How it is rendered.
    pub how: How,
}

impl FuzzCase {
    /// Case `number` of a seed.
    ///
    /// # Errors
    /// None that a seed can cause.
    pub fn of(seed: u64, number: u64) -> Result<Self> {
        let r = &mut Random::of(seed, number);
        // Neighbours are of different kinds, so that those of one block are of all.
        let kind = Kind::ALL[(number % Kind::ALL.len() as u64) as usize];
        let mut how = How::of(seed, number, r)?;
        let mesh = kind.mesh(r);
        let ground = r.chance(0.35);
        let camera = view::camera(r, &mesh);
        let outside = how.method == MethodName::Supersampled;
        let light = view::light(r, &mesh, camera.eye.unwrap_or_default(), outside);
        // Of a stream of its own, as slices are.
        let cut = &mut Random::of(seed ^ 0xa1fa_0000, number);
        let tested = cut.chance(0.12) && how.method != MethodName::Spsm;
        let alpha = if tested { holes::holes(cut, &mesh) } else { AlphaTested::default() };
        let world = World { mesh, alpha, ground, camera, light };
        if outside && !in_one_view(&world, &how) {
            // It refuses a light that is nearer to a caster than it tells.
            how.method = MethodName::RayTraced;
        }
        if how.method == MethodName::RayTraced || outside && !world.light.is_directional() {
            how.settings.partition = None;
        }
        let s = &mut how.settings;
        let plain = s.partition.is_none() && s.shadow_map.compared.is_none() && s.history.is_none();
        let takes = how.method.takes("omni") && plain && !world.light.is_directional();
        if takes && Random::of(seed ^ 0x0a11_a400, number).chance(0.5) {
            s.omni = OmniMaps::Paraboloids;
        }
        Ok(Self { seed, number, kind, world, how })
    }
}

/// Whether one view of the light holds all that casts.
fn in_one_view(world: &World, how: &How) -> bool {
    let view = || {
        let scene = world.scene()?;
        let prepared = scene.prepared()?;
        let one = subpixel_shadows::methods::Settings {
            facets: subpixel_shadows::methods::FacetMode::One,
            ..how.settings.clone()
        };
        one.light_view(&prepared, &scene.light)
    };
    view().is_ok_and(|view| view.complete)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, SceneOptions};
    use std::collections::HashSet;
    use subpixel_shadows::mask_table::MaskVariant;
    use subpixel_shadows::scene::TestedTriangle;

    #[test]
    fn a_case_is_a_function_of_seed_and_number() {
        for number in 0..60 {
            let case = FuzzCase::of(5, number).unwrap();
            assert_eq!(case, FuzzCase::of(5, number).unwrap());
            let other = FuzzCase::of(6, number).unwrap();
            assert!(other.kind == case.kind && other.world != case.world, "{number}");
        }
    }

    #[test]
    fn cases_are_of_every_sort_and_few_are_refused() {
        let (mut seen, mut refused) = (HashSet::new(), 0);
        for number in 0..6120 {
            let case = FuzzCase::of(1, number).unwrap();
            refused += usize::from(case.world.scene().is_err());
            let (s, how) = (&case.how.settings, &case.how);
            seen.insert(format!("{} samples", s.samples.count()));
            seen.insert(format!("{:?}", case.kind));
            seen.insert(format!("{:?} {:?} {:?}", s.facets, s.pairs, s.masks == MaskVariant::Exact));
            seen.insert(format!("{} {}", how.method.name(), s.validity));
            seen.insert(format!("{:?} {}", how.pattern, how.force_all));
            seen.insert(format!("{:?} {}", how.budget.start.is_some(), how.budget.bytes < 1 << 30));
            let light = match case.world.light {
                Light::Directional { .. } => "directional",
                Light::Point { .. } => "point",
                Light::Spot { .. } => "spot",
            };
            seen.insert(format!("{light} {} {}", case.world.ground, how.both));
            seen.insert(format!("alpha {}", case.world.alpha.is_empty()));
            assert!((1..=300).contains(&s.map) && case.world.mesh.triangles.len() <= 1500, "{case:?}");
        }
        assert!(refused <= 30, "{refused} refused");
        let all = [6, Kind::ALL.len(), 2 * 3 * 2, 2 * MethodName::ALL.len(), 3 * 2, 2 * 2, 3 * 2 * 2, 2];
        assert_eq!(seen.len(), all.iter().sum::<usize>(), "{seen:?}");
    }

    #[test]
    fn a_case_that_is_written_reads_back_as_it_is() {
        let folder = std::env::temp_dir().join(format!("subpixel-shadows-fuzz-{}", std::process::id()));
        let mut holes = 0;
        for number in 0..Kind::ALL.len() as u64 * 6 {
            let case = FuzzCase::of(3, number).unwrap();
            let Ok(made) = case.world.scene() else { continue };
            files::write(&folder, &case, &[]).unwrap();
            let file = folder.join("scene.toml");
            let read = Scene::open(&file.to_string_lossy(), &SceneOptions::default()).unwrap();
            assert_eq!((read.camera, read.light), (made.camera, made.light), "{number}");
            let canonical = |scene: &Scene| scene.prepared().unwrap().mesh().clone();
            assert_eq!(canonical(&read), canonical(&made), "{number}");
            // Maps without a hole are not read; equal triangles have no order.
            let solid = |scene: &Scene| {
                let prepared = scene.prepared().unwrap();
                let (mesh, alpha) = (prepared.mesh(), prepared.alpha());
                let holed = |t: &&TestedTriangle| {
                    let map = &alpha.maps[t.map as usize];
                    map.alpha.iter().any(|&a| f32::from(a) < map.threshold())
                };
                let of = |t: &TestedTriangle| {
                    let corners = mesh.triangles[t.triangle as usize].map(|v| mesh.positions[v as usize]);
                    format!("{corners:?} {:?} {:?}", t.uv, alpha.maps[t.map as usize])
                };
                let mut found: Vec<String> = alpha.triangles.iter().filter(holed).map(of).collect();
                found.sort();
                found
            };
            assert_eq!(solid(&read), solid(&made), "{number}");
            holes += usize::from(!solid(&made).is_empty());
        }
        assert!(holes > 3, "{holes} with holes");
        std::fs::remove_dir_all(folder).unwrap();
    }
}
