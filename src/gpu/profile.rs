//! Devices that kernels are built for. The pictures are the same, to the bit.

use super::source::kernel_file;
use std::borrow::Cow;
use std::cell::Cell;

/// Kind of device that kernels are built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Profile {
    /// A GPU.
    Gpu,
    /// A driver that runs kernels on the CPU (llvmpipe, SwiftShader): copies of what is uniform, which vector machines would read lane by
    /// lane, and loops of fewer turns than llvmpipe silently ends.
    Software,
}

thread_local! {
    static FORCED: Cell<Option<Profile>> = const { Cell::new(None) };
}

/// Files of kernels, as they stand in their texts, and what takes their place on a GPU.
const IN_PLACE: [[&str; 2]; 2] = [
    [kernel_file!("shared/frame/frame_copy"), kernel_file!("shared/frame/frame_in_place")],
    [kernel_file!("shared/frame/sample_copy"), kernel_file!("shared/frame/sample_in_place")],
];

impl Profile {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Gpu, Self::Software];

    /// That of a device: [`Profile::Software`] where its adapter says that it is a CPU, but in a browser.
    pub fn of(device: &wgpu::Device) -> Self {
        let of_adapter = || match device.adapter_info().device_type {
            // The copies take a browser's SwiftShader longer to compile than they save in the first frames.
            wgpu::DeviceType::Cpu if !cfg!(target_family = "wasm") => Self::Software,
            _ => Self::Gpu,
        };
        FORCED.get().unwrap_or_else(of_adapter)
    }

    /// Runs `work`, in which all that this thread makes is made for this profile, whatever the device: to test one profile on a device
    /// of the other.
    pub fn within<T>(self, work: impl FnOnce() -> T) -> T {
        struct Restore(Option<Profile>);
        impl Drop for Restore {
            fn drop(&mut self) {
                FORCED.set(self.0);
            }
        }
        let _restore = Restore(FORCED.replace(Some(self)));
        work()
    }

    /// The text of a kernel for it.
    pub fn text(self, source: &str) -> Cow<'_, str> {
        if self == Self::Software || !IN_PLACE.iter().any(|[copy, _]| source.contains(copy)) {
            return Cow::Borrowed(source);
        }
        let text = IN_PLACE.iter().fold(source.to_owned(), |text, [copy, in_place]| text.replace(copy, in_place));
        Cow::Owned(text.replace("frame_given", "frame").replace("samples_given", "samples"))
    }

    /// Most turns of a loop over triangles in one dispatch; what is left takes another.
    pub fn turns(self, software: u32) -> u32 {
        match self {
            Self::Gpu => software.max(1 << 16),
            Self::Software => software,
        }
    }
}
