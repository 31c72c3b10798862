//! Mesh, camera and light, and how a mesh hangs together.

pub mod adjacency;
pub mod alpha;
pub mod area_light;
pub mod camera;
mod coplanar;
pub mod homography;
pub mod light;
pub mod mesh;
pub(crate) mod mesh_tree;
pub(crate) mod objects;
pub mod orthographic;
pub mod projection;
pub(crate) mod weld;

pub use adjacency::{Adjacency, Edge, NO_TRIANGLE};
pub use alpha::{AlphaFilter, AlphaMap, AlphaTested, AlphaWrap, Roles, TestedTriangle};
pub use area_light::AreaLight;
pub use camera::{Camera, Lens, PixelRays};
pub use homography::Homography;
pub use light::Light;
pub use mesh::{Ground, Mesh};
pub use orthographic::{Orthographic, OrthographicView};
pub use projection::PerspectiveTerms;
pub(crate) use projection::inverse_near;
