//! How many bands of facets a frame may be split into before it is refused.

use super::{Capacities, MAX_BANDS, Needs, Settings, pair_bytes};
use crate::{Error, Result};

/// Triangles that the bands of a frame go through in all, each of them through all of the mesh.
const MAX_VISITS: usize = 1 << 25;

/// Texels that take no longer than a triangle: counts of each are cleared and summed up for every band.
const TEXELS: u64 = 64;

/// Bands that are tried of any mesh.
const FEW: usize = 16;

/// Most bands of a mesh of so many triangles and a map of so many texels a side: more would take minutes, or longer than a device lets a
/// submission run.
pub fn most_bands(triangles: usize, map: u32) -> u32 {
    let texels = (u64::from(map).pow(2) / TEXELS) as usize;
    (MAX_VISITS / triangles.max(texels).max(1)).clamp(FEW, MAX_BANDS as usize) as u32
}

/// `wanted` with no more bands than the mesh may have.
///
/// # Errors
/// [`Error::Memory`] if the lists of pairs do not fit `budget` bytes with that many, even if bands share them evenly.
pub fn in_reach(
    needs: &Needs,
    now: Capacities,
    wanted: Capacities,
    settings: &Settings,
    budget: u64,
    triangles: usize,
) -> Result<Capacities> {
    let most = most_bands(triangles, settings.map);
    if wanted.bands <= most || wanted.bands <= now.bands {
        return Ok(wanted);
    }
    let needed = pair_bytes(settings, (needs.pixel_pairs, needs.triangle_pairs, needs.candidates));
    if now.bands >= most || needed / budget.max(1) >= u64::from(most / now.bands.max(1)) {
        let bands = if now.bands == 1 { "1 band".to_owned() } else { format!("the largest of {} bands", now.bands) };
        let map = settings.map;
        let what =
            format!("pair lists of {bands} of facets, {most} at most of {triangles} triangles in a map of {map}");
        return Err(Error::Memory { what, needed, limit: budget });
    }
    Ok(Capacities { bands: most, ..wanted })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::list_sizing::first;
    use crate::methods::output::Budget;
    use crate::samples::{Pattern, Samples};

    #[test]
    fn bands_of_large_meshes_are_few() {
        let of_triangles = |triangles| most_bands(triangles, 17);
        assert_eq!([0, 1, 8192, 1 << 15, 1 << 20, 1 << 27].map(of_triangles), [4096, 4096, 4096, 1024, 32, 16]);
        assert_eq!([1, 512, 2048, 8192, 16384].map(|map| most_bands(5000, map)), [4096, 4096, 512, 32, 16]);
        let settings = Settings::new([64, 48], 17, Samples::new(Pattern::default(), 32).expect("32 samples"));
        let budget = 1u64 << 20;
        let of = |bands, triangle_pairs: u64, triangles| {
            let now = Capacities { bands, ..first(&settings, Budget { start: None, bytes: budget }) };
            let needs = Needs { triangle_pairs, ..Needs::default() };
            in_reach(&needs, now, Capacities { bands: bands * 8, ..now }, &settings, budget, triangles)
        };
        let bands = |wanted: Result<Capacities>| wanted.map(|c| c.bands).map_err(|e| e.to_string());
        // As many as were wanted, as many as may be, and none where even those would not do.
        assert_eq!(bands(of(1, 500_000, 100_000)), Ok(8));
        assert_eq!(bands(of(4, 100_000, 1 << 21)), Ok(16));
        let refused = bands(of(4, 2_500_000, 1 << 21)).expect_err("too much");
        assert!(
            refused.starts_with("memory: 'pair lists of the largest of 4 bands of facets, 16 at most"),
            "{refused}"
        );
        let refused = bands(of(16, 200_000, 1 << 21)).expect_err("as many as may be do not do");
        assert!(refused.contains("of 16 bands") && refused.ends_with("1048576 may be used"), "{refused}");
    }
}
