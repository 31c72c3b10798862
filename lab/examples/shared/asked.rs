//! The command line of an example.

use std::path::PathBuf;
use subpixel_shadows::{Error, Result};

/// Options of an example.
pub struct Asked {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Samples a pixel.
    pub samples: u32,
    /// The folder that is written.
    pub out: PathBuf,
}

impl Asked {
    /// Options of a command line; `out`: the folder where none is given.
    pub fn of(mut words: impl Iterator<Item = String>, out: &str) -> Result<Self> {
        let mut asked = Self { size: [320, 240], samples: 32, out: out.into() };
        while let Some(word) = words.next() {
            let value = words.next().ok_or_else(|| Error::Config(format!("{word} needs a value")))?;
            match word.as_str() {
                "--samples" => {
                    asked.samples = value.parse().map_err(|e| Error::Config(format!("{word} {value}: {e}")))?;
                }
                "--size" => asked.size = lab::options::size(&value).map_err(Error::Config)?,
                "--out" => asked.out = value.into(),
                _ => return Err(Error::Config(format!("'{word}' is not known"))),
            }
        }
        Ok(asked)
    }
}
