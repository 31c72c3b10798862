//! Views: a scene by one method, beside another or traced truth; as a command line, and back.

use crate::overlay::Overlay;
use clap::Parser;
use lab::options::{FrameArguments, RenderOptions, parsed, reason};
use lab::scene::Scene;
use subpixel_shadows::methods::{FacetMode, MethodName};
use subpixel_shadows::{Error, Result};

/// Arguments of the viewer.
#[derive(Clone, Debug, Parser)]
#[command(name = "viewer", version, about = "Looks at a scene by any two methods, or by one and traced truth")]
pub struct ViewArguments {
    /// Scene, and options of the left half.
    #[command(flatten)]
    pub frame: FrameArguments,
    /// The right half: options as of `render`, such as '--method pcf --kernel 5', or truth for 1024 rays a pixel [default: facet-masks,
    /// beside facet-masks truth]
    #[arg(long, value_name = "OPTIONS", allow_hyphen_values = true)]
    pub against: Option<String>,
    /// Where the two halves meet, 0 at the left end to 1 at the right one
    #[arg(long, default_value_t = 0.5, value_name = "SHARE")]
    pub wipe: f32,
    /// The overlay of both halves
    #[arg(long, value_enum, default_value_t, value_name = "QUANTITY")]
    pub show: Overlay,
}

/// The right half.
#[derive(Clone, Debug)]
pub enum Against {
    /// Another method.
    Method(Box<RenderOptions>),
    /// 1024 rays a pixel.
    Truth,
}

/// A scene by one method, and the right half beside it.
#[derive(Clone, Debug)]
pub struct View {
    /// The scene's name, if one was given.
    pub scene: Option<String>,
    /// The left half.
    pub left: RenderOptions,
    /// The right half.
    pub right: Against,
    /// Where they meet, 0 to 1.
    pub wipe: f32,
    /// Quantity that is shown of both.
    pub overlay: Overlay,
}

impl View {
    /// The view of arguments.
    ///
    /// # Errors
    /// [`Error::Config`], one line.
    pub fn new(given: ViewArguments) -> Result<Self> {
        let ViewArguments { frame: FrameArguments { scene, options }, against, wipe, show: overlay } = given;
        options.settings()?;
        if !(0.0..=1.0).contains(&wipe) {
            return Err(Error::Config(format!("--wipe {wipe}: 0 to 1 are possible")));
        }
        let right = match against.as_deref() {
            Some("truth") => Against::Truth,
            Some(line) => Against::Method(Box::new(FrameArguments::of_line(line)?.options)),
            None if options.method == MethodName::FacetMasks && options.settings()?.facets == FacetMode::All => {
                Against::Truth
            }
            None => Against::Method(Box::new(RenderOptions {
                samples: options.samples,
                map: options.map,
                ..RenderOptions::of_method(MethodName::FacetMasks)?
            })),
        };
        if let Against::Method(options) = &right {
            options.settings()?;
        }
        Ok(Self { scene, left: options, right, wipe, overlay })
    }

    /// The view that shows most where none is asked for: bicycle by a shadow map and by facet masks.
    ///
    /// # Errors
    /// As [`RenderOptions::of_method`].
    pub fn first() -> Result<Self> {
        let [left, right] = [MethodName::ShadowMap, MethodName::FacetMasks].map(RenderOptions::of_method);
        let (left, right) = (left?, Against::Method(Box::new(right?)));
        Ok(Self { scene: Some("bicycle".to_owned()), left, right, wipe: 0.5, overlay: Overlay::Shaded })
    }

    /// The view of a command line; words before its arguments are passed over.
    ///
    /// # Errors
    /// [`Error::Config`], one line.
    pub fn of_line(line: &str) -> Result<Self> {
        let refuse = |why: &str| Error::Config(format!("'{}': {why}", line.escape_debug()));
        let words = shlex::split(line).ok_or_else(|| refuse("a quote is not closed"))?;
        let begin = words.iter().take(12).rposition(|word| word == "--" || word == "viewer").map_or(0, |at| at + 1);
        let arguments = std::iter::once("viewer").chain(words[begin..].iter().map(String::as_str));
        let given = parsed(arguments, |given: &ViewArguments| given.frame.options.method);
        Self::new(given.map_err(|e| refuse(&reason(&e)))?)
    }

    /// The arguments that open this view of `scene`.
    pub fn line(&self, scene: &Scene) -> String {
        let left = self.left.line(scene);
        let left = left.strip_prefix("render ").unwrap_or(&left).to_owned();
        let against = match &self.right {
            Against::Truth => "truth".to_owned(),
            Against::Method(options) => {
                let words = options.words(scene, &["camera", "light", "ground", "size"]);
                if words.is_empty() { "--method facet-masks".to_owned() } else { words.join(" ") }
            }
        };
        let against = shlex::try_quote(&against).unwrap_or_default().into_owned();
        let show = match self.overlay {
            Overlay::Shaded => String::new(),
            overlay => format!(" --show {}", overlay.name()),
        };
        format!("{left} --against {against} --wipe {}{show}", self.wipe)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_read_back() {
        for line in [
            "plane",
            "viewer spheres --method pcf --kernel 5 --against truth --wipe 0.25 --show pairs",
            "cargo run --release -p subpixel-shadows-viewer -- plane --method spsm --against '--method remix --splits 2 --samples 8' --light 'point=1,7,0.5'",
        ] {
            let view = View::of_line(line).unwrap();
            let (scene, _) = view.left.open(view.scene.as_deref()).unwrap();
            let again = View::of_line(&view.line(&scene)).unwrap();
            assert_eq!(again.scene, view.scene);
            assert_eq!((again.wipe, again.left.method), (view.wipe, view.left.method));
            assert_eq!((again.overlay, again.overlay != Overlay::Shaded), (view.overlay, line.contains("--show")));
            assert_eq!(again.left.settings().unwrap(), view.left.settings().unwrap());
            match (&again.right, &view.right) {
                (Against::Truth, Against::Truth) => {}
                (Against::Method(a), Against::Method(b)) => assert_eq!(a.settings().unwrap(), b.settings().unwrap()),
                other => panic!("{other:?}"),
            }
            let (opened, _) = again.left.open(again.scene.as_deref()).unwrap();
            assert_eq!((opened.camera, opened.light), (scene.camera, scene.light));
        }
    }

    #[test]
    fn what_is_no_view_is_refused_in_one_line() {
        for (line, part) in [
            ("plane --wipe 2", "0 to 1"),
            ("plane --against 'truths'", "truths"),
            ("plane --show nothing", "nothing"),
            ("plane --against '--samples 3'", "3"),
            ("plane --samples 7", "7"),
            ("plane --kernel 5", "the method facet-masks does not take '--kernel'"),
            ("plane --against '--method spsm --omni paraboloids'", "the method spsm does not take '--omni'"),
        ] {
            let told = match View::of_line(line) {
                // A scene may have any name; it is not opened here.
                Ok(view) if part == "truths" => {
                    assert!(matches!(view.right, Against::Method(_)));
                    continue;
                }
                Ok(view) => panic!("{line}: {view:?}"),
                Err(error) => error.to_string(),
            };
            assert!(told.contains(part) && !told.contains('\n'), "{told}");
        }
    }
}
