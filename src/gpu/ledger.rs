//! Account of the buffers that are made and still held.

use std::cell::RefCell;
use std::ops::Deref;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// A buffer that is held.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct BufferMemory {
    /// Its label.
    pub label: String,
    /// Bytes.
    pub bytes: u64,
}

/// A wgpu buffer that is in the ledger while a clone of this is held.
#[derive(Clone, Debug)]
pub struct Held {
    raw: wgpu::Buffer,
    _entry: Option<Arc<BufferMemory>>,
}

impl Deref for Held {
    type Target = wgpu::Buffer;

    fn deref(&self) -> &wgpu::Buffer {
        &self.raw
    }
}

/// Account of the buffers that were made within it and are still held. A clone is the same account.
#[derive(Clone, Debug, Default)]
pub struct Ledger(Arc<Mutex<Vec<Weak<BufferMemory>>>>);

thread_local! {
    static OPEN: RefCell<Option<Ledger>> = const { RefCell::new(None) };
}

/// Opens the ledger of before again, also when unwinding.
struct Reopen(Option<Ledger>);

impl Drop for Reopen {
    fn drop(&mut self) {
        OPEN.set(self.0.take());
    }
}

impl Ledger {
    /// Runs `work`, every buffer of which goes into this account.
    pub fn within<T>(&self, work: impl FnOnce() -> T) -> T {
        let _reopen = Reopen(OPEN.replace(Some(self.clone())));
        work()
    }

    /// The buffers that are still held, the largest first.
    pub fn held(&self) -> Vec<BufferMemory> {
        let entries = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut held: Vec<BufferMemory> =
            entries.iter().filter_map(Weak::upgrade).map(|entry| (*entry).clone()).collect();
        held.sort_by(|a, b| b.bytes.cmp(&a.bytes).then_with(|| a.label.cmp(&b.label)));
        held
    }

    /// Puts a new buffer into the open account, if any is.
    pub(super) fn enter(raw: wgpu::Buffer, label: &str) -> Held {
        let entry = OPEN.with_borrow(|open| {
            let Self(entries) = open.as_ref()?;
            let entry = Arc::new(BufferMemory { label: label.to_owned(), bytes: raw.size() });
            let mut entries = entries.lock().unwrap_or_else(PoisonError::into_inner);
            if entries.len() == entries.capacity() {
                entries.retain(|entry| entry.strong_count() > 0);
            }
            entries.push(Arc::downgrade(&entry));
            Some(entry)
        });
        Held { raw, _entry: entry }
    }
}
