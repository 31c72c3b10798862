//! Frames while light or camera move in small steps, held against truth of each.

use serde::{Deserialize, Serialize};
use subpixel_shadows::glam::{DQuat, DVec3, Vec3};
use subpixel_shadows::scene::{Camera, Light};
use subpixel_shadows::{Error, Result};

/// The light of frame `k`: turned about the upright axis nearest to it that is square to it, in each step by an angle that moves a shadow by a
/// tenth of a texel where it falls half the light view's width behind its caster.
///
/// # Errors
/// [`Error::Config`] for a light that is not directional.
pub fn turned(light: &Light, map: u32, k: u32) -> Result<Light> {
    let Light::Directional { direction } = *light else {
        return Err(Error::Config("only directional lights are turned".to_owned()));
    };
    let towards = Vec3::from(direction).as_dvec3().normalize();
    let up = if towards.y.abs() > 0.999 { DVec3::X } else { DVec3::Y };
    let axis = (up - towards * up.dot(towards)).normalize();
    let turn = DQuat::from_axis_angle(axis, 0.2 / f64::from(map) * f64::from(k));
    Ok(Light::Directional { direction: (turn * towards).as_vec3().into() })
}

/// The camera of frame `k`: in each step a tenth of a pixel at its target to the right of where it was.
pub fn beside(camera: &Camera, height: u32, k: u32) -> Camera {
    let [eye, target, up] = [camera.eye, camera.target, camera.up].map(|v| Vec3::from(v).as_dvec3());
    let forward = target - eye;
    let tan = (f64::from(camera.vertical_fov_degrees) * 0.5).to_radians().tan();
    let pixel = forward.length() * 2.0 * tan / f64::from(height);
    let step = forward.cross(up).normalize() * (0.1 * pixel * f64::from(k));
    Camera { eye: (eye + step).as_vec3().into(), target: (target + step).as_vec3().into(), ..*camera }
}

/// Errors and flicker of a method over the frames of a movement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// Mean squared error of each frame.
    pub squares: Vec<f64>,
    /// Mean error of each frame.
    pub errors: Vec<f64>,
    /// Of each step the mean over all pixels of |change of ours - change of truth|.
    pub flicker: Vec<f64>,
    /// Of each step the share of pixels that change though truth does not.
    pub still: Vec<f64>,
    /// Of each pixel the sum of its flicker over all steps.
    pub sums: Vec<f32>,
    last: Vec<f32>,
}

/// Flicker over a movement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Flicker {
    /// Mean over steps and pixels of |change of ours - change of truth|.
    pub mean: f64,
    /// Share of pixels that change in a step though truth does not.
    pub still: f64,
    /// Greatest change of the error (root of the mean square) from a frame to the next: what jumps where the texels of a map come to lie otherwise.
    pub jump: f64,
}

impl Course {
    /// Takes in a frame; `before` is the truth of the frame before.
    pub fn add(&mut self, visibility: Vec<f32>, truth: &[f32], before: &[f32]) {
        let pixels = truth.len() as f64;
        let mean = |sum: f64| sum / pixels;
        let off = || visibility.iter().zip(truth).map(|(v, t)| f64::from(v - t));
        self.squares.push(mean(off().map(|d| d * d).sum()));
        self.errors.push(mean(off().map(f64::abs).sum()));
        if !self.last.is_empty() {
            let (mut all, mut still) = (0.0, 0u32);
            self.sums.resize(truth.len(), 0.0);
            for ((((v, t), v0), t0), sum) in
                visibility.iter().zip(truth).zip(&self.last).zip(before).zip(&mut self.sums)
            {
                let change = f64::from((v - v0) - (t - t0)).abs();
                all += change;
                *sum += change as f32;
                still += u32::from(t == t0 && v != v0);
            }
            self.flicker.push(mean(all));
            self.still.push(mean(f64::from(still)));
        }
        self.last = visibility;
    }

    /// Its flicker; `None` of fewer than two frames.
    pub fn flickers(&self) -> Option<Flicker> {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let rmse: Vec<f64> = self.squares.iter().map(|s| s.sqrt()).collect();
        let jump = rmse.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        (!self.flicker.is_empty()).then(|| Flicker { mean: mean(&self.flicker), still: mean(&self.still), jump })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_moves_as_truth_does_does_not_flicker() {
        let truths = [[0.0, 1.0, 1.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
        let course = |frames: [[f32; 3]; 3]| {
            let mut course = Course::default();
            for (k, frame) in frames.into_iter().enumerate() {
                course.add(frame.to_vec(), &truths[k], &truths[k.saturating_sub(1)]);
            }
            course
        };
        let exact = course(truths);
        assert_eq!(exact.flickers(), Some(Flicker::default()));
        assert_eq!((exact.squares, exact.flicker.len()), (vec![0.0; 3], 2));
        // The second pixel goes dark a frame early and stays so: once without truth, and once truth without it.
        let early = course([truths[0], [1.0, 0.0, 0.0], truths[2]]);
        // Its only error is that of the second frame.
        let jump = (1.0f64 / 3.0).sqrt();
        assert_eq!(early.flickers(), Some(Flicker { mean: 1.0 / 3.0, still: 1.0 / 6.0, jump }));
        assert_eq!(early.sums, [0.0, 2.0, 0.0]);
        assert_eq!(Course::default().flickers(), None);
    }

    #[test]
    fn steps_are_small_and_even() {
        let camera = Camera {
            eye: [0.0, 0.0, 10.0],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            vertical_fov_degrees: 90.0,
            ..crate::scene::Scene::open("plane", &Default::default()).unwrap().camera
        };
        // 20 units high at the target: a tenth of a hundredth of them.
        let moved = beside(&camera, 100, 3);
        assert!((moved.eye[0] - 0.06).abs() < 1e-6 && (moved.target[0] - 0.06).abs() < 1e-6 && moved.eye[2] == 10.0);
        let light = turned(&Light::Directional { direction: [1.0, 0.0, 0.0] }, 100, 5).unwrap().homogeneous();
        assert!((light.z.hypot(light.y) - 0.01).abs() < 1e-4, "{light}");
        assert!(turned(&Light::Point { position: [0.0; 3] }, 100, 1).is_err());
    }
}
