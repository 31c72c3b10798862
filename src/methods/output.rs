//! A frame that was read back, what was counted in it, and how its lists fared.

use super::settings::Settings;
use super::strips::Rows;
use crate::gpu::StageTime;

/// Counts of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Counts {
    /// Triangles of the clusters that camera and light may hold something of, those of all views added up; 0 where
    /// [none are left out](crate::methods::Settings::least_culled).
    pub kept_triangles: u64,
    /// Edges that are silhouettes from the light; where clusters of edges are left out, those with texels, once for each view.
    pub silhouette_edges: u64,
    /// Texels marked in the silhouette mask map: silhouettes, and texels whose front layer could not be proved.
    pub silhouette_texels: u64,
    /// Pixels whose facet needed evaluation.
    pub silhouette_pixels: u64,
    /// Pairs of facets and texels.
    pub pixel_texel_pairs: u64,
    /// Pairs of triangles and texels.
    pub triangle_texel_pairs: u64,
    /// Triangles tested against facets in the light view.
    pub candidate_tests: u64,
    /// Triangles evaluated against facets: those that the test kept.
    pub visibility_evaluations: u64,
    /// Evaluations that single precision could not decide and 46 bits did.
    pub refined_evaluations: u64,
    /// Facets of all pixels.
    pub facets: u64,
    /// Pixels whose samples were searched one by one; 0 with one facet a pixel.
    pub complex_pixels: u64,
    /// Facets without a surface.
    pub empty_facets: u64,
    /// Facets turned away from the light.
    pub dark_facets: u64,
    /// Facets settled as lit.
    pub lit_facets: u64,
    /// Facets settled as shadowed.
    pub shadowed_facets: u64,
    /// Pages that were made (`resolution-matched`), in the light's last view.
    pub pages: u64,
    /// Pages that pixels asked for there.
    pub pages_asked: u64,
    /// Thirds of a level by which all had to be coarser than asked for there.
    pub thirds_coarser: u64,
    /// Greatest difference of a texel's nodes from the steps of its sub-texels: parts of 32768 of the light (`deep`).
    pub deep_error: u64,
    /// Texels whose nodes did not suffice for the error asked for (`deep`), of all views of the light.
    pub deep_raised: u64,
}

/// How one list fared.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ListUse {
    /// The list.
    pub name: &'static str,
    /// Elements it needed, the largest band.
    pub needed: u64,
    /// Elements it could hold in the end.
    pub capacity: u64,
    /// Runs of the frame until it fitted.
    pub runs: u32,
}

/// A frame, read back.
#[derive(Clone, Debug)]
pub struct Output {
    /// Visibility of each pixel, row by row from the top.
    pub visibility: Vec<f32>,
    /// Lit samples of each pixel, `words` words each; all ones where nothing is seen. Empty for methods that keep none
    /// ([`FixedMethod::lit`](super::fixed_memory::FixedMethod::lit)). With one facet a pixel samples off the surface
    /// are lit where the pixel is settled as lit, and not where it is evaluated.
    pub lit: Vec<u32>,
    /// Words of a mask.
    pub words: u32,
    /// Triangle of the prepared mesh at each pixel centre; `u32::MAX` where there is none.
    pub triangles: Vec<u32>,
    /// Counters.
    pub counts: Counts,
    /// The lists.
    pub lists: Vec<ListUse>,
    /// GPU time of each stage of the last run, of all strips; empty without time stamps.
    pub stages: Vec<StageTime>,
    /// Milliseconds from submission to the end of the last run, of all strips.
    pub wall_ms: f64,
    /// Dispatches recorded for the last run, of all strips.
    pub dispatches: u32,
}

/// How long the lists are at first, and how much those of pairs may take at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Elements each list that may grow starts with, up to 2^32; `None`: a guess from the image size.
    pub start: Option<usize>,
    /// Bytes the lists of pairs and of candidates may take together, from the first frame on, with what it takes to sort them; a frame
    /// that needs more is split into bands of facets.
    pub bytes: u64,
}

impl Default for Budget {
    fn default() -> Self {
        Self { start: None, bytes: 1 << 30 }
    }
}

impl Output {
    /// The frame of a scene in which no pixel sees a surface: lit everywhere. Nothing is dispatched.
    pub fn nothing_seen(settings: &Settings) -> Self {
        let (pixels, words) = (settings.pixels(), settings.samples.words());
        Self {
            visibility: vec![1.0; pixels],
            lit: vec![u32::MAX; pixels * words as usize],
            words,
            triangles: vec![u32::MAX; pixels],
            counts: Counts { empty_facets: pixels as u64, ..Counts::default() },
            lists: Vec::new(),
            stages: Vec::new(),
            wall_ms: 0.0,
            dispatches: 0,
        }
    }

    /// Adds the strip below. Facets, pairs, times and dispatches add up, those of rows that were known already too; of a list
    /// the largest need is kept.
    pub(crate) fn add_rows(&mut self, below: Self, rows: Rows) {
        let width = self.visibility.len() / (rows.first + rows.known) as usize;
        let skip = rows.known as usize * width;
        // Strips that are read back show no neighbours: the rest is their own.
        self.visibility.extend_from_slice(&below.visibility[skip..]);
        self.lit.extend_from_slice(&below.lit[skip * self.words as usize..]);
        self.triangles.extend_from_slice(&below.triangles[skip..]);
        self.counts = self.counts.with_rows(below.counts);
        for (list, more) in self.lists.iter_mut().zip(below.lists) {
            list.add_rows(&more);
        }
        for more in below.stages {
            match self.stages.iter_mut().find(|stage| stage.name == more.name) {
                Some(stage) => stage.gpu_ms += more.gpu_ms,
                None => self.stages.push(more),
            }
        }
        self.wall_ms += below.wall_ms;
        self.dispatches += below.dispatches;
    }
}

impl ListUse {
    /// Takes in how the list fared for other rows: the largest need, and all runs.
    pub(crate) fn add_rows(&mut self, more: &Self) {
        self.needed = self.needed.max(more.needed);
        self.capacity = self.capacity.max(more.capacity);
        self.runs += more.runs;
    }
}

impl Counts {
    /// With the counts of other rows; what the light sees is the same for all, and is found for one of them at least.
    pub(crate) fn with_rows(self, o: Self) -> Self {
        Self {
            kept_triangles: self.kept_triangles + o.kept_triangles,
            silhouette_edges: self.silhouette_edges.max(o.silhouette_edges),
            silhouette_texels: self.silhouette_texels.max(o.silhouette_texels),
            silhouette_pixels: self.silhouette_pixels + o.silhouette_pixels,
            pixel_texel_pairs: self.pixel_texel_pairs + o.pixel_texel_pairs,
            triangle_texel_pairs: self.triangle_texel_pairs + o.triangle_texel_pairs,
            candidate_tests: self.candidate_tests + o.candidate_tests,
            visibility_evaluations: self.visibility_evaluations + o.visibility_evaluations,
            refined_evaluations: self.refined_evaluations + o.refined_evaluations,
            facets: self.facets + o.facets,
            complex_pixels: self.complex_pixels + o.complex_pixels,
            empty_facets: self.empty_facets + o.empty_facets,
            dark_facets: self.dark_facets + o.dark_facets,
            lit_facets: self.lit_facets + o.lit_facets,
            shadowed_facets: self.shadowed_facets + o.shadowed_facets,
            pages: self.pages + o.pages,
            pages_asked: self.pages_asked + o.pages_asked,
            thirds_coarser: self.thirds_coarser.max(o.thirds_coarser),
            deep_error: self.deep_error.max(o.deep_error),
            deep_raised: self.deep_raised + o.deep_raised,
        }
    }
}
