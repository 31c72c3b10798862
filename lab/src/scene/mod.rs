//! Scenes: loaders and built-in ones.

pub mod builtin;
pub mod load;
mod open;
pub mod options;

pub use builtin::{ALPHA_NAMES, BUILTIN_NAMES, PAPER_NAMES, builtin, names};
pub use load::{Files, Loaded, load, scene_file};
pub use options::{CameraOverride, DEFAULT_LIGHT, SceneOptions, light_from_text};

use subpixel_shadows::Result;
use subpixel_shadows::methods::Prepared;
/// Parts of a scene.
pub use subpixel_shadows::scene::{AlphaTested, Camera, Ground, Lens, Light, Mesh};

/// Mesh of a scene, as scene files name it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Base {
    /// A built-in scene's.
    Builtin(String),
    /// A file's, by its path from the folder of the file that was opened.
    Mesh(String),
}

/// A scene: one mesh, one camera, one light.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the built-in scene, or the file it came from.
    pub name: String,
    /// Its mesh without a ground, as scene files name it.
    pub base: Base,
    /// All casters and receivers, the ground included (its two triangles are the last) where there is one.
    pub mesh: Mesh,
    /// Its triangles that are alpha-tested.
    pub alpha: AlphaTested,
    /// The camera.
    pub camera: Camera,
    /// The light.
    pub light: Light,
    /// The ground plane that was added, if one was.
    pub ground: Option<Ground>,
}

impl Scene {
    /// The mesh with its holes, prepared.
    ///
    /// # Errors
    /// As [`Prepared::with_alpha`].
    pub fn prepared(&self) -> Result<Prepared> {
        Prepared::with_alpha(&self.mesh, &self.alpha)
    }
}
