//! Recording stages into an encoder: the only place that begins compute passes.

use super::bind_groups::{self, BindGroups};
use super::bindings::{Bindings as _, EntryPoint};
use super::program::Compiled;
use super::{Program, Timer};

/// How many workgroups a dispatch runs.
#[derive(Clone, Copy, Debug)]
pub enum Groups<'a> {
    /// Enough for this many invocations, folded over two dimensions (see `kernels/shared/frame/dispatch.wgsl`).
    Items(u64),
    /// This many workgroups, folded over two dimensions.
    Workgroups(u64),
    /// So many workgroups, or as many as the device runs, folded: they go through all there is in steps of their number.
    Strides(u64),
    /// As three `u32` at this word of a buffer say.
    Indirect(&'a wgpu::Buffer, u64),
}

/// Most workgroups along one dimension at WebGPU's default limits.
pub const MAX_GROUPS: u32 = 65_535;

/// `groups` workgroups folded into two dimensions, neither over [`MAX_GROUPS`]; a few spare ones may be in it.
pub fn fold(groups: u64) -> [u32; 3] {
    fold_within(groups, MAX_GROUPS)
}

/// As [`fold`], for a device that runs at most `most` workgroups along one dimension.
pub fn fold_within(groups: u64, most: u32) -> [u32; 3] {
    let most = u64::from(most.max(1));
    if groups <= most {
        return [groups as u32, 1, 1];
    }
    let rows = groups.div_ceil(most);
    [groups.div_ceil(rows) as u32, rows as u32, 1]
}

/// Appends stages to a caller's encoder. Never submits, waits or maps.
pub struct Recorder<'a> {
    /// The device that makes bind groups.
    pub device: &'a wgpu::Device,
    encoder: &'a mut wgpu::CommandEncoder,
    timer: Option<&'a mut Timer>,
    bind_groups: Option<&'a mut BindGroups>,
    dispatches: u32,
    max_groups: u32,
}

impl<'a> Recorder<'a> {
    /// A recorder that appends to `encoder`, with time stamps around each stage if there is a `timer`.
    pub fn new(device: &'a wgpu::Device, encoder: &'a mut wgpu::CommandEncoder, timer: Option<&'a mut Timer>) -> Self {
        let max_groups = device.limits().max_compute_workgroups_per_dimension;
        Self { device, encoder, timer, bind_groups: None, dispatches: 0, max_groups }
    }

    /// The recorder with bind groups that earlier recordings made, which it adds to.
    pub fn keeping(self, bind_groups: &'a mut BindGroups) -> Self {
        bind_groups.begin();
        Self { bind_groups: Some(bind_groups), ..self }
    }

    /// Begins a stage. Dispatches of one stage run in order and see each other's writes.
    pub fn stage(&mut self, name: &'static str) -> Stage<'_> {
        let stamps = self.timer.as_mut().and_then(|t| t.begin(name));
        let pass = self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(name),
            timestamp_writes: stamps.as_ref().map(|(query_set, first)| wgpu::ComputePassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(*first),
                end_of_pass_write_index: Some(*first + 1),
            }),
        });
        let (dispatches, bind_groups) = (&mut self.dispatches, self.bind_groups.as_deref_mut());
        Stage { device: self.device, pass, bind_groups, dispatches, max_groups: self.max_groups }
    }

    /// Fills a buffer with zeros.
    pub fn clear(&mut self, buffer: &wgpu::Buffer) {
        self.encoder.clear_buffer(buffer, 0, None);
    }

    /// Fills a range of 32-bit words of a buffer with zeros.
    pub fn clear_words(&mut self, buffer: &wgpu::Buffer, first: u64, count: u64) {
        self.encoder.clear_buffer(buffer, first * 4, Some(count * 4));
    }

    /// Copies `bytes` from the start of one buffer to the start of another.
    pub fn copy(&mut self, from: &wgpu::Buffer, to: &wgpu::Buffer, bytes: u64) {
        self.encoder.copy_buffer_to_buffer(from, 0, to, 0, bytes);
    }

    /// Copies `count` 32-bit words from one place to another.
    pub fn copy_words(&mut self, from: &wgpu::Buffer, first: u64, to: &wgpu::Buffer, at: u64, count: u64) {
        self.encoder.copy_buffer_to_buffer(from, first * 4, to, at * 4, count * 4);
    }

    /// Copies rows of a buffer into a texture.
    pub fn copy_to_texture(&mut self, from: &wgpu::Buffer, rows: TexelRows) {
        self.encoder.copy_buffer_to_texture(rows.in_buffer(from), rows.in_texture(), rows.extent());
    }

    /// Copies a part of a texture to rows of a buffer.
    pub fn copy_from_texture(&mut self, rows: TexelRows, to: &wgpu::Buffer) {
        self.encoder.copy_texture_to_buffer(rows.in_texture(), rows.in_buffer(to), rows.extent());
    }

    /// Dispatches recorded so far.
    pub fn dispatches(&self) -> u32 {
        self.dispatches
    }
}

/// Rows of a buffer that are a part of a texture.
#[derive(Clone, Copy, Debug)]
pub struct TexelRows<'a> {
    /// The texture.
    pub texture: &'a wgpu::Texture,
    /// Its level.
    pub level: u32,
    /// First column, row and layer.
    pub origin: [u32; 3],
    /// Columns and rows.
    pub size: [u32; 2],
    /// The first row in the buffer.
    pub first: u32,
    /// Bytes of a row in the buffer, a multiple of 256.
    pub row_bytes: u32,
}

impl<'a> TexelRows<'a> {
    fn in_texture(self) -> wgpu::TexelCopyTextureInfo<'a> {
        let [x, y, z] = self.origin;
        let origin = wgpu::Origin3d { x, y, z };
        wgpu::TexelCopyTextureInfo {
            texture: self.texture,
            mip_level: self.level,
            origin,
            aspect: wgpu::TextureAspect::All,
        }
    }

    fn in_buffer(self, buffer: &wgpu::Buffer) -> wgpu::TexelCopyBufferInfo<'_> {
        let layout = wgpu::TexelCopyBufferLayout {
            offset: u64::from(self.first) * u64::from(self.row_bytes),
            bytes_per_row: Some(self.row_bytes),
            rows_per_image: None,
        };
        wgpu::TexelCopyBufferInfo { buffer, layout }
    }

    fn extent(self) -> wgpu::Extent3d {
        wgpu::Extent3d { width: self.size[0], height: self.size[1], depth_or_array_layers: 1 }
    }
}

/// One stage being recorded.
pub struct Stage<'a> {
    /// The device that makes bind groups.
    pub device: &'a wgpu::Device,
    pass: wgpu::ComputePass<'a>,
    bind_groups: Option<&'a mut BindGroups>,
    dispatches: &'a mut u32,
    max_groups: u32,
}

impl Stage<'_> {
    /// Runs `program` over its bindings. A direct dispatch of nothing is left out.
    pub fn run<'b, E: EntryPoint>(
        &mut self,
        program: &Program<E>,
        bindings: impl Into<E::Bindings<'b>>,
        groups: Groups,
    ) {
        self.run_entries(program.compiled(), &bindings.into().entries(), groups);
    }

    /// As [`Stage::run`], with bindings that no type holds together.
    pub fn run_entries(&mut self, program: &Compiled, entries: &[wgpu::BindGroupEntry], groups: Groups) {
        let fold = |groups| Some(fold_within(groups, self.max_groups));
        let direct = match groups {
            Groups::Items(0) | Groups::Workgroups(0) | Groups::Strides(0) => return,
            Groups::Items(n) => fold(n.div_ceil(u64::from(program.workgroup_invocations()))),
            Groups::Workgroups(n) => fold(n),
            Groups::Strides(n) => fold(n.min(u64::from(self.max_groups) * u64::from(self.max_groups))),
            Groups::Indirect(..) => None,
        };
        let bind_group = match &mut self.bind_groups {
            Some(kept) => kept.get(self.device, program, entries),
            None => bind_groups::make(self.device, program, entries),
        };
        self.pass.set_pipeline(program.pipeline());
        self.pass.set_bind_group(0, &bind_group, &[]);
        match (direct, groups) {
            (Some([x, y, z]), _) => self.pass.dispatch_workgroups(x, y, z),
            (None, Groups::Indirect(args, word)) => self.pass.dispatch_workgroups_indirect(args, word * 4),
            (None, _) => {}
        }
        *self.dispatches += 1;
    }
}
