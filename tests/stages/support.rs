//! What the stage tests share: the device, seeded values, poison, and comparison.

pub mod axes;
pub mod depth_map;
pub mod geometry;
pub mod masks;
pub mod meshes;
pub mod multisampled;
pub mod pages;
pub mod pair_lists;
pub mod pixels;
pub mod shadow;
pub mod shapes;
pub mod spsm;
pub mod surfaces;
pub mod views;

use subpixel_shadows::gpu::{Buffer, Gpu, Recorder, Stage};
use subpixel_shadows::scene::Homography;
use subpixel_shadows::{Result, wgpu};
pub use test_support::gpu;

/// What buffers hold before a stage runs: wgpu hands out zeros, which hide missing writes.
pub const POISON: u32 = 0xdead_beef;

/// A homography that divides by more than 0 in a box of some units, but not everywhere.
pub const HOMOGRAPHY: Homography = Homography {
    origin: [0.25, -0.5, 0.125, 3.0],
    right: [0.9, 0.1, -0.2, 0.05],
    up: [-0.1, 0.8, 0.3, -0.02],
    divisor: [0.2, -0.3, 0.6, 2.5],
};

/// A device that runs at most `groups` workgroups along a dimension, and binds at most `binding` bytes: folding and
/// banding at sizes a test can afford.
pub fn small_gpu(groups: u32, binding: u64) -> Gpu {
    let limits = wgpu::Limits {
        max_compute_workgroups_per_dimension: groups,
        max_storage_buffer_binding_size: binding,
        ..wgpu::Limits::default()
    };
    Gpu::open_with_limits(None, Some(limits)).expect("a device with small limits")
}

/// Result of recording a stage: nothing, or one that must be good.
pub trait Done {
    /// Fails on an error.
    fn done(self);
}

impl Done for () {
    fn done(self) {}
}

impl Done for Result<()> {
    fn done(self) {
        self.expect("the stage records");
    }
}

/// Records one stage, submits it, waits, and fails on any error of the device.
pub fn run<D: Done>(gpu: &Gpu, record: impl FnOnce(&mut Stage) -> D) {
    let mut encoder = gpu.encoder();
    record(&mut Recorder::new(&gpu.device, &mut encoder, None).stage("test")).done();
    gpu.submit_and_wait(encoder).expect("the stage runs");
    gpu.check().expect("no error of the device");
}

/// Words behind the scan of work items where no table was made.
pub const NO_TABLE: [u32; 3] = [0; 3];

/// A buffer of `data`.
pub fn upload<T: bytemuck::Pod>(gpu: &Gpu, data: &[T]) -> Buffer<T> {
    let buffer = Buffer::banded(&gpu.device, "test.input", data.len()).expect("memory for the input");
    buffer.write(&gpu.queue, data);
    buffer
}

/// A buffer of `len` elements all words of which are [`POISON`], those of its padding to 16 bytes, too.
pub fn poisoned<T: bytemuck::Pod>(gpu: &Gpu, len: usize) -> Buffer<T> {
    let buffer = upload(gpu, &vec![T::zeroed(); len]);
    let padded = vec![POISON; buffer.bytes() as usize / 4];
    gpu.queue.write_buffer(buffer.raw(), 0, bytemuck::cast_slice(&padded));
    buffer
}

/// Words that a buffer of `len` has, padding included.
pub fn padded(len: usize) -> usize {
    len.max(1).next_multiple_of(4)
}

/// All words of a buffer, padding included: what was written past the end shows there.
pub fn read_padded<T: bytemuck::Pod>(gpu: &Gpu, buffer: &Buffer<T>) -> Vec<u32> {
    let words = buffer.bytes() as usize / 4;
    let copy = Buffer::<u32>::storage(&gpu.device, "test.padded", words).expect("memory for a copy");
    let mut encoder = gpu.encoder();
    Recorder::new(&gpu.device, &mut encoder, None).copy(buffer.raw(), copy.raw(), buffer.bytes());
    gpu.submit_and_wait(encoder).expect("the copy runs");
    copy.read(gpu).expect("readback")
}

/// A texture of one 32-bit word a texel, of every usage a stage may need, that holds `words` row by row.
pub fn texture(
    gpu: &Gpu,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    words: Option<&[u32]>,
) -> wgpu::Texture {
    use wgpu::TextureUsages as U;
    let stored = if format == wgpu::TextureFormat::R32Float { U::STORAGE_BINDING } else { U::empty() };
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test.texture"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: U::TEXTURE_BINDING | U::COPY_SRC | U::COPY_DST | stored,
        view_formats: &[],
    });
    if let Some(words) = words {
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
        gpu.queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(words), layout, size);
    }
    texture
}

/// A view of a texture that holds `bytes` row by row.
pub fn filled_texture(
    gpu: &Gpu,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    bytes: &[u8],
) -> wgpu::TextureView {
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test.texture"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let row = bytes.len() as u32 / height;
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    gpu.queue.write_texture(texture.as_image_copy(), bytes, layout, size);
    texture.create_view(&Default::default())
}

/// The words of such a texture, row by row.
pub fn read_texture(gpu: &Gpu, texture: &wgpu::Texture) -> Vec<u32> {
    let (width, height) = (texture.width() as usize, texture.height() as usize);
    let row = width.next_multiple_of(64);
    let words = Buffer::<u32>::storage(&gpu.device, "test.texels", row * height).expect("memory for a copy");
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * row as u32), rows_per_image: None };
    let mut encoder = gpu.encoder();
    let to = wgpu::TexelCopyBufferInfo { buffer: words.raw(), layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
    gpu.submit_and_wait(encoder).expect("the copy runs");
    let words = words.read(gpu).expect("readback");
    words.chunks(row).flat_map(|r| r[..width].to_vec()).collect()
}

/// Where two lists first differ, lengths before contents; `None` if they are equal.
pub fn difference<T: PartialEq + std::fmt::Debug>(got: &[T], want: &[T]) -> Option<String> {
    if got.len() != want.len() {
        return Some(format!("{} elements, {} expected", got.len(), want.len()));
    }
    let at = got.iter().zip(want).position(|(g, w)| g != w)?;
    let wrong = got.iter().zip(want).filter(|(g, w)| g != w).count();
    Some(format!("{wrong} of {} differ, first at {at}: {:?}, {:?} expected", got.len(), got[at], want[at]))
}

/// Fails unless the lists are equal.
#[track_caller]
pub fn assert_same<T: PartialEq + std::fmt::Debug>(what: &str, got: &[T], want: &[T]) {
    if let Some(difference) = difference(got, want) {
        panic!("{what}: {difference}");
    }
}

/// Seeded random values (SplitMix64), the same on every machine.
pub struct Random(u64);

impl Random {
    /// A sequence of its own for each seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// A word.
    pub fn word(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 32) as u32
    }

    /// A value below `end`.
    pub fn below(&mut self, end: u32) -> u32 {
        ((u64::from(self.word()) * u64::from(end)) >> 32) as u32
    }

    /// `len` values below `end`.
    pub fn list(&mut self, len: usize, end: u32) -> Vec<u32> {
        (0..len).map(|_| self.below(end)).collect()
    }

    /// `len` words.
    pub fn words(&mut self, len: usize) -> Vec<u32> {
        (0..len).map(|_| self.word()).collect()
    }
}

/// Sizes around the multiples of a workgroup or block at which a kernel could go wrong.
pub fn sizes_around(unit: usize) -> Vec<usize> {
    let mut sizes: Vec<_> = [1, 2, 3].iter().flat_map(|n| [n * unit - 1, n * unit, n * unit + 1]).collect();
    sizes.extend([2, 3, 4, 5, 7, 8, 9]);
    sizes.sort_unstable();
    sizes.dedup();
    sizes
}
