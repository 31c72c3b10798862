//! The surfaces that samples were given, held against those that they see.

use super::FacetSet;
use oracle::truth::{Progress, SeenTruth, Tracer, full_mask};
use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};
use subpixel_shadows::methods::facet_masks::{FacetMode, Settings};
use subpixel_shadows::scene::Camera;
use subpixel_shadows::stages::facet_classify::FacetState;
use subpixel_shadows::{Error, Result};

/// A frame against seen truth ([`oracle::truth::seen_truth`]). Counts are of samples.
///
/// With a facet for every surface all samples of the image are compared. Else a pixel claims what its centre sees, and that sample
/// alone is compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SeenErrors {
    /// Samples compared.
    pub seen_samples: u64,
    /// Samples that were given another surface than they see: must be 0.
    pub seen_wrong: u64,
    /// Samples that were given another one, of which either may stand.
    pub seen_tied: u64,
    /// The first wrong sample, in the order of the pixels: pixel, sample, and triangle it was given (`u32::MAX` for none).
    #[serde(skip)]
    pub first_wrong: Option<[u32; 3]>,
}

impl SeenErrors {
    /// Holds the facets of a frame that was rendered with `settings` against seen truth. `tracer` is of the mesh that facets name
    /// triangles of.
    ///
    /// # Errors
    /// [`Error::Config`] if the masks are not of as many words and facets, or the facets not of this image and mesh; as [`SeenTruth::new`].
    pub fn of(
        set: &FacetSet,
        tracer: &Tracer,
        camera: &Camera,
        settings: &Settings,
        progress: Progress,
    ) -> Result<Self> {
        let (words, count, masks) = (set.words, set.facets.len(), set.masks.len());
        if words != settings.samples.words() || masks < 3 * words as usize * count {
            return Err(Error::Config(format!("{masks} words of masks of {words} for {count} facets")));
        }
        let all = full_mask(settings.samples.count());
        let asked = if settings.facets == FacetMode::All { all } else { 1 };
        // The facets of each pixel: where they begin in the list of those that are not empty, sorted by pixel.
        let mut facets: Vec<(u32, u32, u128)> = (set.facets.iter().enumerate())
            .filter(|(_, facet)| facet.state != FacetState::Empty as u32)
            .map(|(f, facet)| (facet.pixel, facet.triangle, set.masks_of(f)[0] & all))
            .collect();
        facets.par_sort_unstable_by_key(|&(pixel, ..)| pixel);
        let pixels = settings.pixels();
        let triangles = tracer.triangle_count();
        if let Some(&(pixel, triangle, _)) = facets.iter().find(|f| f.0 as usize >= pixels || f.1 as usize >= triangles)
        {
            return Err(Error::Config(format!(
                "a facet of pixel {pixel} and triangle {triangle}, of {pixels} pixels and {triangles} triangles"
            )));
        }
        let given = |pixel: u32, sample: usize| {
            let first = facets.partition_point(|f| f.0 < pixel);
            let own = facets[first..].iter().take_while(|f| f.0 == pixel);
            own.into_iter().find(|f| f.2 >> sample & 1 != 0).map(|f| f.1)
        };
        Self::count(tracer, camera, settings, asked, given, progress)
    }

    /// Holds what each pixel's centre was given (`u32::MAX` for nothing), row by row from the top, against seen truth.
    ///
    /// # Errors
    /// [`Error::Config`] if the triangles are not of this image and mesh; as [`SeenTruth::new`].
    pub fn of_centres(
        triangles: &[u32],
        tracer: &Tracer,
        camera: &Camera,
        settings: &Settings,
        progress: Progress,
    ) -> Result<Self> {
        let (pixels, count) = (settings.pixels(), tracer.triangle_count());
        if triangles.len() != pixels {
            return Err(Error::Config(format!("triangles of {} pixels, of {pixels}", triangles.len())));
        }
        if let Some(t) = triangles.iter().find(|&&t| t != u32::MAX && t as usize >= count) {
            return Err(Error::Config(format!("triangle {t}, of {count}")));
        }
        let given = |pixel: u32, _| Some(triangles[pixel as usize]).filter(|&t| t != u32::MAX);
        Self::count(tracer, camera, settings, 1, given, progress)
    }

    fn count(
        tracer: &Tracer,
        camera: &Camera,
        settings: &Settings,
        asked: u128,
        given: impl Fn(u32, usize) -> Option<u32> + Sync,
        progress: Progress,
    ) -> Result<Self> {
        let [w, h] = settings.size;
        let truth = SeenTruth::new(tracer, camera, &settings.samples, w, h)?;
        let done = AtomicUsize::new(0);
        let row = |y: u32| {
            let mut errors = Self::default();
            for pixel in y * w..(y + 1) * w {
                let result = truth.judge(pixel, asked, |k| given(pixel, k));
                errors.seen_samples += u64::from(asked.count_ones());
                errors.seen_wrong += u64::from(result.wrong.count_ones());
                errors.seen_tied += u64::from(result.tied.count_ones());
                if result.wrong != 0 && errors.first_wrong.is_none() {
                    let sample = result.wrong.trailing_zeros();
                    errors.first_wrong = Some([pixel, sample, given(pixel, sample as usize).unwrap_or(u32::MAX)]);
                }
            }
            let rows = done.fetch_add(1, Ordering::Relaxed) + 1;
            if let Some(report) = progress {
                report(rows, h as usize);
            }
            errors
        };
        Ok((0..h).into_par_iter().map(row).reduce(Self::default, Self::plus))
    }

    fn plus(self, o: Self) -> Self {
        Self {
            seen_samples: self.seen_samples + o.seen_samples,
            seen_wrong: self.seen_wrong + o.seen_wrong,
            seen_tied: self.seen_tied + o.seen_tied,
            first_wrong: [self.first_wrong, o.first_wrong].into_iter().flatten().min(),
        }
    }
}
