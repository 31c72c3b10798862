//! Agreement of the house with itself, without a GPU: every kernel has its room, fits WebGPU's default limits, and lays
//! its shared structs out as Rust does.

use naga::{AddressSpace, Module, ShaderStage, TypeInner};
use std::collections::BTreeSet;
use std::mem::offset_of;
use std::path::Path;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::layout::{Field, Shared};
use subpixel_shadows::gpu::source::write_bare;
use subpixel_shadows::gpu::{Profile, kernels};
use subpixel_shadows::scene::{Edge, Homography};
use subpixel_shadows::stages::camera_visibility::{Centres, Pass};
use subpixel_shadows::stages::pixel_texel_pairs::TALLY_WORDS;
use subpixel_shadows::stages::shadow_rays::TreePlace;
use subpixel_shadows::stages::{
    caster_positions, cluster_bounds, cluster_culling, compact, dispatch_args, facet_classify, gbuffer_triangles,
    history, instance_positions, light_lists, map_moments, pixel_counts, pixel_coverage, pixel_receivers,
    pixel_triangles, pixel_views, prefix_scan, radix_sort, sample_surfaces, sorted_pairs, summed_area, texel_group,
    triangle_ids, visibility_texture, work_owners,
};
use subpixel_shadows::status::{Need, StatusBand, StatusHead};

/// A struct as Rust knows it.
struct Registered {
    kernel: &'static str,
    name: &'static str,
    size: usize,
    fields: &'static [Field],
}

fn of<T: Shared>() -> Registered {
    Registered { kernel: T::KERNEL, name: T::NAME, size: size_of::<T>(), fields: T::FIELDS }
}

/// The edges of a mesh are part of the scene, which knows no kernel.
fn edge() -> Registered {
    const FIELDS: &[Field] = &[
        Field { name: "v0", offset: offset_of!(Edge, v0), size: 4 },
        Field { name: "v1", offset: offset_of!(Edge, v1), size: 4 },
        Field { name: "t0", offset: offset_of!(Edge, t0), size: 4 },
        Field { name: "t1", offset: offset_of!(Edge, t1), size: 4 },
    ];
    Registered { kernel: "shared/raster/edge", name: "Edge", size: size_of::<Edge>(), fields: FIELDS }
}

/// A list with a header, which the host writes as plain words: 16 counters, what was listed lately, then pairs.
fn candidates() -> Registered {
    const FIELDS: &[Field] = &[
        Field { name: "tally", offset: 0, size: 64 },
        Field { name: "seen", offset: 64, size: 4 * TALLY_WORDS - 64 },
        Field { name: "list", offset: 4 * TALLY_WORDS, size: 8 },
    ];
    Registered { kernel: "shared/raster/candidates", name: "Candidates", size: 4 * TALLY_WORDS + 8, fields: FIELDS }
}

/// Likewise: counts, the words of the two requests among them, then pixels and triangles.
fn doubts() -> Registered {
    const FIELDS: &[Field] = &[
        Field { name: "needed", offset: 0, size: 4 },
        Field { name: "listed", offset: 4, size: 4 },
        Field { name: "blocks", offset: 8, size: 4 },
        Field { name: "pad", offset: 12, size: 4 },
        Field { name: "list", offset: 4 * Centres::COUNTS, size: 8 },
    ];
    Registered { kernel: "camera_visibility", name: "Doubts", size: 4 * Centres::COUNTS + 8, fields: FIELDS }
}

/// Likewise: counters of the frame, then those of each band.
fn status() -> Registered {
    const HEAD: usize = size_of::<StatusHead>();
    const FIELDS: &[Field] = &[
        Field { name: "head", offset: 0, size: HEAD },
        Field { name: "bands", offset: HEAD, size: size_of::<StatusBand>() },
    ];
    Registered { kernel: "shared/frame/status", name: "Status", size: HEAD + size_of::<StatusBand>(), fields: FIELDS }
}

/// Every struct that the host shares with a kernel. A struct of a file that kernels import is registered under
/// that file and found in every kernel that imports it.
fn registry() -> Vec<Registered> {
    vec![
        of::<Frame>(),
        of::<Pass>(),
        of::<TreePlace>(),
        edge(),
        candidates(),
        doubts(),
        status(),
        of::<Need>(),
        of::<StatusHead>(),
        of::<StatusBand>(),
        of::<Homography>(),
        of::<caster_positions::CasterPositionsParams>(),
        of::<instance_positions::InstancePositionsParams>(),
        of::<cluster_bounds::ClusterBoundsParams>(),
        of::<cluster_culling::ClusterBox>(),
        of::<cluster_culling::ClusterParams>(),
        of::<compact::CompactParams>(),
        of::<dispatch_args::ArgsRequest>(),
        of::<facet_classify::Facet>(),
        of::<facet_classify::Undecided>(),
        of::<gbuffer_triangles::GbufferTrianglesParams>(),
        of::<history::FrameBefore>(),
        of::<light_lists::LightPart>(),
        of::<map_moments::MapLevels>(),
        of::<pixel_counts::PixelCounts>(),
        of::<pixel_coverage::Covering>(),
        of::<pixel_receivers::PixelReceiversParams>(),
        of::<pixel_triangles::PixelPair>(),
        of::<pixel_views::LightViews>(),
        of::<prefix_scan::PrefixScanParams>(),
        of::<radix_sort::RadixSortParams>(),
        of::<sample_surfaces::PixelSlot>(),
        of::<sample_surfaces::SurfaceStep>(),
        of::<sorted_pairs::SortedPairsParams>(),
        of::<summed_area::SummedAreaParams>(),
        of::<texel_group::TexelGroupParams>(),
        of::<triangle_ids::TriangleIdsParams>(),
        of::<visibility_texture::Lists>(),
        of::<visibility_texture::PackedRows>(),
        of::<visibility_texture::PointShare>(),
        of::<work_owners::WorkOwnersParams>(),
    ]
}

/// The structs that a kernel's uniform and storage bindings hold, themselves or in arrays or other structs.
fn bound_structs(module: &Module) -> BTreeSet<String> {
    fn visit(module: &Module, ty: naga::Handle<naga::Type>, found: &mut BTreeSet<String>) {
        match &module.types[ty].inner {
            TypeInner::Array { base, .. } => visit(module, *base, found),
            TypeInner::Struct { members, .. } => {
                found.extend(module.types[ty].name.clone());
                members.iter().for_each(|member| visit(module, member.ty, found));
            }
            _ => {}
        }
    }
    let mut found = BTreeSet::new();
    for (_, variable) in module.global_variables.iter() {
        if matches!(variable.space, AddressSpace::Uniform | AddressSpace::Storage { .. }) {
            visit(module, variable.ty, &mut found);
        }
    }
    found
}

/// How a struct of a kernel differs from its Rust twin; `None` if it does not.
fn disagreement(module: &Module, rust: &Registered) -> Option<String> {
    let context = module.to_ctx();
    let Some((_, ty)) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(rust.name)) else {
        return Some("the kernel has no such struct".to_owned());
    };
    let TypeInner::Struct { members, span } = &ty.inner else {
        return Some("it is no struct in the kernel".to_owned());
    };
    let kernel: Vec<_> = members
        .iter()
        .map(|m| {
            let size = module.types[m.ty].inner.size(context) as usize;
            (m.name.clone().unwrap_or_default(), m.offset as usize, size)
        })
        .collect();
    let rust_fields: Vec<_> = rust.fields.iter().map(|f| (f.name.to_owned(), f.offset, f.size)).collect();
    if kernel != rust_fields {
        return Some(format!("fields (name, offset, size): kernel {kernel:?}, Rust {rust_fields:?}"));
    }
    (*span as usize != rust.size).then(|| format!("size: kernel {span}, Rust {}", rust.size))
}

fn parse(stem: &str, source: &str) -> Module {
    naga::front::wgsl::parse_str(source).unwrap_or_else(|e| panic!("{stem}: {}", e.emit_to_string(source)))
}

/// The text that a web page has of a file.
fn bare(text: &str) -> String {
    let mut bytes = vec![0; text.len()];
    let length = write_bare(text, &mut bytes);
    bytes.truncate(length);
    String::from_utf8(bytes).expect("text")
}

/// The parts of a kernel that a compiler reads, without where they stand.
fn meaning(stem: &str, text: &str) -> String {
    let known = format!("{:?}", parse(stem, text));
    let mut parts = known.split("Span { start: ");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once(" }").map_or(part, |(_, rest)| rest))
}

/// Kernels without comments are the same kernels.
#[test]
fn bare_kernels_are_the_kernels() {
    let (mut sum, mut left) = (0, 0);
    for (stem, source, _) in kernels::ALL {
        let (whole, page) = (source.text(), source.0.iter().map(|text| bare(text)).collect::<String>());
        assert!(!page.contains("//") && !page.contains("\n "), "{stem}");
        assert_eq!(meaning(stem, &whole), meaning(stem, &page), "{stem}");
        if let Some(other) = Some(page.replacen("+1u", "+2u", 1)).filter(|other| *other != page) {
            assert_ne!(meaning(stem, &whole), meaning(stem, &other), "{stem}");
        }
        (sum, left) = (sum + whole.len(), left + page.len());
    }
    assert!(3 * left < 2 * sum, "{left} of {sum} bytes are left");
}

#[test]
fn shared_structs_agree() {
    let registry = registry();
    let mut used = BTreeSet::new();
    for (stem, source, _) in kernels::ALL {
        let module = parse(stem, &source.text());
        for name in bound_structs(&module) {
            let twin = registry
                .iter()
                .find(|r| r.name == name && (r.kernel == *stem || r.kernel.contains('/')))
                .unwrap_or_else(|| panic!("kernels/{stem}.wgsl: struct '{name}' is not registered here"));
            if let Some(disagreement) = disagreement(&module, twin) {
                panic!("kernels/{stem}.wgsl: struct '{name}': {disagreement}");
            }
            used.insert((twin.kernel, twin.name));
        }
    }
    for twin in &registry {
        assert!(used.contains(&(twin.kernel, twin.name)), "no kernel binds '{}' of {}", twin.name, twin.kernel);
    }
}

/// The check fails when it must: a name, an order, an offset, a size, a missing struct.
#[test]
fn disagreement_is_found() {
    let source = "struct S { a: u32, b: vec2<f32>, c: array<u32, 3> }
        @group(0) @binding(0) var<storage, read> s: array<S>;";
    let module = parse("test", source);
    assert_eq!(bound_structs(&module), BTreeSet::from(["S".to_owned()]));
    let field = |name, offset, size| Field { name, offset, size };
    let check = |size, fields: &[Field]| {
        let fields = fields.to_vec().leak();
        disagreement(&module, &Registered { kernel: "test", name: "S", size, fields })
    };
    assert_eq!(check(32, &[field("a", 0, 4), field("b", 8, 8), field("c", 16, 12)]), None);
    for (size, fields) in [
        (28, [field("a", 0, 4), field("b", 8, 8), field("c", 16, 12)]),
        (32, [field("a", 0, 4), field("b", 4, 8), field("c", 16, 12)]),
        (32, [field("a", 0, 4), field("b", 8, 8), field("c", 16, 16)]),
        (32, [field("b", 0, 4), field("a", 8, 8), field("c", 16, 12)]),
    ] {
        assert!(check(size, &fields).is_some(), "{size} {fields:?}");
    }
    assert!(check(32, &[field("a", 0, 4)]).is_some());
    assert!(disagreement(&module, &Registered { kernel: "test", name: "T", size: 4, fields: &[] }).is_some());
}

#[test]
fn kernels_fit_default_limits() {
    for ((stem, source, entries), profile) in kernels::ALL.iter().flat_map(|k| Profile::ALL.map(|p| (*k, p))) {
        let module = parse(stem, &profile.text(&source.text()));
        assert_eq!(module.entry_points.len(), entries.len());
        for (point, entry) in module.entry_points.iter().zip(entries) {
            let at = format!("kernels/{stem}.wgsl: {}", entry.name);
            assert_eq!(point.stage, ShaderStage::Compute, "{at}");
            assert_eq!((point.name.as_str(), point.workgroup_size), (entry.name, entry.workgroup), "{at}");
            let invocations: u32 = entry.workgroup.iter().product();
            assert!((1..=256).contains(&invocations), "{at}: {invocations} invocations");
            let storage = entry.bindings.iter().filter(|b| b.access.is_storage_buffer());
            assert!(storage.count() <= 8, "{at}: more than 8 storage buffers");
        }
        let workgroup_bytes: u32 = module
            .global_variables
            .iter()
            .filter(|(_, v)| v.space == AddressSpace::WorkGroup)
            .map(|(_, v)| module.types[v.ty].inner.size(module.to_ctx()))
            .sum();
        assert!(workgroup_bytes <= 16_384, "kernels/{stem}.wgsl: {workgroup_bytes} bytes of workgroup memory");
    }
}

/// Stems of the files of a folder that end in `.extension`.
fn stems(folder: &str, extension: &str) -> BTreeSet<String> {
    let files = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).expect(folder);
    let paths = files.map(|f| f.expect(folder).path());
    let named = paths.filter(|p| p.extension().is_some_and(|e| e == extension));
    named.map(|p| p.file_stem().expect(folder).to_string_lossy().into_owned()).collect()
}

/// The stage of a kernel: one whose name ends in `_64` is for devices with 64-bit atomics.
fn stage_of(kernel: &str) -> String {
    kernel.strip_suffix("_64").unwrap_or(kernel).to_owned()
}

/// A stage is five files of one stem: none is missing, none is left over.
#[test]
fn every_kernel_has_its_room() {
    let kernels: BTreeSet<String> = kernels::ALL.iter().map(|(stem, ..)| stage_of(stem)).collect();
    let there: BTreeSet<String> = stems("kernels", "wgsl").iter().map(|stem| stage_of(stem)).collect();
    assert_eq!(kernels, there, "kernels built in, kernels there");
    for folder in ["src/stages", "oracle/src/reference", "tests/stages", "benches/stages"] {
        let mut files = stems(folder, "rs");
        files.retain(|stem| !["mod", "main", "support", "harness", "view"].contains(&stem.as_str()));
        let missing: Vec<_> = kernels.difference(&files).collect();
        let extra: Vec<_> = files.difference(&kernels).collect();
        assert!(missing.is_empty() && extra.is_empty(), "{folder}: missing {missing:?}, without a kernel {extra:?}");
    }
}

/// Stages without a list that may run over: they prove more items than one dimension of a dispatch holds in place of it.
const WITHOUT_A_LIST: [&str; 27] = [
    "axis_density",
    "compared_depths",
    "deep_map",
    "deep_shadows",
    "front_layer",
    "history",
    "kept_triangles",
    "light_layers",
    "map_moments",
    "moment_shadows",
    "page_casters",
    "page_query",
    "page_refinement",
    "page_requests",
    "paraboloid_casters",
    "pixel_views",
    "polygon_ids",
    "seen_depths",
    "seen_texels",
    "shadow_map",
    "silhouette_map",
    "silhouette_points",
    "smsr",
    "spsm_map",
    "spsm_query",
    "warped_casters",
    "warped_query",
];

/// Every stage proves the same eight things.
#[test]
fn every_stage_has_the_standard_cases() {
    for (stem, ..) in kernels::ALL {
        let stage = stage_of(stem);
        let (room, other) = match WITHOUT_A_LIST.contains(&stage.as_str()) {
            true => ("beyond_one_dimension", "overflow_by_one"),
            false => ("overflow_by_one", "beyond_one_dimension"),
        };
        let cases = [
            "empty",
            "one",
            "every_size_around_workgroup",
            "random_seeded",
            "degenerate",
            room,
            "two_d_dispatch",
            "detects_corruption",
        ];
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/stages/{stage}.rs"));
        let text = std::fs::read_to_string(&file).expect("the tests of the stage");
        let has = |case: &str| text.contains(&format!("\nfn {case}()"));
        for case in cases {
            assert!(has(case), "tests/stages/{stage}.rs has no '{case}'");
        }
        assert!(!has(other), "tests/stages/{stage}.rs: '{other}' does not apply to it");
    }
}

/// Names of the public types of a source file.
fn public_types(text: &str) -> Vec<&str> {
    let starts = ["pub struct ", "pub enum ", "pub trait ", "pub type ", "pub union "];
    let lines = text.split("\n#[cfg(test)]").next().unwrap_or_default().lines();
    lines
        .filter_map(|line| {
            // As they stand, and in `shared_struct!`.
            let line = line.trim_start();
            let line =
                line.split_once("=> ").filter(|(kernel, _)| kernel.starts_with('"')).map_or(line, |(_, rest)| rest);
            starts.iter().find_map(|start| line.strip_prefix(start))
        })
        .filter_map(|rest| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next())
        // Names that a macro is given.
        .filter(|name| !name.is_empty())
        .collect()
}

/// The files of a folder, and of those in it, that end in `.extension`.
fn files_of(folder: &Path, extension: &str) -> Vec<std::path::PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files_of(&path, extension));
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found
}

/// A name is one thing. The bindings of kernels are named by their entry points, in a module a kernel.
#[test]
fn no_two_public_types_share_a_name() {
    let mut known = std::collections::BTreeMap::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for file in ["src", "oracle/src", "lab/src"].iter().flat_map(|folder| files_of(&root.join(folder), "rs")) {
        if file.ends_with("gpu/kernels.rs") {
            continue;
        }
        let text = std::fs::read_to_string(&file).expect("a text file");
        for name in public_types(&text) {
            if let Some(other) = known.insert(name.to_owned(), file.clone()) {
                panic!("{name} is in {} and in {}", other.display(), file.display());
            }
        }
    }
    assert!(known.len() > 200 && known.contains_key("Frame") && known.contains_key("ShadowPass"), "{}", known.len());
    let text = "pub struct A;\n    \"k\" => pub struct B {\npub enum C<T> {}\n#[cfg(test)]\npub struct D;";
    assert_eq!(public_types(text), ["A", "B", "C"]);
}

/// Kernels and what they import stay within 230 lines of 110 columns, the host side of a stage within 300 lines, all else within 500.
#[test]
fn files_stay_readable() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = [
        ("kernels", "wgsl", 230, 60),
        ("src/stages", "rs", 300, 30),
        ("src", "rs", 500, 100),
        ("oracle", "rs", 500, 40),
        ("lab", "rs", 500, 60),
        ("tests", "rs", 500, 60),
    ];
    for (folder, extension, most, least) in folders {
        let mut files = files_of(&root.join(folder), extension);
        files.retain(|file| !file.ends_with("gpu/kernels.rs"));
        assert!(files.len() > least, "{folder}: {} files", files.len());
        for file in files {
            let text = std::fs::read_to_string(&file).expect("a text file");
            let (lines, name) = (text.lines().count(), file.display());
            assert!(lines <= most, "{name}: {lines} lines, at most {most}");
            let widest = text.lines().map(|line| line.chars().count()).max().unwrap_or_default();
            assert!(extension != "wgsl" || widest <= 110, "{name}: {widest} columns");
        }
    }
}

/// A file that one kernel alone imports lies in that kernel's folder, one that several import in `shared`.
#[test]
fn imports_lie_with_their_users() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("kernels");
    let mut users: std::collections::BTreeMap<String, BTreeSet<String>> = std::collections::BTreeMap::new();
    for file in files_of(&root, "wgsl") {
        let text = std::fs::read_to_string(&file).expect("a text file");
        let inside = file.strip_prefix(&root).expect("a kernel's file");
        let user = match inside.iter().next().and_then(|part| part.to_str()).expect("a name") {
            "shared" => inside.display().to_string(),
            top => stage_of(top.strip_suffix(".wgsl").unwrap_or(top)),
        };
        for name in text.lines().filter_map(|l| l.strip_prefix("//@import ")).flat_map(str::split_whitespace) {
            users.entry(name.to_owned()).or_default().insert(user.clone());
        }
    }
    for file in files_of(&root, "wgsl") {
        let inside = file.strip_prefix(&root).expect("a kernel's file");
        let parts: Vec<_> = inside.iter().filter_map(|part| part.to_str()).collect();
        let [folder, .., name] = parts[..] else { continue };
        let name = name.strip_suffix(".wgsl").unwrap_or(name);
        // On a GPU in place of what is imported: see `gpu::Profile`.
        let imported = name.replace("_in_place", "_copy");
        let users = users.get(&imported).unwrap_or_else(|| panic!("nobody imports {}", inside.display()));
        if folder != "shared" {
            assert_eq!(users.iter().collect::<Vec<_>>(), [folder], "{}", inside.display());
        } else if let [user] = Vec::from_iter(users)[..] {
            assert!(user.starts_with("shared/"), "{} is for {user} alone", inside.display());
        }
    }
}
