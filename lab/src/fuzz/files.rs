//! A case as files: the scene, its mesh, and the command that repeats it.

use super::{Fault, FuzzCase};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::ImageEncoder as _;
use serde_json::json;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use subpixel_shadows::light_view::{OmniMaps, PartBy, SplitPlan, Warp};
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::{FacetMode, MethodName, PairVariant};
use subpixel_shadows::samples::Pattern;
use subpixel_shadows::scene::{AlphaFilter, AlphaMap, AlphaTested, AlphaWrap, Light, Mesh, TestedTriangle};
use subpixel_shadows::{Error, Result};

/// Writes `scene.toml`, `mesh.ply` (with holes `mesh.gltf`) and `command.txt` into `folder`; returns the command.
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
    let mesh = if case.world.alpha.is_empty() {
        ("mesh.ply", ply(&case.world.mesh))
    } else {
        ("mesh.gltf", gltf(&case.world.mesh, &case.world.alpha)?)
    };
    for (name, text) in [mesh, ("scene.toml", toml(case)), ("command.txt", about)] {
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
    let told = how.setting.contains("splits=") || how.setting.contains("warp=") || how.setting.contains("partition=");
    if let Some(SplitPlan { by, splits, warp, focus, weight }) = s.partition.filter(|_| !told) {
        let warp = match warp {
            Warp::Whole | Warp::Box => "even",
            Warp::Stable => "stable",
            Warp::Trapezoid => "trapezoid",
            Warp::LightSpace => "lispsm",
            Warp::Perspective => "perspective",
            Warp::Fitted => "fitted",
        };
        line += match by {
            PartBy::Depth => "",
            PartBy::SeenDepth => " --partition seen-depths",
            PartBy::FrustumFaces => " --partition frustum-faces",
            PartBy::ReceiverClusters => " --partition receiver-clusters",
        };
        let _ = write!(line, " --splits {splits} --warp {warp} --focus {focus} --split-weight {weight}");
    }
    if s.omni == OmniMaps::Paraboloids {
        line += " --omni paraboloids";
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
    let mesh = if world.alpha.is_empty() { "mesh.ply" } else { "mesh.gltf" };
    let mut text = format!("mesh = \"{mesh}\"\n");
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
    if let Some(plane) = world.camera.near_plane {
        let [a, b, c, d] = plane.map(f64::from);
        let _ = writeln!(text, "near_plane = [{a:?}, {b:?}, {c:?}, {d:?}]");
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

/// The mesh with its holes: a primitive of the triangles without, and one for each map.
fn gltf(mesh: &Mesh, alpha: &AlphaTested) -> Result<String> {
    let mut tested = vec![None; mesh.triangles.len()];
    alpha.triangles.iter().for_each(|of| tested[of.triangle as usize] = Some(of));
    let (mut bytes, mut views, mut accessors, mut primitives) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for map in std::iter::once(None).chain((0..alpha.maps.len() as u32).map(Some)) {
        let own = mesh.triangles.iter().zip(&tested).filter(|(_, of)| of.map(|of| of.map) == map);
        let own: Vec<(&[u32; 3], Option<&TestedTriangle>)> = own.map(|(t, of)| (t, *of)).collect();
        if own.is_empty() {
            continue;
        }
        let mut add = |kind: &str, count: usize, floats: &mut dyn Iterator<Item = f32>| {
            let start = bytes.len();
            bytes.extend(floats.flat_map(f32::to_le_bytes));
            views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": bytes.len() - start }));
            accessors
                .push(json!({ "bufferView": views.len() - 1, "componentType": 5126, "count": count, "type": kind }));
            accessors.len() - 1
        };
        let corners = own.iter().flat_map(|(t, _)| t.map(|v| mesh.positions[v as usize]));
        let positions = add("VEC3", 3 * own.len(), &mut corners.flatten());
        let mut primitive = json!({ "attributes": { "POSITION": positions } });
        if let Some(map) = map {
            let uv = own.iter().filter_map(|(_, of)| of.map(|of| of.uv)).flatten().flatten();
            primitive["attributes"]["TEXCOORD_0"] = json!(add("VEC2", 3 * own.len(), &mut uv.into_iter()));
            primitive["material"] = json!(map);
        }
        primitives.push(primitive);
    }
    let data = |kind: &str, bytes: &[u8]| format!("data:{kind};base64,{}", STANDARD.encode(bytes));
    let mut images = Vec::new();
    for map in &alpha.maps {
        let pixels: Vec<u8> = map.alpha.iter().flat_map(|&a| [255, 255, 255, a]).collect();
        let mut png = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new(&mut png);
        let written = encoder.write_image(&pixels, map.size[0], map.size[1], image::ExtendedColorType::Rgba8);
        written.map_err(|e| Error::Config(format!("a map of alpha: {e}")))?;
        images.push(json!({ "uri": data("image/png", &png) }));
    }
    let wrap = |wrap: AlphaWrap| match wrap {
        AlphaWrap::Repeat => 10497,
        AlphaWrap::Mirror => 33648,
        AlphaWrap::Clamp => 33071,
    };
    let sampler = |map: &AlphaMap| {
        let filter = if map.filter == AlphaFilter::Nearest { 9728 } else { 9729 };
        json!({ "magFilter": filter, "wrapS": wrap(map.wrap[0]), "wrapT": wrap(map.wrap[1]) })
    };
    let material = |(k, map): (usize, &AlphaMap)| {
        let texture = json!({ "baseColorTexture": { "index": k } });
        json!({ "alphaMode": "MASK", "alphaCutoff": f64::from(map.cutoff), "pbrMetallicRoughness": texture })
    };
    let texture = |k: usize| json!({ "source": k, "sampler": k });
    let root = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": primitives }],
        "materials": alpha.maps.iter().enumerate().map(material).collect::<Vec<_>>(),
        "textures": (0..alpha.maps.len()).map(texture).collect::<Vec<_>>(),
        "samplers": alpha.maps.iter().map(sampler).collect::<Vec<_>>(),
        "images": images,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": bytes.len(), "uri": data("application/octet-stream", &bytes) }],
    });
    Ok(root.to_string())
}
