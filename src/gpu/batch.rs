//! Pipelines that are compiled together, on all cores.

use super::program::Compiled;
use rayon::prelude::*;
use std::cell::RefCell;
use std::sync::atomic::{AtomicUsize, Ordering};

thread_local! {
    static WAITING: RefCell<Option<Vec<Compiled>>> = const { RefCell::new(None) };
}

/// Puts the list of before back, also when unwinding.
struct Restore(Option<Vec<Compiled>>);

impl Drop for Restore {
    fn drop(&mut self) {
        WAITING.set(self.0.take());
    }
}

/// Leaves a program to be compiled to the batch that this thread is in, and says whether there is one.
pub(super) fn defer(program: &Compiled) -> bool {
    WAITING.with_borrow_mut(|waiting| waiting.as_mut().map(|list| list.push(program.clone())).is_some())
}

/// Runs `work` and leaves the programs that it made uncompiled.
pub(super) fn collected<T>(work: impl FnOnce() -> T) -> (T, Vec<Compiled>) {
    let _restore = Restore(WAITING.replace(Some(Vec::new())));
    let out = work();
    (out, WAITING.take().unwrap_or_default())
}

/// Runs `work` and then compiles the programs that it made. `told` hears, from any thread, how many are compiled, and of how many. Within
/// a batch that is begun already, just runs `work`. In a browser programs are compiled when they are first used: its compiler has threads of
/// its own.
pub(super) fn together<T>(told: Option<&(dyn Fn(usize, usize) + Send + Sync)>, work: impl FnOnce() -> T) -> T {
    if WAITING.with_borrow(Option::is_some) {
        return work();
    }
    WAITING.set(Some(Vec::new()));
    let restore = Restore(None);
    let out = work();
    let programs = WAITING.take().unwrap_or_default();
    drop(restore);
    if cfg!(target_family = "wasm") {
        return out;
    }
    if programs.is_empty() {
        return out;
    }
    let done = AtomicUsize::new(0);
    let tell = |done: usize| told.into_iter().for_each(|told| told(done, programs.len()));
    tell(0);
    programs.par_iter().for_each(|program| {
        program.try_compile();
        tell(done.fetch_add(1, Ordering::Relaxed) + 1);
    });
    for program in &programs {
        program.pipeline();
    }
    out
}
