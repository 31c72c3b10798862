// Counters of a frame: what it counted, what its lists needed, and that its last stage has run.

// Of a list: items that it needed, and whether they are beyond 2^32.
struct Need {
    items: u32,
    over: u32,
}

struct StatusHead {
    silhouette_edges: atomic<u32>,
    finished: atomic<u32>,           // the frame's stamp, once its last stage has run
    candidate_tests: array<u32, 2>,  // low and high word
    facets: array<atomic<u32>, 8>,   // of each state
    longest_pixel: atomic<u32>,      // longest list of triangles of a pixel
    maps: u32,                       // number of the light maps that the frame used
    pixel_triangles: Need,
    complex_pixels: Need,
    facets_needed: Need,
    nearest_key: atomic<u32>,     // complement of the bits of the least view depth that pixels see
    farthest_depth: atomic<u32>,  // bits of the greatest
    // Of the clusters that were kept, in all views; 0 where none are left out
    kept_triangles: atomic<u32>,
}

// Needs of one band of facets in one view of the light.
struct StatusBand {
    pixel_pairs: Need,
    triangle_pairs: Need,
    candidates: u32,
    doubts: u32,
    longest: u32,        // longest list of triangles of a place of the map
    marked_texels: u32,  // of the first band
}

struct Status {
    head: StatusHead,
    bands: array<StatusBand>,
}
