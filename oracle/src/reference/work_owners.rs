//! Definition of the owners of work items.

/// The owner of each work item, of owners with `counts` items.
pub fn owners(counts: &[u32]) -> Vec<u32> {
    let of = |(&count, owner): (&u32, u32)| (0..count).map(move |_| owner);
    counts.iter().zip(0..).flat_map(of).collect()
}

/// The table of at most `room` places that finds them: the owner of every `stride`th item, and that of the last.
pub fn table(counts: &[u32], stride: usize, room: usize) -> Vec<u32> {
    let owners = owners(counts);
    owners.iter().step_by(stride).chain(owners.last()).copied().take(room).collect()
}
