//! Memory that is refused on purpose: what becomes of that is tested with it (`tests/memory.rs`). Counted and refused by thread, so that
//! tests do not disturb each other; in a program that asks for nothing of it, a request costs a count.

use crate::{Error, Result};
use std::cell::Cell;

/// The side that refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The device has no memory: [`Error::Gpu`].
    Device,
    /// The request is above a limit: [`Error::Memory`].
    Limit,
}

thread_local! {
    static ASKED: Cell<u64> = const { Cell::new(0) };
    static REFUSED: Cell<Option<(u64, Refusal)>> = const { Cell::new(None) };
}

/// How many times this thread has asked a device for memory.
pub fn asked_here() -> u64 {
    ASKED.get()
}

/// Refuses one of this thread's requests: that after `further` others. `None` refuses none.
pub fn refuse(further: u64, refusal: Option<Refusal>) {
    REFUSED.set(refusal.map(|refusal| (ASKED.get() + further, refusal)));
}

/// Whether the request that is to be refused has not come yet.
pub fn is_pending() -> bool {
    REFUSED.get().is_some()
}

/// Counts a request of so many bytes.
///
/// # Errors
/// If it is the one to refuse.
pub(super) fn ask(what: &str, bytes: u64) -> Result<()> {
    let now = ASKED.get();
    ASKED.set(now + 1);
    match REFUSED.get() {
        Some((at, refusal)) if at == now => {
            REFUSED.set(None);
            Err(match refusal {
                Refusal::Device => out_of_memory(what, bytes),
                Refusal::Limit => Error::Memory { what: what.to_owned(), needed: bytes, limit: 0 },
            })
        }
        _ => Ok(()),
    }
}

/// Message where the device has no memory.
pub(super) fn out_of_memory(what: &str, bytes: u64) -> Error {
    Error::Gpu(format!("out of memory allocating '{what}' ({bytes} bytes)"))
}
