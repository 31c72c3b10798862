//! The command line of the examples that go through scenes.

use crate::scene::BUILTIN_NAMES;
use std::path::PathBuf;
use subpixel_shadows::{Error, Result};

/// `[--size WxH] [--samples N] [--map N] [--ground] [--out DIR] [SCENE …]`
pub struct Arguments {
    /// Width and height of the image.
    pub size: [u32; 2],
    /// Samples a pixel, if given.
    pub samples: Option<u32>,
    /// Texels along a side of the light's map.
    pub map: u32,
    /// Whether a ground is added.
    pub ground: bool,
    /// Folder of what is written.
    pub out: PathBuf,
    /// Every built-in scene if none is named.
    pub scenes: Vec<String>,
}

impl Arguments {
    /// Reads them from the words after the program's name.
    ///
    /// # Errors
    /// [`Error::Config`] with the word that cannot be read.
    pub fn of(mut words: impl Iterator<Item = String>) -> Result<Self> {
        let mut found = Self {
            size: [800, 600],
            samples: None,
            map: 512,
            ground: false,
            out: PathBuf::from("out"),
            scenes: Vec::new(),
        };
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or_else(|| Error::Config(format!("{word} needs a value")));
            let number = |text: &str| text.parse::<u32>().map_err(|e| Error::Config(format!("'{text}': {e}")));
            match word.as_str() {
                "--ground" => found.ground = true,
                "--samples" => found.samples = Some(number(&value()?)?),
                "--out" => found.out = value()?.into(),
                "--map" => found.map = number(&value()?)?,
                "--size" => {
                    let text = value()?;
                    let (w, h) = text.split_once('x').ok_or_else(|| Error::Config(format!("'{text}' is no WxH")))?;
                    found.size = [number(w)?, number(h)?];
                }
                _ => found.scenes.push(word),
            }
        }
        if found.scenes.is_empty() {
            found.scenes = BUILTIN_NAMES.map(str::to_owned).to_vec();
        }
        Ok(found)
    }
}
