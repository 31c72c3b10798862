//! Structs that the host shares with kernels. `tests/contract.rs` compares each with naga's own offsets.

/// A field of a shared struct, as Rust lays it out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// Bytes from the start of the struct.
    pub offset: usize,
    /// Bytes it takes.
    pub size: usize,
}

/// A struct that a kernel reads or writes. Made by [`shared_struct!`](crate::shared_struct).
pub trait Shared: bytemuck::Pod {
    /// Stem of the kernel that declares it.
    const KERNEL: &'static str;
    /// Its name there.
    const NAME: &'static str;
    /// Its fields, in order.
    const FIELDS: &'static [Field];
}

/// Declares a `repr(C)` struct that has a twin of the given name in `kernels/<kernel>.wgsl`.
#[macro_export]
macro_rules! shared_struct {
    ($(#[$doc:meta])* $kernel:literal => pub struct $name:ident { $($(#[$field_doc:meta])* pub $field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        pub struct $name { $($(#[$field_doc])* pub $field: $type,)* }

        impl $crate::gpu::layout::Shared for $name {
            const KERNEL: &'static str = $kernel;
            const NAME: &'static str = stringify!($name);
            const FIELDS: &'static [$crate::gpu::layout::Field] = &[$($crate::gpu::layout::Field {
                name: stringify!($field),
                offset: std::mem::offset_of!($name, $field),
                size: size_of::<$type>(),
            },)*];
        }
    };
}
