//! Values of a kernel's bindings. [`kernels`](super::kernels) has, for each entry point, a struct with a field a binding; a wrong,
//! a missing or a swapped buffer does not compile:
//!
//! ```
//! use subpixel_shadows::gpu::kernels::dispatch_args::Fold;
//! use subpixel_shadows::gpu::Buffer;
//! use subpixel_shadows::stages::dispatch_args::ArgsRequest;
//!
//! fn bind<'a>(counts: &'a Buffer<u32>, requests: &'a Buffer<ArgsRequest>, args: &'a Buffer<u32>) -> Fold<'a> {
//!     Fold { counts: counts.as_read(), requests: requests.as_read(), args: args.as_write() }
//! }
//! ```
//!
//! ```compile_fail,E0308
//! # use subpixel_shadows::gpu::kernels::dispatch_args::Fold;
//! # use subpixel_shadows::gpu::Buffer;
//! # use subpixel_shadows::stages::dispatch_args::ArgsRequest;
//! # fn bind<'a>(counts: &'a Buffer<u32>, requests: &'a Buffer<ArgsRequest>, args: &'a Buffer<u32>) -> Fold<'a> {
//! Fold { counts: requests.as_read(), requests: counts.as_read(), args: args.as_write() }
//! # }
//! ```
//!
//! ```compile_fail,E0063
//! # use subpixel_shadows::gpu::kernels::dispatch_args::Fold;
//! # use subpixel_shadows::gpu::Buffer;
//! # use subpixel_shadows::stages::dispatch_args::ArgsRequest;
//! # fn bind<'a>(counts: &'a Buffer<u32>, requests: &'a Buffer<ArgsRequest>, args: &'a Buffer<u32>) -> Fold<'a> {
//! Fold { counts: counts.as_read(), requests: requests.as_read() }
//! # }
//! ```
//!
//! ```compile_fail,E0308
//! # use subpixel_shadows::gpu::kernels::dispatch_args::Fold;
//! # use subpixel_shadows::gpu::Buffer;
//! # use subpixel_shadows::stages::dispatch_args::ArgsRequest;
//! # fn bind<'a>(counts: &'a Buffer<u32>, requests: &'a Buffer<ArgsRequest>, args: &'a Buffer<u32>) -> Fold<'a> {
//! Fold { counts: counts.as_read(), requests: requests.as_read(), args: args.as_read() }
//! # }
//! ```

use super::Buffer;
use super::program::{Access, Binding, Entry};
use bytemuck::Pod;
use std::fmt::Debug;
use std::marker::PhantomData;
use wgpu::{BindGroupEntry, BindingResource};

/// An entry point of a kernel, known by the type of its bindings.
pub trait EntryPoint: Debug + 'static {
    /// Its description.
    const ENTRY: Entry;
    /// Its kernel's `override` values.
    type Constants: Overrides;
    /// Its bindings.
    type Bindings<'a>: Bindings<'a>;
}

/// A value for each binding of an entry point.
pub trait Bindings<'a>: Copy {
    /// Their descriptions.
    const ROWS: &'static [Binding];
    /// As wgpu takes them.
    fn entries(self) -> Vec<BindGroupEntry<'a>>;
}

/// Values for the `override`s of a kernel.
pub trait Overrides {
    /// Names and values.
    fn list(&self) -> Vec<(&'static str, f64)>;
}

/// A kernel without `override`s.
impl Overrides for () {
    fn list(&self) -> Vec<(&'static str, f64)> {
        Vec::new()
    }
}

/// A value of one binding.
pub trait Bound<'a>: Copy {
    /// How the kernel uses it.
    const ACCESS: Access;
    /// As wgpu takes it.
    fn resource(self) -> BindingResource<'a>;
}

/// Declares the bindings of an entry point, a struct with a field for each, and its pipeline.
#[macro_export]
macro_rules! entry_point {
    (
        $kernel:literal, $entry:literal, $workgroup:expr, $source:expr, $constants:ty => $bindings:ident, $program:ident {
            $($index:literal $name:ident: $type:ty,)*
        }
    ) => {
        #[doc = concat!("Bindings of `", $entry, "`.")]
        #[derive(Clone, Copy, Debug)]
        pub struct $bindings<'a> {
            $(#[doc = concat!("`@binding(", $index, ")`.")] pub $name: $type,)*
        }

        #[doc = concat!("Pipeline of `", $entry, "`.")]
        pub type $program = $crate::gpu::Program<$bindings<'static>>;

        impl $crate::gpu::bindings::EntryPoint for $bindings<'static> {
            const ENTRY: $crate::gpu::Entry = $crate::gpu::Entry {
                kernel: $kernel,
                name: $entry,
                source: $source,
                workgroup: $workgroup,
                bindings: <$bindings<'static> as $crate::gpu::bindings::Bindings<'static>>::ROWS,
            };
            type Constants = $constants;
            type Bindings<'a> = $bindings<'a>;
        }

        impl<'a> $crate::gpu::bindings::Bindings<'a> for $bindings<'a> {
            const ROWS: &'static [$crate::gpu::program::Binding] = &[$($crate::gpu::program::Binding {
                index: $index,
                name: stringify!($name),
                access: <$type as $crate::gpu::bindings::Bound<'a>>::ACCESS,
            }),*];

            fn entries(self) -> Vec<$crate::wgpu::BindGroupEntry<'a>> {
                vec![$($crate::wgpu::BindGroupEntry {
                    binding: $index,
                    resource: $crate::gpu::bindings::Bound::resource(self.$name),
                }),*]
            }
        }
    };
}

/// Declares the text of a kernel: its files from `kernels/`, imports first.
macro_rules! source {
    ($($file:literal,)*) => {
        /// The kernel's text, imports first.
        pub const SOURCE: crate::gpu::Source = crate::gpu::Source(&[$(crate::gpu::source::kernel_file!($file)),*]);
    };
}
pub(super) use source;

/// Declares the constants of a kernel.
macro_rules! constants {
    ($($name:ident = $value:literal,)*) => {
        $(#[doc = concat!("`", stringify!($name), "` of the kernel.")] pub const $name: u32 = $value;)*
    };
}
pub(super) use constants;

/// Makes the bindings of one entry point from those of another of the same kernel that has them all.
macro_rules! subset {
    ($all:ident => $some:ident { $($name:ident),* }) => {
        impl<'a> From<$all<'a>> for $some<'a> {
            fn from(all: $all<'a>) -> Self {
                Self { $($name: all.$name),* }
            }
        }
    };
}
pub(super) use subset;

/// Declares the bindings of several entry points of a kernel, each of which takes those it uses.
macro_rules! group {
    ($group:ident { $($name:ident: $type:ty,)* }) => {
        /// Bindings of several entry points.
        #[derive(Clone, Copy, Debug)]
        pub struct $group<'a> {
            $(#[doc = concat!("`", stringify!($name), "`.")] pub $name: $type,)*
        }
    };
}
pub(super) use group;

/// Lists the entry points of a kernel.
macro_rules! entries {
    ($($name:ident,)*) => {
        /// The kernel's entry points.
        pub const ENTRIES: &[crate::gpu::Entry] = &[$(<$name<'static> as EntryPoint>::ENTRY),*];
    };
}
pub(super) use entries;

/// Declares the `override` values of a kernel.
macro_rules! overrides {
    ($($name:ident: $type:ty = $default:expr, $wgsl:literal,)*) => {
        /// The kernel's `override` values; by default as the kernel has them.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Constants {
            $(#[doc = concat!("`", $wgsl, "`.")] pub $name: $type,)*
        }

        impl Default for Constants {
            fn default() -> Self {
                Self { $($name: $default),* }
            }
        }

        impl Overrides for Constants {
            fn list(&self) -> Vec<(&'static str, f64)> {
                vec![$(($wgsl, Override::value(self.$name))),*]
            }
        }
    };
}
pub(super) use overrides;

/// A value of an `override`.
pub trait Override {
    /// As wgpu takes it.
    fn value(self) -> f64;
}

impl Override for bool {
    fn value(self) -> f64 {
        f64::from(u8::from(self))
    }
}

impl Override for u32 {
    fn value(self) -> f64 {
        f64::from(self)
    }
}

impl Override for i32 {
    fn value(self) -> f64 {
        f64::from(self)
    }
}

impl Override for f32 {
    fn value(self) -> f64 {
        f64::from(self)
    }
}

/// A range of a buffer.
#[derive(Clone, Copy, Debug)]
struct Range<'a> {
    buffer: &'a wgpu::Buffer,
    offset: u64,
    size: Option<std::num::NonZeroU64>,
}

impl<'a> Range<'a> {
    fn whole(buffer: &'a wgpu::Buffer) -> Self {
        Self { buffer, offset: 0, size: None }
    }

    fn resource(self) -> BindingResource<'a> {
        BindingResource::Buffer(wgpu::BufferBinding { buffer: self.buffer, offset: self.offset, size: self.size })
    }
}

/// Declares a buffer binding.
macro_rules! bound {
    ($(#[$doc:meta])* $name:ident $access:ident) => {
        $(#[$doc])*
        #[derive(Debug)]
        pub struct $name<'a, T> {
            range: Range<'a>,
            element: PhantomData<T>,
        }

        impl<T> Clone for $name<'_, T> {
            fn clone(&self) -> Self {
                *self
            }
        }

        impl<T> Copy for $name<'_, T> {}

        impl<'a, T: Pod> $name<'a, T> {
            /// The whole of a buffer whose type does not say what it holds.
            pub fn of(buffer: &'a wgpu::Buffer) -> Self {
                Self { range: Range::whole(buffer), element: PhantomData }
            }

            /// A buffer from a byte on, a multiple of the device's alignment of offsets.
            pub fn from(buffer: &'a wgpu::Buffer, offset: u64) -> Self {
                Self { range: Range { buffer, offset, size: None }, element: PhantomData }
            }

            /// The same bytes as elements of another type.
            pub fn cast<U: Pod>(self) -> $name<'a, U> {
                $name { range: self.range, element: PhantomData }
            }
        }

        impl<'a, T: Pod> Bound<'a> for $name<'a, T> {
            const ACCESS: Access = Access::$access;

            fn resource(self) -> BindingResource<'a> {
                self.range.resource()
            }
        }
    };
}

/// Declares a texture binding.
macro_rules! texture {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name<'a>(pub &'a wgpu::TextureView);

        impl<'a> Bound<'a> for $name<'a> {
            const ACCESS: Access = Access::$name;

            fn resource(self) -> BindingResource<'a> {
                BindingResource::TextureView(self.0)
            }
        }
    };
}

bound! {
    /// A uniform buffer of one or several `T`.
    Uniform Uniform
}
bound! {
    /// A storage buffer of `T` that is read.
    Read Read
}
bound! {
    /// A storage buffer of `T` that is written, and may be read.
    Write ReadWrite
}
texture! {
    /// A texture of unsigned integers, one sample a texel.
    TextureUint
}
texture! {
    /// Layers of textures of unsigned integers.
    TextureUintLayers
}
texture! {
    /// A multisampled texture of unsigned integers.
    TextureUintSamples
}
texture! {
    /// A texture of `f32`, or a depth texture.
    TextureFloat
}
texture! {
    /// A multisampled texture of `f32`, or of depths.
    TextureFloatSamples
}
texture! {
    /// A storage texture of format `r32float`.
    TextureStoreR32Float
}

impl<T: Pod> Buffer<T> {
    /// As a uniform binding.
    pub fn as_uniform(&self) -> Uniform<'_, T> {
        Uniform::of(self.raw())
    }

    /// As a binding that is read.
    pub fn as_read(&self) -> Read<'_, T> {
        Read::of(self.raw())
    }

    /// As a binding that is written.
    pub fn as_write(&self) -> Write<'_, T> {
        Write::of(self.raw())
    }

    /// `len` elements from `first` on, rounded up to 16 bytes, as a binding that is read. `first` is a multiple of the device's alignment
    /// of storage offsets.
    pub fn read_range(&self, first: usize, len: usize) -> Read<'_, T> {
        Read { range: self.range(first, len), element: PhantomData }
    }

    /// As [`Buffer::read_range`], as a binding that is written.
    pub fn write_range(&self, first: usize, len: usize) -> Write<'_, T> {
        Write { range: self.range(first, len), element: PhantomData }
    }

    fn range(&self, first: usize, len: usize) -> Range<'_> {
        let bytes = ((len.max(1) * size_of::<T>()) as u64).next_multiple_of(16);
        Range { buffer: self.raw(), offset: (first * size_of::<T>()) as u64, size: std::num::NonZeroU64::new(bytes) }
    }
}
