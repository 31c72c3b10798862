//! Changes that a caller may make to a scene, and the text forms of cameras and lights.

use super::{Camera, Lens, Light, Mesh};
use glam::{DVec3, Vec3};
use std::fmt;
use std::str::FromStr;
use subpixel_shadows::scene::mesh::MAX_EXTENT;
use subpixel_shadows::{Error, Result};

/// Changes to a scene when it is opened.
#[derive(Clone, Debug, Default)]
pub struct SceneOptions {
    /// Add a ground plane under the scene, also where its file does not ask for one.
    pub ground: bool,
    /// Parts of the camera to set.
    pub camera: Option<CameraOverride>,
    /// The light to use instead of the scene's own.
    pub light: Option<Light>,
}

/// Parts of a camera; those not given stay as they are, or are framed from the scene's bounds.
///
/// As text: `eye=X,Y,Z;target=X,Y,Z;up=X,Y,Z;fov=DEGREES;shift=X,Y;pixel_aspect=RATIO;mirrored=true;near_plane=A,B,C,D`, each part optional, in any order.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraOverride {
    /// Position.
    pub eye: Option<[f32; 3]>,
    /// Point looked at.
    pub target: Option<[f32; 3]>,
    /// Direction that is up in the image.
    pub up: Option<[f32; 3]>,
    /// Full vertical field of view, degrees.
    pub fov: Option<f32>,
    /// Place of the image's middle, in halves of the image from the view direction.
    pub shift: Option<[f32; 2]>,
    /// Width of a pixel by its height.
    pub pixel_aspect: Option<f32>,
    /// Whether left and right are exchanged.
    pub mirrored: Option<bool>,
    /// Oblique near plane.
    pub near_plane: Option<[f32; 4]>,
}

/// The light of scenes that bring none: towards `(0.5, 1, 0.3)`.
pub const DEFAULT_LIGHT: Light = Light::Directional { direction: [0.5, 1.0, 0.3] };

impl From<Camera> for CameraOverride {
    /// All parts of a camera but its depth range.
    fn from(camera: Camera) -> Self {
        let Lens { shift, pixel_aspect, mirrored } = camera.lens;
        Self {
            eye: Some(camera.eye),
            target: Some(camera.target),
            up: Some(camera.up),
            fov: Some(camera.vertical_fov_degrees),
            shift: Some(shift),
            pixel_aspect: Some(pixel_aspect),
            mirrored: Some(mirrored),
            near_plane: camera.near_plane,
        }
    }
}

impl CameraOverride {
    /// `base`, or a camera that frames `mesh`, with the given parts set and with a depth range that cuts nothing off:
    /// near is 1e-4 scene radii.
    ///
    /// # Errors
    /// [`Error::Scene`] with the numbers if the camera cannot be used, or the mesh is too large to be framed in `f32`.
    pub fn apply(&self, base: Option<Camera>, mesh: &Mesh) -> Result<Camera> {
        let (lowest, highest) = framed_box(mesh);
        if [lowest, highest].iter().any(|p| p.abs().max_element() > MAX_EXTENT) {
            return Err(Error::Scene(format!(
                "the mesh reaches from ({}, {}, {}) to ({}, {}, {}), too far for a camera with 32-bit numbers",
                lowest.x, lowest.y, lowest.z, highest.x, highest.y, highest.z
            )));
        }
        let mut camera = base.unwrap_or_else(|| Camera::framing(lowest, highest));
        camera.eye = self.eye.unwrap_or(camera.eye);
        camera.target = self.target.unwrap_or(camera.target);
        camera.vertical_fov_degrees = self.fov.unwrap_or(camera.vertical_fov_degrees);
        camera.lens.shift = self.shift.unwrap_or(camera.lens.shift);
        camera.lens.pixel_aspect = self.pixel_aspect.unwrap_or(camera.lens.pixel_aspect);
        camera.near_plane = self.near_plane.or(camera.near_plane);
        camera.lens.mirrored = self.mirrored.unwrap_or(camera.lens.mirrored);
        let eye = Vec3::from(camera.eye).as_dvec3();
        match self.up {
            Some(up) => camera.up = up,
            // Looking straight along the default up, another direction has to be up.
            None => {
                let view = Vec3::from(camera.target).as_dvec3() - eye;
                let up = Vec3::from(camera.up).as_dvec3();
                if view.cross(up).length() <= 1e-6 * view.length() * up.length() {
                    camera.up = if view.z.abs() > 0.9 * view.length() { [0.0, 1.0, 0.0] } else { [0.0, 0.0, -1.0] };
                }
            }
        }
        (camera.near, camera.far) = depth_range(lowest, highest, eye);
        camera.check()?;
        Ok(camera)
    }
}

/// Near and far for an eye and the box of a scene: near cuts nothing off in normal use, far lies behind everything.
fn depth_range(lowest: DVec3, highest: DVec3, eye: DVec3) -> (f32, f32) {
    let radius = (highest - lowest).length() * 0.5;
    let distance = ((lowest + highest) * 0.5 - eye).length();
    ((radius * 1e-4) as f32, ((radius + distance) * 100.0) as f32)
}

/// A camera at `eye` for a mesh known to be of ordinary size.
pub(super) fn camera_at(mesh: &Mesh, eye: [f32; 3], target: [f32; 3], vertical_fov_degrees: f32) -> Camera {
    let (lowest, highest) = framed_box(mesh);
    let (near, far) = depth_range(lowest, highest, Vec3::from(eye).as_dvec3());
    Camera { eye, target, up: [0.0, 1.0, 0.0], vertical_fov_degrees, near, far, lens: Lens::CENTRED, near_plane: None }
}

/// The box that cameras are fitted to: the bounds, or a stand-in if there is nothing or it has no extent in `f32`.
fn framed_box(mesh: &Mesh) -> (DVec3, DVec3) {
    let Some((lowest, highest)) = mesh.bounds() else { return (DVec3::NEG_ONE, DVec3::ONE) };
    // Smaller than this, eye and target would round to one place, or the depth range to 0.
    let least = (lowest.abs().max(highest.abs()).max_element() * 1e-5).max(1e-18);
    let pad = DVec3::splat(if (highest - lowest).length() < least { least } else { 0.0 });
    (lowest - pad, highest + pad)
}

impl FromStr for CameraOverride {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let mut camera = Self::default();
        for (key, value) in parts("camera", text)? {
            match key {
                "eye" => set("camera", key, &mut camera.eye, vector("camera", key, value)?)?,
                "target" => set("camera", key, &mut camera.target, vector("camera", key, value)?)?,
                "up" => set("camera", key, &mut camera.up, vector("camera", key, value)?)?,
                "fov" => set("camera", key, &mut camera.fov, number("camera", key, value)?)?,
                "shift" => set("camera", key, &mut camera.shift, vector("camera", key, value)?)?,
                "pixel_aspect" => set("camera", key, &mut camera.pixel_aspect, number("camera", key, value)?)?,
                "mirrored" => set("camera", key, &mut camera.mirrored, truth("camera", key, value)?)?,
                "near_plane" => set("camera", key, &mut camera.near_plane, vector("camera", key, value)?)?,
                _ => {
                    return Err(Error::Scene(format!(
                        "camera has no part '{key}', only eye, target, up, fov, shift, pixel_aspect, mirrored and near_plane"
                    )));
                }
            }
        }
        Ok(camera)
    }
}

impl fmt::Display for CameraOverride {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let vector = |[x, y, z]: [f32; 3]| format!("{x},{y},{z}");
        let parts = [
            ("eye", self.eye.map(vector)),
            ("target", self.target.map(vector)),
            ("up", self.up.map(vector)),
            ("fov", self.fov.map(|fov| fov.to_string())),
            ("shift", self.shift.map(|[x, y]| format!("{x},{y}"))),
            ("pixel_aspect", self.pixel_aspect.map(|aspect| aspect.to_string())),
            ("mirrored", self.mirrored.map(|mirrored| mirrored.to_string())),
            ("near_plane", self.near_plane.map(|[a, b, c, d]| format!("{a},{b},{c},{d}"))),
        ];
        let given: Vec<_> = parts.into_iter().filter_map(|(key, value)| Some(format!("{key}={}", value?))).collect();
        f.write_str(&given.join(";"))
    }
}

/// Reads a light: `directional=X,Y,Z`, `point=X,Y,Z` or `spot=X,Y,Z;target=X,Y,Z;angle=DEGREES`.
///
/// # Errors
/// [`Error::Scene`] with the part that cannot be read, or the light that cannot be used.
pub fn light_from_text(text: &str) -> Result<Light> {
    let (mut kind, mut target, mut angle) = (None, None, None);
    for (key, value) in parts("light", text)? {
        match key {
            "directional" | "point" | "spot" => {
                set("light", "kind", &mut kind, (key, vector("light", key, value)?))?;
            }
            "target" => set("light", key, &mut target, vector("light", key, value)?)?,
            "angle" => set("light", key, &mut angle, number("light", key, value)?)?,
            _ => {
                return Err(Error::Scene(format!(
                    "light has no part '{key}', only directional, point, or spot with target and angle"
                )));
            }
        }
    }
    let (kind, at) =
        kind.ok_or_else(|| Error::Scene(format!("light '{text}' is neither directional, point nor spot")))?;
    light_from_parts(kind, at, target, angle)
}

/// The light of `kind` with its direction or position; a spot takes a target and an angle, 60 degrees if not given.
pub(super) fn light_from_parts(
    kind: &str,
    at: [f32; 3],
    target: Option<[f32; 3]>,
    angle: Option<f32>,
) -> Result<Light> {
    let light = match (kind, target) {
        ("spot", Some(target)) => Light::Spot { position: at, target, angle_degrees: angle.unwrap_or(60.0) },
        ("spot", None) => return Err(Error::Scene("spot light has no target".into())),
        (_, Some(_)) => return Err(Error::Scene(format!("{kind} light takes no target, only a spot does"))),
        _ if angle.is_some() => return Err(Error::Scene(format!("{kind} light takes no angle, only a spot does"))),
        ("point", None) => Light::Point { position: at },
        _ => Light::Directional { direction: at },
    };
    light.check()?;
    Ok(light)
}

/// The `key=value` parts of a text.
fn parts<'a>(what: &str, text: &'a str) -> Result<Vec<(&'a str, &'a str)>> {
    text.split(';')
        .map(str::trim)
        .filter(|part| !part.is_empty())
        .map(|part| {
            part.split_once('=')
                .map(|(key, value)| (key.trim(), value.trim()))
                .ok_or_else(|| Error::Scene(format!("{what} part '{part}' is not of the form key=value")))
        })
        .collect()
}

fn set<T>(what: &str, key: &str, slot: &mut Option<T>, value: T) -> Result<()> {
    match slot.replace(value) {
        Some(_) => Err(Error::Scene(format!("{what} {key} is given twice"))),
        None => Ok(()),
    }
}

fn number(what: &str, key: &str, text: &str) -> Result<f32> {
    text.trim().parse().map_err(|_| Error::Scene(format!("{what} {key}: '{text}' is not a number")))
}

fn truth(what: &str, key: &str, text: &str) -> Result<bool> {
    text.trim().parse().map_err(|_| Error::Scene(format!("{what} {key}: '{text}' is neither true nor false")))
}

fn vector<const N: usize>(what: &str, key: &str, text: &str) -> Result<[f32; N]> {
    let numbers = text.split(',').map(|n| number(what, key, n)).collect::<Result<Vec<f32>>>()?;
    <[f32; N]>::try_from(numbers)
        .map_err(|n| Error::Scene(format!("{what} {key}: '{text}' has {} numbers, needs {N}", n.len())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_are_read_part_by_part() {
        let camera: CameraOverride = "eye=1,2.5,-3; fov=35".parse().unwrap();
        assert_eq!(camera, CameraOverride { eye: Some([1.0, 2.5, -3.0]), fov: Some(35.0), ..Default::default() });
        let lens: CameraOverride = "shift=0.25,-1;pixel_aspect=2;mirrored=true;near_plane=0,0.5,1,-2".parse().unwrap();
        let wanted = CameraOverride {
            shift: Some([0.25, -1.0]),
            pixel_aspect: Some(2.0),
            mirrored: Some(true),
            near_plane: Some([0.0, 0.5, 1.0, -2.0]),
            ..Default::default()
        };
        assert_eq!(lens, wanted);
        assert_eq!("".parse::<CameraOverride>().unwrap(), CameraOverride::default());
        for (text, part) in [
            ("eye=1,2", "2 numbers"),
            ("eye=1,2,x", "'x'"),
            ("eye", "'eye'"),
            ("eye=1,2,3;eye=1,2,3", "twice"),
            ("look=1,2,3", "'look'"),
            ("fov=wide", "'wide'"),
            ("shift=1,2,3", "needs 2"),
            ("near_plane=1,0,0", "3 numbers, needs 4"),
            ("mirrored=1", "neither true nor false"),
        ] {
            let message = text.parse::<CameraOverride>().unwrap_err().to_string();
            assert!(message.contains(part) && message.contains("camera"), "{text}: {message}");
        }
    }

    #[test]
    fn lights_are_read() {
        assert_eq!(
            light_from_text("directional=0.5,1,0.3").unwrap(),
            Light::Directional { direction: [0.5, 1.0, 0.3] }
        );
        assert_eq!(light_from_text("point=1,2,3").unwrap(), Light::Point { position: [1.0, 2.0, 3.0] });
        assert_eq!(
            light_from_text("spot=1,2,3;target=0,0,0;angle=40").unwrap(),
            Light::Spot { position: [1.0, 2.0, 3.0], target: [0.0; 3], angle_degrees: 40.0 }
        );
        for (text, part) in [
            ("", "neither"),
            ("target=0,0,0", "neither"),
            ("directional=0,0,0", "length 0"),
            ("directional=0,nan,0", "NaN"),
            ("directional=1,0,0;point=1,0,0", "twice"),
            ("point=1,2,3;angle=4", "angle"),
            ("directional=1,2,3;target=0,0,0", "target"),
            ("spot=1,2,3", "target"),
            ("spot=1,2,3;target=1,2,3", "both"),
            ("spot=1,2,3;target=0,0,0;angle=180", "180"),
            ("sun=1,2,3", "'sun'"),
        ] {
            let message = light_from_text(text).unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn a_camera_straight_above_finds_an_up() {
        let mesh = Mesh::default();
        let top: CameraOverride = "eye=0,5,0;target=0,0,0".parse().unwrap();
        assert_eq!(top.apply(None, &mesh).unwrap().up, [0.0, 0.0, -1.0]);
        let bad: CameraOverride = "eye=0,5,0;target=0,0,0;up=0,1,0".parse().unwrap();
        assert!(bad.apply(None, &mesh).unwrap_err().to_string().contains("parallel"));
        let same: CameraOverride = "eye=1,1,1;target=1,1,1".parse().unwrap();
        assert!(same.apply(None, &mesh).unwrap_err().to_string().contains("both (1, 1, 1)"));
    }

    #[test]
    fn meshes_of_every_size_are_framed_or_refused() {
        for scale in [0.0f32, 1e-44, 1e-30, 1e-12, 1.0, 1e12, 1e17] {
            for offset in [0.0f32, 1.0, 1e6] {
                let positions = vec![[offset, 0.0, 0.0], [offset + scale, 0.0, 0.0], [offset, scale, 0.0]];
                let mesh = Mesh { positions, triangles: vec![[0, 1, 2]] };
                let camera = CameraOverride::default().apply(None, &mesh).unwrap();
                assert!(camera.near.is_normal() && camera.far.is_finite(), "{scale} {offset}: {camera:?}");
            }
        }
        let mesh = Mesh { positions: vec![[0.0; 3], [3e38, 0.0, 0.0], [0.0, 3e38, 0.0]], triangles: vec![[0, 1, 2]] };
        let message = CameraOverride::default().apply(None, &mesh).unwrap_err().to_string();
        assert!(message.contains("too far"), "{message}");
    }
}
