//! The node tree of a glTF document: placed triangles, the first camera and the first light.

use super::super::{Beside, Loaded, Parsed, quoted, without_name};
use super::accessor::Source;
use super::alpha::Materials;
use super::ignored::ignored;
use super::json::{self, Node, Root};
use super::primitives::Budget;
use glam::{DMat4, DQuat, DVec3};
use std::borrow::Cow;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use subpixel_shadows::scene::{Camera, Lens, Light, Mesh, TestedTriangle};

/// Walks the scene of `root` from its roots and collects what is there, in world space.
pub(super) fn assemble(root: &Root, buffers: &[Cow<'_, [u8]>], beside: Beside) -> Parsed<Loaded> {
    let source = Source { root, buffers };
    let placed = placed_nodes(root)?;

    // Counted before anything is built: few bytes can ask for very many triangles.
    let mut total = 0u64;
    for mesh in placed.iter().filter_map(|(node, _)| root.nodes[*node].mesh) {
        total = total.saturating_add(source.triangle_count(mesh)?);
        if total > Mesh::MAX_TRIANGLES as u64 {
            return Err(format!(
                "glTF: the scene has {total} triangles or more, at most {} may be used",
                Mesh::MAX_TRIANGLES
            ));
        }
    }

    let mut loaded = Loaded::default();
    let mut decoded: HashMap<usize, (Mesh, Vec<TestedTriangle>)> = HashMap::new();
    let mut materials = Materials::default();
    let mut budget = Budget::new();
    for (index, matrix) in &placed {
        let node = &root.nodes[*index];
        if let Some(mesh) = node.mesh {
            let part = match decoded.entry(mesh) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => new.insert(source.decode(mesh, &mut budget, (&mut materials, beside))?),
            };
            append(&mut loaded, part, matrix);
        }
        if let (None, Some(camera)) = (&loaded.camera, node.camera) {
            loaded.camera = read_camera(root, camera, matrix).map_err(|e| format!("glTF: node {index}: {e}"))?;
        }
        let light = node.extensions.as_ref().and_then(|e| e.light.as_ref());
        if let (None, Some(light)) = (&loaded.light, light) {
            let light = read_light(root, light.light, matrix).map_err(|e| format!("glTF: node {index}: {e}"))?;
            loaded.light = Some(light);
        }
    }
    loaded.alpha.maps = materials.maps;
    loaded.ignored = ignored(root, materials.unread);
    Ok(loaded)
}

/// The nodes of the scene with their matrices, parents before children.
fn placed_nodes(root: &Root) -> Parsed<Vec<(usize, DMat4)>> {
    let nodes = &root.nodes;
    let mut parent: Vec<Option<usize>> = vec![None; nodes.len()];
    for (p, node) in nodes.iter().enumerate() {
        for &child in &node.children {
            match parent.get_mut(child) {
                None => return Err(format!("glTF: node {p} has child {child}, there are {} nodes", nodes.len())),
                Some(Some(other)) => return Err(format!("glTF: node {child} has two parents, {other} and {p}")),
                Some(free) => *free = Some(p),
            }
        }
    }
    let roots: Vec<usize> = match (root.scene, root.scenes.as_slice()) {
        (Some(scene), scenes) => scenes
            .get(scene)
            .ok_or_else(|| format!("glTF: scene {scene} is used, there are {}", scenes.len()))?
            .nodes
            .clone(),
        (None, [first, ..]) => first.nodes.clone(),
        (None, []) => (0..nodes.len()).filter(|&n| parent[n].is_none()).collect(),
    };
    if let Some(bad) = roots.iter().find(|&&n| n >= nodes.len()) {
        return Err(format!("glTF: the scene has root node {bad}, there are {} nodes", nodes.len()));
    }

    // With one parent each, the nodes that no parentless node reaches are those on and below cycles.
    let mut reached = vec![false; nodes.len()];
    let mut stack: Vec<usize> = (0..nodes.len()).filter(|&n| parent[n].is_none()).collect();
    while let Some(n) = stack.pop() {
        reached[n] = true;
        stack.extend(&nodes[n].children);
    }
    if let Some(n) = reached.iter().position(|r| !r) {
        return Err(format!("glTF: node {n} is its own ancestor or below one that is"));
    }

    let mut placed = Vec::new();
    let mut seen = vec![false; nodes.len()];
    let mut stack: Vec<(usize, DMat4)> = roots.iter().rev().map(|&n| (n, DMat4::IDENTITY)).collect();
    while let Some((n, above)) = stack.pop() {
        if std::mem::replace(&mut seen[n], true) {
            return Err(format!("glTF: node {n} is in the scene twice"));
        }
        let matrix = above * local_matrix(&nodes[n]);
        placed.push((n, matrix));
        stack.extend(nodes[n].children.iter().rev().map(|&child| (child, matrix)));
    }
    Ok(placed)
}

fn local_matrix(node: &Node) -> DMat4 {
    match &node.matrix {
        Some(columns) => DMat4::from_cols_array(columns),
        None => DMat4::from_scale_rotation_translation(
            node.scale.map_or(DVec3::ONE, DVec3::from),
            node.rotation.map_or(DQuat::IDENTITY, |q| {
                let q = DQuat::from_array(q);
                if q.length_squared() > 0.0 { q.normalize() } else { DQuat::IDENTITY }
            }),
            node.translation.map_or(DVec3::ZERO, DVec3::from),
        ),
    }
}

fn append(loaded: &mut Loaded, (part, holes): &(Mesh, Vec<TestedTriangle>), matrix: &DMat4) {
    let all = &mut loaded.mesh;
    let (first, mirrors) = (all.triangles.len() as u32, matrix.determinant() < 0.0);
    loaded.alpha.triangles.extend(holes.iter().map(|of| {
        let [a, b, c] = of.uv;
        TestedTriangle { triangle: of.triangle + first, uv: if mirrors { [a, c, b] } else { of.uv }, ..*of }
    }));
    let base = all.positions.len() as u32;
    all.positions
        .extend(part.positions.iter().map(|p| matrix.transform_point3(p.map(f64::from).into()).as_vec3().to_array()));
    // A mirroring node turns the winding over; the outside stays the outside.
    all.triangles.extend(part.triangles.iter().map(|tri| {
        let [a, b, c] = tri.map(|v| v + base);
        if mirrors { [a, c, b] } else { [a, b, c] }
    }));
}

/// Position of a node, and the directions of its −z and y axes.
fn frame(matrix: &DMat4) -> (DVec3, DVec3, DVec3) {
    let at = matrix.w_axis.truncate();
    (at, -matrix.z_axis.truncate().normalize_or_zero(), matrix.y_axis.truncate().normalize_or_zero())
}

/// A point ahead of `at`, far enough to be another point in `f32`.
fn ahead(at: DVec3, direction: DVec3) -> [f32; 3] {
    (at + direction * at.length().max(1.0)).as_vec3().into()
}

/// `None` for a camera without perspective.
fn read_camera(root: &Root, index: usize, matrix: &DMat4) -> Parsed<Option<Camera>> {
    let camera =
        root.cameras.get(index).ok_or_else(|| format!("camera {index} is used, there are {}", root.cameras.len()))?;
    let Some(json::Perspective { yfov }) = camera.perspective else { return Ok(None) };
    let (eye, forward, up) = frame(matrix);
    let camera = Camera {
        eye: eye.as_vec3().into(),
        target: ahead(eye, forward),
        up: up.as_vec3().into(),
        vertical_fov_degrees: yfov.to_degrees() as f32,
        // The file's own range says what its renderer could hold; here nothing needs to be cut.
        near: 1e-4,
        far: 1e4,
        lens: Lens::CENTRED,
        near_plane: None,
    };
    camera.check().map_err(|e| format!("camera {index}: {}", without_name(&e)))?;
    Ok(Some(camera))
}

fn read_light(root: &Root, index: usize, matrix: &DMat4) -> Parsed<Light> {
    let lights = &root.extensions.lights.lights;
    let light = lights.get(index).ok_or_else(|| format!("light {index} is used, there are {}", lights.len()))?;
    let (at, forward, _) = frame(matrix);
    let position = at.as_vec3().to_array();
    let light = match light.kind.as_str() {
        "directional" => Light::Directional { direction: (-forward).as_vec3().into() },
        "point" => Light::Point { position },
        "spot" => Light::Spot {
            position,
            target: ahead(at, forward),
            // A half angle of 90 degrees is allowed in the file; the cone matters for shading alone.
            angle_degrees: (2.0 * light.spot.outer_cone_angle).to_degrees().min(179.0) as f32,
        },
        other => return Err(format!("light {index} has type {}", quoted(other))),
    };
    light.check().map_err(|e| format!("light {index}: {}", without_name(&e)))?;
    Ok(light)
}
