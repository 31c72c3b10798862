//! The one error type of the library.

use std::path::PathBuf;

/// Error that the library returns instead of a panic. Its text names the file or object and the numbers.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be read, written or understood.
    #[error("{}: {message}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Fault, with line, byte or object and the numbers.
        message: String,
    },
    /// A mesh holds something that is not geometry (a vertex that is not finite, an index out of range, …).
    #[error("mesh '{name}': {message}")]
    Mesh {
        /// Name of the mesh.
        name: String,
        /// Fault, with the numbers.
        message: String,
    },
    /// A camera, light or ground that cannot be used.
    #[error("scene: {0}")]
    Scene(String),
    /// A setting that cannot be used (sizes, samples, map, names).
    #[error("config: {0}")]
    Config(String),
    /// No adapter, or none that has what is needed.
    #[error("no adapter: {0}")]
    NoAdapter(String),
    /// The GPU failed: device lost, out of memory, a validation error, or no answer in time.
    #[error("gpu: {0}")]
    Gpu(String),
    /// A list or the whole frame needs more memory than may be used.
    #[error("memory: '{what}' needs {needed} bytes, {limit} may be used")]
    Memory {
        /// The buffer or the frame.
        what: String,
        /// Bytes it needs.
        needed: u64,
        /// Bytes it may have.
        limit: u64,
    },
    /// More of something than there can be.
    #[error("limit: {needed} {what}, {limit} are possible")]
    Limit {
        /// Things that are too many.
        what: String,
        /// How many it takes.
        needed: u64,
        /// How many there may be.
        limit: u64,
    },
}

impl Error {
    /// A [`Error::File`] from its parts.
    pub fn file(path: impl Into<PathBuf>, message: impl Into<String>) -> Self {
        Self::File { path: path.into(), message: message.into() }
    }

    /// A [`Error::Mesh`] from its parts.
    pub fn mesh(name: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Mesh { name: name.into(), message: message.into() }
    }

    /// Whether the fault lies with the GPU (exit status 3 of the program) rather than with the input (1).
    pub fn is_gpu(&self) -> bool {
        matches!(self, Self::Gpu(_) | Self::NoAdapter(_))
    }
}

/// Result of the library.
pub type Result<T> = std::result::Result<T, Error>;
