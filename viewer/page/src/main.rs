//! Makes the viewer's web page of its WebAssembly: `page WASM DIR` writes the files that a server hands out as they are, and says how many
//! bytes these are when it compresses them. `./web.sh` runs it.

use flate2::Compression;
use flate2::write::GzEncoder;
use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use wasm_bindgen_cli_support::Bindgen;

/// Files of the page besides its code.
const FILES: [(&str, &[u8]); 3] = [
    ("index.html", include_bytes!("../../web/index.html")),
    ("worker.js", include_bytes!("../../web/worker.js")),
    ("viewer.png", include_bytes!("../../../data/pictures/viewer.png")),
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [wasm, folder] = &arguments[..] else {
        eprintln!("error: page WASM DIR: {} arguments were given", arguments.len());
        return ExitCode::from(2);
    };
    match make(wasm, Path::new(folder)) {
        Ok(bytes) => {
            println!("{folder}: {bytes} bytes compressed, without the picture for browsers that have no WebGPU");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {wasm}: {error}");
            ExitCode::FAILURE
        }
    }
}

/// A script, or a page with one, without indents, empty lines, and lines of comments.
fn code_only(script: &str) -> String {
    let lines = script.lines().map(str::trim);
    let code = lines.filter(|line| !line.is_empty() && !["//", "/**", "*"].iter().any(|c| line.starts_with(c)));
    code.collect::<Vec<_>>().join("\n")
}

/// Writes the page and says how many bytes it is, compressed.
fn make(wasm: &str, folder: &Path) -> Result<usize, Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let mut bindgen = Bindgen::new();
    bindgen.input_path(wasm).web(true)?.typescript(false).remove_name_section(true).remove_producers_section(true);
    bindgen.generate(folder)?;
    let glue = folder.join("viewer.js");
    std::fs::write(&glue, code_only(&std::fs::read_to_string(&glue)?))?;
    for (name, content) in FILES {
        let path = folder.join(name);
        match std::str::from_utf8(content) {
            Ok(text) => std::fs::write(path, code_only(text))?,
            Err(_) => std::fs::write(path, content)?,
        }
    }
    ["viewer_bg.wasm", "viewer.js", "worker.js", "index.html"].iter().try_fold(0, |sum, name| {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(&std::fs::read(folder.join(name))?)?;
        Ok(sum + encoder.finish()?.len())
    })
}
