//! Several lights as lists by tiles of the image: for clustered and forward shading.

use super::{Inputs, LightReach, LightTarget, ShadowPass, Target};
use crate::frame::sample_words;
use crate::gpu::{Buffer, Recorder};
use crate::methods::Settings;
use crate::methods::prepared::CasterBuffers;
use crate::methods::strip_method::StripMethod;
use crate::pixel_filter::PixelFilter;
use crate::scene::{Camera, Light};
use crate::stages::light_lists::{LIST_ENTRY, LightListMemory, LightLists, LightPart, words_for};
use crate::{Error, Result};
use glam::{DVec3, Vec3};

/// Lists of lights, and the number of one of them.
///
/// For each tile of 8 × 8 pixels the buffer has a list of the lights that [reach](LightReach) it and are not dark in all of it, each with a byte of
/// visibility a pixel; [`light_lists_wgsl`] reads it. A byte is the nearest 255th of the share of the pixel's seen samples that are lit and within
/// reach: 0 where the pixel sees nothing. With one surface a pixel and no facets the surface at its centre is within reach or not.
#[derive(Clone, Copy, Debug)]
pub struct ListedTarget<'a> {
    /// A buffer of usage `STORAGE`, as long as [`light_list_bytes`] says. Entries without room are left out, and [`FrameStatus::light_lists`](super::FrameStatus::light_lists)
    /// says how many are needed.
    pub lists: &'a wgpu::Buffer,
    /// Number that the light has in the lists.
    pub light: u32,
    /// The lists begin anew with this light; else it is added to those that they hold.
    pub begin: bool,
}

/// Bytes of the lists of an image of so many pixels that have room for `entries`: one for each light in each tile of 8 × 8 pixels that it reaches and
/// is not dark in.
pub fn light_list_bytes(size: [u32; 2], entries: u64) -> u64 {
    4 * words_for(size, entries)
}

/// WGSL that reads lists of lights in a shader of the application's, to be put before its text: the storage buffer `light_lists` at this group and
/// binding, and
///
/// - `first_light(pixel: vec2<u32>) -> u32`: the first entry of the pixel's tile, 0 if it has none;
/// - `listed_light(entry: u32, pixel: vec2<u32>) -> ListedLight`: number of the `light`, its `visibility` in the pixel (0 to 1; 0 too where the light does
///   not reach the pixel), and the `next` entry, 0 after the last. Lights come in the order in which they were recorded;
/// - `lists_all_lights(pixel: vec2<u32>) -> bool`: whether none of the tile's had no room. Where one had, shading may take lights that are not listed
///   for lit until the buffer is longer.
///
/// ```wgsl
/// for (var entry = first_light(pixel); entry != 0u;) {
///     let listed = listed_light(entry, pixel);
///     colour += listed.visibility * shade(lights[listed.light]);
///     entry = listed.next;
/// }
/// ```
pub fn light_lists_wgsl(group: u32, binding: u32) -> String {
    let text = include_str!("light_lists.wgsl");
    text.replace("{group}", &group.to_string()).replace("{binding}", &binding.to_string())
}

impl LightReach {
    /// Whether no surface that an image of `size` pixels of the camera shows is within reach of the light: by the sphere around its cone and range, and the
    /// image's sides. A light of which this is so needs no frame.
    pub fn misses(&self, light: &Light, camera: &Camera, [width, height]: [u32; 2]) -> bool {
        let Some((centre, radius)) = self.sphere(light) else { return false };
        let rays = camera.rays(width, height);
        let away = centre - rays.eye;
        // Roundings of the frame's numbers, and of the camera's.
        let radius = radius * (1.0 + 1e-5) + 1e-5 * away.length();
        let corners = rays.corners(width, height);
        let middle = corners.iter().sum::<DVec3>();
        let beyond = |k: usize| {
            let side = corners[k].cross(corners[(k + 1) % 4]).normalize();
            side.dot(away) * side.dot(middle).signum() < -radius
        };
        (0..4).any(beyond) || away.dot(rays.forward) + radius < f64::from(camera.near)
    }

    /// A sphere that holds what is within reach.
    fn sphere(&self, light: &Light) -> Option<(DVec3, f64)> {
        let range = f64::from(self.range);
        let at = light.homogeneous();
        if at.w == 0.0 || !range.is_finite() {
            return None;
        }
        let at = at.truncate();
        let Some((axis, cosine)) = self.cone_of(light) else { return Some((at, range)) };
        // Of the cone's cap, or around its tip and the rim of that.
        match cosine < std::f64::consts::FRAC_1_SQRT_2 {
            true => Some((at + axis * (range * cosine), range * (1.0 - cosine * cosine).sqrt())),
            false => Some((at + axis * (range / (2.0 * cosine)), range / (2.0 * cosine))),
        }
    }

    /// Axis and cosine of half the angle of the cone that is asked.
    fn cone_of(&self, light: &Light) -> Option<(DVec3, f64)> {
        match *light {
            Light::Spot { position, target, angle_degrees } if self.cone => {
                let axis = Vec3::from(target).as_dvec3() - Vec3::from(position).as_dvec3();
                Some((axis.normalize(), (0.5 * f64::from(angle_degrees).to_radians()).cos()))
            }
            _ => None,
        }
    }
}

/// The pipelines, and memory for an image.
pub struct PassLists {
    stage: LightLists,
    samples: Buffer<[f32; 4]>,
    pub memory: LightListMemory,
}

impl PassLists {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, settings: &Settings) -> Result<Self> {
        if settings.filter != PixelFilter::Box {
            let filter = settings.filter;
            return Err(Error::Config(format!(
                "lists of lights: pixels hold their own samples, not those around them by the filter {filter:?}"
            )));
        }
        let samples = Buffer::uniform(device, "light_lists.samples", 64)?;
        samples.write(queue, &sample_words(&settings.samples));
        let memory = LightListMemory::new(device, settings.size)?;
        Ok(Self { stage: LightLists::new(device, settings.samples.words()), samples, memory })
    }

    /// Memory for an image of another size.
    pub fn resize(&mut self, device: &wgpu::Device, size: [u32; 2]) -> Result<()> {
        self.memory = LightListMemory::new(device, size)?;
        Ok(())
    }

    /// Records lists without an entry.
    pub fn record_begin(&self, rec: &mut Recorder, lists: &wgpu::Buffer, size: [u32; 2]) -> Result<()> {
        let part = LightPart::everywhere(0, size, capacity(lists, size));
        self.stage.record_begin(&mut rec.stage("light_lists"), part, lists)
    }

    /// Records the visibility of a strip of rows.
    pub fn record_share(
        &self,
        rec: &mut Recorder,
        method: &StripMethod,
        casters: &CasterBuffers,
        strip: [u32; 2],
        part: LightPart,
    ) -> Result<()> {
        let stage = &mut rec.stage("light_lists");
        let frame = method.frame();
        match method.facets() {
            Some(facets) => {
                let of = (frame, &self.samples, strip);
                self.stage.record_share(stage, of, part, casters, facets, &self.memory)
            }
            None => {
                let seen = (method.id_keys(), method.visibility());
                self.stage.record_centres(stage, (frame, strip), part, casters, seen, &self.memory)
            }
        }
    }

    /// Records the entries of the light, once all strips have their visibility.
    pub fn record_append(&self, rec: &mut Recorder, lists: &wgpu::Buffer, part: LightPart) -> Result<()> {
        self.stage.record_append(&mut rec.stage("light_lists"), part, &self.memory, lists)
    }
}

/// A light as the stage takes it.
pub fn part_of(listed: ListedTarget, light: &Light, reach: LightReach, size: [u32; 2]) -> LightPart {
    let part = LightPart::everywhere(listed.light, size, capacity(listed.lists, size));
    let cone = reach.cone_of(light);
    if light.is_directional() || (cone.is_none() && reach.range.is_infinite()) {
        return part;
    }
    let (axis, cosine) = cone.unwrap_or((DVec3::ZERO, -2.0));
    let range = reach.range.min(f32::MAX);
    LightPart { axis: axis.as_vec3().into(), cosine: cosine as f32, range, everywhere: 0, ..part }
}

/// Entries that lists of an image have room for.
fn capacity(lists: &wgpu::Buffer, size: [u32; 2]) -> u32 {
    let words = (lists.size() / 4).saturating_sub(words_for(size, 0));
    // The highest bit of an entry's number is a mark.
    (words / u64::from(LIST_ENTRY)).min(u64::from(u32::MAX >> 1) - 1) as u32
}

impl ShadowPass {
    /// Appends a frame for each of several lights as [`ShadowPass::record_lights`] does, and lists of them all into `lists`
    /// ([`ListedTarget`]), which begin anew. Lights have their numbers in `lights`; the [reach](LightTarget::reach) of each says where it is asked. Returns the number of
    /// each light's frame; `None` for a light that reaches nothing in the image ([`LightReach::misses`]) and has no other target: it takes no dispatch.
    ///
    /// Many small lights take what they reach: no memory and no entry beyond it. To go on with lists, of lights of another pass,
    /// give targets their [`listed`](Target::listed).
    ///
    /// # Errors
    /// As [`ShadowPass::record_lights`]; [`Error::Config`] for a pass made without [`PassConfig::light_lists`](super::PassConfig::light_lists), a buffer that is too short
    /// for a list a tile or of another usage, and [`Error::Memory`] for one above what a binding holds.
    pub fn record_light_lists(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs,
        lights: &[LightTarget],
        lists: &wgpu::Buffer,
    ) -> Result<Vec<Option<u64>>> {
        let size = self.settings.size;
        self.check_listed(&Target {
            listed: Some(ListedTarget { lists, light: 0, begin: true }),
            ..Target::default()
        })?;
        inputs.camera.check()?;
        let mut reached = Vec::new();
        for (number, light) in (0..).zip(lights) {
            light.light.check()?;
            light.reach.check()?;
            let LightTarget { target, reach, .. } = light;
            let alone = target.visibility.is_none() && target.lit.is_none() && target.counts.is_none();
            if alone && reach.misses(&light.light, inputs.camera, size) {
                continue;
            }
            let listed = ListedTarget { lists, light: number, begin: reached.is_empty() };
            let target = Target { listed: Some(listed), ..*target };
            reached.push((number, LightTarget { target, ..*light }));
        }
        let asked: Vec<LightTarget> = reached.iter().map(|(_, light)| *light).collect();
        let frames = self.record_lights(encoder, inputs, &asked)?;
        if let ([], Some(own)) = (frames.as_slice(), &self.lists) {
            own.record_begin(&mut Recorder::new(&self.maker.device, encoder, None), lists, size)?;
        }
        let mut numbers = vec![None; lights.len()];
        reached.iter().zip(frames).for_each(|((light, _), frame)| numbers[*light as usize] = Some(frame));
        Ok(numbers)
    }

    /// Checks where a light is listed, if anywhere.
    pub(super) fn check_listed(&self, target: &Target) -> Result<()> {
        let Some(ListedTarget { lists, .. }) = target.listed else { return Ok(()) };
        let refuse = |text: String| Err(Error::Config(format!("lists of lights: {text}")));
        if self.lists.is_none() {
            return refuse("the pass was made without (PassConfig: light_lists)".to_owned());
        }
        if self.last.is_some() {
            return refuse("a pass that keeps the last picture keeps no lists".to_owned());
        }
        let usage = lists.usage();
        if !usage.contains(wgpu::BufferUsages::STORAGE) {
            return refuse(format!("the usage {usage:?} of the buffer lacks STORAGE"));
        }
        let (bytes, needed) = (lists.size(), light_list_bytes(self.settings.size, 0));
        if bytes < needed {
            return refuse(format!("a buffer of {bytes} bytes, {needed} are needed without any entry"));
        }
        let limit = self.maker.device.limits().max_storage_buffer_binding_size;
        if bytes > limit {
            return Err(Error::Memory { what: "lists of lights".to_owned(), needed: bytes, limit });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points within reach lie in the sphere; what no pixel can see is missed, and what some can is not.
    #[test]
    fn spheres_hold_what_is_within_reach() {
        let camera = Camera::look_at([0.0, 0.0, 5.0], [0.0; 3], [0.0, 1.0, 0.0], 40.0, 0.5);
        for angle_degrees in [5.0f32, 60.0, 90.0, 91.0, 150.0, 179.0] {
            let light = Light::Spot { position: [0.5, 1.0, 0.25], target: [1.5, -1.0, 0.0], angle_degrees };
            let reach = LightReach::cone(2.0);
            let (centre, radius) = reach.sphere(&light).expect("it ends");
            let (axis, cosine) = reach.cone_of(&light).expect("a cone");
            let at = light.homogeneous().truncate();
            for k in 0..2000 {
                let turn = f64::from(k) * 2.399963;
                let z = 1.0 - (f64::from(k) + 0.5) / 1000.0;
                let way = DVec3::new((1.0 - z * z).sqrt() * turn.cos(), z, (1.0 - z * z).sqrt() * turn.sin());
                if way.dot(axis) >= cosine {
                    assert!((at + way * 2.0 - centre).length() <= radius * (1.0 + 1e-9), "{angle_degrees}");
                }
            }
        }
        let misses = |position: [f32; 3], range: f32| {
            let reach = LightReach { range, ..LightReach::EVERYWHERE };
            reach.misses(&Light::Point { position }, &camera, [320, 240])
        };
        assert!(!misses([0.0; 3], 0.1) && !misses([9.0, 0.0, 0.0], f32::INFINITY));
        // Half the height at the origin is 1.82, half the width 2.43.
        for (at, radius) in
            [([0.0f32, 2.5, 0.0], 0.6), ([0.0, -2.5, 0.0], 0.6), ([3.0, 0.0, 0.0], 0.5), ([-3.0, 0.0, 0.0], 0.5)]
        {
            assert!(misses(at, radius) && !misses(at, 2.0 * radius), "{at:?}");
        }
        assert!(misses([0.0, 0.0, 6.0], 1.4) && misses([0.0, 0.0, 4.9], 0.3) && !misses([0.0, 0.0, 4.9], 0.5));
        let sun = Light::Directional { direction: [0.0, 1.0, 0.0] };
        assert!(!LightReach::cone(0.1).misses(&sun, &camera, [320, 240]));
    }
}
