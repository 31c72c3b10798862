//! Light maps, and casters set up in the light's view, that stand from frame to frame, while casters and the light's view do.
//!
//! A frame uses maps that an earlier one made only when that one is known to have run, and while no frame is on its way that makes others. What it then
//! found in memory it notes by number, so that frames that run in another order than they were recorded in are told.
//!
//! Maps are made of vertices relative to the camera that makes them, and hold within its rounding: a frame that uses them reaches out by
//! its own margins or theirs, whichever are wider, and makes them anew where theirs are much wider.

use super::status::InFlight;
use crate::light_view::{LightView, Margins, unit_scale};
use crate::methods::facet_masks::MapSource;
use crate::scene::Camera;
use glam::{DVec3, Vec3};

/// Theirs may be this many times as wide as a frame's own.
const WIDER: f64 = 2.0;

/// The light maps in memory, as frames recorded so far will leave them.
#[derive(Default)]
pub struct KeptMaps {
    /// Number of the maps, from 1 on.
    number: u32,
    /// Their view, and how far those that make them reach out; `None` where casters move.
    of: Option<(LightView, Reach)>,
    /// Whether a frame has run that made them.
    made: bool,
}

/// How far a view from a camera reaches out.
#[derive(Clone, Copy)]
struct Reach {
    margins: Margins,
    /// Least divisor, in world units.
    near: f64,
    /// Scaled units of a divisor, of which there is one behind some lights.
    unit: f64,
}

/// Light maps of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameMaps {
    /// Their number; 0 if no single view of the light is used.
    pub number: u32,
    /// Whether the frame makes them.
    pub source: MapSource,
    /// Margins of the frame that makes them.
    pub margins: Option<Margins>,
}

impl FrameMaps {
    /// Of a frame that needs no maps, or has several views of the light, each of which takes the place of the one before.
    pub const NONE: Self = Self { number: 0, source: MapSource::Made, margins: None };

    /// Where those of a strip of the image come from.
    pub fn source_of(&self, strip: u32) -> MapSource {
        if strip == 0 || self.source == MapSource::Requested { self.source } else { MapSource::Kept }
    }
}

impl Reach {
    fn of(view: &LightView, camera: &Camera, bounds: (DVec3, DVec3)) -> Self {
        let eye = Vec3::from(camera.eye).as_dvec3();
        let scale = unit_scale(eye, bounds);
        let seen = view.relative_to(eye, scale);
        Self { margins: seen.margins(), near: seen.near / scale, unit: if view.perspective { scale } else { 1.0 } }
    }

    /// Whether maps that were made with `self` do for a frame with `other`.
    fn does_for(&self, other: &Self) -> bool {
        let Margins { texels, depth } = other.margins;
        (self.near, self.unit) == (other.near, other.unit)
            && self.margins.texels <= WIDER * texels
            && self.margins.depth <= WIDER * depth
    }
}

impl KeptMaps {
    /// Those of a frame from `camera` with the view `view` of casters that stand between `bounds`, if `keeps`.
    pub fn for_frame(
        &mut self,
        view: &LightView,
        (camera, bounds): (&Camera, (DVec3, DVec3)),
        keeps: bool,
        in_flight: &InFlight,
    ) -> FrameMaps {
        let now = Reach::of(view, camera, bounds);
        let mut reach = match self.of {
            Some((of, reach)) if keeps && of == *view && reach.does_for(&now) => reach,
            _ => {
                *self = Self { number: self.number.checked_add(1).unwrap_or(1), of: None, made: false };
                now
            }
        };
        let others =
            in_flight.labels().any(|label| label.maps.source != MapSource::Kept && label.maps.number != self.number);
        let source = if self.made && !others { MapSource::Kept } else { MapSource::Made };
        if source == MapSource::Made {
            // Those of one number hold within the widest.
            reach.margins = reach.margins.or(now.margins);
        }
        self.of = Some((*view, reach));
        FrameMaps { number: self.number, source, margins: Some(reach.margins) }
    }

    /// Takes in that a frame has run, with these maps.
    pub fn have_run(&mut self, maps: FrameMaps) {
        self.made |= maps.source == MapSource::Made && maps.number == self.number && maps.number != 0;
    }

    /// Forgets them: the memory is another one, or holds others.
    pub fn forget(&mut self) {
        (self.of, self.made) = (None, false);
    }
}
