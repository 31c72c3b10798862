//! Mechanism that knows nothing of shadows: device, buffers, programs, recording, timing, readback.

mod batch;
pub mod bind_groups;
pub mod bindings;
pub mod buffer;
pub mod device;
pub mod faults;
pub(crate) mod given;
#[rustfmt::skip]
pub mod kernels;
pub mod kept;
pub mod layout;
pub mod ledger;
#[cfg(feature = "mutations")]
pub mod mutation;
pub mod profile;
pub mod program;
pub mod recorder;
pub(crate) mod scope;
pub mod source;
pub mod timer;
pub mod uniforms;
pub mod uploads;

pub use bind_groups::BindGroups;
pub use buffer::Buffer;
pub use device::{AdapterSummary, Gpu};
pub use kept::KeptPrograms;
pub use ledger::{BufferMemory, Ledger};
pub use profile::Profile;
pub use program::{Entry, Program};
pub use recorder::{Groups, Recorder, Stage, TexelRows};
pub use source::Source;
pub use timer::{StageTime, Timer};
pub use uniforms::Uniforms;
pub use uploads::{StagedUploads, Uploads};
