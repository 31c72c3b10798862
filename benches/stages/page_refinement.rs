//! The first round of pages over a ball, which makes all pages of a level: the choice of pages, and the comparison of 32 samples a pixel with them.

use crate::harness::Case;
use crate::harness::geometry::{MAP, Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu, Recorder};
use subpixel_shadows::stages::page_casters::PageTexels;
use subpixel_shadows::stages::page_refinement::{PageChanges, PageRefinement, PageRefinementOptions};
use subpixel_shadows::stages::page_requests::{PageNodes, PageTree};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let mut cases = Vec::new();
    for compare in [false, true] {
        let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
        let (samples, tree) = (samples(gpu, 32)?, PageTree::new(MAP));
        let options = PageRefinementOptions { tree, budget: 1024, finer: 0, changed: 1, bias: [5e-5, 1.05] };
        let stage = PageRefinement::new(&gpu.device, options)?;
        let (count, triangles) = (setup.id_keys.len(), setup.casters.triangles.len());
        let nodes = PageNodes::new(&gpu.device, stage.numbers(), tree, count)?;
        let found = PageChanges::new(&gpu.device, tree)?;
        let texels = PageTexels::new(&gpu.device, &gpu.queue, triangles, options.budget)?;
        let visibility = Buffer::<f32>::storage(&gpu.device, "bench.visibility", count)?;
        let (first, all) = (*stage.rounds().start(), tree.nodes());
        let mut encoder = gpu.encoder();
        let choose = &mut Recorder::new(&gpu.device, &mut encoder, None);
        stage.record_choice(
            &mut choose.stage("bench"),
            &setup.frame,
            setup.seen_with(&samples),
            (&nodes, &found),
            first,
        )?;
        gpu.submit_and_wait(encoder)?;
        cases.push(Case {
            name: format!("page_refinement {}", if compare { "compare" } else { "choice" }),
            size: triangles,
            bytes: if compare { count * (4 + 4 + 12 + 4 + 32 * 12) } else { count * 4 + all * (4 + 4 + 4 + 12 + 14) },
            atomics: if compare { count } else { 0 },
            // The sample's place and depth, page and texel; the pixel's box.
            flops: if compare { count * (32 * 24 + 5 * 60) } else { 0 },
            record: Box::new(move |s| {
                let seen = setup.seen_with(&samples);
                if compare {
                    let of = (&nodes, &texels, &found);
                    return stage.record_compare(s, &setup.frame, seen, of, first, &visibility);
                }
                stage.record_choice(s, &setup.frame, seen, (&nodes, &found), first)
            }),
        });
    }
    Ok(cases)
}
