//! Files that kernels import, each by itself: it parses with what it imports and what it says that it needs of the kernel
//! (`//@needs DECLARATION;`, a line a name), which is what it uses and no more, and every kernel that imports it has that.

use crate::kernel::{Imports, Kernel, join, parse};
use naga::Module;
use naga::common::wgsl::{TypeContext, address_space_str};
use std::path::Path;

/// A file that kernels import.
pub struct Shared<'a> {
    file: &'a str,
    /// Names that it needs, each with its [`shape`].
    needs: Vec<(String, String)>,
}

/// A declaration of WGSL without value or body, of a binding without its place.
#[derive(Clone, Copy)]
struct Need<'a> {
    name: &'a str,
    text: &'a str,
}

/// Reads and checks every file that kernels import, those before others that these import.
///
/// # Errors
/// The first that needs what it does not say, or says that it needs what it does not use.
pub fn read<'a>(folder: &Path, imports: &'a Imports) -> Result<Vec<Shared<'a>>, String> {
    let mut joined = Vec::new();
    for file in imports.values() {
        let (mut files, mut source) = (Vec::new(), String::new());
        join(folder, imports, file, &mut files, &mut source)?;
        joined.push((files.len(), file, source));
    }
    joined.sort();
    joined.into_iter().map(|(_, file, source)| read_one(folder, file, &source)).collect()
}

/// `source`: the file behind what it imports.
fn read_one<'a>(folder: &Path, file: &'a str, source: &str) -> Result<Shared<'a>, String> {
    let fault = |text: String| format!("kernels/{file}, by itself: {text}");
    let text = std::fs::read_to_string(folder.join(file)).map_err(|e| fault(e.to_string()))?;
    let own = needs(&text).map_err(fault)?;
    let declared: Vec<_> = source.lines().filter_map(name_of).collect();
    for need in &own {
        let Need { name, .. } = need;
        if own.iter().filter(|other| other.name == *name).count() > 1 {
            return Err(fault(format!("'{name}' is needed twice")));
        }
        if declared.contains(name) {
            return Err(fault(format!("'{name}' is not needed of kernels: it is declared")));
        }
        if !uses(&text, name) {
            return Err(fault(format!("'{name}' is needed but not used")));
        }
    }
    // Its own before those of its imports, of which each is as good as the others.
    let mut all = own.clone();
    for need in needs(source).map_err(fault)? {
        let Need { name, text: declaration } = need;
        if all.iter().any(|known| known.name == name) || declared.contains(&name) {
            continue;
        }
        if uses(&text, name) {
            return Err(fault(format!("'{name}' is used: `//@needs {declaration}`")));
        }
        all.push(need);
    }
    let stubs = all.iter().enumerate().map(|(i, need)| need.stub(i)).collect::<Result<String, _>>().map_err(fault)?;
    let (module, _) = parse(&format!("{stubs}{source}"), file.trim_end_matches(".wgsl")).map_err(fault)?;
    let known = |need: &Need| shape(&module, need.name).map(|shape| (need.name.to_owned(), shape));
    Ok(Shared { file, needs: own.iter().filter_map(known).collect() })
}

/// Whether a kernel has what the files that it imports need.
///
/// # Errors
/// The first need that it does not meet.
pub fn check(kernel: &Kernel, shared: &[Shared<'_>]) -> Result<(), String> {
    for Shared { file, needs } in shared.iter().filter(|shared| kernel.files.iter().any(|file| file == shared.file)) {
        for (name, needed) in needs {
            let found = shape(&kernel.module, name).unwrap_or_else(|| "nothing of that name".to_owned());
            if !meets(needed, &found) {
                let stem = &kernel.stem;
                return Err(format!("kernels/{stem}.wgsl: {file} needs '{name}' as `{needed}`, here it is `{found}`"));
            }
        }
    }
    Ok(())
}

/// Whether a shape is as needed. What is only read may be written, too, and a uniform may be a copy of it.
fn meets(needed: &str, found: &str) -> bool {
    let as_good = [("var<storage, read> ", "var<storage, read_write> "), ("var<uniform> ", "var<private> ")];
    needed == found || as_good.iter().any(|(only, better)| needed.replacen(only, better, 1) == found)
}

/// The needs that a text states.
fn needs(text: &str) -> Result<Vec<Need<'_>>, String> {
    let lines = text.lines().filter(|line| line.starts_with("//@needs"));
    let need = |line| -> Option<Need<'_>> {
        let text = str::strip_prefix(line, "//@needs ").filter(|text| text.ends_with(';') && !text.starts_with('@'))?;
        Some(Need { name: name_of(text)?, text })
    };
    lines.map(|line| need(line).ok_or_else(|| format!("'{line}' is no declaration"))).collect()
}

/// The name that a line declares, if it begins a declaration of the module.
fn name_of(line: &str) -> Option<&str> {
    let mut rest = line;
    while rest.starts_with('@') {
        rest = rest.split_once(' ')?.1;
    }
    let rest = match rest.strip_prefix("var<") {
        Some(rest) => rest.split_once('>')?.1,
        None => {
            ["fn", "var", "const", "override", "struct", "alias"].iter().find_map(|kind| rest.strip_prefix(kind))?
        }
    };
    rest.strip_prefix(' ')?.split(|c| !in_word(c)).next().filter(|name| !name.is_empty())
}

fn in_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Whether a text has a name outside comments, but as that of a member.
fn uses(text: &str, name: &str) -> bool {
    text.lines().filter_map(|line| line.split("//").next()).any(|code| {
        code.match_indices(name).any(|(at, _)| {
            !code[..at].ends_with(|c| in_word(c) || c == '.') && !code[at + name.len()..].starts_with(in_word)
        })
    })
}

impl Need<'_> {
    /// It as the `index`th whole declaration of a text: in a group of its own, 1 for a constant, 0 for a result.
    fn stub(&self, index: usize) -> Result<String, String> {
        let text = self.text.trim_end_matches(';');
        let (kind, _) = text.split_once([' ', '<']).unwrap_or_default();
        Ok(match kind {
            "fn" => match text.rsplit_once("-> ") {
                Some((_, result)) => format!("{text} {{ return {result}(); }}\n"),
                None => format!("{text} {{}}\n"),
            },
            "var" if text.starts_with("var<private>") || text.starts_with("var<workgroup>") => format!("{text};\n"),
            "var" => format!("@group(1) @binding({index}) {text};\n"),
            "const" => match text.split_once(": ") {
                Some((_, ty)) => format!("{text} = {ty}(1);\n"),
                None => return Err(format!("'{}' needs a type", self.name)),
            },
            "override" => format!("{text};\n"),
            _ => return Err(format!("'{}' is a type, and types are imported", self.name)),
        })
    }
}

/// The kind and type of a variable, constant or function; `None` if there is none of that name.
fn shape(module: &Module, name: &str) -> Option<String> {
    let ty = |ty| module.to_ctx().type_to_string(ty);
    let named = |other: &Option<String>| other.as_deref() == Some(name);
    let variable = module.global_variables.iter().find(|(_, v)| named(&v.name)).map(|(_, v)| {
        let space = match address_space_str(v.space) {
            (None, _) => String::new(),
            (Some("storage"), access) => format!("<storage, {}>", access.unwrap_or("read")),
            (Some(space), _) => format!("<{space}>"),
        };
        format!("var{space} {}", ty(v.ty))
    });
    let of_function = || {
        module.functions.iter().find(|(_, f)| named(&f.name)).map(|(_, f)| {
            let arguments: Vec<_> = f.arguments.iter().map(|a| ty(a.ty)).collect();
            let result = f.result.as_ref().map(|r| format!(" -> {}", ty(r.ty)));
            format!("fn({}){}", arguments.join(", "), result.unwrap_or_default())
        })
    };
    let of_override = || {
        let found = module.overrides.iter().find(|(_, o)| named(&o.name));
        found.map(|(_, o)| format!("override {}", ty(o.ty)))
    };
    let of_constant = || {
        let found = module.constants.iter().find(|(_, c)| named(&c.name));
        found.map(|(_, c)| format!("const {}", ty(c.ty)))
    };
    variable.or_else(of_function).or_else(of_override).or_else(of_constant)
}
