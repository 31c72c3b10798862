//! The project's scene files: a mesh or a built-in scene, with camera, light and ground of their own.
//!
//! ```toml
//! mesh = "arch.obj"      # relative to this file, in its folder or below; or: builtin = "windmill"
//! ground = true          # add a ground plane
//! [camera]               # each key optional, else framed from the bounds
//! eye = [4.0, 3.0, 6.0]
//! target = [0.0, 1.0, 0.0]
//! up = [0.0, 1.0, 0.0]
//! fov = 40.0             # vertical, degrees
//! shift = [0.0, 0.0]     # of the image's middle, in halves of the image
//! pixel_aspect = 1.0     # width by height
//! mirrored = false
//! # near_plane = [0.0, 1.0, 0.0, -0.5]   # where 1 y - 0.5 < 0 nothing is seen; the eye lies there
//! [light]                # one of directional (towards the light), point, spot
//! spot = [3.0, 6.0, 2.0]
//! target = [0.0, 0.0, 0.0]
//! angle = 60.0           # full cone, degrees
//! ```

use super::super::builtin::{builtin, names};
use super::super::options::{CameraOverride, light_from_parts};
use super::super::{Base, Lens, Light, Scene};
use super::text::without_bom;
use super::{Beside, Loaded, Parsed, inside, load_among, quoted, without_name};
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile {
    mesh: Option<String>,
    builtin: Option<String>,
    #[serde(default)]
    ground: bool,
    camera: Option<CameraOverride>,
    light: Option<LightTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LightTable {
    directional: Option<[f32; 3]>,
    point: Option<[f32; 3]>,
    spot: Option<[f32; 3]>,
    target: Option<[f32; 3]>,
    angle: Option<f32>,
}

/// Reads a scene file; `beside` it lies its mesh.
pub(super) fn load(beside: Beside, bytes: &[u8]) -> Parsed<Loaded> {
    let text =
        std::str::from_utf8(without_bom(bytes)).map_err(|e| format!("is not UTF-8 at byte {}", e.valid_up_to()))?;
    let file: SceneFile = ::toml::from_str(text).map_err(|e| {
        let start = e.span().map_or(0, |span| span.start);
        let line = text.bytes().take(start).filter(|&b| b == b'\n').count() + 1;
        format!("line {line}: {}", e.message())
    })?;

    let mut loaded = base(beside, &file)?;
    loaded.ground = file.ground;
    if let Some(camera) = &file.camera {
        loaded.camera = Some(camera.apply(loaded.camera, &loaded.mesh).map_err(|e| without_name(&e))?);
    }
    if let Some(light) = file.light {
        let choices = [("directional", light.directional), ("point", light.point), ("spot", light.spot)];
        let mut given = choices.iter().filter_map(|(kind, at)| at.map(|at| (*kind, at)));
        let (Some((kind, at)), None) = (given.next(), given.next()) else {
            return Err("[light] needs exactly one of 'directional', 'point' and 'spot'".into());
        };
        loaded.light = Some(light_from_parts(kind, at, light.target, light.angle).map_err(|e| without_name(&e))?);
    }
    Ok(loaded)
}

/// The text of a scene file that opens as `scene`, in the folder of the file that it was opened from.
pub fn scene_file(scene: &Scene) -> String {
    let vector = |v: [f32; 3]| format!("[{:?}, {:?}, {:?}]", v[0], v[1], v[2]);
    let (key, name) = match &scene.base {
        Base::Builtin(name) => ("builtin", name),
        Base::Mesh(name) => ("mesh", name),
    };
    let mut text = format!("{key} = {}\n", ::toml::Value::from(name.as_str()));
    if scene.ground.is_some() {
        text += "ground = true\n";
    }
    let camera = &scene.camera;
    let Lens { shift: [x, y], pixel_aspect, mirrored } = camera.lens;
    text += &format!(
        "[camera]\neye = {}\ntarget = {}\nup = {}\nfov = {:?}\nshift = [{x:?}, {y:?}]\npixel_aspect = {pixel_aspect:?}\nmirrored = {mirrored}\n",
        vector(camera.eye),
        vector(camera.target),
        vector(camera.up),
        camera.vertical_fov_degrees,
    );
    if let Some([a, b, c, d]) = camera.near_plane {
        text += &format!("near_plane = [{a:?}, {b:?}, {c:?}, {d:?}]\n");
    }
    text += "[light]\n";
    text += &match scene.light {
        Light::Directional { direction } => format!("directional = {}\n", vector(direction)),
        Light::Point { position } => format!("point = {}\n", vector(position)),
        Light::Spot { position, target, angle_degrees } => {
            format!("spot = {}\ntarget = {}\nangle = {angle_degrees:?}\n", vector(position), vector(target))
        }
    };
    text
}

/// Base of the scene file.
fn base(beside: Beside, file: &SceneFile) -> Parsed<Loaded> {
    match (&file.mesh, &file.builtin) {
        (Some(name), None) => {
            let mesh = inside(beside.folder, name)?;
            // Scene files do not nest, so they cannot name each other in a circle.
            if mesh.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
                return Err(format!("mesh {} is a scene file itself", quoted(&mesh.to_string_lossy())));
            }
            let loaded = load_among(&mesh, beside.files).map_err(|e| e.to_string())?;
            Ok(Loaded { base: Some(Base::Mesh(name.clone())), ..loaded })
        }
        (None, Some(name)) => {
            let scene = builtin(name).ok_or_else(|| {
                format!("builtin {} is none of {}", quoted(name), names().collect::<Vec<_>>().join(", "))
            })?;
            Ok(Loaded {
                mesh: scene.mesh,
                alpha: scene.alpha,
                camera: Some(scene.camera),
                light: Some(scene.light),
                base: Some(scene.base),
                ..Loaded::default()
            })
        }
        _ => Err("needs exactly one of the keys 'mesh' and 'builtin'".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::SceneOptions;
    use super::super::Files;
    use super::*;
    use std::path::Path;

    #[test]
    fn scene_files_read_back() {
        let files = Files::default();
        let beside = Beside { folder: Path::new(""), files: &files };
        for (name, light) in [
            ("plane", Light::Point { position: [1.0, 1e-30, -3e7] }),
            ("spheres", Light::Spot { position: [1.0, 2.0, 0.3], target: [0.7, 0.0, 0.0], angle_degrees: 33.3 }),
            ("knot", Light::Directional { direction: [0.1, 0.7, 0.300_000_1] }),
            ("leaves", Light::Directional { direction: [0.1, 0.7, 0.3] }),
        ] {
            let mut scene = builtin(name).unwrap();
            scene.light = light;
            scene.camera.eye[1] += 0.1;
            scene.camera.lens.shift = [0.25, -0.1];
            let [x, y, z] = scene.camera.eye;
            scene.camera.near_plane = Some([-x, -y, -z, 0.25 * (x * x + y * y + z * z)]);
            let read = load(beside, scene_file(&scene).as_bytes()).unwrap();
            assert_eq!((read.light, read.mesh.triangles.len()), (Some(light), scene.mesh.triangles.len()));
            assert_eq!((read.base.as_ref(), read.alpha == scene.alpha), (Some(&scene.base), true), "{name}");
            let camera = read.camera.unwrap();
            assert_eq!(
                (camera.eye, camera.target, camera.lens, camera.near_plane),
                (scene.camera.eye, scene.camera.target, scene.camera.lens, scene.camera.near_plane)
            );
        }
    }

    /// A saved scene file names the mesh of the scene, whether that was opened by itself or by another scene file.
    #[test]
    fn scene_files_name_what_can_be_opened() {
        const MESH: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let mut files = Files::default();
        files.hold("folder/sub/a \"b\".obj", MESH);
        files.hold("folder/first.toml", &b"mesh = 'sub/a \"b\".obj'\nground = true\n"[..]);
        let open = |files: &Files, name: &str| Scene::open_among(name, &SceneOptions::default(), files).map(|o| o.0);
        let first = open(&files, "folder/first.toml").unwrap();
        assert_eq!((first.mesh.triangles.len(), &first.base), (3, &Base::Mesh("sub/a \"b\".obj".into())));
        files.hold("folder/second.toml", scene_file(&first).into_bytes());
        let second = open(&files, "folder/second.toml").unwrap();
        assert_eq!((&second.mesh, &second.base), (&first.mesh, &first.base));
        assert_eq!((second.camera, second.light), (first.camera, first.light));
        let alone = open(&files, "folder/sub/a \"b\".obj").unwrap();
        files.hold("folder/sub/third.toml", scene_file(&alone).into_bytes());
        assert_eq!(open(&files, "folder/sub/third.toml").unwrap().mesh, alone.mesh);
        // In another folder there is no such mesh.
        files.hold("third.toml", scene_file(&alone).into_bytes());
        let told = open(&files, "third.toml").unwrap_err().to_string();
        assert!(told.contains("third.toml") && told.contains("a \"b\".obj"), "{told}");
    }
}
