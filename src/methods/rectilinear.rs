//! `rectilinear`: rectilinear texture warping (Rosen 2012), or logarithmic axes (Lloyd et al. 2008), one page of calls to stages. Texels of the light's map
//! are as wide as a function of either axis makes them, which is found anew in every frame; nothing is read back. Memory is fixed: 4 bytes a texel, and
//! 180 KiB.

use super::debug_views::DebugViews;
use super::fixed_memory::{FixedMethod, MethodParts, StageInputs};
use super::settings::{AxisSettings, ShadowMapSettings};
use crate::Result;
use crate::gpu::{Buffer, Gpu, Recorder};
use crate::stages::PrimaryHits;
use crate::stages::axis_density::{AxisDensity, AxisTables};
use crate::stages::warped_casters::{WarpedCasters, WarpedTexels};
use crate::stages::warped_query::WarpedQuery;

/// The method for one image, map and setting.
#[derive(Debug)]
pub struct Rectilinear {
    size: u32,
    density: AxisDensity,
    casters: WarpedCasters,
    query: WarpedQuery,
    tables: AxisTables,
    texels: WarpedTexels,
    visibility: Buffer<f32>,
}

impl Rectilinear {
    /// Builds pipelines and memory.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`Buffer::storage`].
    pub fn new(parts: MethodParts) -> Result<Self> {
        let MethodParts { device, queue, casters, settings, .. } = parts;
        settings.check()?;
        let ShadowMapSettings { constant, slope, .. } = settings.shadow_map;
        let AxisSettings { density, stretch } = settings.axes;
        Ok(Self {
            size: settings.map,
            density: AxisDensity::new(device, density, stretch)?,
            casters: WarpedCasters::new(device, settings.alpha_tested),
            query: WarpedQuery::new(device, [constant, slope]),
            tables: AxisTables::new(device, settings.map)?,
            texels: WarpedTexels::new(device, queue, casters.triangles.len(), settings.map)?,
            visibility: Buffer::storage(device, "warped_query.visibility", settings.pixels())?,
        })
    }
}

impl FixedMethod for Rectilinear {
    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let (frame, geometry) = (inputs.frame, inputs.geometry);
        let Self { size, density, casters, query, tables, texels, visibility } = self;
        rec.clear(tables.requests.raw());
        rec.clear(texels.keys.raw());
        let seen = PrimaryHits {
            samples: inputs.samples,
            id_keys: inputs.id_keys,
            triangles: &inputs.casters.triangles,
            points: &geometry.points,
        };
        {
            let stage = &mut rec.stage("axis_density");
            density.record_request(stage, frame, seen, tables);
            density.record_shape(stage, frame, *size, tables)?;
        }
        let blocks = geometry.in_light(inputs.casters);
        casters.record(&mut rec.stage("warped_casters"), frame, blocks, tables, texels)?;
        query.record(&mut rec.stage("warped_query"), frame, seen, (tables, texels), visibility);
        Ok(())
    }

    fn visibility(&self) -> &Buffer<f32> {
        &self.visibility
    }

    fn looks(&self, gpu: &Gpu) -> Result<Option<DebugViews>> {
        DebugViews::of_keys(gpu, &self.texels.keys).map(Some)
    }
}
