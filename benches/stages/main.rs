//! Times every stage over a range of sizes, beside what the device could do at best.
//!
//! `cargo bench --bench stages -- [FILTER,…] [--quick] [--log-sizes 18,20] [--repeats N] [--json FILE] [--baseline FILE]`
//!
//! First the ceilings of the device are measured (copy bandwidth, scattered atomics, arithmetic, a dependent dispatch), then
//! all cases of one size in turn, round after round, so that a slow spell of the machine hits all alike. Times are GPU time
//! stamps around the stage; upload, readback and compilation are left out. The limit of a case is the largest of its bytes
//! at the copy bandwidth, its atomics and its arithmetic at their rates, plus its dispatches. `--baseline` takes what an
//! earlier run wrote with `--json`, and each row then ends in its median over that of the baseline.
//!
//! Stages that take textures come after all others: once a texture was cleared, llvmpipe (Mesa 22.3.6) takes the first time
//! stamp of a pass only when something waits for it, so that passes of direct dispatches seem to take no time.

mod axis_density;
mod camera_visibility;
mod candidate_pairs;
mod caster_positions;
mod cluster_bounds;
mod cluster_culling;
mod compact;
mod compared_depths;
mod deep_map;
mod deep_shadows;
mod dispatch_args;
mod facet_classify;
mod front_layer;
mod gbuffer_triangles;
mod harness;
mod history;
mod instance_positions;
mod kept_triangles;
mod light_layers;
mod light_lists;
mod map_moments;
mod moment_shadows;
mod page_casters;
mod page_query;
mod page_refinement;
mod page_requests;
mod paraboloid_casters;
mod pixel_counts;
mod pixel_coverage;
mod pixel_filter;
mod pixel_receivers;
mod pixel_texel_pairs;
mod pixel_triangles;
mod pixel_views;
mod polygon_ids;
mod prefix_scan;
mod radix_sort;
mod requested_blocks;
mod resolve;
mod sample_bins;
mod sample_surfaces;
mod seen_depths;
mod seen_texels;
mod shadow_map;
mod shadow_rays;
mod silhouette_map;
mod silhouette_mask;
mod silhouette_points;
mod smsr;
mod sorted_pairs;
mod spsm_map;
mod spsm_query;
mod summed_area;
mod surface_receivers;
mod texel_group;
mod triangle_ids;
mod triangle_setup;
mod triangle_texel_pairs;
mod vertex_project;
mod visibility_masks;
mod visibility_texture;
mod warped_casters;
mod warped_query;
mod work_owners;

use harness::{Ceilings, Options, Row};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;

type Maker = for<'a> fn(&'a Gpu, usize) -> Result<Vec<harness::Case<'a>>>;

fn run(options: &Options) -> Result<()> {
    let gpu = Gpu::open(None)?;
    println!("adapter: {} ({}, {})", gpu.adapter.name, gpu.adapter.backend, gpu.adapter.driver);
    let ceilings = Ceilings::measure(&gpu)?;
    println!(
        "ceilings: copy {:.2} GB/s, scattered atomics {:.3} G/s, arithmetic {:.2} GFLOP/s, dispatch {:.1} us",
        ceilings.bytes_per_ms * 1e-6,
        ceilings.atomics_per_ms * 1e-6,
        ceilings.flops_per_ms * 1e-6,
        ceilings.dispatch_ms * 1e3
    );
    println!("{}", Row::HEAD);
    let mut rows = Vec::new();
    let baseline = options.baseline()?;
    let without_textures: [Maker; 58] = [
        prefix_scan::cases,
        summed_area::cases,
        compact::cases,
        compared_depths::cases,
        radix_sort::cases,
        sorted_pairs::cases,
        texel_group::cases,
        dispatch_args::cases,
        work_owners::cases,
        caster_positions::cases,
        vertex_project::cases,
        cluster_bounds::cases,
        cluster_culling::cases,
        triangle_setup::cases,
        camera_visibility::cases,
        light_layers::cases,
        kept_triangles::cases,
        polygon_ids::cases,
        shadow_map::cases,
        page_requests::cases,
        page_casters::cases,
        page_query::cases,
        page_refinement::cases,
        axis_density::cases,
        warped_casters::cases,
        warped_query::cases,
        paraboloid_casters::cases,
        smsr::cases,
        map_moments::cases,
        moment_shadows::cases,
        deep_map::cases,
        deep_shadows::cases,
        shadow_rays::cases,
        sample_bins::cases,
        silhouette_mask::cases,
        silhouette_points::cases,
        silhouette_map::cases,
        seen_depths::cases,
        seen_texels::cases,
        spsm_map::cases,
        spsm_query::cases,
        front_layer::cases,
        pixel_triangles::cases,
        pixel_counts::cases,
        pixel_coverage::cases,
        sample_surfaces::cases,
        pixel_views::cases,
        light_lists::cases,
        facet_classify::cases,
        pixel_texel_pairs::cases,
        triangle_texel_pairs::cases,
        candidate_pairs::cases,
        visibility_masks::cases,
        requested_blocks::cases,
        resolve::cases,
        pixel_filter::cases,
        history::cases,
        instance_positions::cases,
    ];
    let with_textures: [Maker; 5] = [
        triangle_ids::cases,
        gbuffer_triangles::cases,
        pixel_receivers::cases,
        surface_receivers::cases,
        visibility_texture::cases,
    ];
    for makers in [&without_textures[..], &with_textures] {
        for log_size in options.log_sizes() {
            let mut cases = Vec::new();
            for make in makers {
                cases.extend(make(&gpu, 1 << log_size)?);
                cases.retain(|case| options.wants(&case.name));
            }
            for mut row in harness::measure(&gpu, &ceilings, &cases, options.repeats)? {
                baseline.note(&mut row);
                println!("{row}");
                rows.push(row);
            }
        }
    }
    options.save(&gpu, &ceilings, &rows)
}

fn main() {
    if let Err(error) = run(&Options::from_args()) {
        eprintln!("{error}");
        std::process::exit(if error.is_gpu() { 3 } else { 1 });
    }
}
