//! `resolution-matched`: resolution-matched shadow maps (Lefohn, Sengupta, Owens 2007), one page of calls to stages. The light's view is a
//! quadtree of pages of 32 × 32 texels, of which those are made that pixels ask for, by as many thirds of a level coarser as a budget takes. Pages are
//! made anew in every frame; nothing is read back. By [`PageRule::Fitted`](crate::stages::page_requests::PageRule) they are fitted virtual shadow
//! maps (Giegl, Wimmer 2007): all pages of a cell of the view, as fine as the finest that is asked for in it; by `Edges` adaptive shadow maps
//! (Fernando et al. 2001): fine pages where a silhouette is; by `Tiled` tiled shadow maps (Arvo 2004): a share of the budget for each cell; by `Queried` queried virtual shadow maps (Giegl, Wimmer 2007): a level finer wherever
//! that changes what pixels see. Memory is fixed: 4 KiB a page, 20 bytes a node of the tree, 24 with `Queried`.

use super::fixed_memory::{FixedMethod, MethodParts, StageInputs};
use super::light_maps::{LightMapPipelines, LightMaps};
use super::output::Counts;
use super::settings::{PageSettings, ShadowMapSettings};
use crate::Result;
use crate::gpu::{Buffer, Gpu, Recorder};
use crate::stages::page_casters::{PageCasters, PageTexels};
use crate::stages::page_query::PageQuery;
use crate::stages::page_refinement::{PageChanges, PageRefinement, PageRefinementOptions};
use crate::stages::page_requests::{PageNodes, PageRequests, PageRequestsOptions, PageRule, PageTree};
use crate::stages::{PrefixScan, PrimaryHits};

/// The method for one image, map and setting.
#[derive(Debug)]
pub struct ResolutionMatched {
    rule: Rule,
    casters: PageCasters,
    nodes: PageNodes,
    texels: PageTexels,
    visibility: Buffer<f32>,
}

/// How pages come to be.
#[derive(Debug)]
enum Rule {
    /// All at once, by what pixels ask for.
    Asked {
        requests: PageRequests,
        query: PageQuery,
        /// Silhouettes in the light's view, where the rule asks for them.
        edges: Option<Box<(LightMapPipelines, LightMaps)>>,
    },
    /// Level by level, by what they change.
    Queried { refinement: PageRefinement, found: PageChanges },
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
        let (bias, PageSettings { finer, rule, changed, .. }) = ([constant, slope], settings.pages);
        let (tree, budget) = (PageTree::new(settings.map), settings.pages.budget(settings.map));
        let rule = if rule == PageRule::Queried {
            let options = PageRefinementOptions { tree, budget, finer, changed, bias };
            let found = PageChanges::new(device, tree)?;
            Rule::Queried { refinement: PageRefinement::new(device, options)?, found }
        } else {
            let edges = || {
                let with = LightMapPipelines::new(device, &PrefixScan::new(device));
                let maps = LightMaps::new(device, queue, &with, casters.edges.len(), settings.map as usize)?;
                Ok::<_, crate::Error>(Box::new((with, maps)))
            };
            Rule::Asked {
                requests: PageRequests::new(device, PageRequestsOptions { tree, budget, finer, rule })?,
                query: PageQuery::new(device, tree, bias),
                edges: matches!(rule, PageRule::Edges | PageRule::Tiled).then(edges).transpose()?,
            }
        };
        let numbers = match &rule {
            Rule::Asked { requests, .. } => requests.numbers(),
            Rule::Queried { refinement, .. } => refinement.numbers(),
        };
        Ok(Self {
            nodes: PageNodes::new(device, numbers, tree, settings.pixels())?,
            texels: PageTexels::new(device, queue, casters.triangles.len(), budget)?,
            rule,
            casters: PageCasters::new(device, tree, budget, settings.alpha_tested),
            visibility: Buffer::storage(device, "page_query.visibility", settings.pixels())?,
        })
    }
}

impl FixedMethod for ResolutionMatched {
    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let (frame, geometry) = (inputs.frame, inputs.geometry);
        let Self { rule, casters, nodes, texels, visibility } = self;
        let seen = PrimaryHits {
            samples: inputs.samples,
            id_keys: inputs.id_keys,
            triangles: &inputs.casters.triangles,
            points: &geometry.points,
        };
        let blocks = || geometry.in_light(inputs.casters);
        match rule {
            Rule::Asked { requests, query, edges } => {
                if let Some((with, maps)) = edges.as_deref() {
                    maps.record(rec, with, frame, (inputs.casters, geometry), inputs.status, false)?;
                }
                rec.clear(nodes.requests.raw());
                rec.clear(texels.keys.raw());
                {
                    let stage = &mut rec.stage("page_requests");
                    requests.record_request(stage, frame, seen, nodes, edges.as_ref().map(|edges| &edges.1.sat))?;
                    requests.record_choose(stage, nodes)?;
                }
                casters.record(&mut rec.stage("page_casters"), frame, blocks(), nodes, texels)?;
                query.record(&mut rec.stage("page_query"), frame, seen, (nodes, texels), visibility);
            }
            Rule::Queried { refinement, found } => {
                found.clear(rec);
                for level in refinement.rounds() {
                    rec.clear(nodes.requests.raw());
                    rec.clear(texels.keys.raw());
                    let stage = &mut rec.stage("page_refinement");
                    refinement.record_choice(stage, frame, seen, (nodes, found), level)?;
                    casters.record(stage, frame, blocks(), nodes, texels)?;
                    refinement.record_compare(stage, frame, seen, (nodes, texels, found), level, visibility)?;
                }
            }
        }
        Ok(())
    }

    fn visibility(&self) -> &Buffer<f32> {
        &self.visibility
    }

    fn counts(&self, gpu: &Gpu) -> Result<Option<Counts>> {
        let [pages, thirds_coarser, pages_asked] = match &self.rule {
            Rule::Asked { .. } => self.nodes.counts(gpu)?,
            Rule::Queried { found, .. } => {
                let [made, asked] = found.counts(gpu)?;
                [made, 0, asked]
            }
        }
        .map(u64::from);
        Ok(Some(Counts { pages, pages_asked, thirds_coarser, ..Counts::default() }))
    }
}
