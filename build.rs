//! Joins the kernels with what they import, validates each with naga, and writes the table the host reads:
//! source, entry points, workgroup sizes, bindings and `const` values. Any shader error fails the build, and so does a kernel that
//! naga cannot put into the languages of the other platforms, Metal's and Direct3D 12's: this machine may not be able to run those.

use naga::back::{hlsl, msl, pipeline_constants::process_overrides};
use naga::valid::{Capabilities, GlobalUse, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage};
use std::collections::HashSet;
use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=kernels");
    println!("cargo:rerun-if-changed=build.rs");
    // Tests that need a GPU fail without one; on a machine that has none they are built as listed `ignored`.
    println!("cargo:rustc-check-cfg=cfg(no_gpu)");
    println!("cargo:rerun-if-env-changed=SUBPIXEL_SHADOWS_NO_GPU");
    if env::var("SUBPIXEL_SHADOWS_NO_GPU").is_ok_and(|v| v == "1") {
        println!("cargo:rustc-cfg=no_gpu");
    }
    match table(Path::new("kernels")) {
        Ok(text) => {
            let out = Path::new(&env::var("OUT_DIR").expect("cargo sets OUT_DIR")).join("kernels.rs");
            fs::write(out, text).expect("the build folder is writable");
        }
        Err(message) => {
            eprintln!("{message}");
            std::process::exit(1);
        }
    }
}

/// The Rust text that describes every kernel in `folder`.
fn table(folder: &Path) -> Result<String, String> {
    let mut files: Vec<_> = fs::read_dir(folder)
        .map_err(|e| format!("{}: {e}", folder.display()))?
        .filter_map(|f| f.ok().map(|f| f.path()))
        .filter(|p| p.extension().is_some_and(|e| e == "wgsl"))
        .collect();
    files.sort();
    let mut out = String::new();
    let mut all = String::new();
    for file in files {
        let stem = file.file_stem().and_then(|s| s.to_str()).ok_or("kernel file name")?.to_owned();
        let mut imported = HashSet::new();
        let source = expand(folder, &file, &mut imported, false)?;
        let mut kernels = vec![(stem.clone(), source, Capabilities::empty())];
        if imported.contains("keys") {
            let source = expand(folder, &file, &mut HashSet::new(), true)?;
            let wide = Capabilities::SHADER_INT64 | Capabilities::SHADER_INT64_ATOMIC_ALL_OPS;
            kernels.push((format!("{stem}_64"), source, wide));
        }
        for (stem, source, allowed) in kernels {
            write_kernel(&mut out, &stem, &source, allowed)?;
            write!(all, "({stem:?}, {stem}::SOURCE, {stem}::ENTRIES), ").map_err(|e| e.to_string())?;
        }
    }
    writeln!(
        out,
        "/// Stem, text and entry points of every kernel.\npub const ALL: &[(&str, &str, &[crate::gpu::program::Entry])] = &[{all}];"
    )
    .map_err(|e| e.to_string())?;
    Ok(out)
}

/// The text of `file` with each line `//@import name` replaced by `shared/name.wgsl`, once. A kernel that imports `keys` is there
/// twice: as it stands, and `wide`, for devices with 64-bit atomics, under its name with `_64`. There `keys_64` stands for `keys`,
/// and lines from `//@narrow` to `//@end` are left out.
fn expand(folder: &Path, file: &Path, seen: &mut HashSet<String>, wide: bool) -> Result<String, String> {
    println!("cargo:rerun-if-changed={}", file.display());
    let text = fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
    let mut out = String::new();
    let mut narrow = false;
    for line in text.lines() {
        match line.strip_prefix("//@import ") {
            _ if line == "//@narrow" => narrow = true,
            _ if line == "//@end" => narrow = false,
            _ if narrow && wide => {}
            Some(name) if seen.insert(name.trim().to_owned()) => {
                let name = if wide && name.trim() == "keys" { "keys_64" } else { name.trim() };
                out += &expand(folder, &folder.join("shared").join(format!("{name}.wgsl")), seen, wide)?;
            }
            Some(_) => {}
            None => {
                out += line;
                out.push('\n');
            }
        }
    }
    Ok(out)
}

fn write_kernel(out: &mut String, stem: &str, source: &str, allowed: Capabilities) -> Result<(), String> {
    let module = naga::front::wgsl::parse_str(source)
        .map_err(|e| format!("kernels/{stem}.wgsl: {}", e.emit_to_string_with_path(source, stem)))?;
    let info = Validator::new(ValidationFlags::all(), allowed)
        .validate(&module)
        .map_err(|e| format!("kernels/{stem}.wgsl: {}", e.emit_to_string_with_path(source, stem)))?;
    for entry in &module.entry_points {
        translate(&module, &info, &entry.name).map_err(|e| format!("kernels/{stem}.wgsl: '{}' {e}", entry.name))?;
    }
    let describe = |e: std::fmt::Error| e.to_string();
    writeln!(
        out,
        "#[doc = \"`kernels/{stem}.wgsl`.\"]\npub mod {stem} {{\nuse crate::gpu::program::{{Access, Binding, Entry}};"
    )
    .map_err(describe)?;
    writeln!(out, "/// The kernel's text, imports joined.\npub const SOURCE: &str = {source:?};").map_err(describe)?;
    for (_, constant) in module.constants.iter() {
        if let (Some(name), naga::Expression::Literal(naga::Literal::U32(v))) =
            (&constant.name, &module.global_expressions[constant.init])
        {
            writeln!(out, "/// `{name}` of the kernel.\npub const {}: u32 = {v};", name.to_uppercase())
                .map_err(describe)?;
        }
    }
    let names: Vec<_> = module.entry_points.iter().map(|e| format!("ENTRY_{}", e.name.to_uppercase())).collect();
    writeln!(out, "/// The kernel's entry points.\npub const ENTRIES: &[Entry] = &[{}];", names.join(", "))
        .map_err(describe)?;
    for (i, entry) in module.entry_points.iter().enumerate() {
        let uses = info.get_entry_point(i);
        let mut bindings = String::new();
        for (handle, global) in module.global_variables.iter() {
            let (Some(binding), Some(name)) = (&global.binding, &global.name) else { continue };
            if uses[handle] == GlobalUse::empty() {
                continue;
            }
            // A uniform `x_given` is bound by the name `x`: the kernel works on a copy of that name.
            let name = name.strip_suffix("_given").unwrap_or(name);
            let access = match global.space {
                naga::AddressSpace::Uniform => "Uniform",
                naga::AddressSpace::Storage { access } if access.contains(naga::StorageAccess::STORE) => "ReadWrite",
                naga::AddressSpace::Storage { .. } => "Read",
                _ => texture_access(&module.types[global.ty].inner).ok_or_else(|| {
                    format!("kernels/{stem}.wgsl: binding '{name}' is of no kind that the host knows")
                })?,
            };
            if binding.group != 0 {
                return Err(format!(
                    "kernels/{stem}.wgsl: '{name}' is in group {}, every binding is in group 0",
                    binding.group
                ));
            }
            write!(bindings, "Binding {{ index: {}, name: {name:?}, access: Access::{access} }}, ", binding.binding)
                .map_err(describe)?;
        }
        writeln!(
            out,
            "/// Entry point `{0}` of `kernels/{stem}.wgsl`.\npub const {1}: Entry = Entry {{ kernel: {stem:?}, name: {0:?}, source: SOURCE, workgroup: {2:?}, bindings: &[{bindings}] }};",
            entry.name,
            format_args!("ENTRY_{}", entry.name.to_uppercase()),
            entry.workgroup_size,
        )
        .map_err(describe)?;
    }
    writeln!(out, "}}").map_err(describe)
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

/// How a kernel uses a texture; `None` if the host knows no such binding.
fn texture_access(inner: &naga::TypeInner) -> Option<&'static str> {
    use naga::{ImageClass, ImageDimension, ScalarKind, StorageAccess, StorageFormat};
    let naga::TypeInner::Image { dim: ImageDimension::D2, arrayed, class } = inner else { return None };
    match (*class, *arrayed) {
        (ImageClass::Sampled { kind: ScalarKind::Uint, multi: false }, false) => Some("TextureUint"),
        (ImageClass::Sampled { kind: ScalarKind::Uint, multi: false }, true) => Some("TextureUintLayers"),
        (ImageClass::Sampled { kind: ScalarKind::Uint, multi: true }, false) => Some("TextureUintSamples"),
        (ImageClass::Sampled { kind: ScalarKind::Float, multi: false }, false) => Some("TextureFloat"),
        (ImageClass::Storage { format: StorageFormat::R32Float, access }, false) if access == StorageAccess::STORE => {
            Some("TextureStoreR32Float")
        }
        _ => None,
    }
}
