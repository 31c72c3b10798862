//! Options of the command line, with those of a frame.json behind them.

use super::args::Cli;
use clap::error::ErrorKind;
use clap::{ArgMatches, CommandFactory, Parser};
use lab::options::{FrameArguments, RenderOptions, is_on_line, reason, refusal};
use lab::report::FrameReport;
use lab::scene::{CameraOverride, light_from_text, names};
use serde_json::{Map, Value};
use std::ffi::OsString;
use std::path::Path;
use subpixel_shadows::scene::Mesh;
use subpixel_shadows::{Error, Result};

/// Largest frame.json that is read, bytes.
const LARGEST: u64 = 1 << 26;

/// Options that say where files and lines go, and nothing of a frame.
const NOT_OF_A_FRAME: [&str; 5] = ["from", "out", "quiet", "help", "version"];

/// Scene and options of `render` or `explain`: those of `matches`, which they were parsed from, and behind them those of `--from`.
/// An option on the command line that the method does not take ends the program with status 2.
pub fn given(
    matches: &ArgMatches,
    scene: Option<String>,
    options: RenderOptions,
) -> Result<(Option<String>, RenderOptions)> {
    let (scene, options) = match &options.from {
        Some(path) => with_frame(matches, scene, &options, path)?,
        None => (scene, options),
    };
    if let Some(text) = refusal(matches, options.method) {
        Cli::command().error(ErrorKind::ArgumentConflict, text).exit();
    }
    Ok((scene, options))
}

/// Scene and options of a frame.json, those on the command line before them.
fn with_frame(
    matches: &ArgMatches,
    scene: Option<String>,
    own: &RenderOptions,
    path: &Path,
) -> Result<(Option<String>, RenderOptions)> {
    let settings = settings_in(path, &read(path)?)?;
    let mut arguments = vec![OsString::from("subpixel-shadows")];
    let mut method = own.method;
    let mut found = Vec::new();
    for (name, value) in &settings {
        let Some(argument) = of_frame(path, name, value)? else { continue };
        if name == "method" && !is_on_line(matches, "method") {
            method = argument.options.method;
        }
        found.push((name, argument));
    }
    // Another method may be asked for, which takes less.
    let kept = found.iter().filter(|(name, _)| *name != "scene" && !is_on_line(matches, name) && method.takes(name));
    arguments.extend(kept.map(|(_, argument)| argument.text.clone()));
    for argument in FrameArguments::command().get_opts() {
        let id = argument.get_id().as_str();
        if !is_on_line(matches, id) {
            continue;
        }
        let mut text = OsString::from(format!("--{}", argument.get_long().unwrap_or(id)));
        if argument.get_action().takes_values() {
            text.push("=");
            text.push(matches.get_raw(id).and_then(|mut values| values.next()).unwrap_or_default());
        }
        arguments.push(text);
    }
    let of_file = found.into_iter().find(|(name, _)| *name == "scene").and_then(|(_, argument)| argument.scene);
    let fault = |e: clap::Error| Error::file(path, format!("settings: {}", reason(&e)));
    Ok((scene.or(of_file), FrameArguments::try_parse_from(arguments).map_err(fault)?.options))
}

/// The note that the scene of `--from` has another mesh than it had, if so: the picture is another then.
pub fn other_mesh(options: &RenderOptions, frame: &FrameReport) -> Option<String> {
    let path = options.from.as_deref()?;
    let whole = read(path).ok()?;
    let (then, now) = (whole.get("mesh")?, serde_json::to_value(frame.mesh).ok()?);
    let same = ["scene", "ground"].iter().all(|key| whole["settings"].get(*key) == frame.settings.get(*key));
    (same && *then != now)
        .then(|| format!("{}: the mesh of '{}' was another then: {then}, now {now}", path.display(), frame.scene))
}

/// A frame.json.
fn read(path: &Path) -> Result<Value> {
    let fault = |e: std::io::Error| Error::file(path, format!("cannot be read: {e}"));
    let about = std::fs::metadata(path).map_err(fault)?;
    if !about.is_file() || about.len() > LARGEST {
        return Err(Error::file(path, format!("is no frame.json: {} bytes", about.len())));
    }
    let text = std::fs::read(path).map_err(fault)?;
    serde_json::from_slice(&text).map_err(|e| Error::file(path, format!("is no JSON: {e}")))
}

/// Its object `settings`.
fn settings_in(path: &Path, whole: &Value) -> Result<Map<String, Value>> {
    match whole.get("settings") {
        Some(Value::Object(settings)) => Ok(settings.clone()),
        Some(other) => Err(Error::file(path, format!("settings is {}, no object", short(other)))),
        None => Err(Error::file(path, "has no settings, which frame.json holds now")),
    }
}

/// One setting of a frame.json.
struct Setting {
    /// As on the command line.
    text: OsString,
    /// The options with it alone.
    options: RenderOptions,
    /// The scene, if that is what is set.
    scene: Option<String>,
}

/// One setting; `None` where it says that nothing was given.
fn of_frame(path: &Path, name: &str, value: &Value) -> Result<Option<Setting>> {
    let fault = |why: &str| Error::file(path, format!("settings: {name} is {}: {why}", short(value)));
    let command = FrameArguments::command();
    let argument = command.get_opts().find(|a| a.get_long() == Some(name) && !NOT_OF_A_FRAME.contains(&name));
    let flag = argument.is_some_and(|a| !a.get_action().takes_values());
    if argument.is_none() && name != "scene" {
        return Err(fault("there is no such option"));
    }
    let text = match value {
        Value::Null | Value::Bool(false) if flag || value.is_null() => return Ok(None),
        Value::Bool(true) if flag => format!("--{name}"),
        Value::String(text) if !flag && name == "scene" => text.clone(),
        Value::String(text) if !flag => format!("--{name}={text}"),
        Value::Number(number) if !flag && name != "scene" => format!("--{name}={number}"),
        _ if flag => return Err(fault("true or false is possible")),
        _ => return Err(fault("neither a text nor a number")),
    };
    let mut line = vec!["subpixel-shadows", if name == "scene" { "--" } else { &text }];
    if name == "scene" {
        line.push(&text);
        if !names().any(|name| name == text) && !Path::new(&text).exists() {
            return Err(fault("neither a built-in scene nor a file"));
        }
    }
    let parsed = match FrameArguments::try_parse_from(&line) {
        // It stands alone here.
        Err(e) if e.kind() == ErrorKind::MissingRequiredArgument => {
            FrameArguments::try_parse_from([line[0], "--truth", &text])
        }
        parsed => parsed,
    };
    let FrameArguments { scene, options } = parsed.map_err(|e| fault(&reason(&e)))?;
    options.settings().map_err(|e| fault(&e.to_string()))?;
    let camera = options.camera.as_deref().map(str::parse::<CameraOverride>).transpose();
    if let Some(camera @ CameraOverride { eye: Some(_), target: Some(_), .. }) =
        camera.map_err(|e| fault(&e.to_string()))?
    {
        camera.apply(None, &Mesh::default()).map_err(|e| fault(&e.to_string()))?;
    }
    options.light.as_deref().map(light_from_text).transpose().map_err(|e| fault(&e.to_string()))?;
    Ok(Some(Setting { text: text.clone().into(), options, scene }))
}

/// A value for people.
fn short(value: &Value) -> String {
    let text = value.to_string();
    match text.char_indices().nth(100) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::scene::Scene;
    use std::collections::BTreeSet;
    use subpixel_shadows::methods::{METHOD_OPTIONS, MethodName};

    fn options(arguments: &[&str]) -> RenderOptions {
        FrameArguments::try_parse_from([&["subpixel-shadows"], arguments].concat()).unwrap().options
    }

    /// Every option of the table is one of the program, and every option of the program is in some frame.json.
    #[test]
    fn every_option_is_recorded() {
        let command = FrameArguments::command();
        let names: BTreeSet<&str> = command.get_opts().filter_map(|a| a.get_long()).collect();
        assert!(METHOD_OPTIONS.iter().all(|o| names.contains(*o)));
        for argument in command.get_opts() {
            assert_eq!(argument.get_long().unwrap().replace('-', "_"), argument.get_id().as_str());
        }
        let scene = Scene::open("plane", &Default::default()).unwrap();
        let mut recorded = BTreeSet::new();
        for method in MethodName::ALL {
            let found = options(&["--method", method.name()]).recorded(&scene, "cpu", Value::Null);
            assert!(METHOD_OPTIONS.iter().all(|o| found.contains_key(*o) == method.takes(o)), "{found:?}");
            recorded.extend(found.into_iter().map(|(name, _)| name));
        }
        let wanted = names.iter().filter(|n| !NOT_OF_A_FRAME.contains(n)).chain(&["scene"]).map(|n| (*n).to_owned());
        assert_eq!(recorded, wanted.collect());
    }

    /// Recorded settings read back to the same options, scene, camera and light.
    #[test]
    fn what_is_recorded_reads_back() {
        let lights =
            ["point=0.1,1e-30,-3e7", "spot=1,2,0.3;target=0.7,0,0;angle=33.3", "directional=0.1,0.7,0.30000001"];
        let asked: [&[&str]; 3] = [
            &["--samples", "8", "--pairs", "sorted", "--validity", "off", "--list-start", "77", "--force-all"],
            &["--method", "remix", "--focus", "0.1", "--bleeding", "0.3", "--grazing", "5", "--warp", "even"],
            &["--method", "smsr", "--reach", "9", "--shape", "corners", "--truth", "--converged", "--size", "7x9"],
        ];
        for (asked, light) in asked.iter().zip(lights) {
            let own = options(
                &[asked, &["--light", light, "--camera", "eye=0.1,2,3.3333333;fov=40.1;shift=0.1,-0.7"][..]].concat(),
            );
            let scene = own.open(Some("spheres")).unwrap().0;
            let path = Path::new("f.json");
            let mut line = vec![OsString::from("subpixel-shadows")];
            for (name, value) in own.recorded(&scene, "cpu", Value::Null) {
                let found = of_frame(path, &name, &value).unwrap();
                line.extend(found.into_iter().filter(|f| f.scene.is_none()).map(|f| f.text));
            }
            let again = FrameArguments::try_parse_from(line).unwrap().options;
            assert_eq!(again.settings().unwrap(), own.settings().unwrap());
            assert_eq!(
                (again.force_all, again.list_start, again.converged),
                (own.force_all, own.list_start, own.converged)
            );
            let reopened = again.open(Some("spheres")).unwrap().0;
            assert_eq!((reopened.camera, reopened.light), (scene.camera, scene.light));
        }
    }
}
