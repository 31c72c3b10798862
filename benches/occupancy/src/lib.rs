//! Every pipeline of the library as AMD's compiler makes it (RADV with ACO, in Mesa): registers, spills, scratch, waves.
//!
//! No GPU is needed: with `RADV_FORCE_FAMILY` the driver compiles for a GPU that is not there. A family is a process of its own
//! ([`families`]), as the driver reads that variable once. [`made`] lists the pipelines, [`spirv`] translates them as wgpu does, [`radv`]
//! compiles them, [`limits`] says what they may take, [`page`] writes them down.

pub mod families;
pub mod limits;
pub mod made;
pub mod page;
pub mod radv;
pub mod spirv;

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A pipeline: kernel, entry point, values of its constants. As [`subpixel_shadows::gpu::program::LOG`] tells it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pipeline(pub String, pub String, pub BTreeMap<String, f64>);

impl Pipeline {
    /// Kernel and entry point, and whether it is made for triangles with holes.
    pub fn name(&self) -> String {
        let holes = if self.2.get("ALPHA").is_some_and(|on| *on != 0.0) { " with holes" } else { "" };
        format!("{}.{}{holes}", self.0, self.1)
    }

    /// Its constants, in a line.
    pub fn constants(&self) -> String {
        self.2.iter().map(|(name, value)| format!("{name} {value}")).collect::<Vec<_>>().join(", ")
    }
}

/// Figures of a compiled pipeline, as the driver tells them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Figures {
    /// Vector registers of an invocation.
    pub vector_registers: u64,
    /// Scalar registers of a wave.
    pub scalar_registers: u64,
    /// Vector registers put into memory.
    pub spilled_vector: u64,
    /// Scalar registers put into vector registers.
    pub spilled_scalar: u64,
    /// Bytes of memory of a wave for arrays that are indexed, and for spilled registers.
    pub scratch: u64,
    /// Bytes of workgroup memory.
    pub workgroup_memory: u64,
    /// Bytes of machine code.
    pub code: u64,
    /// Waves that a SIMD can hold at once: waves of 32 invocations on navi21, of 64 on vega10.
    pub waves: u64,
}

/// Pipelines whose SPIR-V is the same, the first of them by name, and what the driver says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The first.
    pub pipeline: Pipeline,
    /// How many there are.
    pub alike: usize,
    /// The figures.
    pub figures: Figures,
}
