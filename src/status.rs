//! Counters of a frame, as kernels and the host have them: what the frame counted, what its lists needed, and that its last stage has run.

use crate::shared_struct;

/// State of a facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum FacetState {
    /// No surface: counts as lit.
    Empty = 0,
    /// Its seen side faces away from the light.
    Dark = 1,
    /// Nothing lies between it and the light.
    Lit = 2,
    /// One sheet covers all of it.
    Shadowed = 3,
    /// To be evaluated.
    Undecided = 4,
}

impl FacetState {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Empty, Self::Dark, Self::Lit, Self::Shadowed, Self::Undecided];
}

shared_struct! {
    /// Items that a list needed, and whether they are beyond 2^32.
    "shared/frame/status" => pub struct Need {
        /// Items.
        pub items: u32,
        /// 1 if they are beyond 2^32.
        pub over: u32,
    }
}

impl Need {
    /// The items; beyond 2^32 the most that a word holds, which no list can hold.
    pub fn items(self) -> u64 {
        u64::from(if self.over == 0 { self.items } else { u32::MAX })
    }
}

shared_struct! {
    /// Counters of the whole frame.
    "shared/frame/status" => pub struct StatusHead {
        /// Silhouette edges.
        pub silhouette_edges: u32,
        /// The frame's stamp, once its last stage has run; 0 before.
        pub finished: u32,
        /// Triangles tested against facets, low and high word.
        pub candidate_tests: [u32; 2],
        /// Facets of each [`FacetState`].
        pub facets: [u32; 8],
        /// Longest list of triangles of a pixel.
        pub longest_pixel: u32,
        /// Number of the light maps that the frame used: that of [`Frame::maps`](crate::frame::Frame::maps), where these were in memory.
        pub maps: u32,
        /// Triangles in the lists of all pixels.
        pub pixel_triangles: Need,
        /// Pixels whose samples are searched one by one.
        pub complex_pixels: Need,
        /// Facets.
        pub facets_needed: Need,
        /// Complement of the bits of the least view depth that pixels see, world units; 0 where none was found.
        pub nearest_key: u32,
        /// Bits of the greatest; 0 where none was found.
        pub farthest_depth: u32,
        /// Triangles of the [clusters](crate::stages::cluster_culling) that were kept, in all views; 0 where none are left out.
        pub kept_triangles: u32,
    }
}

shared_struct! {
    /// Counters of one band of facets in one view of the light.
    "shared/frame/status" => pub struct StatusBand {
        /// Pixel-texel pairs.
        pub pixel_pairs: Need,
        /// Triangle-texel pairs.
        pub triangle_pairs: Need,
        /// Pairs of facet and caster that were worth evaluating.
        pub candidates: u32,
        /// Candidates that single precision did not decide.
        pub doubts: u32,
        /// Longest list of triangles of a place of the map.
        pub longest: u32,
        /// Marked texels of the view; in its first band.
        pub marked_texels: u32,
    }
}

/// A frame's counters, read back.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Status {
    /// Counters of the whole frame.
    pub head: StatusHead,
    /// Counters of each band of each view, view after view.
    pub bands: Vec<StatusBand>,
}

impl Status {
    /// Words of a status with so many bands in all views.
    pub const fn words(bands: usize) -> usize {
        Self::band(bands)
    }

    /// The first word of a band.
    pub const fn band(band: usize) -> usize {
        (size_of::<StatusHead>() + band * size_of::<StatusBand>()) / 4
    }

    /// Status from the words of a buffer; words that are missing are 0.
    pub fn of(words: &[u32]) -> Self {
        let (head, bands) = words.split_at(words.len().min(Self::band(0)));
        let mut first = [0; Self::band(0)];
        first[..head.len()].copy_from_slice(head);
        let band = |words: &[u32]| bytemuck::pod_read_unaligned(bytemuck::cast_slice(words));
        Self {
            head: bytemuck::cast(first),
            bands: bands.chunks_exact(Self::band(1) - Self::band(0)).map(band).collect(),
        }
    }

    /// The least and the greatest view depth that pixel centres see, world units, where stage
    /// [`seen_depths`](crate::stages::seen_depths) ran and found any.
    pub fn depths(&self) -> Option<[f32; 2]> {
        let StatusHead { nearest_key, farthest_depth, .. } = self.head;
        (nearest_key != 0).then(|| [!nearest_key, farthest_depth].map(f32::from_bits))
    }

    /// Its words.
    pub fn to_words(&self) -> Vec<u32> {
        let mut words = bytemuck::cast_slice(&[self.head]).to_vec();
        words.extend_from_slice(bytemuck::cast_slice(&self.bands));
        words
    }
}

/// The word of a status at which a field of its head begins.
#[macro_export]
macro_rules! status_word {
    ($field:ident) => {
        std::mem::offset_of!($crate::status::StatusHead, $field) / 4
    };
}
