//! A case as files: the scene, its mesh, and the command that repeats it.

use super::{Fault, FuzzCase};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use subpixel_shadows::light_view::{SplitPlan, Warp};
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::{FacetMode, MethodName, PairVariant};
use subpixel_shadows::samples::Pattern;
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::{Error, Result};

/// Writes `scene.toml`, `mesh.ply` and `command.txt` into `folder`; returns the command.
///
/// # Errors
/// [`Error::File`] if that cannot be done.
pub fn write(folder: &Path, case: &FuzzCase, faults: &[(Fault, u64, String)]) -> Result<String> {
    std::fs::create_dir_all(folder).map_err(|e| Error::file(folder, format!("cannot be made: {e}")))?;
    let engine = if faults.iter().all(|(f, ..)| matches!(f, Fault::CpuFacet | Fault::CpuSeen | Fault::CpuScene)) {
        " --engine cpu"
    } else {
        ""
    };
    let command = format!("subpixel-shadows {}{engine}", command(&folder.join("scene.toml"), case));
    let mut about = format!(
        "{command}\n\nShrunk from case {} of seed {} ({}): subpixel-shadows fuzz --seed {1} --first {0} --cases 1\n",
        case.number,
        case.seed,
        case.kind.name()
    );
    for (fault, count, at) in faults {
        let _ = writeln!(about, "{}: {count}. {at}", fault.name());
    }
    for (name, text) in [("mesh.ply", ply(&case.world.mesh)), ("scene.toml", toml(case)), ("command.txt", about)] {
        let path: PathBuf = folder.join(name);
        std::fs::write(&path, text).map_err(|e| Error::file(&path, format!("cannot be written: {e}")))?;
    }
    Ok(command)
}

/// The arguments that render the case from its scene file.
pub fn command(scene: &Path, case: &FuzzCase) -> String {
    let how = &case.how;
    let s = &how.settings;
    let [w, h] = s.size;
    let mut line = format!("render {} --method {} --size {w}x{h} --map {}", scene.display(), how.method.name(), s.map);
    let pattern = match how.pattern {
        Pattern::Grid => "grid",
        Pattern::Rotated => "rotated",
        Pattern::LowDiscrepancy => "low-discrepancy",
    };
    let _ = write!(line, " --samples {} --pattern {pattern}", s.samples.count());
    if how.method.takes("facets") {
        line += if s.facets == FacetMode::All { " --facets all" } else { " --facets one" };
    }
    if how.method == MethodName::FacetMasks {
        let masks = if s.masks == MaskVariant::Exact { "exact" } else { "table" };
        let pairs = match s.pairs {
            PairVariant::Tiled => "tiled",
            PairVariant::Grouped => "grouped",
            PairVariant::Sorted => "sorted",
        };
        let _ = write!(line, " --masks {masks} --pairs {pairs}");
        let _ = write!(line, " --memory-limit {}", (how.budget.bytes >> 20).max(1));
        if let Some(start) = how.budget.start {
            let _ = write!(line, " --list-start {start}");
        }
    }
    for (option, value) in how.setting.split_whitespace().filter_map(|part| part.split_once('=')) {
        let _ = write!(line, " --{option} {value}");
    }
    let told = how.setting.contains("splits=") || how.setting.contains("warp=");
    if let Some(SplitPlan { splits, warp, focus, weight }) = s.partition.filter(|_| !told) {
        let warp = match warp {
            Warp::Whole | Warp::Box => "even",
            Warp::Trapezoid => "trapezoid",
            Warp::LightSpace => "lispsm",
            Warp::Perspective => "perspective",
            Warp::Fitted => "fitted",
        };
        let _ = write!(line, " --splits {splits} --warp {warp} --focus {focus} --split-weight {weight}");
    }
    if how.method == MethodName::RayTraced {
        line += if s.ray_traced.silhouettes { " --rays silhouettes" } else { " --rays all" };
    }
    line += if s.validity { " --validity on" } else { " --validity off" };
    line + if how.force_all { " --force-all" } else { "" } + " --frames 1 --truth"
}

/// The scene file.
fn toml(case: &FuzzCase) -> String {
    let world = &case.world;
    let mut text = "mesh = \"mesh.ply\"\n".to_owned();
    if world.ground {
        text += "ground = true\n";
    }
    text += "\n[camera]\n";
    for (key, value) in [("eye", world.camera.eye), ("target", world.camera.target), ("up", world.camera.up)] {
        if let Some(value) = value {
            let _ = writeln!(text, "{key} = {}", vector(value));
        }
    }
    if let Some(fov) = world.camera.fov {
        let _ = writeln!(text, "fov = {:?}", f64::from(fov));
    }
    if let Some([x, y]) = world.camera.shift {
        let _ = writeln!(text, "shift = [{:?}, {:?}]", f64::from(x), f64::from(y));
    }
    if let Some(aspect) = world.camera.pixel_aspect {
        let _ = writeln!(text, "pixel_aspect = {:?}", f64::from(aspect));
    }
    if let Some(mirrored) = world.camera.mirrored {
        let _ = writeln!(text, "mirrored = {mirrored}");
    }
    text += "\n[light]\n";
    let _ = match world.light {
        Light::Directional { direction } => writeln!(text, "directional = {}", vector(direction)),
        Light::Point { position } => writeln!(text, "point = {}", vector(position)),
        Light::Spot { position, target, angle_degrees } => {
            let (at, to) = (vector(position), vector(target));
            writeln!(text, "spot = {at}\ntarget = {to}\nangle = {:?}", f64::from(angle_degrees))
        }
    };
    text
}

/// The numbers as `f64`, which read back are the same `f32`.
fn vector(v: [f32; 3]) -> String {
    format!("[{:?}, {:?}, {:?}]", f64::from(v[0]), f64::from(v[1]), f64::from(v[2]))
}

/// The mesh, vertices that no triangle uses left out.
fn ply(mesh: &Mesh) -> String {
    let mut place = vec![None; mesh.positions.len()];
    let mut vertices = Vec::new();
    let faces: Vec<[usize; 3]> = mesh
        .triangles
        .iter()
        .map(|t| {
            t.map(|v| {
                *place[v as usize].get_or_insert_with(|| {
                    vertices.push(mesh.positions[v as usize]);
                    vertices.len() - 1
                })
            })
        })
        .collect();
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices.len(),
        faces.len()
    );
    for [x, y, z] in vertices {
        let _ = writeln!(text, "{x:?} {y:?} {z:?}");
    }
    for [a, b, c] in faces {
        let _ = writeln!(text, "3 {a} {b} {c}");
    }
    text
}
