//! Mesh, camera, light and ground; loaders and built-in scenes.

pub mod adjacency;
#[cfg(feature = "scenes")]
pub mod builtin;
pub mod camera;
mod coplanar;
pub mod light;
#[cfg(feature = "scenes")]
pub mod load;
pub mod mesh;
pub(crate) mod mesh_tree;
#[cfg(feature = "scenes")]
mod open;
pub mod options;
pub(crate) mod weld;

pub use adjacency::{Adjacency, Edge, NO_TRIANGLE};
#[cfg(feature = "scenes")]
pub use builtin::{BUILTIN_NAMES, builtin};
pub use camera::{Camera, PixelRays};
pub use light::Light;
#[cfg(feature = "scenes")]
pub use load::{Loaded, load};
pub use mesh::{Ground, Mesh};
pub use options::{CameraOverride, DEFAULT_LIGHT, SceneOptions};

/// A scene: one mesh, one camera, one light.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the built-in scene, or the file it came from.
    pub name: String,
    /// All casters and receivers, the ground included (its two triangles are the last) where there is one.
    pub mesh: Mesh,
    /// The camera.
    pub camera: Camera,
    /// The light.
    pub light: Light,
    /// The ground plane that was added, if one was.
    pub ground: Option<Ground>,
}
