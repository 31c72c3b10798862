//! `resolution-matched`: resolution-matched shadow maps (Lefohn, Sengupta, Owens 2007), one page of calls to stages. The light's view is a
//! quadtree of pages of 32 × 32 texels, of which those are made that pixels ask for, by as many thirds of a level coarser as a budget takes. Pages are
//! made anew in every frame; nothing is read back. By [`PageRule::Fitted`](crate::stages::page_requests::PageRule) they are fitted virtual shadow
//! maps (Giegl, Wimmer 2007): all pages of a cell of the view, as fine as the finest that is asked for in it; by `Edges` adaptive shadow maps
//! (Fernando et al. 2001): fine pages where a silhouette is. Memory is fixed: 4 KiB a page, 20 bytes a node of the tree.

use super::fixed_memory::{FixedMethod, MethodParts, StageInputs};
use super::light_maps::{LightMapPipelines, LightMaps};
use super::output::Counts;
use super::settings::{PageSettings, ShadowMapSettings};
use crate::Result;
use crate::gpu::{Buffer, Gpu, Recorder};
use crate::stages::page_casters::{PageCasters, PageTexels};
use crate::stages::page_query::PageQuery;
use crate::stages::page_requests::{PageNodes, PageRequests, PageRequestsOptions, PageRule, PageTree};
use crate::stages::{PrefixScan, PrimaryHits};

/// The method for one image, map and setting.
#[derive(Debug)]
pub struct ResolutionMatched {
    requests: PageRequests,
    casters: PageCasters,
    query: PageQuery,
    nodes: PageNodes,
    texels: PageTexels,
    visibility: Buffer<f32>,
    /// Silhouettes in the light's view, where pages are asked for at edges.
    edges: Option<Box<(LightMapPipelines, LightMaps)>>,
}

impl ResolutionMatched {
    /// Builds pipelines and memory.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`Buffer::storage`].
    pub fn new(parts: MethodParts) -> Result<Self> {
        let MethodParts { device, queue, casters, settings, .. } = parts;
        settings.check()?;
        let ShadowMapSettings { constant, slope, .. } = settings.shadow_map;
        let PageSettings { finer, rule, .. } = settings.pages;
        let (tree, budget) = (PageTree::new(settings.map), settings.pages.budget(settings.map));
        let requests = PageRequests::new(device, PageRequestsOptions { tree, budget, finer, rule })?;
        let edges = || {
            let with = LightMapPipelines::new(device, &PrefixScan::new(device));
            let maps = LightMaps::new(device, queue, &with, casters.edges.len(), settings.map as usize)?;
            Ok::<_, crate::Error>(Box::new((with, maps)))
        };
        Ok(Self {
            nodes: PageNodes::new(device, &requests, tree, settings.pixels())?,
            texels: PageTexels::new(device, queue, casters.triangles.len(), budget)?,
            requests,
            casters: PageCasters::new(device, tree, budget, settings.alpha_tested),
            query: PageQuery::new(device, tree, [constant, slope]),
            visibility: Buffer::storage(device, "page_query.visibility", settings.pixels())?,
            edges: (rule == PageRule::Edges).then(edges).transpose()?,
        })
    }
}

impl FixedMethod for ResolutionMatched {
    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let (frame, geometry) = (inputs.frame, inputs.geometry);
        let Self { requests, casters, query, nodes, texels, visibility, edges } = self;
        if let Some((with, maps)) = edges.as_deref() {
            maps.record(rec, with, frame, (inputs.casters, geometry), inputs.status, false)?;
        }
        rec.clear(nodes.requests.raw());
        rec.clear(texels.keys.raw());
        let seen = PrimaryHits {
            samples: inputs.samples,
            id_keys: inputs.id_keys,
            triangles: &inputs.casters.triangles,
            points: &geometry.points,
        };
        {
            let stage = &mut rec.stage("page_requests");
            requests.record_request(stage, frame, seen, nodes, edges.as_ref().map(|edges| &edges.1.sat))?;
            requests.record_choose(stage, nodes)?;
        }
        casters.record(&mut rec.stage("page_casters"), frame, geometry.in_light(inputs.casters), nodes, texels)?;
        query.record(&mut rec.stage("page_query"), frame, seen, (nodes, texels), visibility);
        Ok(())
    }

    fn visibility(&self) -> &Buffer<f32> {
        &self.visibility
    }

    fn counts(&self, gpu: &Gpu) -> Result<Option<Counts>> {
        let [pages, thirds_coarser, pages_asked] = self.nodes.counts(gpu)?.map(u64::from);
        Ok(Some(Counts { pages, pages_asked, thirds_coarser, ..Counts::default() }))
    }
}
