//! A picture held against scene truth.

use super::mean_flip;
use super::metrics::{Metrics, Truth};
use glam::DVec3;
use oracle::truth::predicate::Plane;
use oracle::truth::{Progress, SceneTruth, Tracer, TruthImage, full_mask, join_mask};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use subpixel_shadows::methods::Settings;
use subpixel_shadows::scene::{Camera, Light};
use subpixel_shadows::{Error, Result};

/// Scene truth of one view, traced once, with what comparing pictures against it needs.
#[derive(Clone, Debug)]
pub struct TracedScene {
    /// The truth.
    pub image: TruthImage,
    visibility: Vec<f32>,
    one_plane: Vec<bool>,
}

impl TracedScene {
    /// Traces the samples of `settings` in every pixel, and weighs them by its filter.
    ///
    /// # Errors
    /// As [`SceneTruth::new`].
    pub fn new(
        tracer: &Tracer,
        camera: &Camera,
        light: &Light,
        settings: &Settings,
        progress: Progress,
    ) -> Result<Self> {
        Self::of_points(tracer, camera, &[*light], settings, progress)
    }

    /// As [`TracedScene::new`], the mean over some points of a light. The image is that of the first.
    ///
    /// # Errors
    /// As [`SceneTruth::new`]; [`Error::Config`] without a point.
    pub fn of_points(
        tracer: &Tracer,
        camera: &Camera,
        points: &[Light],
        settings: &Settings,
        progress: Progress,
    ) -> Result<Self> {
        let [width, height] = settings.size;
        let truth = |light| SceneTruth::new(tracer, camera, light, &settings.samples, width, height);
        let first = truth(points.first().ok_or_else(|| Error::Config("a light without points".to_owned()))?)?;
        let image = first.image(part_of(progress, 0, points.len()).as_deref());
        let weighted = |image: &TruthImage| image.filtered(settings.filter, &settings.samples);
        let mut visibility = weighted(&image);
        for (k, point) in points.iter().enumerate().skip(1) {
            let more = weighted(&truth(point)?.image(part_of(progress, k, points.len()).as_deref()));
            visibility.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
        visibility.iter_mut().for_each(|sum| *sum /= points.len() as f32);
        let eye = camera.rays(width, height).eye;
        let full = full_mask(settings.samples.count());
        let one_plane =
            (0..width * height).into_par_iter().map(|pixel| sees_one_plane(&first, tracer, eye, pixel, full)).collect();
        Ok(Self { visibility, image, one_plane })
    }

    /// Visibility of each pixel, row by row from the top.
    pub fn visibility(&self) -> &[f32] {
        &self.visibility
    }

    /// Holds a picture of visibility against it.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Config`] if the sizes do not agree.
    pub fn errors(&self, visibility: &[f32]) -> Result<SceneErrors> {
        let TruthImage { width, height, samples, .. } = self.image;
        let mut errors = SceneErrors::against(width, height, samples, &self.visibility, visibility)?;
        let within = 1.0 / f64::from(samples) + 1e-6;
        let planar = || self.one_plane.iter().zip(visibility).zip(&self.visibility).filter(|((one, _), _)| **one);
        let near = |ours: f32, truth: f32| (f64::from(ours) - f64::from(truth)).abs() <= within;
        let all = planar().count();
        errors.scene_one_plane_pixels = all as u64;
        if all > 0 && samples > 1 {
            let matching = planar().filter(|((_, ours), truth)| near(**ours, **truth)).count();
            errors.scene_one_plane_match = Some(matching as f64 / all as f64);
        }
        Ok(errors)
    }
}

/// A frame against scene truth: the whole error of the method, and how much of it is where one facet is the whole truth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneErrors {
    /// Pixels of the image.
    pub scene_pixels: u64,
    /// Root of the mean squared difference.
    pub scene_rmse: f64,
    /// Mean absolute difference.
    pub scene_mean: f64,
    /// Largest absolute difference.
    pub scene_max: f64,
    /// Share of the pixels within 1/N of truth; as the other two of its kind, `None` with one sample: any picture is within 1.
    pub scene_pixel_match: Option<f64>,
    /// Pixels of the silhouette band: neither all lit nor all dark in truth, grown by one pixel. Figures of the band are `None` where it
    /// is empty, as it is of truth with one sample.
    pub scene_band_pixels: u64,
    /// Root of the mean squared difference in the band.
    pub scene_band_rmse: Option<f64>,
    /// Mean absolute difference in the band.
    pub scene_band_mean: Option<f64>,
    /// Largest absolute difference in the band.
    pub scene_band_max: Option<f64>,
    /// Share of the band's pixels within 1/N of truth.
    pub scene_band_pixel_match: Option<f64>,
    /// Pixels that are lit in truth, less than that here by half a step of 8 bits or more, and not near the band.
    pub scene_acne_pixels: u64,
    /// Pixels that are dark in truth and lit here by half a step of 8 bits or more.
    pub scene_leak_pixels: u64,
    /// Mean of the FLIP map.
    pub scene_flip: f64,
    /// Pixels whose samples all see one plane.
    pub scene_one_plane_pixels: u64,
    /// Share of those within 1/N of truth; `None` without any.
    pub scene_one_plane_match: Option<f64>,
}

/// A frame against rays so many that more change nothing: the error of the method and of its samples together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ConvergedErrors {
    /// Root of the mean squared difference.
    pub converged_rmse: f64,
    /// Mean absolute difference.
    pub converged_mean: f64,
    /// Largest absolute difference.
    pub converged_max: f64,
    /// Pixels of the silhouette band of this truth; where there are none, `None` is said of it.
    pub converged_band_pixels: u64,
    /// Root of the mean squared difference in the band.
    pub converged_band_rmse: Option<f64>,
    /// Mean absolute difference in the band.
    pub converged_band_mean: Option<f64>,
    /// Mean of the FLIP map.
    pub converged_flip: f64,
}

impl ConvergedErrors {
    /// Holds a picture of visibility against 1024 rays a pixel, weighted by the filter of `settings` ([`SceneTruth::converged_by`]); of several
    /// points of a light as many to each.
    ///
    /// # Errors
    /// As [`SceneTruth::new`]; [`subpixel_shadows::Error::Config`] if the sizes do not agree.
    pub fn of(
        visibility: &[f32],
        tracer: &Tracer,
        camera: &Camera,
        points: &[Light],
        settings: &Settings,
        progress: Progress,
    ) -> Result<Self> {
        let ([width, height], samples) = (settings.size, &settings.samples);
        let mut truth = vec![0.0; visibility.len()];
        for (k, light) in points.iter().enumerate() {
            let scene = SceneTruth::new(tracer, camera, light, samples, width, height)?;
            let own = scene.converged_by(settings.filter, part_of(progress, k, points.len()).as_deref());
            truth.iter_mut().zip(own).for_each(|(sum, (share, _))| *sum += share);
        }
        truth.iter_mut().for_each(|sum| *sum /= points.len() as f32);
        let e = SceneErrors::against(width, height, samples.count(), &truth, visibility)?;
        Ok(Self {
            converged_rmse: e.scene_rmse,
            converged_mean: e.scene_mean,
            converged_max: e.scene_max,
            converged_band_pixels: e.scene_band_pixels,
            converged_band_rmse: e.scene_band_rmse,
            converged_band_mean: e.scene_band_mean,
            converged_flip: e.scene_flip,
        })
    }
}

impl SceneErrors {
    /// As they would be of this version: earlier ones wrote perfect scores where `samples` or the pixels say nothing.
    pub fn honest(self, samples: u32) -> Self {
        let some = |pixels: u64, value: Option<f64>| value.filter(|_| pixels > 0);
        let share = |pixels: u64, value: Option<f64>| some(pixels, value).filter(|_| samples > 1);
        let (band, plane) = (self.scene_band_pixels, self.scene_one_plane_pixels);
        Self {
            scene_pixel_match: share(self.scene_pixels, self.scene_pixel_match),
            scene_band_rmse: some(band, self.scene_band_rmse),
            scene_band_mean: some(band, self.scene_band_mean),
            scene_band_max: some(band, self.scene_band_max),
            scene_band_pixel_match: share(band, self.scene_band_pixel_match),
            scene_one_plane_match: share(plane, self.scene_one_plane_match),
            ..self
        }
    }

    /// Holds `visibility` against any picture of truth; nothing is said of pixels that see one plane.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Config`] if the sizes do not agree.
    pub fn against(width: u32, height: u32, samples: u32, truth: &[f32], visibility: &[f32]) -> Result<Self> {
        let held = Truth { width, height, samples, visibility: truth };
        let Metrics { whole, band, acne_pixels, leak_pixels } = held.compare(visibility)?;
        Ok(Self {
            scene_pixels: whole.pixels,
            scene_rmse: whole.rmse.unwrap_or_default(),
            scene_mean: whole.mean.unwrap_or_default(),
            scene_max: whole.max.unwrap_or_default(),
            scene_pixel_match: whole.pixel_match,
            scene_band_pixels: band.pixels,
            scene_band_rmse: band.rmse,
            scene_band_mean: band.mean,
            scene_band_max: band.max,
            scene_band_pixel_match: band.pixel_match,
            scene_acne_pixels: acne_pixels,
            scene_leak_pixels: leak_pixels,
            scene_flip: mean_flip(width, height, truth, visibility)?,
            scene_one_plane_pixels: 0,
            scene_one_plane_match: None,
        })
    }
}

/// Progress of part `k` of so many alike.
fn part_of(progress: Progress<'_>, k: usize, of: usize) -> Option<Box<dyn Fn(usize, usize) + Sync + '_>> {
    let told = progress?;
    Some(Box::new(move |done, total| told(k * total + done, of * total)))
}

/// Whether all samples of a pixel see surfaces of one plane.
fn sees_one_plane(scene: &SceneTruth, tracer: &Tracer, eye: DVec3, pixel: u32, full: u128) -> bool {
    let surfaces = scene.surfaces(pixel);
    let seen = surfaces.iter().fold(0, |seen, (_, mask)| seen | join_mask(*mask));
    let corners = |t: u32| tracer.corners(t).map(|p| p - eye);
    let Some((first, others)) = surfaces.split_first() else { return false };
    let plane = Plane::new(corners(first.0));
    seen == full && others.iter().all(|&(t, _)| corners(t).iter().all(|&p| plane.height(p) == 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A journal of an earlier version has numbers where nothing is known.
    #[test]
    fn perfect_scores_of_nothing_are_not_taken() {
        let old = r#"{"scene_pixels":12,"scene_rmse":0.5,"scene_mean":0.5,"scene_max":0.5,"scene_pixel_match":1.0,
            "scene_band_pixels":0,"scene_band_rmse":0.0,"scene_band_mean":0.0,"scene_band_max":0.0,
            "scene_band_pixel_match":1.0,"scene_acne_pixels":0,"scene_leak_pixels":0,"scene_flip":0.0,
            "scene_one_plane_pixels":3,"scene_one_plane_match":1.0}"#;
        let old: SceneErrors = serde_json::from_str(old).unwrap();
        assert_eq!((old.scene_band_rmse, old.scene_pixel_match), (Some(0.0), Some(1.0)));
        let [one, many] = [1, 32].map(|samples| old.honest(samples));
        assert_eq!([one.scene_pixel_match, one.scene_one_plane_match], [None; 2]);
        assert_eq!([many.scene_pixel_match, many.scene_one_plane_match], [Some(1.0); 2]);
        for errors in [one, many] {
            let band = [errors.scene_band_rmse, errors.scene_band_mean, errors.scene_band_max];
            assert_eq!((band, errors.scene_band_pixel_match, errors.scene_rmse), ([None; 3], None, 0.5));
        }
        let some = SceneErrors { scene_band_pixels: 5, ..old };
        assert_eq!(some.honest(32), some);
    }
}
