//! The written file is current, and the kernels are of the languages of all platforms.

use bindings::{FILE, generate, kernels};
use naga::back::{hlsl, msl, pipeline_constants::process_overrides};
use naga::valid::ModuleInfo;
use naga::{Module, ShaderStage};
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[test]
fn the_written_file_is_current() {
    let written = std::fs::read_to_string(root().join(FILE)).expect("the file is there");
    let current = generate(&root()).unwrap_or_else(|e| panic!("{e}"));
    let line = written.lines().zip(current.lines()).position(|(a, b)| a != b);
    let place = line.map_or("length".to_owned(), |line| format!("line {}", line + 1));
    assert!(written == current, "{FILE} is stale ({place}): cargo run -p subpixel-shadows-bindings");
}

/// Puts an entry point, its overrides at their defaults, into the languages of Metal and Direct3D 12.
fn translate(module: &Module, info: &ModuleInfo, entry: &str) -> Result<(), String> {
    let (module, info) = process_overrides(module, info, Some((ShaderStage::Compute, entry)), &Default::default())
        .map_err(|e| format!("with its defaults: {e}"))?;
    let entry_point = Some((ShaderStage::Compute, entry.to_owned()));
    let options = msl::Options { lang_version: (2, 4), ..Default::default() };
    let pipeline = msl::PipelineOptions { entry_point: entry_point.clone(), ..Default::default() };
    let (_, told) = msl::write_string(&module, &info, &options, &pipeline).map_err(|e| format!("for Metal: {e}"))?;
    told.entry_point_names.into_iter().collect::<Result<Vec<_>, _>>().map_err(|e| format!("for Metal: {e}"))?;
    let options = hlsl::Options { shader_model: hlsl::ShaderModel::V6_0, ..Default::default() };
    let mut text = String::new();
    let told = hlsl::Writer::new(&mut text, &options, &hlsl::PipelineOptions { entry_point })
        .write(&module, &info, None)
        .map_err(|e| format!("for Direct3D 12: {e}"))?;
    told.entry_point_names.into_iter().collect::<Result<Vec<_>, _>>().map_err(|e| format!("for Direct3D 12: {e}"))?;
    Ok(())
}

#[test]
fn every_entry_point_translates_to_metal_and_direct3d() {
    for kernel in kernels(&root().join("kernels")).unwrap_or_else(|e| panic!("{e}")) {
        for entry in &kernel.module.entry_points {
            translate(&kernel.module, &kernel.info, &entry.name)
                .unwrap_or_else(|e| panic!("kernels/{}.wgsl: '{}' {e}", kernel.stem, entry.name));
        }
    }
}

/// A folder for files of a test.
fn folder(test: &str) -> PathBuf {
    std::env::temp_dir().join(format!("subpixel-shadows-bindings-{test}-{}", std::process::id()))
}

/// A change of a kernel is a change of the file: a binding's type, access or name, and a struct that nobody declares.
#[test]
fn changes_are_seen() {
    let folder = folder("changes");
    let (kernels, src) = (folder.join("kernels"), folder.join("src"));
    std::fs::create_dir_all(&kernels).expect("a folder");
    std::fs::create_dir_all(&src).expect("a folder");
    std::fs::write(src.join("one.rs"), "shared_struct! {\n    \"one\" => pub struct Params {\n").expect("a file");
    let made = |binding: &str| {
        let text = format!(
            "struct Params {{ n: u32 }}\nstruct Other {{ n: u32 }}\n@group(0) @binding(0) {binding}\n\
             @compute @workgroup_size(64) fn go() {{ _ = bound[0].n; }}"
        );
        std::fs::write(kernels.join("one.wgsl"), text).expect("a file");
        generate(&folder)
    };
    let right = made("var<storage, read> bound: array<Params>;").expect("a file");
    assert!(right.contains("0 bound: Read<'a, crate::one::Params>,"), "{right}");
    let written = made("var<storage, read_write> bound: array<Params>;").expect("a file");
    assert!(written.contains("0 bound: Write<'a, crate::one::Params>,"), "{written}");
    let other = made("var<storage, read> bound: array<Other>;").expect_err("no struct of that name");
    assert!(other.contains("'Other'"), "{other}");
    let text = made("var<storage, read> bound: array<Params").expect_err("no WGSL");
    assert!(text.contains("one.wgsl"), "{text}");
    std::fs::remove_dir_all(folder).expect("the folder goes");
}

/// A file that kernels import says what it needs of them, and they have that.
#[test]
fn needs_are_seen() {
    const PART: &str = "//@import base\n//@needs override LAST: u32;\n//@needs var<storage, read> layers: array<vec4f>;\n\
        //@needs fn keep(id: u32, depth: f32) -> bool;\n//@needs fn note(id: u32);\n\
        fn take(id: u32) -> bool { note(id); return keep(id, last_of(layers[id]) * f32(LAST)); }\n";
    const BASE: &str = "//@needs const ITEMS: u32;\n//@needs var<uniform> scale: f32;\n\
        fn last_of(v: vec4f) -> f32 { return scale * v[ITEMS - 1u]; }\n";
    const ONE: &str = "//@import part\noverride LAST: u32 = 1u;\nconst ITEMS = 4u;\nvar<private> scale: f32;\n\
        @group(0) @binding(0) var<storage, read_write> layers: array<vec4f>;\n\
        fn keep(id: u32, depth: f32) -> bool { return depth > f32(id); }\nfn note(id: u32) {}\n\
        @compute @workgroup_size(64) fn go() { if take(1u) { scale = 2.0; } }\n";
    let folder = folder("needs");
    std::fs::create_dir_all(folder.join("one")).expect("a folder");
    // The fault found after a change of one of them.
    let fault_of = |changed: &str, old: &str, new: &str| {
        for (file, text) in [("one/part.wgsl", PART), ("one/base.wgsl", BASE), ("one.wgsl", ONE)] {
            let text = if changed == text { text.replacen(old, new, 1) } else { text.to_owned() };
            std::fs::write(folder.join(file), text).expect("a file");
        }
        assert!(changed.contains(old), "'{old}' is there to be changed");
        kernels(&folder).err().unwrap_or_default()
    };
    let none = fault_of(ONE, "2.0", "3.0");
    assert!(none.is_empty(), "{none}");
    let (part, base, one) =
        ("kernels/one/part.wgsl, by itself: ", "kernels/one/base.wgsl, by itself: ", "kernels/one.wgsl: ");
    for (changed, old, new, place, told) in [
        // Used but not said: of the kernel, of the kernel by an import, of an import.
        (PART, "//@needs override LAST: u32;\n", "", part, "`LAST`"),
        (BASE, "//@needs const ITEMS: u32;\n", "", base, "`ITEMS`"),
        (PART, "f32(LAST)", "f32(LAST) * scale", part, "'scale' is used: `//@needs var<uniform> scale: f32;`"),
        (PART, "//@import base\n", "", part, "`last_of`"),
        // Said but not so: not used, declared here, said twice, a type, no declaration.
        (PART, "f32(LAST)", "2.0", part, "'LAST' is needed but not used"),
        (PART, "fn take", "fn note(id: u32) {}\nfn take", part, "'note' is not needed"),
        (PART, "//@needs fn note", "//@needs fn keep();\n//@needs fn note", part, "'keep' is needed twice"),
        (PART, "//@needs fn note(id: u32);", "//@needs struct note;", part, "'note' is a type"),
        (PART, "note(id: u32);", "note(id: u32)", part, "'//@needs fn note(id: u32)' is no declaration"),
        // Used otherwise than said: written, and of another type.
        (PART, "{ note(id);", "{ note(id); layers[id] = vec4f();", part, "layers"),
        (BASE, "scale: f32", "scale: u32", base, "scale"),
        // Not so in the kernel: a function is missing, and another kind, type, address space, result.
        (ONE, "fn note(id: u32) {}\n", "", one, "`note`"),
        (
            ONE,
            "const ITEMS",
            "override ITEMS",
            one,
            "one/base.wgsl needs 'ITEMS' as `const u32`, here it is `override u32`",
        ),
        (
            ONE,
            "layers: array<vec4f>",
            "layers: array<vec4f, 4>",
            one,
            "here it is `var<storage, read_write> array<vec4<f32>, 4>`",
        ),
        (ONE, "var<private>", "var<workgroup>", one, "'scale' as `var<uniform> f32`, here it is `var<workgroup> f32`"),
        (ONE, "fn note(id: u32) {", "fn note(id: u32) -> u32 { return id;", one, "here it is `fn(u32) -> u32`"),
    ] {
        let fault = fault_of(changed, old, new);
        assert!(fault.starts_with(place) && fault.contains(told), "'{new}' for '{old}': {fault}");
    }
    std::fs::remove_dir_all(folder).expect("the folder goes");
}
