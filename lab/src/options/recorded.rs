//! Options as text: what a frame.json records, and the command line that repeats a frame.

use super::{FrameArguments, RenderOptions};
use crate::scene::{Camera, CameraOverride, Lens, Light, Scene};
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{ArgMatches, CommandFactory, FromArgMatches, ValueEnum};
use serde_json::{Map, Value, json};
use std::ffi::OsString;
use subpixel_shadows::methods::{METHOD_OPTIONS, METHODS, MethodName};
use subpixel_shadows::{Error, Result};

impl RenderOptions {
    /// Settings that a frame was asked for with, by the names of the options: `--from` repeats it. Camera and light are those that were used,
    /// in numbers that read back the same; so are engine and adapter.
    pub fn recorded(&self, scene: &Scene, engine: &str, adapter: Value) -> Map<String, Value> {
        fn word(value: impl ValueEnum) -> Value {
            value.to_possible_value().map_or(Value::Null, |v| json!(v.get_name()))
        }
        let o = self;
        let number = |value: f32| json!(value.to_string().parse::<f64>().unwrap_or(f64::from(value)));
        let [width, height] = o.size;
        let own = o.method.row().partition;
        let all = [
            ("scene", json!(scene.name)),
            ("method", json!(o.method.name())),
            ("engine", json!(engine)),
            ("adapter", adapter),
            ("camera", json!(camera_text(&scene.camera))),
            ("light", json!(light_text(&scene.light))),
            ("light-radius", json!(o.light_radius)),
            ("light-points", json!(o.light_points)),
            ("ground", json!(o.ground)),
            ("samples", json!(o.samples)),
            ("pattern", word(o.pattern)),
            ("map", json!(o.map)),
            ("size", json!(format!("{width}x{height}"))),
            ("truth", json!(o.truth)),
            ("converged", json!(o.converged)),
            ("looks", json!(o.looks)),
            ("frames", json!(o.frames)),
            ("force-all", json!(o.force_all)),
            ("memory-limit", json!(o.memory_limit)),
            ("list-start", json!(o.list_start)),
            ("facets", word(o.facets)),
            ("validity", word(o.validity)),
            ("masks", word(o.masks)),
            ("pairs", word(o.pairs)),
            ("projection", word(o.projection)),
            ("filter", word(o.filter)),
            ("encoding", word(o.encoding)),
            ("search", word(o.search)),
            ("recovery", word(o.recovery)),
            ("slope-power", json!(o.slope_power)),
            ("lookups", json!(o.asked_texels())),
            ("rays", word(o.rays)),
            ("kernel", json!(o.kernel)),
            ("taps", json!(o.taps)),
            ("radius", number(o.radius)),
            ("turned", word(o.turned)),
            ("compare", word(o.compare)),
            ("bias", number(o.bias)),
            ("slope-bias", number(o.slope_bias)),
            ("sub-texels", json!(o.sub_texels)),
            ("nodes", json!(o.nodes)),
            ("error", number(o.error)),
            ("shape", word(o.shape)),
            ("reach", json!(o.reach)),
            ("partition", word(o.partition)),
            ("splits", json!(o.splits.or(own.map(|plan| plan.splits)))),
            ("split-weight", json!(o.split_weight)),
            ("warp", o.warp.or(own.map(|_| Default::default())).map_or(Value::Null, word)),
            ("focus", json!(o.focus)),
            ("omni", word(o.omni)),
            ("bleeding", number(o.bleeding)),
            ("grazing", number(o.grazing)),
            ("exponent", number(o.exponent)),
            ("layers", json!(o.layers)),
            ("terms", json!(o.terms)),
            ("history", json!(o.history)),
            ("confidence-power", json!(o.confidence_power)),
            ("pages", json!(o.pages)),
            ("finer", json!(o.finer)),
            ("page-rule", word(o.page_rule)),
            ("changed", json!(o.changed)),
            ("density", word(o.density)),
            ("stretch", json!(o.stretch)),
        ];
        all.into_iter().filter(|(name, _)| o.method.takes(name)).map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

/// A camera as `--camera` takes it.
pub fn camera_text(camera: &Camera) -> String {
    let all = CameraOverride::from(*camera);
    let without_lens = CameraOverride { shift: None, pixel_aspect: None, mirrored: None, ..all };
    if camera.lens == Lens::CENTRED { without_lens } else { all }.to_string()
}

/// A light as `--light` takes it.
pub fn light_text(light: &Light) -> String {
    match *light {
        Light::Directional { direction } => format!("directional={}", vector(direction)),
        Light::Point { position } => format!("point={}", vector(position)),
        Light::Spot { position, target, angle_degrees } => {
            format!("spot={};target={};angle={angle_degrees}", vector(position), vector(target))
        }
    }
}

fn vector([x, y, z]: [f32; 3]) -> String {
    format!("{x},{y},{z}")
}

/// Options that say nothing of the picture.
const OF_NO_PICTURE: [&str; 8] = ["scene", "engine", "adapter", "truth", "converged", "looks", "frames", "list-start"];

impl FrameArguments {
    /// The arguments of a command line such as `render plant --samples 8`; the words before the scene and quotes as a shell has them may be
    /// there or not.
    ///
    /// # Errors
    /// [`Error::Config`], one line, if they are not those of `render`.
    pub fn of_line(line: &str) -> Result<Self> {
        let refuse = |why: &str| Error::Config(format!("'{}': {why}", line.escape_debug()));
        let words = shlex::split(line).ok_or_else(|| refuse("a quote is not closed"))?;
        let begin = words.iter().take(8).position(|word| word == "render").map_or(0, |at| at + 1);
        let arguments = std::iter::once("subpixel-shadows").chain(words[begin..].iter().map(String::as_str));
        parsed(arguments, |given: &Self| given.options.method).map_err(|e| match e.kind() {
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => refuse("is no frame"),
            _ => refuse(&reason(&e)),
        })
    }
}

/// Arguments, of which the method, as `method` finds it in them, takes every option.
///
/// # Errors
/// As clap's, also for an option of other methods.
pub fn parsed<A: CommandFactory + FromArgMatches>(
    arguments: impl IntoIterator<Item = impl Into<OsString> + Clone>,
    method: impl FnOnce(&A) -> MethodName,
) -> clap::error::Result<A> {
    let mut command = A::command();
    let matches = command.try_get_matches_from_mut(arguments)?;
    let given = A::from_arg_matches(&matches)?;
    match refusal(&matches, method(&given)) {
        Some(text) => Err(command.error(ErrorKind::ArgumentConflict, text)),
        None => Ok(given),
    }
}

/// Why `method` cannot be given one of the options on a command line, if so.
pub fn refusal(matches: &ArgMatches, method: MethodName) -> Option<String> {
    let option = METHOD_OPTIONS.iter().find(|option| is_on_line(matches, option) && !method.takes(option))?;
    let takers: Vec<&str> = METHODS.iter().filter(|row| row.method.takes(option)).map(|row| row.name).collect();
    let verb = if takers.len() == 1 { "does" } else { "do" };
    Some(format!("the method {} does not take '--{option}'; {} {verb}", method.name(), takers.join(", ")))
}

/// Whether an option was given on a command line.
pub fn is_on_line(matches: &ArgMatches, name: &str) -> bool {
    matches.value_source(&name.replace('-', "_")) == Some(ValueSource::CommandLine)
}

/// Reason that clap gives before it explains the usage, in one line.
pub fn reason(error: &clap::Error) -> String {
    let text = error.to_string();
    let first = text.split("\n\n").next().unwrap_or_default();
    first.strip_prefix("error: ").unwrap_or(first).split_whitespace().collect::<Vec<_>>().join(" ")
}

impl RenderOptions {
    /// The options of a method that nothing else is said of.
    ///
    /// # Errors
    /// [`Error::Config`] if the program had an option without a default.
    pub fn of_method(method: MethodName) -> Result<Self> {
        FrameArguments::of_line(&format!("--method {}", method.name())).map(|plain| plain.options)
    }

    /// The command line that renders the same picture, after the program's name: scene, camera and light, and what is not as it is by default.
    pub fn line(&self, scene: &Scene) -> String {
        let words = ["render".to_owned(), scene.name.clone()].into_iter().chain(self.words(scene, &[]));
        let quoted = words.map(|word| shlex::try_quote(&word).unwrap_or_default().into_owned());
        quoted.collect::<Vec<_>>().join(" ")
    }

    /// The options of [`RenderOptions::line`] but those of these names.
    pub fn words(&self, scene: &Scene, without: &[&str]) -> Vec<String> {
        let own = self.recorded(scene, "gpu", Value::Null);
        let plain =
            Self::of_method(self.method).map(|plain| plain.recorded(scene, "gpu", Value::Null)).unwrap_or_default();
        let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let mut words = Vec::new();
        for (name, value) in own.iter().filter(|(name, _)| !without.contains(&name.as_str())) {
            let stands = matches!(name.as_str(), "camera" | "light");
            let method = name == "method" && self.method != Default::default();
            let set = !OF_NO_PICTURE.contains(&name.as_str()) && plain.get(name) != Some(value);
            match value {
                Value::Bool(true) if set => words.push(format!("--{name}")),
                Value::Null | Value::Bool(_) => {}
                _ if stands || method || set => words.extend([format!("--{name}"), text(value)]),
                _ => {}
            }
        }
        words
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line reads back to the same settings, camera and light.
    #[test]
    fn lines_read_back() {
        for line in [
            "render plant",
            "cargo run --release -- render plane --method pcf --kernel 5 --light 'point=1,7.25,0.1' --size 64x48",
            "windmill --facets one --samples 8 --map 256 --pattern grid --ground --camera 'eye=9,9,9.1;target=0,0,0;fov=31'",
            "spheres --method shadow-map --bias 0.001 --slope-bias 2.5",
            "leaves --method deep --sub-texels 8 --nodes 15 --error 0.02",
            "spheres --method remix --splits 2 --warp even --bleeding 0.25 --grazing 5",
        ] {
            let own = FrameArguments::of_line(line).unwrap();
            let (scene, _) = own.options.open(own.scene.as_deref()).unwrap();
            let written = own.options.line(&scene);
            let again = FrameArguments::of_line(&written).unwrap();
            let (reopened, _) = again.options.open(again.scene.as_deref()).unwrap();
            assert_eq!(again.options.settings().unwrap(), own.options.settings().unwrap(), "{written}");
            assert_eq!((reopened.camera, reopened.light), (scene.camera, scene.light), "{written}");
            assert_eq!((again.options.method, again.options.ground), (own.options.method, own.options.ground));
        }
        let plain = FrameArguments::of_line("plane").unwrap();
        let (scene, _) = plain.options.open(plain.scene.as_deref()).unwrap();
        let other =
            FrameArguments::of_line(&RenderOptions { samples: 8, ..plain.options.clone() }.line(&scene)).unwrap();
        assert_ne!(other.options.settings().unwrap(), plain.options.settings().unwrap());
    }

    #[test]
    fn what_is_no_line_is_refused_in_one() {
        for (line, part) in [
            ("render plane --samples many", "many"),
            ("--methods pcf", "--methods"),
            ("'plane", "not closed"),
            ("--help", "no frame"),
            ("--method nothing", "no such method"),
            ("plane --method spsm --kernel 5", "the method spsm does not take '--kernel'; pcf does"),
            ("--method lispsm --splits 2", "resolution-matched, rectilinear, supersampled do"),
        ] {
            let message = FrameArguments::of_line(line).unwrap_err().to_string();
            assert!(message.contains(part) && !message.contains('\n'), "{line}: {message}");
        }
    }
}
