//! Pages that the pixels of a ball ask for, of a tree over a map of 512 × 512, and those that are made.

use crate::harness::Case;
use crate::harness::geometry::{MAP, Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::page_requests::{PageNodes, PageRequests, PageRequestsOptions, PageRule, PageTree};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let mut cases = Vec::new();
    for choose in [false, true] {
        let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
        let samples = samples(gpu, 32)?;
        let options = PageRequestsOptions { tree: PageTree::new(MAP), budget: 1024, finer: 0, rule: PageRule::Matched };
        let stage = PageRequests::new(&gpu.device, options)?;
        let count = setup.id_keys.len();
        let nodes = PageNodes::new(&gpu.device, stage.numbers(), options.tree, count)?;
        let all = options.tree.nodes();
        cases.push(Case {
            name: format!("page_requests {}", if choose { "choose" } else { "request" }),
            size: setup.casters.triangles.len(),
            bytes: if choose { all * (4 + 4 + 4 + 4 + 12 + 14) } else { count * (4 + 4 + 12 + 48) },
            atomics: 0,
            // Five rays to the plane and into the light's view.
            flops: if choose { 0 } else { count * 5 * 60 },
            record: Box::new(move |s| {
                if choose {
                    return stage.record_choose(s, &nodes);
                }
                stage.record_request(s, &setup.frame, setup.seen_with(&samples), &nodes, None)
            }),
        });
    }
    Ok(cases)
}
