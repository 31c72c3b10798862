//! Programs that are made once and used again, for work that makes many short-lived methods.

use super::program::{Compiled, Entry};
use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

/// Key of a program: the device, the entry point, and the values of its constants.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Key {
    device: wgpu::Device,
    kernel: &'static str,
    entry: &'static str,
    constants: Vec<(String, u64)>,
}

/// A store of programs. Compiling is most of the cost of a small frame: with [`KeptPrograms::within`] every program of a method that is
/// made anew is the one that was compiled the first time. There are as many as there are entry points and values of their constants, so
/// the store is bounded by the settings it meets. A clone is the same store.
#[derive(Clone, Debug, Default)]
pub struct KeptPrograms(Arc<Mutex<HashMap<Key, Compiled>>>);

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
    /// Runs `work`, in which every [`Compiled::new`](super::program::Compiled::new) of this thread takes what is kept, and keeps what it has to make.
    pub fn within<T>(&self, work: impl FnOnce() -> T) -> T {
        let before = IN_USE.with_borrow_mut(|slot| slot.replace(self.clone()));
        let _restore = Restore(before);
        work()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.lock().map_or(0, |kept| kept.len())
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
        let Some(store) = IN_USE.with_borrow(Clone::clone) else { return make() };
        let constants = constants.iter().map(|(name, value)| ((*name).to_owned(), value.to_bits())).collect();
        let key = Key { device: device.clone(), kernel: entry.kernel, entry: entry.name, constants };
        if let Some(known) = store.0.lock().ok().and_then(|kept| kept.get(&key).cloned()) {
            return known;
        }
        let made = make();
        if let Ok(mut kept) = store.0.lock() {
            kept.insert(key, made.clone());
        }
        made
    }
}
