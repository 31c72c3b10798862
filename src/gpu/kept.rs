//! Programs that are made once and used again.

use super::batch;
use super::profile::Profile;
use super::program::{Compiled, Entry};
use super::source::Source;
use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Key of a program: the device and what it is built for, the kernel's text, the entry point, and the values of its constants.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Key {
    device: wgpu::Device,
    profile: Profile,
    /// Where the text is: comparing it is dear, and the same text elsewhere is no harm.
    source: usize,
    entry: &'static str,
    constants: Vec<(String, u64)>,
}

#[derive(Debug, Default)]
struct Kept {
    programs: HashMap<Key, Compiled>,
    /// Modules by device, what they are built for, and text.
    modules: HashMap<(wgpu::Device, Profile, Source), wgpu::ShaderModule>,
}

/// Who hears how many programs of a batch are compiled, and of how many.
type Told = Arc<dyn Fn(usize, usize) + Send + Sync>;

/// A store of programs and of the modules that they are made from. Compiling is most of the cost of a small frame: with
/// [`KeptPrograms::within`] every program of a method that is made anew is the one that was compiled the first time. There are as many as
/// there are entry points and values of their constants, so the store is bounded by the settings it meets. Devices that meet one store must be
/// of one [`wgpu::Instance`]: nothing tells those of two apart. A clone is the same store.
#[derive(Clone, Default)]
pub struct KeptPrograms {
    kept: Arc<Mutex<Kept>>,
    cache: Option<wgpu::PipelineCache>,
    told: Option<Told>,
}

impl fmt::Debug for KeptPrograms {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "KeptPrograms({})", self.len())
    }
}

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

/// Programs that are not compiled yet.
#[derive(Debug)]
pub(crate) struct Uncompiled(Vec<Compiled>);

impl Uncompiled {
    /// Result of `work`, and its programs, of which it compiles none.
    pub fn of<T>(work: impl FnOnce() -> T) -> (T, Self) {
        let (out, list) = batch::collected(work);
        (out, Self(list))
    }

    /// Compiles up to so many, and says how many. What fails is left to whoever asks for its pipeline.
    pub fn compile(&mut self, most: usize) -> usize {
        let first = self.0.len().saturating_sub(most);
        let some = self.0.drain(first..);
        some.map(|program| program.try_compile()).count()
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl KeptPrograms {
    /// An empty store whose programs are compiled with a pipeline cache ([`wgpu::Features::PIPELINE_CACHE`]) of the application's, on the
    /// device that it is of: filled from a file, it saves a later start the driver's part of compiling.
    pub fn with_cache(cache: wgpu::PipelineCache) -> Self {
        Self { cache: Some(cache), ..Self::default() }
    }

    /// The same store, which tells `told` of the programs that are compiled together, as for a pass that is made: how many are done, and of
    /// how many. It is called from any thread, first with none.
    #[must_use]
    pub fn telling(self, told: impl Fn(usize, usize) + Send + Sync + 'static) -> Self {
        Self { told: Some(Arc::new(told)), ..self }
    }

    /// Runs `work`, in which every [`Compiled::new`](super::program::Compiled::new) of this thread takes what is kept, and keeps what it
    /// has to make.
    pub fn within<T>(&self, work: impl FnOnce() -> T) -> T {
        let before = IN_USE.with_borrow_mut(|slot| slot.replace(self.clone()));
        let _restore = Restore(before);
        work()
    }

    /// Runs `work`, in which no program is made twice and no kernel's text is read twice: with the store in use, or one for this
    /// work alone. The programs are compiled at its end, on all cores ([`rayon`]'s threads).
    pub fn once<T>(work: impl FnOnce() -> T) -> T {
        let store = Self::in_use();
        let told = store.told.clone();
        batch::together(told.as_deref(), || store.within(work))
    }

    /// The same store, which tells another besides.
    pub(crate) fn also_telling(self, also: impl Fn(usize, usize) + Send + Sync + 'static) -> Self {
        let first = self.told.clone();
        self.telling(move |done, of| {
            also(done, of);
            if let Some(first) = &first {
                first(done, of);
            }
        })
    }

    /// The same store, which tells nobody.
    #[cfg(feature = "baselines")]
    pub(crate) fn silent(self) -> Self {
        Self { told: None, ..self }
    }

    /// The store in use, or an empty one.
    pub(crate) fn in_use() -> Self {
        IN_USE.with_borrow(Clone::clone).unwrap_or_default()
    }

    /// The pipeline cache of the store in use.
    pub(super) fn cache() -> Option<wgpu::PipelineCache> {
        IN_USE.with_borrow(|store| store.as_ref().and_then(|store| store.cache.clone()))
    }

    /// How many programs there are.
    pub fn len(&self) -> usize {
        self.lock().programs.len()
    }

    /// Whether there is none yet.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn lock(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The program that is kept for this, or `make`'s, which is kept from now on where a store is in use; and whether it is `make`'s.
    pub(super) fn get_or_make(
        device: &wgpu::Device,
        entry: Entry,
        constants: &[(&str, f64)],
        make: impl FnOnce() -> Compiled,
    ) -> (Compiled, bool) {
        let Some(store) = IN_USE.with_borrow(Clone::clone) else { return (make(), true) };
        let constants = constants.iter().map(|(name, value)| ((*name).to_owned(), value.to_bits())).collect();
        let profile = Profile::of(device);
        let key = Key {
            device: device.clone(),
            profile,
            source: entry.source.0.as_ptr() as usize,
            entry: entry.name,
            constants,
        };
        let known = store.lock().programs.get(&key).cloned();
        if let Some(known) = known {
            return (known, false);
        }
        let made = make();
        store.lock().programs.insert(key, made.clone());
        (made, true)
    }

    /// Likewise the module of a kernel's text.
    pub(super) fn module_or_make(
        device: &wgpu::Device,
        source: Source,
        make: impl FnOnce() -> wgpu::ShaderModule,
    ) -> wgpu::ShaderModule {
        let Some(store) = IN_USE.with_borrow(Clone::clone) else { return make() };
        let mut kept = store.lock();
        kept.modules.entry((device.clone(), Profile::of(device), source)).or_insert_with(make).clone()
    }
}
