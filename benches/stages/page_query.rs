//! Depth comparison of 32 samples a pixel with the pages that the pixels of a ball ask for.

use crate::harness::Case;
use crate::harness::geometry::{MAP, Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu, Recorder};
use subpixel_shadows::stages::page_casters::PageTexels;
use subpixel_shadows::stages::page_query::PageQuery;
use subpixel_shadows::stages::page_requests::{PageNodes, PageRequests, PageRequestsOptions, PageRule, PageTree};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let samples = samples(gpu, 32)?;
    let (tree, budget) = (PageTree::new(MAP), 1024);
    let requests =
        PageRequests::new(&gpu.device, PageRequestsOptions { tree, budget, finer: 0, rule: PageRule::Matched })?;
    let count = setup.id_keys.len();
    let nodes = PageNodes::new(&gpu.device, requests.numbers(), tree, count)?;
    let triangles = setup.casters.triangles.len();
    let texels = PageTexels::new(&gpu.device, &gpu.queue, triangles, budget)?;
    let visibility = Buffer::<f32>::storage(&gpu.device, "bench.visibility", count)?;
    let mut encoder = gpu.encoder();
    {
        let mut rec = Recorder::new(&gpu.device, &mut encoder, None);
        let s = &mut rec.stage("bench");
        requests.record_request(s, &setup.frame, setup.seen_with(&samples), &nodes, None)?;
        requests.record_choose(s, &nodes)?;
    }
    gpu.submit_and_wait(encoder)?;
    let [made, ..] = nodes.counts(gpu)?;
    let stage = PageQuery::new(&gpu.device, tree, [5e-5, 1.05]);
    Ok(vec![Case {
        name: "page_query".to_owned(),
        size: triangles,
        bytes: count * 12 + made as usize * 4096 * 4,
        atomics: 0,
        // The sample's place and depth, page and texel.
        flops: count * 32 * 24,
        record: Box::new(move |s| {
            stage.record(s, &setup.frame, setup.seen_with(&samples), (&nodes, &texels), &visibility);
            Ok(())
        }),
    }])
}
