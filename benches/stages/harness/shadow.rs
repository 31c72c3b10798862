//! The frame of the shadow stages: the ball of the geometry stages, nothing settled, every list made by the stages before.

use super::geometry::{IMAGE, MAP, Setup};
use oracle::reference::prefix_scan;
use std::rc::Rc;
use subpixel_shadows::Result;
use subpixel_shadows::frame::{Frame, sample_words};
use subpixel_shadows::gpu::{Buffer, Gpu, Groups, Recorder, Stage, recorder};
use subpixel_shadows::samples::Samples;
use subpixel_shadows::stages::candidate_pairs::CandidatePairs;
use subpixel_shadows::stages::facet_classify::{ClassifyInputs, FacetClassify, Facets};
use subpixel_shadows::stages::pixel_texel_pairs::{PairLists, PairTiles, PixelTexelPairs, TALLY_WORDS};
use subpixel_shadows::stages::triangle_texel_pairs::TriangleTexelPairs;

/// Where pairs meet, as by default.
pub const PLACES: PairTiles = PairTiles::Tiles;

/// Everything that the stages read and write.
pub struct Shadow {
    pub setup: Rc<Setup>,
    pub frame: Buffer<Frame>,
    pub samples: Buffer<[f32; 4]>,
    pub sat: Buffer<u32>,
    pub splits: Buffer<f32>,
    pub facets: Facets,
    pub facet_offsets: Buffer<u32>,
    pub facet_args: Buffer<u32>,
    pub lists: PairLists,
    pub pair_args: Buffer<u32>,
    pub candidate_args: Buffer<u32>,
    /// Pixel-texel pairs, triangle-texel pairs, candidates.
    pub counts: [usize; 3],
    /// Facets and triangles of one place, of all places.
    pub tests: usize,
    /// Work items of the facets.
    pub items: usize,
}

fn submit(gpu: &Gpu, record: impl FnOnce(&mut Stage) -> Result<()>) -> Result<()> {
    let mut encoder = gpu.encoder();
    record(&mut Recorder::new(&gpu.device, &mut encoder, None).stage("setup"))?;
    gpu.submit_and_wait(encoder)
}

fn scanned(gpu: &Gpu, counts: &Buffer<u32>, count: usize) -> Result<(Vec<u32>, usize)> {
    let scan = prefix_scan::exclusive(&counts.read_first(gpu, count)?);
    Ok(([scan.sums, vec![scan.total, 0]].concat(), scan.total as usize))
}

fn args(gpu: &Gpu, items: usize) -> Result<Buffer<u32>> {
    let args = Buffer::indirect(&gpu.device, "bench.args", 4)?;
    args.write(&gpu.queue, &recorder::fold((items as u64).div_ceil(64)));
    Ok(args)
}

impl Shadow {
    /// The frame of about `size` triangles; `None` above what the geometry stages take.
    pub fn new(gpu: &Gpu, size: usize) -> Result<Option<Rc<Self>>> {
        let Some(setup) = Setup::new(gpu, size)? else { return Ok(None) };
        let (device, queue) = (&gpu.device, &gpu.queue);
        let (pixels, texels) = ((IMAGE[0] * IMAGE[1]) as usize, (MAP * MAP) as usize);
        let places = PLACES.count(MAP as usize);
        let mut content = setup.frame.read(gpu)?[0];
        content.flags |= Frame::ALL_UNDECIDED;
        (content.facets_total, content.facet_count) = (pixels as u32, pixels as u32);
        let frame = Buffer::uniform(device, "bench.frame", 1)?;
        frame.write(queue, &[content]);
        let samples = Buffer::uniform(device, "bench.samples", 64)?;
        samples.write(queue, &sample_words(&Samples::new(Default::default(), 32)?));
        let sat = Buffer::storage(device, "bench.sat", texels)?;
        // Every texel counts.
        let splits = Buffer::from_slice(device, queue, "bench.splits", &vec![-2.0; texels])?;
        let facets = Facets::new(device, pixels, pixels, 1)?;
        let classify = FacetClassify::new(device, 1);
        let around = ClassifyInputs {
            triangles: &setup.casters.triangles,
            positions: &setup.casters.positions,
            sat: &sat,
            splits: &splits,
        };
        submit(gpu, |s| {
            classify.record_one(s, &frame, &setup.id_keys, &facets);
            classify.record_classify(s, &frame, &samples, around, &facets, Groups::Items(pixels as u64));
            Ok(())
        })?;
        let (words, items) = scanned(gpu, &facets.items, pixels)?;
        let facet_offsets = Buffer::from_slice(device, queue, "bench.facet_offsets", &words)?;
        let facet_args = args(gpu, items)?;
        let pixel_stage = PixelTexelPairs::new(device, PLACES);
        let triangle_stage = TriangleTexelPairs::new(device, PLACES);
        let mut shadow = Self {
            lists: PairLists::new(device, MAP as usize, PLACES, 1, 1, 1, false)?,
            pair_args: args(gpu, 0)?,
            candidate_args: args(gpu, 0)?,
            counts: [0; 3],
            tests: 0,
            setup,
            frame,
            samples,
            sat,
            splits,
            facets,
            facet_offsets,
            facet_args,
            items,
        };
        submit(gpu, |s| shadow.pixel_pairs(s, &pixel_stage, 0))?;
        let (pixel_offsets, pixel_count) = scanned(gpu, &shadow.lists.place_counts, shadow.lists.place_counts.len())?;
        shadow.lists.place_counts.write(queue, &vec![0; places]);
        submit(gpu, |s| shadow.triangle_pairs(s, &triangle_stage, 0))?;
        let (triangle_offsets, triangle_count) =
            scanned(gpu, &shadow.lists.place_counts, shadow.lists.place_counts.len())?;
        let lengths =
            |offsets: &[u32]| offsets.windows(2).map(|w| (w[1] - w[0]) as usize).take(places).collect::<Vec<_>>();
        shadow.tests = lengths(&pixel_offsets).iter().zip(lengths(&triangle_offsets)).map(|(p, t)| p * t).sum();
        let deepest = shadow.lists.place_deepest.read(gpu)?;
        let room = (8 * pixel_count).max(1 << 16);
        shadow.lists = PairLists::new(device, MAP as usize, PLACES, pixel_count, triangle_count, room, false)?;
        shadow.lists.place_deepest.write(queue, &deepest);
        shadow.lists.pixel_offsets.write(queue, &pixel_offsets);
        shadow.lists.triangle_offsets.write(queue, &triangle_offsets);
        content.pixel_texel_capacity = pixel_count as u32;
        content.triangle_texel_capacity = triangle_count as u32;
        content.candidate_capacity = room as u32;
        shadow.frame.write(queue, &[content]);
        submit(gpu, |s| shadow.pixel_pairs(s, &pixel_stage, 1))?;
        shadow.lists.place_counts.write(queue, &vec![0; places]);
        submit(gpu, |s| shadow.triangle_pairs(s, &triangle_stage, 1))?;
        shadow.lists.place_counts.write(queue, &vec![0; places]);
        let mut tally = vec![0; TALLY_WORDS];
        tally[0] = pixel_count as u32;
        shadow.lists.candidates.write(queue, &tally);
        shadow.pair_args = args(gpu, pixel_count)?;
        submit(gpu, |s| shadow.candidates(s, &CandidatePairs::new(device, 1, PLACES, true)))?;
        let found = shadow.lists.candidates.read_first(gpu, 2)?[1] as usize;
        shadow.candidate_args = args(gpu, found.min(room))?;
        shadow.counts = [pixel_count, triangle_count, found.min(room)];
        Ok(Some(Rc::new(shadow)))
    }

    /// One run of the pixel-texel pairs. Counts go on from the run before; writes beyond the list are left out.
    pub fn pixel_pairs(&self, s: &mut Stage, stage: &PixelTexelPairs, run: u32) -> Result<()> {
        let args = [(self.facet_args.raw(), 0); 2];
        stage.record(s, run, &self.frame, &self.facets, &self.facet_offsets, args, &self.splits, &self.lists)
    }

    /// One run of the triangle-texel pairs.
    pub fn triangle_pairs(&self, s: &mut Stage, stage: &TriangleTexelPairs, run: u32) -> Result<()> {
        let blocks = self.setup.lit();
        stage.record(s, run, &self.frame, blocks, blocks.args, &self.lists)
    }

    /// The candidates of all pairs.
    pub fn candidates(&self, s: &mut Stage, stage: &CandidatePairs) -> Result<()> {
        let (triangles, map) = (self.triangles(), &self.setup.map_points);
        let args = (self.pair_args.raw(), 0);
        stage.record(s, &self.frame, triangles, map, &self.facets, args, &self.lists, 1)
    }

    /// Vertex indices.
    pub fn triangles(&self) -> &Buffer<[u32; 4]> {
        &self.setup.casters.triangles
    }
}
