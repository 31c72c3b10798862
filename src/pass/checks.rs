//! Checks of settings, device and a frame's inputs.

use super::casters::{CasterSet, Moves};
use super::textures::ImagePart;
use super::{Casters, GBuffer, Inputs, ShadowPass, Target};
use crate::methods::names::TexelQuery;
use crate::methods::{FacetMode, MethodName, Settings};
use crate::{Error, Result};
use glam::{DVec3, Vec3};

impl ShadowPass {
    /// Checks all inputs of a frame; the box of the casters.
    pub(super) fn check(&self, inputs: &Inputs, target: &Target) -> Result<(DVec3, DVec3)> {
        inputs.camera.check()?;
        inputs.light.check()?;
        target.check(self.settings.size, self.image.lit().map(|lit| lit.len() as u64 * 4))?;
        target.check_counts(self.settings.pixels(), self.image.method.counts().is_some())?;
        self.check_listed(target)?;
        inputs.reach.check()?;
        if let Some([near, far]) = inputs.depths
            && !(near > 0.0 && near <= far && far.is_finite())
        {
            return Err(Error::Config(format!("depths {near} to {far} of what is seen; they are above 0 and rise")));
        }
        if inputs.layers == 0 {
            return Err(Error::Config("the light is in no layer: it is in one of eight at the least".to_owned()));
        }
        if inputs.layers != u8::MAX && self.image.method.keeps_history() {
            return Err(Error::Config("layers of a light: a history of frames is that of a light of all".to_owned()));
        }
        self.check_gbuffer(inputs)?;
        self.bounds_of(inputs)
    }

    /// The middle of the casters.
    pub(super) fn middle_of(&self, inputs: &Inputs) -> Result<DVec3> {
        self.bounds_of(inputs).map(|(low, high)| 0.5 * (low + high))
    }

    fn check_gbuffer(&self, &Inputs { gbuffer, camera, origin, .. }: &Inputs) -> Result<()> {
        let refuse = |text: &str| Err(Error::Config(text.to_owned()));
        let part = ImagePart { size: self.settings.size, origin };
        match gbuffer {
            GBuffer::None => Ok(()),
            GBuffer::SampleIds(_) if self.settings.facets == FacetMode::One => refuse(
                "a G-buffer of several samples shows several surfaces a pixel; they need a facet for every surface",
            ),
            GBuffer::SampleIds(_) if self.image.method.is_fixed() => refuse(
                "a G-buffer of several samples: facet-masks takes it, other methods find every surface themselves",
            ),
            GBuffer::SampleIds(given) => given.check(part, self.settings.samples.offsets()),
            GBuffer::TriangleIds(_) if self.settings.facets == FacetMode::All => refuse(
                "triangle numbers of one sample show one surface a pixel; with a facet for every surface the pass finds casters itself, and takes depths or positions",
            ),
            GBuffer::TriangleIds(given) => given.check(part),
            GBuffer::Surfaces(_) if !self.maker.receivers => {
                refuse("surfaces in a G-buffer need a pass that was made with room for receivers")
            }
            GBuffer::Surfaces(given) if self.settings.facets == FacetMode::One && given.samples() > 1 => {
                refuse("multisampled depths show a pixel beside its centre; they need a facet for every surface")
            }
            GBuffer::Surfaces(given) => given.check(part, camera),
        }
    }

    /// The box of the casters.
    fn bounds_of(&self, inputs: &Inputs) -> Result<(DVec3, DVec3)> {
        let limits = self.maker.device.limits();
        let refuse = |text: &str| Err(Error::Config(text.to_owned()));
        if let Some(parts) = &self.casters.parts {
            if inputs.moved.is_some() || inputs.placed.is_some() {
                return refuse("casters in parts: the frame says by part where they are");
            }
            let join = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
            parts.check(inputs.parts, &limits)?;
            return Ok(parts.boxes(inputs.parts, false).into_iter().reduce(join).unwrap_or((DVec3::ZERO, DVec3::ONE)));
        }
        if let [first, ..] = inputs.parts {
            let (number, count) = (first.part, inputs.parts.len());
            return Err(Error::Config(format!(
                "casters that are not in parts: the frame says where {count} of them are, the first part {number}"
            )));
        }
        let [low, high] = match (&self.casters.moves, &inputs.moved, &inputs.placed) {
            (None, None, None) => {
                return Ok(self.casters.prepared.tree().bounds().unwrap_or((DVec3::ZERO, DVec3::ONE)));
            }
            (Some(Moves::Vertices(places)), Some(moved), None) => {
                moved.vertices.check(places.len(), &limits)?;
                moved.bounds
            }
            (Some(Moves::Transforms { instances, .. }), None, Some(placed)) => {
                placed.transforms.check(*instances, &limits)?;
                placed.bounds
            }
            (None, Some(_), _) => return refuse("static casters: they are not moved by a vertex buffer"),
            (Some(Moves::Transforms { .. }), Some(_), _) => {
                return refuse("instances: they are not moved by a vertex buffer");
            }
            (Some(Moves::Transforms { .. }), None, None) => return refuse("instances: the frame has no transforms"),
            (Some(Moves::Vertices(_)), None, None) => return refuse("moving casters: the frame has no vertex buffer"),
            (_, _, Some(_)) => return refuse("casters of one mesh: they are not placed by transforms"),
        };
        if !(0..3).all(|k| low[k].is_finite() && high[k].is_finite() && low[k] <= high[k]) {
            return Err(Error::Config(format!("moved casters: no box from {low:?} to {high:?}")));
        }
        Ok((Vec3::from(low).as_dvec3(), Vec3::from(high).as_dvec3()))
    }
}

/// The settings as the pass can use them for any camera and light: without validity masks no facet is settled (see
/// [`crate::plan`]), and casters that turn away are left out where that changes nothing.
pub fn settled(wanted: &Settings, method: MethodName) -> Settings {
    let wanted = &match method.takes("facets") {
        true => wanted.clone(),
        // A method of one receiver a pixel.
        false => Settings { facets: FacetMode::One, ..wanted.clone() },
    };
    let proved = wanted.validity || wanted.samples.count() == 1 || wanted.facets == FacetMode::All;
    Settings { cull_back: true, settle: wanted.settle && proved, omni: method.omni(wanted), ..wanted.clone() }
}

/// Whether the method's tree of the casters is made once.
fn is_by_tree(method: MethodName) -> bool {
    matches!(method, MethodName::RayTraced | MethodName::Supersampled)
}

/// Refuses casters of another pass that move for such a method.
pub fn check_shared(casters: &CasterSet, method: MethodName) -> Result<()> {
    if casters.are_known() || !is_by_tree(method) {
        return Ok(());
    }
    Err(Error::Config(format!("{}: its tree of casters is made once, those of the other pass move", method.name())))
}

/// Refuses casters that move for a method whose tree of them is made once.
pub fn check_moving(casters: &Casters, method: MethodName) -> Result<()> {
    let by_tree = is_by_tree(method);
    match casters {
        Casters::AlphaTested { casters, .. } => check_moving(casters, method),
        Casters::Parts { .. } if by_tree => {
            Err(Error::Config(format!("{}: its tree of casters is made once, they cannot be in parts", method.name())))
        }
        Casters::Moving { .. } | Casters::Instanced { .. } if by_tree => {
            Err(Error::Config(format!("{}: its tree of casters is made once, they cannot move", method.name())))
        }
        _ => Ok(()),
    }
}

/// Refuses alpha-tested casters for what does not ask for their holes.
pub fn check_tested(tested: bool, settings: &Settings, method: MethodName) -> Result<()> {
    let name = method.name();
    match method.row().query {
        _ if !tested => Ok(()),
        TexelQuery::Triangles => {
            Err(Error::Config(format!("{name}: casters are alpha-tested, which all other methods take")))
        }
        _ if settings.alpha_tested => Ok(()),
        _ => Err(Error::Config(
            "alpha-tested casters in a pass that was made without (settings: alpha_tested)".to_owned(),
        )),
    }
}

pub fn check_limits(have: &wgpu::Limits) -> Result<()> {
    let need = ShadowPass::required_limits();
    let pairs = [
        (
            "storage buffers a stage",
            need.max_storage_buffers_per_shader_stage,
            have.max_storage_buffers_per_shader_stage,
        ),
        ("storage textures a stage", 1, have.max_storage_textures_per_shader_stage),
        ("sampled textures a stage", 3, have.max_sampled_textures_per_shader_stage),
        (
            "invocations a workgroup",
            need.max_compute_invocations_per_workgroup,
            have.max_compute_invocations_per_workgroup,
        ),
        ("invocations along a workgroup", need.max_compute_workgroup_size_x, have.max_compute_workgroup_size_x),
        ("bytes of workgroup memory", need.max_compute_workgroup_storage_size, have.max_compute_workgroup_storage_size),
    ];
    match pairs.into_iter().find(|(_, need, have)| have < need) {
        Some((what, need, have)) => Err(Error::Config(format!("the device allows {have} {what}, {need} are needed"))),
        None => Ok(()),
    }
}
