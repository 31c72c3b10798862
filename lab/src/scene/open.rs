//! Opening a scene by name or path.

use super::builtin::{builtin, names};
use super::load::{EXTENSIONS, Files, Loaded, load_among};
use super::options::{DEFAULT_LIGHT, SceneOptions};
use super::{AlphaTested, Base, Mesh, Scene};
use std::path::Path;
use subpixel_shadows::{Error, Result};

impl Scene {
    /// The scene that `spec` names: a built-in one, or a `.glb`, `.gltf`, `.obj`, `.ply` or `.toml` file.
    ///
    /// A scene without a camera is framed from its bounds, before a ground is added; one without a light gets
    /// [`DEFAULT_LIGHT`]. A scene without triangles is no error.
    ///
    /// # Errors
    /// [`Error::Scene`] if `spec` is neither a name nor a file, or camera, light or extent cannot be used;
    /// [`Error::File`] if the file cannot be read; [`Error::Mesh`] if the mesh cannot be used.
    pub fn open(spec: &str, options: &SceneOptions) -> Result<Self> {
        Self::open_and_note(spec, options).map(|(scene, _)| scene)
    }

    /// As [`Scene::open`], with one line for people on what the file holds that is not read (skins, textures, …), if
    /// it does.
    ///
    /// # Errors
    /// As [`Scene::open`].
    pub fn open_and_note(spec: &str, options: &SceneOptions) -> Result<(Self, Option<String>)> {
        Self::open_among(spec, options, &Files::default())
    }

    /// As [`Scene::open_and_note`]; files, also those that a file names, are looked for among `files` first.
    ///
    /// # Errors
    /// As [`Scene::open`].
    pub fn open_among(spec: &str, options: &SceneOptions, files: &Files) -> Result<(Self, Option<String>)> {
        let loaded = match builtin(spec) {
            Some(scene) => {
                let (camera, light) = (Some(scene.camera), Some(scene.light));
                let base = Some(scene.base);
                Loaded { mesh: scene.mesh, alpha: scene.alpha, camera, light, base, ..Loaded::default() }
            }
            None => from_file(spec, files)?,
        };
        Self::of_loaded(spec, loaded, options)
    }

    fn of_loaded(spec: &str, loaded: Loaded, options: &SceneOptions) -> Result<(Self, Option<String>)> {
        let note = loaded.note().map(|note| format!("{}: {note}", spec.escape_debug()));
        let mut mesh = loaded.mesh;
        mesh.check(spec)?;
        let camera = options.camera.unwrap_or_default().apply(loaded.camera, &mesh).map_err(|e| named(spec, e))?;
        let light = options.light.or(loaded.light).unwrap_or(DEFAULT_LIGHT);
        light.check()?;
        let ground = if options.ground || loaded.ground { mesh.ground_below() } else { None };
        if let Some(ground) = &ground {
            mesh.add_ground(ground);
            mesh.check(spec)?;
        }
        let (alpha, base) = (loaded.alpha, loaded.base.unwrap_or_else(|| Base::Mesh(spec.into())));
        alpha.check(&mesh)?;
        Ok((Self { name: spec.into(), base, mesh, alpha, camera, light, ground }, note))
    }

    /// A scene of one mesh with the camera that frames it and the [`DEFAULT_LIGHT`].
    ///
    /// # Errors
    /// As [`Scene::open`] for what it finds in the mesh.
    pub fn of_mesh(name: &str, mesh: Mesh) -> Result<Self> {
        mesh.check(name)?;
        let camera = super::CameraOverride::default().apply(None, &mesh).map_err(|e| named(name, e))?;
        let alpha = AlphaTested::default();
        let base = Base::Mesh(name.into());
        Ok(Self { name: name.into(), base, mesh, alpha, camera, light: DEFAULT_LIGHT, ground: None })
    }
}

/// Adds the name of the scene to an error that does not name it.
fn named(name: &str, error: Error) -> Error {
    match error {
        Error::Scene(message) => Error::Scene(format!("'{}': {message}", name.escape_debug())),
        other => other,
    }
}

fn from_file(spec: &str, files: &Files) -> Result<Loaded> {
    let path = Path::new(spec);
    let means_file = files.holds(path) || path.exists() || path.extension().is_some() || path.components().count() > 1;
    if !means_file {
        return Err(Error::Scene(format!(
            "no scene '{}'; built in are {}; files are read with the extensions {}",
            spec.escape_debug(),
            names().collect::<Vec<_>>().join(", "),
            EXTENSIONS.join(", ")
        )));
    }
    load_among(path, files)
}
