//! A kernel: its files, what naga knows of it, and the Rust text of its bindings.

use crate::alone;
use crate::types::{SharedStructs, texture};
use naga::valid::{Capabilities, GlobalUse, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, Expression, GlobalVariable, Handle, Literal, Module, StorageAccess};
use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::Path;

/// A kernel with what it imports.
pub struct Kernel {
    /// Its name.
    pub stem: String,
    /// Its files from `kernels/`, imports first.
    pub files: Vec<String>,
    /// Their texts, joined.
    pub source: String,
    /// The parsed text.
    pub module: Module,
    /// Result of validation.
    pub info: ModuleInfo,
}

/// The kernels of a folder, by name.
///
/// # Errors
/// The first file that cannot be read, parsed or validated, those that others import by themselves.
pub fn kernels(folder: &Path) -> Result<Vec<Kernel>, String> {
    let (mut stems, mut imports) = (Vec::new(), Imports::new());
    for file in files(folder, "")? {
        let Some(stem) = file.strip_suffix(".wgsl") else { continue };
        match stem.rsplit_once('/') {
            None => stems.push(stem.to_owned()),
            Some((_, name)) => {
                if let Some(other) = imports.insert(name.to_owned(), file.clone()) {
                    return Err(format!("{other} and {file} have one name"));
                }
            }
        }
    }
    stems.sort();
    let shared = alone::read(folder, &imports)?;
    let read = |stem| {
        let kernel = Kernel::read(folder, &imports, stem)?;
        alone::check(&kernel, &shared)?;
        Ok(kernel)
    };
    stems.into_iter().map(read).collect()
}

/// Files that kernels import, by name.
pub(crate) type Imports = HashMap<String, String>;

/// The files of a folder and of those in it, from the folder on.
fn files(folder: &Path, within: &str) -> Result<Vec<String>, String> {
    let fault = |e: std::io::Error| format!("{}: {e}", folder.display());
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder.join(within)).map_err(fault)? {
        let entry = entry.map_err(fault)?;
        let name = entry.file_name();
        let name = name.to_str().ok_or("a file name that is no text")?;
        let path = if within.is_empty() { name.to_owned() } else { format!("{within}/{name}") };
        if entry.path().is_dir() {
            found.extend(files(folder, &path)?);
        } else {
            found.push(path);
        }
    }
    Ok(found)
}

/// Parses and validates the text of `stem`; 64-bit integers are for stems that end with `_64`.
pub(crate) fn parse(source: &str, stem: &str) -> Result<(Module, ModuleInfo), String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string_with_path(source, stem))?;
    let allowed = Capabilities::SHADER_INT64 | Capabilities::SHADER_INT64_ATOMIC_ALL_OPS;
    let allowed = if stem.ends_with("_64") { allowed } else { Capabilities::empty() };
    let info = Validator::new(ValidationFlags::all(), allowed)
        .validate(&module)
        .map_err(|e| e.emit_to_string_with_path(source, stem))?;
    Ok((module, info))
}

/// Appends a file after what it imports, each once.
pub(crate) fn join(
    folder: &Path,
    imports: &Imports,
    file: &str,
    files: &mut Vec<String>,
    source: &mut String,
) -> Result<(), String> {
    let path = folder.join(file);
    let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    for name in text.lines().filter_map(|line| line.strip_prefix("//@import ")).flat_map(str::split_whitespace) {
        let imported = imports.get(name).ok_or_else(|| format!("{}: no file '{name}' to import", path.display()))?;
        if !files.contains(imported) {
            join(folder, imports, imported, files, source)?;
        }
    }
    if !files.iter().any(|known| known == file) {
        files.push(file.to_owned());
        source.push_str(&text);
    }
    Ok(())
}

/// A binding of a kernel, as the host has it.
struct Bound {
    variable: Handle<GlobalVariable>,
    index: u32,
    name: String,
    /// Type of the field.
    field: String,
}

impl Kernel {
    fn read(folder: &Path, imports: &Imports, stem: String) -> Result<Self, String> {
        let (mut files, mut source) = (Vec::new(), String::new());
        join(folder, imports, &format!("{stem}.wgsl"), &mut files, &mut source)?;
        let (module, info) = parse(&source, &stem).map_err(|e| format!("kernels/{stem}.wgsl: {e}"))?;
        Ok(Self { stem, files, source, module, info })
    }

    /// Bindings in the order of their declarations.
    fn bindings(&self, structs: &SharedStructs) -> Result<Vec<Bound>, String> {
        let mut found = Vec::new();
        for (variable, global) in self.module.global_variables.iter() {
            let (Some(binding), Some(name)) = (&global.binding, &global.name) else { continue };
            if binding.group != 0 {
                return Err(format!("'{name}' is in group {}, every binding is in group 0", binding.group));
            }
            // The kernel works on a copy of a uniform `x_given` by the name `x`.
            let name = name.strip_suffix("_given").unwrap_or(name).to_owned();
            let ty = &self.module.types[global.ty];
            let element = || {
                let found = structs.element(&self.module, &self.stem, &ty.inner, ty.name.as_deref());
                found.map_err(|e| format!("'{name}': {e}"))
            };
            let field = match global.space {
                AddressSpace::Uniform => format!("Uniform<'a, {}>", element()?),
                AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => {
                    format!("Write<'a, {}>", element()?)
                }
                AddressSpace::Storage { .. } => format!("Read<'a, {}>", element()?),
                _ => {
                    let unknown = || format!("binding '{name}' is of no kind that the host knows");
                    format!("{}<'a>", texture(&ty.inner).ok_or_else(unknown)?)
                }
            };
            found.push(Bound { variable, index: binding.binding, name, field });
        }
        Ok(found)
    }

    /// Appends the kernel's module.
    pub(crate) fn write(&self, structs: &SharedStructs, out: &mut String) -> Result<(), String> {
        let Self { stem, module, info, .. } = self;
        let bindings = self.bindings(structs)?;
        let mut text = String::new();
        let files: Vec<_> = self.files.iter().map(|file| format!("{:?}", file.trim_end_matches(".wgsl"))).collect();
        list(&mut text, "source!", &files);
        let mut values = Vec::new();
        for (_, constant) in module.constants.iter() {
            if let (Some(name), Expression::Literal(Literal::U32(v))) =
                (&constant.name, &module.global_expressions[constant.init])
            {
                values.push(format!("{} = {v}", name.to_uppercase()));
            }
        }
        list(&mut text, "constants!", &values);
        let has_overrides = self.write_constants(&mut text);
        let constants = if has_overrides { "Constants" } else { "()" };
        let mut used: Vec<(String, Vec<&str>)> = Vec::new();
        for (i, entry) in module.entry_points.iter().enumerate() {
            let uses = info.get_entry_point(i);
            let mut bound: Vec<_> = bindings.iter().filter(|b| uses[b.variable] != GlobalUse::empty()).collect();
            bound.sort_by_key(|b| b.index);
            let (name, group, ty) = (&entry.name, entry.workgroup_size, camel(&entry.name));
            let _ = writeln!(
                text,
                "entry_point! {{ {stem:?}, {name:?}, {group:?}, SOURCE, {constants} => {ty}, {ty}Program {{"
            );
            for Bound { index, name, field, .. } in &bound {
                let _ = writeln!(text, "    {index} {name}: {field},");
            }
            text.push_str("} }\n");
            used.push((ty, bound.iter().map(|b| b.name.as_str()).collect()));
        }
        let entries: Vec<_> = used.iter().map(|(ty, _)| ty.clone()).collect();
        for (name, of) in self.groups()? {
            let in_group = |name: &str| used.iter().any(|(ty, names)| of.contains(ty) && names.contains(&name));
            let members: Vec<_> = bindings.iter().filter(|b| in_group(&b.name)).collect();
            let _ = writeln!(text, "group! {{ {name} {{");
            for Bound { name, field, .. } in &members {
                let _ = writeln!(text, "    {name}: {field},");
            }
            text.push_str("} }\n");
            used.push((name, members.iter().map(|b| b.name.as_str()).collect()));
        }
        for (i, (whole, all)) in used.iter().enumerate() {
            for (j, (part, some)) in used.iter().enumerate() {
                if i != j && some.iter().all(|name| all.contains(name)) {
                    let _ = writeln!(text, "subset! {{ {whole} => {part} {{ {} }} }}", some.join(", "));
                }
            }
        }
        list(&mut text, "entries!", &entries);
        let _ = write!(
            out,
            "/// `kernels/{stem}.wgsl`.\npub mod {stem} {{\n    use crate::entry_point;\n    use crate::gpu::bindings::*;\n\n"
        );
        for line in text.lines() {
            let _ = writeln!(out, "    {line}");
        }
        out.push_str("}\n\n");
        Ok(())
    }

    /// Groups of entry points that are given the same bindings (`//@bindings NAME: entry, entry`), by their types.
    fn groups(&self) -> Result<Vec<(String, Vec<String>)>, String> {
        let mut found = Vec::new();
        for line in self.source.lines().filter_map(|line| line.strip_prefix("//@bindings ")) {
            let (name, entries) = line.split_once(": ").ok_or_else(|| format!("'{line}': no entry points"))?;
            let entries: Vec<_> = entries.split(", ").map(str::trim).collect();
            if let Some(other) = entries.iter().find(|e| self.module.entry_points.iter().all(|p| p.name != **e)) {
                return Err(format!("'{line}': no entry point '{other}'"));
            }
            found.push((name.to_owned(), entries.into_iter().map(camel).collect()));
        }
        Ok(found)
    }

    /// Appends the struct of the kernel's `override`s that have a literal default; whether there is any.
    fn write_constants(&self, text: &mut String) -> bool {
        let mut rows = String::new();
        for (_, constant) in self.module.overrides.iter() {
            let (Some(name), Some(init)) = (&constant.name, constant.init) else { continue };
            let Expression::Literal(literal) = self.module.global_expressions[init] else { continue };
            let (ty, default) = match literal {
                Literal::U32(v) => ("u32", v.to_string()),
                Literal::I32(v) => ("i32", v.to_string()),
                Literal::F32(v) => ("f32", format!("{v:?}")),
                Literal::Bool(v) => ("bool", v.to_string()),
                _ => continue,
            };
            let _ = writeln!(rows, "    {}: {ty} = {default}, {name:?},", name.to_lowercase());
        }
        if !rows.is_empty() {
            let _ = write!(text, "overrides! {{\n{rows}}}\n");
        }
        !rows.is_empty()
    }
}

/// Appends a macro with a list, lines of at most 120 columns.
fn list(text: &mut String, name: &str, items: &[String]) {
    if items.is_empty() {
        return;
    }
    let _ = write!(text, "{name} {{");
    let mut column = usize::MAX;
    for item in items {
        if column.saturating_add(item.len()) > 110 {
            text.push_str("\n   ");
            column = 3;
        }
        let _ = write!(text, " {item},");
        column += item.len() + 2;
    }
    text.push_str("\n}\n");
}

/// `settle_all` as `SettleAll`.
fn camel(name: &str) -> String {
    name.split('_').map(|word| word[..1].to_uppercase() + &word[1..]).collect()
}
