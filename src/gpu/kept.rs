//! Programs that are made once and used again.

use super::profile::Profile;
use super::program::{Compiled, Entry};
use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Key of a program: the device and what it is built for, the entry point, and the values of its constants.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Key {
    device: wgpu::Device,
    profile: Profile,
    kernel: &'static str,
    entry: &'static str,
    constants: Vec<(String, u64)>,
}

#[derive(Debug, Default)]
struct Kept {
    programs: HashMap<Key, Compiled>,
    /// Modules by device, what they are built for, and text.
    modules: HashMap<(wgpu::Device, Profile, &'static str), wgpu::ShaderModule>,
}

/// A store of programs and of the modules that they are made from. Compiling is most of the cost of a small frame: with
/// [`KeptPrograms::within`] every program of a method that is made anew is the one that was compiled the first time. There are as many as
/// there are entry points and values of their constants, so the store is bounded by the settings it meets. A clone is the same store.
#[derive(Clone, Debug, Default)]
pub struct KeptPrograms(Arc<Mutex<Kept>>);

thread_local! {
    static IN_USE: RefCell<Option<KeptPrograms>> = const { RefCell::new(None) };
}

/// Puts the store of before back, also when unwinding.
struct Restore(Option<KeptPrograms>);

impl Drop for Restore {
    fn drop(&mut self) {
        IN_USE.with_borrow_mut(|slot| *slot = self.0.take());
    }
}

impl KeptPrograms {
    /// Runs `work`, in which every [`Compiled::new`](super::program::Compiled::new) of this thread takes what is kept, and keeps what it
    /// has to make.
    pub fn within<T>(&self, work: impl FnOnce() -> T) -> T {
        let before = IN_USE.with_borrow_mut(|slot| slot.replace(self.clone()));
        let _restore = Restore(before);
        work()
    }

    /// Runs `work`, in which no program is made twice and no kernel's text is read twice: with the store in use, or one for this
    /// work alone.
    pub fn once<T>(work: impl FnOnce() -> T) -> T {
        match IN_USE.with_borrow(Clone::clone) {
            Some(_) => work(),
            None => Self::default().within(work),
        }
    }

    /// How many programs there are.
    pub fn len(&self) -> usize {
        self.0.lock().map_or(0, |kept| kept.programs.len())
    }

    /// Whether there is none yet.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The program that is kept for this, or `make`'s, which is kept from now on where a store is in use.
    pub(super) fn get_or_make(
        device: &wgpu::Device,
        entry: Entry,
        constants: &[(&str, f64)],
        make: impl FnOnce() -> Compiled,
    ) -> Compiled {
        let Some(Self(store)) = IN_USE.with_borrow(Clone::clone) else { return make() };
        let constants = constants.iter().map(|(name, value)| ((*name).to_owned(), value.to_bits())).collect();
        let profile = Profile::of(device);
        let key = Key { device: device.clone(), profile, kernel: entry.kernel, entry: entry.name, constants };
        let known =
            |store: &Mutex<Kept>| store.lock().unwrap_or_else(PoisonError::into_inner).programs.get(&key).cloned();
        if let Some(known) = known(&store) {
            return known;
        }
        let made = make();
        store.lock().unwrap_or_else(PoisonError::into_inner).programs.insert(key, made.clone());
        made
    }

    /// Likewise the module of a kernel's text.
    pub(super) fn module_or_make(
        device: &wgpu::Device,
        source: &'static str,
        make: impl FnOnce() -> wgpu::ShaderModule,
    ) -> wgpu::ShaderModule {
        let Some(Self(store)) = IN_USE.with_borrow(Clone::clone) else { return make() };
        let mut kept = store.lock().unwrap_or_else(PoisonError::into_inner);
        kept.modules.entry((device.clone(), Profile::of(device), source)).or_insert_with(make).clone()
    }
}
