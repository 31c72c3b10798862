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

/// A change of a kernel is a change of the file: a binding's type, access or name, and a struct that nobody declares.
#[test]
fn changes_are_seen() {
    let folder = std::env::temp_dir().join(format!("subpixel-shadows-bindings-{}", std::process::id()));
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
