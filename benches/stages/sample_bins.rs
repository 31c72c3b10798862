//! 32 samples of every facet into the texels of the light view, and every triangle of a ball against them.

use crate::harness::Case;
use crate::harness::shadow::Shadow;
use std::rc::Rc;
use subpixel_shadows::gpu::{Buffer, Gpu, Recorder, recorder};
use subpixel_shadows::stages::PrefixScan;
use subpixel_shadows::stages::camera_visibility::Blocks;
use subpixel_shadows::stages::sample_bins::{BinInputs, Bins, SampleBins};
use subpixel_shadows::{Error, Result};

struct Setting {
    stage: SampleBins,
    bins: Bins,
    args: Buffer<u32>,
    shadow: Rc<Shadow>,
    /// The first, which samples fill.
    band: usize,
}

impl Setting {
    fn scene(&self) -> BinInputs<'_> {
        let blocks = Blocks { args: (self.args.raw(), 0), ..self.shadow.setup.lit() };
        let positions = &self.shadow.setup.casters.positions;
        BinInputs { samples: &self.shadow.samples, blocks, positions, facets: &self.shadow.facets }
    }
}

fn setting(gpu: &Gpu, shadow: &Rc<Shadow>) -> Result<Setting> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let map = shadow.setup.layers.nearest_keys.len().isqrt();
    let bins = Bins::new(device, &gpu.queue, map, shadow.facets.list.len(), 32)?;
    bins.prepare(queue, &shadow.frame.read(gpu)?[0]);
    let args = Buffer::indirect(device, "bench.args", 6)?;
    let groups = |per: u64| recorder::fold((shadow.setup.in_light.items as u64).div_ceil(per));
    args.write(queue, &[groups(8), groups(1)].concat());
    let stage = SampleBins::new(device, &PrefixScan::new(device), 1);
    let band = 0;
    Ok(Setting { stage, bins, args, shadow: shadow.clone(), band })
}

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(shadow) = Shadow::new(gpu, size)? else { return Ok(Vec::new()) };
    let [count, occlude] = [setting(gpu, &shadow)?, setting(gpu, &shadow)?];
    // The bins of a band, once.
    let texels = shadow.setup.layers.nearest_keys.len();
    let mut encoder = gpu.encoder();
    let mut rec = Recorder::new(&gpu.device, &mut encoder, None);
    let Setting { stage, bins, band, .. } = &occlude;
    for of in [&count, &occlude] {
        stage.record_list(&mut rec.stage("setup"), &of.shadow.facets, &of.bins)?;
    }
    rec.clear(bins.texel_ends.raw());
    stage.record_bin(&mut rec.stage("setup"), 0, *band, occlude.scene(), bins)?;
    rec.copy_words(bins.texel_offsets.raw(), 0, bins.texel_ends.raw(), 0, texels as u64);
    stage.record_bin(&mut rec.stage("setup"), 1, *band, occlude.scene(), bins)?;
    gpu.submit_and_wait(encoder)?;
    let binned = bins.texel_offsets.read(gpu)?[texels] as usize;
    if binned == 0 {
        return Err(Error::Scene("sample_bins: no sample to bin".to_owned()));
    }
    let lengths =
        |offsets: Vec<u32>| offsets.windows(2).take(texels).map(|w| (w[1] - w[0]) as usize).collect::<Vec<_>>();
    let (samples, casters) =
        (lengths(bins.texel_offsets.read(gpu)?), lengths(shadow.lists.triangle_offsets.read(gpu)?));
    let tests: usize = samples.iter().zip(&casters).map(|(s, c)| s * c).sum();
    Ok(vec![
        Case {
            name: "sample_bins count".to_owned(),
            size,
            // A facet for its samples, and the count of a texel each; then the texels are scanned.
            bytes: binned / 32 * 144 + binned * 4 + texels * 8,
            atomics: binned,
            flops: 0,
            record: Box::new(move |s| count.stage.record_bin(s, 0, count.band, count.scene(), &count.bins)),
        },
        Case {
            name: "sample_bins occlude".to_owned(),
            size,
            // At the least every sample once.
            bytes: binned * 16,
            atomics: 0,
            // Four half-planes for each caster and sample of a texel.
            flops: tests * 16,
            record: Box::new(move |s| occlude.stage.record_occlude(s, occlude.band, occlude.scene(), &occlude.bins)),
        },
    ])
}
