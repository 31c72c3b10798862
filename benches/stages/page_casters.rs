//! Casters of a ball into the pages that its pixels ask for.

use crate::harness::Case;
use crate::harness::geometry::{MAP, Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Gpu, Recorder};
use subpixel_shadows::stages::page_casters::{PageCasters, PageTexels};
use subpixel_shadows::stages::page_requests::{PageNodes, PageRequests, PageRequestsOptions, PageRule, PageTree};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let samples = samples(gpu, 32)?;
    let (tree, budget) = (PageTree::new(MAP), 1024);
    let requests =
        PageRequests::new(&gpu.device, PageRequestsOptions { tree, budget, finer: 0, rule: PageRule::Matched })?;
    let nodes = PageNodes::new(&gpu.device, requests.numbers(), tree, setup.id_keys.len())?;
    let triangles = setup.casters.triangles.len();
    let texels = PageTexels::new(&gpu.device, &gpu.queue, triangles, budget)?;
    let stage = PageCasters::new(&gpu.device, tree, budget, false);
    let mut encoder = gpu.encoder();
    {
        let mut rec = Recorder::new(&gpu.device, &mut encoder, None);
        let s = &mut rec.stage("bench");
        requests.record_request(s, &setup.frame, setup.seen_with(&samples), &nodes, None)?;
        requests.record_choose(s, &nodes)?;
    }
    gpu.submit_and_wait(encoder)?;
    let [made, ..] = nodes.counts(gpu)?;
    Ok(vec![Case {
        name: "page_casters".to_owned(),
        size: triangles,
        bytes: triangles * (16 + 48 + 8 + 4 + 8 + 4 + 12) + made as usize * 1024 * 4,
        atomics: made as usize * 1024,
        flops: made as usize * 1024 * 30,
        record: Box::new(move |s| stage.record(s, &setup.frame, setup.lit(), &nodes, &texels)),
    }])
}
