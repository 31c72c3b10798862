//! Lists of pairs as they are read back.

use super::POISON;
use super::shadow::with_total;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::pixel_texel_pairs::{PairLists, PairTiles};
use subpixel_shadows::stages::{SortedPairs, sorted_pairs};

/// Result of a pair stage.
pub struct Listed {
    /// Pairs of each place.
    pub counts: Vec<u32>,
    /// As the kernel leaves it.
    pub deepest: Vec<u32>,
    /// The list with what was in it before: (facet, texel or part of a tile) or (triangle, place).
    pub list: Vec<(u32, u32)>,
    /// Of triangles and tiles: the words before the triangles.
    pub parts: Vec<u32>,
}

impl Listed {
    /// The pairs of each place, rising.
    pub fn sets(&self) -> Vec<Vec<u32>> {
        let offsets = with_total(&self.counts);
        let set = |place: usize| {
            let mut set: Vec<u32> =
                self.list[offsets[place] as usize..offsets[place + 1] as usize].iter().map(|p| p.0).collect();
            set.sort_unstable();
            set
        };
        (0..self.counts.len()).map(set).collect()
    }

    /// Facets of each texel, rising, whatever places they met at.
    pub fn texel_sets(&self, places: PairTiles, map: usize) -> Vec<Vec<u32>> {
        if places == PairTiles::Texels {
            return self.sets();
        }
        let (offsets, across) = (with_total(&self.counts), map.div_ceil(2));
        let mut sets = vec![Vec::new(); map * map];
        for (tile, ends) in offsets[..=self.counts.len()].windows(2).enumerate() {
            for &(facet, name) in &self.list[ends[0] as usize..ends[1] as usize] {
                assert!(name >> 4 == tile as u32 && name & 15 != 0, "facet {facet}, tile {tile}: named {name:x}");
                for bit in (0..4).filter(|bit| name & (1 << bit) != 0) {
                    let (x, y) = (tile % across * 2 + bit % 2, tile / across * 2 + bit / 2);
                    assert!(x < map && y < map, "facet {facet}, tile {tile}: beyond the map");
                    sets[y * map + x].push(facet);
                }
            }
        }
        sets.iter_mut().for_each(|set| set.sort_unstable());
        sets
    }
}

/// The place of a texel.
pub fn place_of(places: PairTiles, map: usize, texel: usize) -> usize {
    match places {
        PairTiles::Texels => texel,
        PairTiles::Tiles => texel / map / 2 * map.div_ceil(2) + texel % map / 2,
    }
}

/// The greatest depth of each place.
pub fn deepest_of<T: Copy + PartialOrd>(places: PairTiles, map: usize, texels: &[Option<T>]) -> Vec<Option<T>> {
    let mut deepest = vec![None; places.count(map)];
    for (texel, &depth) in texels.iter().enumerate() {
        let place = &mut deepest[place_of(places, map, texel)];
        if depth > *place {
            *place = depth;
        }
    }
    deepest
}

/// Triangles and the words before them, 0 where there are none.
pub fn triangle_list(gpu: &Gpu, lists: &PairLists) -> Vec<(u32, u32)> {
    let words = lists.triangle_pairs.read(gpu).expect("readback");
    match lists.places {
        PairTiles::Texels => words.into_iter().map(|t| (t, 0)).collect(),
        PairTiles::Tiles => words.chunks_exact(2).map(|w| (w[1], w[0])).collect(),
    }
}

/// Poisoned memory for `capacity` pairs as they come, and a few more.
pub fn unsorted(gpu: &Gpu, capacity: usize) -> sorted_pairs::SortedPairsScratch {
    let unsorted = SortedPairs::scratch(&gpu.device, capacity + 4, false).expect("memory");
    unsorted.keys.write(&gpu.queue, &vec![POISON; capacity + 4]);
    unsorted.values.write(&gpu.queue, &vec![POISON; capacity + 4]);
    unsorted
}

/// Asserts that the pairs (texel, item) in `unsorted` are those of `grouped`, if all have room, and as many as `counts` say.
#[track_caller]
pub fn check_appended(
    gpu: &Gpu,
    unsorted: &sorted_pairs::SortedPairsScratch,
    capacity: usize,
    counts: &[u32],
    grouped: impl Iterator<Item = (u32, u32)>,
) {
    let needed: usize = counts.iter().map(|&c| c as usize).sum();
    let read = |buffer: &Buffer<u32>| buffer.read(gpu).expect("readback");
    assert_eq!(read(&unsorted.appended), [needed as u32, 0], "appended: as many pairs");
    let mut got: Vec<(u32, u32)> = read(&unsorted.keys).into_iter().zip(read(&unsorted.values)).collect();
    let room = needed.min(capacity);
    assert!(got[room..].iter().all(|&p| p == (POISON, POISON)), "appended: written beyond {room} pairs");
    got.truncate(room);
    if needed <= capacity {
        let mut grouped: Vec<(u32, u32)> = grouped.take(needed).collect();
        grouped.sort_unstable();
        got.sort_unstable();
        assert_eq!(got, grouped, "appended: the same pairs");
    }
}
