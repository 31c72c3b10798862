//! Parts of a view with a map each, and how texels lie over them.

use crate::{Error, Result};

/// How the texels of a map lie over what is seen of a slice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Warp {
    /// Evenly, over the whole view, whatever is seen.
    Whole,
    /// Evenly, over the box around what is seen.
    Box,
    /// Evenly, over a square around the sphere that holds the slice, whose size changes by steps and whose place by whole texels: while the
    /// camera moves, what stands keeps its texels (Valient 2008: Stable Rendering of Cascaded Shadow Maps, in ShaderX6).
    Stable,
    /// Over a trapezoid around it: the first part of the slice, a share of its depth, gets 80 % of the rows, as far as the last row
    /// is not stretched beyond what depths in it can be told by their slope.
    Trapezoid,
    /// As [`Warp::Trapezoid`], by the distance of the centre of projection that is best for a frustum and a light from the side.
    LightSpace,
    /// As [`Warp::LightSpace`], from the eye itself, as perspective shadow maps see the scene (Stamminger, Drettakis 2002; Scherzer 2011,
    /// section 4.2.2): texels keep their size beside pixels of a view across the light, and far from the eye are the largest of all.
    Perspective,
    /// As makes texels the smallest beside pixels, in the mean over what is seen: by the best distance of the centre of projection,
    /// or evenly over the box.
    #[default]
    Fitted,
}

/// The parts of what the camera sees that have a view of the light each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PartBy {
    /// Slices by depth.
    #[default]
    Depth,
    /// Slices of the depths that pixels see (Lauritzen, Salvi, Lefohn 2010: Sample Distribution Shadow Maps), told by the frame before
    /// ([`Inputs::depths`](crate::pass::Inputs::depths)); [`PartBy::Depth`] where nothing told them.
    SeenDepth,
    /// The faces of the view frustum that the light enters by, or leaves by where it stands in front of the camera: up to four, each with the part
    /// of the view whose light passes it (Kozlov 2004; Lloyd et al. 2006). One part where the light is in the frustum.
    FrustumFaces,
    /// Clusters of objects that receive: connected parts of a mesh that stands, or parts of the casters, brought together as the light and the camera see them
    /// to [`SplitPlan::MOST`] or fewer (Forsyth 2006). A pixel asks the finest view that holds it. [`PartBy::Depth`] where objects are not known.
    ReceiverClusters,
}

/// View that is cut, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitPlan {
    /// Kind of the parts.
    pub by: PartBy,
    /// Slices of the view, 1 to [`SplitPlan::MOST`]; 1 of other parts than slices.
    pub splits: u32,
    /// How each is seen.
    pub warp: Warp,
    /// Share of a slice's depth, from its near side, that [`Warp::Trapezoid`] gives 80 % of the rows.
    pub focus: f64,
    /// Where slices end: 1 for depths that grow by a factor from slice to slice, 0 for slices of one length, between them for a mean of
    /// both (the practical scheme of Zhang et al. 2006).
    pub weight: f64,
}

impl Default for SplitPlan {
    /// One slice, fitted.
    fn default() -> Self {
        Self { by: PartBy::Depth, splits: 1, warp: Warp::default(), focus: Self::FOCUS, weight: Self::WEIGHT }
    }
}

impl SplitPlan {
    /// Most slices, and most parts.
    pub const MOST: u32 = 4;
    /// The focus where none is told.
    pub const FOCUS: f64 = 0.6;
    /// The weight where none is told.
    pub const WEIGHT: f64 = 0.5;

    /// Checks the values against what is possible.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers.
    pub fn check(&self) -> Result<()> {
        let Self { by, splits, warp, focus, weight } = *self;
        let most = Self::MOST;
        let other = match by {
            PartBy::Depth | PartBy::SeenDepth => None,
            PartBy::FrustumFaces => Some("faces of its frustum"),
            PartBy::ReceiverClusters => Some("clusters of receivers"),
        };
        if let Some(other) = other {
            if splits != 1 {
                return Err(Error::Config(format!("{splits} splits of a view in {other}; slices alone are counted")));
            }
            if warp == Warp::Stable {
                return Err(Error::Config(format!("stable maps of a view in {other}; slices alone have them")));
            }
        }
        if !(1..=most).contains(&splits) {
            return Err(Error::Config(format!("{splits} splits of the view; 1 to {most} are possible")));
        }
        if !(focus > 0.0 && focus <= 1.0) {
            let text = format!("a focus on the first {focus} of a slice; more than 0, up to 1, is possible");
            return Err(Error::Config(text));
        }
        if !(0.0..=1.0).contains(&weight) {
            return Err(Error::Config(format!("slices that grow by a weight of {weight}; 0 to 1 are possible")));
        }
        Ok(())
    }

    /// Whether there may be several views.
    pub fn is_several(&self) -> bool {
        self.splits > 1 || matches!(self.by, PartBy::FrustumFaces | PartBy::ReceiverClusters)
    }
}
