//! Bindings, constants and texts of the kernels. Written by `cargo run -p subpixel-shadows-bindings`: change `kernels/` and run it again.

/// `kernels/axis_density.wgsl`.
pub mod axis_density {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "shared/facet/map_footprint", "shared/raster/axis_table", "axis_density",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, AXIS_CELLS = 1024, WORKGROUP = 64, SHAPE_WORKGROUP = 256, EACH = 4,
        LEVELS = 11, NEAREST_WORD = 22528, REQUEST_WORDS = 22529, ONE = 128, MOST = 131072, SPREAD = 4,
        REQUESTED = 0, LOGARITHMIC = 1,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        density: u32 = 0, "DENSITY",
        stretch: u32 = 64, "STRETCH",
    }
    entry_point! { "axis_density", "request", [64, 1, 1], SOURCE, Constants => Request, RequestProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 id_keys: Read<'a, u32>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        5 requests: Write<'a, u32>,
    } }
    entry_point! { "axis_density", "shape", [256, 1, 1], SOURCE, Constants => Shape, ShapeProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        5 requests: Write<'a, u32>,
        6 densities: Write<'a, u32>,
    } }
    entry_point! { "axis_density", "divide", [64, 1, 1], SOURCE, Constants => Divide, DivideProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        7 axes: Read<'a, u32>,
        8 borders: Write<'a, f32>,
    } }
    entries! {
        Request, Shape, Divide,
    }
}

/// `kernels/camera_visibility.wgsl`.
pub mod camera_visibility {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/pass", "shared/math/divide",
        "shared/frame/pixel_ray", "shared/frame/facing", "shared/math/double_float", "shared/frame/vertex",
        "shared/frame/facing_46", "shared/frame/near_distance", "shared/facet/eye_order_46", "shared/raster/rect",
        "shared/raster/work_items", "shared/raster/span", "camera_visibility/camera_raster", "shared/alpha",
        "shared/frame/mapped_view", "shared/frame/frame_copy", "camera_visibility",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, BLOCK = 8, BLOCK_SHIFT = 3, STRIDE = 8,
        HEAD = 5, OWNERS = 64, ALPHA_BILINEAR = 1, ALPHA_WRAP_X = 1, ALPHA_WRAP_Y = 3, WORKGROUP = 64,
        SETTLED = 2147483648,
    }
    overrides! {
        alpha: u32 = 0, "ALPHA",
    }
    entry_point! { "camera_visibility", "raster", [64, 1, 1], SOURCE, Constants => Raster, RasterProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        2 triangles: Read<'a, [u32; 4]>,
        3 points: Read<'a, [f32; 4]>,
        4 camera_rects: Read<'a, [u32; 2]>,
        5 work_offsets: Read<'a, u32>,
        6 keys: Write<'a, u32>,
        7 id_keys: Write<'a, u32>,
        8 doubts: Write<'a, u32>,
    } }
    entry_point! { "camera_visibility", "ask", [1, 1, 1], SOURCE, Constants => Ask, AskProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        5 work_offsets: Read<'a, u32>,
        8 doubts: Write<'a, u32>,
    } }
    entry_point! { "camera_visibility", "settle", [64, 1, 1], SOURCE, Constants => Settle, SettleProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        2 triangles: Read<'a, [u32; 4]>,
        3 points: Read<'a, [f32; 4]>,
        6 keys: Write<'a, u32>,
        7 id_keys: Write<'a, u32>,
        8 doubts: Write<'a, u32>,
        9 positions: Read<'a, [f32; 4]>,
    } }
    entry_point! { "camera_visibility", "settle_all", [64, 1, 1], SOURCE, Constants => SettleAll, SettleAllProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        2 triangles: Read<'a, [u32; 4]>,
        3 points: Read<'a, [f32; 4]>,
        4 camera_rects: Read<'a, [u32; 2]>,
        5 work_offsets: Read<'a, u32>,
        6 keys: Write<'a, u32>,
        7 id_keys: Write<'a, u32>,
        8 doubts: Write<'a, u32>,
        9 positions: Read<'a, [f32; 4]>,
    } }
    entry_point! { "camera_visibility", "take", [64, 1, 1], SOURCE, Constants => Take, TakeProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        6 keys: Write<'a, u32>,
        7 id_keys: Write<'a, u32>,
    } }
    subset! { Raster => Ask { frame, work_offsets, doubts } }
    subset! { Raster => Take { frame, keys, id_keys } }
    subset! { Settle => Take { frame, keys, id_keys } }
    subset! { SettleAll => Raster { frame, step, triangles, points, camera_rects, work_offsets, keys, id_keys, doubts } }
    subset! { SettleAll => Ask { frame, work_offsets, doubts } }
    subset! { SettleAll => Settle { frame, step, triangles, points, keys, id_keys, doubts, positions } }
    subset! { SettleAll => Take { frame, keys, id_keys } }
    entries! {
        Raster, Ask, Settle, SettleAll, Take,
    }
}

/// `kernels/candidate_pairs.wgsl`.
pub mod candidate_pairs {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/pass", "shared/math/divide",
        "shared/frame/pixel_ray", "shared/facet/facet", "shared/frame/from_lamp", "shared/facet/facet_outline",
        "shared/frame/facing", "candidate_pairs/facet_quad", "shared/raster/candidates", "shared/raster/rect",
        "shared/raster/places", "shared/raster/tile_cells", "shared/frame/frame_copy",
        "candidate_pairs/caster_effect", "candidate_pairs",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FACET_ALONE = 16777216, FACET_AWAY = 33554432, STATE_EMPTY = 0, STATE_DARK = 1,
        STATE_LIT = 2, STATE_SHADOWED = 3, STATE_UNDECIDED = 4, STATE_MERGED = 5, STATE_BITS = 7, WAS_SETTLED = 16,
        WAS_HELD = 32, WAS_MERGED = 8, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, SEEN = 65536, TALLY_PAIRS = 0,
        TALLY_CANDIDATES = 1, TALLY_DOUBTS = 2, TALLY_LONGEST = 3, TALLY_CUTS = 4, TALLY_TESTS = 5, BLOCK = 8,
        BLOCK_SHIFT = 3, NOTHING = 0, MATTERS = 1, COVERS = 2, WORKGROUP = 64, SEEN_BITS = 16, KNOWN = 2147483648,
    }
    overrides! {
        tile_shift: u32 = 0, "TILE_SHIFT",
        alone: u32 = 1, "ALONE",
        words: u32 = 1, "WORDS",
        round_length: u32 = 4096, "ROUND_LENGTH",
    }
    entry_point! { "candidate_pairs", "cull", [64, 1, 1], SOURCE, Constants => Cull, CullProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        2 pairs: Read<'a, [u32; 2]>,
        3 triangle_offsets: Read<'a, u32>,
        4 pair_triangles: Read<'a, u32>,
        5 triangles: Read<'a, [u32; 4]>,
        6 map_points: Read<'a, [f32; 4]>,
        7 candidates: Write<'a, u32>,
        8 masks: Write<'a, u32>,
        9 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
    } }
    entries! {
        Cull,
    }
}

/// `kernels/caster_positions.wgsl`.
pub mod caster_positions {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/dispatch", "shared/math/finite", "shared/math/within_box", "shared/math/homography",
        "caster_positions",
    }
    constants! {
        WORKGROUP = 64, NO_PLACE = 4294967295, FAULT_OUTSIDE = 0, FAULT_PARTED = 1,
    }
    entry_point! { "caster_positions", "gather", [64, 1, 1], SOURCE, () => Gather, GatherProgram {
        0 params: Uniform<'a, crate::stages::caster_positions::CasterPositionsParams>,
        1 vertices: Read<'a, u32>,
        2 places: Read<'a, [u32; 2]>,
        3 positions: Write<'a, [f32; 4]>,
        4 faults: Write<'a, u32>,
    } }
    entries! {
        Gather,
    }
}

/// `kernels/cluster_bounds.wgsl`.
pub mod cluster_bounds {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/dispatch", "shared/raster/cluster_box", "cluster_bounds",
    }
    constants! {
        WORKGROUP = 64, SIDE = 8,
    }
    entry_point! { "cluster_bounds", "of_vertices", [64, 1, 1], SOURCE, () => OfVertices, OfVerticesProgram {
        0 params: Uniform<'a, crate::stages::cluster_bounds::ClusterBoundsParams>,
        1 positions: Read<'a, [f32; 4]>,
        2 vertex_boxes: Write<'a, crate::stages::cluster_culling::ClusterBox>,
    } }
    entry_point! { "cluster_bounds", "of_users", [64, 1, 1], SOURCE, () => OfUsers, OfUsersProgram {
        0 params: Uniform<'a, crate::stages::cluster_bounds::ClusterBoundsParams>,
        2 vertex_boxes: Write<'a, crate::stages::cluster_culling::ClusterBox>,
        3 uses: Read<'a, u32>,
        4 boxes: Write<'a, crate::stages::cluster_culling::ClusterBox>,
    } }
    entries! {
        OfVertices, OfUsers,
    }
}

/// `kernels/cluster_culling.wgsl`.
pub mod cluster_culling {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/status", "shared/math/divide",
        "shared/raster/rect", "shared/frame/from_lamp", "shared/raster/view_sides", "shared/raster/map_ends",
        "shared/raster/requested_part", "shared/raster/clusters", "shared/raster/cluster_box",
        "shared/frame/frame_copy", "cluster_culling",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, BLOCK = 8, BLOCK_SHIFT = 3, MOST_WORDS = 64, CLUSTER_SIZE = 64, PART_TRIANGLES = 0,
        PART_EDGES = 1, PART_VERTICES = 2, PARTS = 3, KEPT_HEAD = 8, ALL_CLUSTERS = 4294967295, WORKGROUP = 64,
        WORDS = 2,
    }
    entry_point! { "cluster_culling", "test_camera", [64, 1, 1], SOURCE, () => TestCamera, TestCameraProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::cluster_culling::ClusterParams>,
        2 boxes: Read<'a, crate::stages::cluster_culling::ClusterBox>,
        4 marks: Write<'a, u32>,
        5 mark_counts: Write<'a, u32>,
    } }
    entry_point! { "cluster_culling", "test_light", [64, 1, 1], SOURCE, () => TestLight, TestLightProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::cluster_culling::ClusterParams>,
        2 boxes: Read<'a, crate::stages::cluster_culling::ClusterBox>,
        3 requested: Read<'a, u32>,
        4 marks: Write<'a, u32>,
        5 mark_counts: Write<'a, u32>,
    } }
    entry_point! { "cluster_culling", "emit", [64, 1, 1], SOURCE, () => Emit, EmitProgram {
        1 params: Uniform<'a, crate::stages::cluster_culling::ClusterParams>,
        4 marks: Write<'a, u32>,
        6 offsets: Read<'a, u32>,
        7 kept_clusters: Write<'a, u32>,
        8 status: Write<'a, u32>,
    } }
    subset! { TestLight => TestCamera { frame, params, boxes, marks, mark_counts } }
    entries! {
        TestCamera, TestLight, Emit,
    }
}

/// `kernels/compact.wgsl`.
pub mod compact {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/dispatch", "compact",
    }
    constants! {
        WORKGROUP = 64, ITEMS = 32,
    }
    entry_point! { "compact", "count", [64, 1, 1], SOURCE, () => Count, CountProgram {
        0 params: Uniform<'a, crate::stages::compact::CompactParams>,
        1 counts: Read<'a, u32>,
        2 flags: Read<'a, u32>,
        3 marks: Write<'a, u32>,
        4 mark_counts: Write<'a, u32>,
    } }
    entry_point! { "compact", "emit", [64, 1, 1], SOURCE, () => Emit, EmitProgram {
        0 params: Uniform<'a, crate::stages::compact::CompactParams>,
        3 marks: Write<'a, u32>,
        5 offsets: Read<'a, u32>,
        6 kept_from: Read<'a, u32>,
        7 kept: Write<'a, u32>,
    } }
    group! { Lists {
        params: Uniform<'a, crate::stages::compact::CompactParams>,
        counts: Read<'a, u32>,
        flags: Read<'a, u32>,
        marks: Write<'a, u32>,
        mark_counts: Write<'a, u32>,
        offsets: Read<'a, u32>,
        kept_from: Read<'a, u32>,
        kept: Write<'a, u32>,
    } }
    subset! { Lists => Count { params, counts, flags, marks, mark_counts } }
    subset! { Lists => Emit { params, marks, offsets, kept_from, kept } }
    entries! {
        Count, Emit,
    }
}

/// `kernels/compared_depths.wgsl`.
pub mod compared_depths {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/raster/front_split", "compared_depths",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, MIDPOINT = 0, SECOND = 1, DUAL = 2, WORKGROUP = 64,
    }
    overrides! {
        rule: u32 = 0, "RULE",
        farthest: f32 = 0.0, "FARTHEST",
    }
    entry_point! { "compared_depths", "settle", [64, 1, 1], SOURCE, Constants => Settle, SettleProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 second_keys: Read<'a, u32>,
        2 nearest_keys: Write<'a, u32>,
    } }
    entries! {
        Settle,
    }
}

/// `kernels/deep_map.wgsl`.
pub mod deep_map {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/raster/front_split", "shared/raster/deep_nodes",
        "deep_map",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, NO_PLACE = 16777215, WHOLE = 128, WORKGROUP = 64, MOST_NODES = 15, ERROR_UNIT = 32768,
        TRIES = 8,
    }
    overrides! {
        sub: u32 = 4, "SUB",
        nodes: u32 = 7, "NODES",
        error: f32 = 8.0, "ERROR",
    }
    entry_point! { "deep_map", "compress", [64, 1, 1], SOURCE, Constants => Compress, CompressProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 nearest_keys: Read<'a, u32>,
        2 deep: Write<'a, u32>,
        3 worst: Write<'a, u32>,
    } }
    entries! {
        Compress,
    }
}

/// `kernels/deep_shadows.wgsl`.
pub mod deep_shadows {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "shared/raster/deep_nodes", "deep_shadows",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, NO_PLACE = 16777215, WHOLE = 128, WORKGROUP = 64,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        sub: u32 = 4, "SUB",
        nodes: u32 = 7, "NODES",
        bias_constant: f32 = 5e-5, "BIAS_CONSTANT",
        bias_slope: f32 = 1.05, "BIAS_SLOPE",
    }
    entry_point! { "deep_shadows", "ask", [64, 1, 1], SOURCE, Constants => Ask, AskProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 id_keys: Read<'a, u32>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        5 deep: Read<'a, u32>,
        6 visibility: Write<'a, f32>,
    } }
    entries! {
        Ask,
    }
}

/// `kernels/dispatch_args.wgsl`.
pub mod dispatch_args {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "dispatch_args",
    }
    constants! {
        WORKGROUP = 64,
    }
    overrides! {
        max_groups: u32 = 65535, "MAX_GROUPS",
    }
    entry_point! { "dispatch_args", "fold", [64, 1, 1], SOURCE, Constants => Fold, FoldProgram {
        0 counts: Read<'a, u32>,
        1 requests: Read<'a, crate::stages::dispatch_args::ArgsRequest>,
        2 args: Write<'a, u32>,
    } }
    entries! {
        Fold,
    }
}

/// `kernels/facet_classify.wgsl`.
pub mod facet_classify {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/raster/rect",
        "shared/frame/pixel_ray", "shared/facet/facet", "shared/frame/facing", "shared/math/double_float",
        "shared/frame/vertex", "shared/frame/facing_46", "shared/raster/front_split", "shared/facet/only_receiver",
        "shared/raster/summed_area", "shared/frame/frame_copy", "shared/roles", "facet_classify/facet_samples",
        "shared/frame/from_lamp", "shared/raster/view_sides", "shared/facet/facet_box", "shared/facet/facet_extent",
        "facet_classify/facet_place", "facet_classify",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, BLOCK = 8, BLOCK_SHIFT = 3, FACET_ALONE = 16777216, FACET_AWAY = 33554432,
        STATE_EMPTY = 0, STATE_DARK = 1, STATE_LIT = 2, STATE_SHADOWED = 3, STATE_UNDECIDED = 4, STATE_MERGED = 5,
        STATE_BITS = 7, WAS_SETTLED = 16, WAS_HELD = 32, WAS_MERGED = 8, FRONT = 0, BACK = 1, UNSURE = 2,
        DROPPED = 3, MOST_SPLITS = 256, ROLE_UNSEEN = 65536, WORKGROUP = 64, UNSURE_GROUPS = 64,
    }
    overrides! {
        words: u32 = 1, "WORDS",
        clamped: u32 = 2, "CLAMPED",
        receivers: u32 = 1, "RECEIVERS",
    }
    entry_point! { "facet_classify", "one", [64, 1, 1], SOURCE, Constants => One, OneProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 id_keys: Read<'a, u32>,
        7 facets: Write<'a, crate::stages::facet_classify::Facet>,
        8 masks: Write<'a, u32>,
        10 pixel_facets: Write<'a, u32>,
    } }
    entry_point! { "facet_classify", "begin", [1, 1, 1], SOURCE, Constants => Begin, BeginProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        9 facet_items: Write<'a, u32>,
    } }
    entry_point! { "facet_classify", "classify", [64, 1, 1], SOURCE, Constants => Classify, ClassifyProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        3 triangles: Read<'a, [u32; 4]>,
        4 positions: Read<'a, [f32; 4]>,
        5 sat: Read<'a, u32>,
        6 splits: Read<'a, f32>,
        7 facets: Write<'a, crate::stages::facet_classify::Facet>,
        8 masks: Write<'a, u32>,
        9 facet_items: Write<'a, u32>,
        11 undecided: Write<'a, crate::stages::facet_classify::Undecided>,
    } }
    entry_point! { "facet_classify", "classify_unsure", [64, 1, 1], SOURCE, Constants => ClassifyUnsure, ClassifyUnsureProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        3 triangles: Read<'a, [u32; 4]>,
        4 positions: Read<'a, [f32; 4]>,
        5 sat: Read<'a, u32>,
        6 splits: Read<'a, f32>,
        7 facets: Write<'a, crate::stages::facet_classify::Facet>,
        8 masks: Write<'a, u32>,
        9 facet_items: Write<'a, u32>,
        11 undecided: Write<'a, crate::stages::facet_classify::Undecided>,
    } }
    subset! { Classify => Begin { frame, facet_items } }
    subset! { Classify => ClassifyUnsure { frame, samples, triangles, positions, sat, splits, facets, masks, facet_items, undecided } }
    subset! { ClassifyUnsure => Begin { frame, facet_items } }
    subset! { ClassifyUnsure => Classify { frame, samples, triangles, positions, sat, splits, facets, masks, facet_items, undecided } }
    entries! {
        One, Begin, Classify, ClassifyUnsure,
    }
}

/// `kernels/front_layer.wgsl`.
pub mod front_layer {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/raster/work_items", "shared/raster/front_split",
        "shared/math/divide", "shared/raster/rect", "shared/raster/undivided", "shared/raster/conservative",
        "shared/raster/span", "shared/raster/block_bits", "shared/raster/cover_cells", "shared/raster/mask_rows",
        "shared/frame/facing", "shared/frame/frame_copy", "front_layer",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, STRIDE = 8, HEAD = 5, OWNERS = 64, BLOCK = 8, BLOCK_SHIFT = 3, FRONT = 0, BACK = 1,
        UNSURE = 2, DROPPED = 3, WORKGROUP = 64,
    }
    entry_point! { "front_layer", "check", [64, 1, 1], SOURCE, () => Check, CheckProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 triangles: Read<'a, [u32; 4]>,
        2 map_points: Read<'a, [f32; 4]>,
        3 light_rects: Read<'a, [u32; 2]>,
        4 work_offsets: Read<'a, u32>,
        5 nearest_keys: Read<'a, u32>,
        6 second_keys: Read<'a, u32>,
        7 mask: Write<'a, u32>,
        9 facing: Read<'a, u32>,
    } }
    entry_point! { "front_layer", "settle", [64, 1, 1], SOURCE, () => Settle, SettleProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        5 nearest_keys: Read<'a, u32>,
        6 second_keys: Read<'a, u32>,
        7 mask: Write<'a, u32>,
        8 splits: Write<'a, f32>,
    } }
    entries! {
        Check, Settle,
    }
}

/// `kernels/gbuffer_triangles.wgsl`.
pub mod gbuffer_triangles {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/status", "shared/math/divide",
        "shared/frame/strip", "shared/raster/pixel_pair", "shared/raster/covering", "shared/math/word_masks",
        "gbuffer_triangles/listed_samples", "gbuffer_triangles",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, WORKGROUP = 64, FAULT_UNKNOWN = 2, MOST = 128,
    }
    entry_point! { "gbuffer_triangles", "count_layers", [64, 1, 1], SOURCE, () => CountLayers, CountLayersProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::gbuffer_triangles::GbufferTrianglesParams>,
        2 layers: TextureUintLayers<'a>,
        4 numbers: Read<'a, u32>,
        5 pixel_counts: Write<'a, u32>,
        6 complex_flags: Write<'a, u32>,
        7 facet_counts: Write<'a, u32>,
        8 status: Write<'a, u32>,
        9 faults: Write<'a, u32>,
        15 id_keys: Write<'a, u32>,
    } }
    entry_point! { "gbuffer_triangles", "count_samples", [64, 1, 1], SOURCE, () => CountSamples, CountSamplesProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::gbuffer_triangles::GbufferTrianglesParams>,
        3 multisampled: TextureUintSamples<'a>,
        4 numbers: Read<'a, u32>,
        5 pixel_counts: Write<'a, u32>,
        6 complex_flags: Write<'a, u32>,
        7 facet_counts: Write<'a, u32>,
        8 status: Write<'a, u32>,
        9 faults: Write<'a, u32>,
        15 id_keys: Write<'a, u32>,
    } }
    entry_point! { "gbuffer_triangles", "emit_layers", [64, 1, 1], SOURCE, () => EmitLayers, EmitLayersProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::gbuffer_triangles::GbufferTrianglesParams>,
        2 layers: TextureUintLayers<'a>,
        4 numbers: Read<'a, u32>,
        5 pixel_counts: Write<'a, u32>,
        10 pixel_offsets: Read<'a, u32>,
        11 pixel_list: Write<'a, crate::stages::pixel_triangles::PixelPair>,
    } }
    entry_point! { "gbuffer_triangles", "emit_samples", [64, 1, 1], SOURCE, () => EmitSamples, EmitSamplesProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::gbuffer_triangles::GbufferTrianglesParams>,
        3 multisampled: TextureUintSamples<'a>,
        4 numbers: Read<'a, u32>,
        5 pixel_counts: Write<'a, u32>,
        10 pixel_offsets: Read<'a, u32>,
        11 pixel_list: Write<'a, crate::stages::pixel_triangles::PixelPair>,
    } }
    entry_point! { "gbuffer_triangles", "fill_layers", [64, 1, 1], SOURCE, () => FillLayers, FillLayersProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::gbuffer_triangles::GbufferTrianglesParams>,
        2 layers: TextureUintLayers<'a>,
        4 numbers: Read<'a, u32>,
        5 pixel_counts: Write<'a, u32>,
        10 pixel_offsets: Read<'a, u32>,
        12 complex_pixels: Read<'a, u32>,
        13 complex_total: Read<'a, u32>,
        14 covering_masks: Write<'a, u32>,
        16 coverings: Write<'a, crate::stages::pixel_coverage::Covering>,
    } }
    entry_point! { "gbuffer_triangles", "fill_samples", [64, 1, 1], SOURCE, () => FillSamples, FillSamplesProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::gbuffer_triangles::GbufferTrianglesParams>,
        3 multisampled: TextureUintSamples<'a>,
        4 numbers: Read<'a, u32>,
        5 pixel_counts: Write<'a, u32>,
        10 pixel_offsets: Read<'a, u32>,
        12 complex_pixels: Read<'a, u32>,
        13 complex_total: Read<'a, u32>,
        14 covering_masks: Write<'a, u32>,
        16 coverings: Write<'a, crate::stages::pixel_coverage::Covering>,
    } }
    entries! {
        CountLayers, CountSamples, EmitLayers, EmitSamples, FillLayers, FillSamples,
    }
}

/// `kernels/history.wgsl`.
pub mod history {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "shared/facet/view_choice", "history",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, WORKGROUP = 64,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        reach: f32 = 1.0, "REACH",
        power: u32 = 8, "POWER",
    }
    entry_point! { "history", "blend", [64, 1, 1], SOURCE, Constants => Blend, BlendProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 views: Uniform<'a, crate::stages::pixel_views::LightViews>,
        2 before: Uniform<'a, crate::stages::history::FrameBefore>,
        4 id_keys: Read<'a, u32>,
        5 triangles: Read<'a, [u32; 4]>,
        6 points: Read<'a, [f32; 4]>,
        7 past: Read<'a, [f32; 4]>,
        8 visibility: Write<'a, f32>,
        9 kept: Write<'a, [f32; 4]>,
    } }
    entries! {
        Blend,
    }
}

/// `kernels/instance_positions.wgsl`.
pub mod instance_positions {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/dispatch", "shared/math/finite", "shared/math/within_box", "shared/math/homography",
        "instance_positions",
    }
    constants! {
        WORKGROUP = 64, FAULT_OUTSIDE = 0,
    }
    entry_point! { "instance_positions", "transform", [64, 1, 1], SOURCE, () => Transform, TransformProgram {
        0 params: Uniform<'a, crate::stages::instance_positions::InstancePositionsParams>,
        1 sources: Read<'a, [u32; 2]>,
        2 vertices: Read<'a, [f32; 4]>,
        3 transforms: Read<'a, u32>,
        4 positions: Write<'a, [f32; 4]>,
        5 faults: Write<'a, u32>,
    } }
    entries! {
        Transform,
    }
}

/// `kernels/kept_triangles.wgsl`.
pub mod kept_triangles {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "shared/facet/beside", "shared/alpha", "shared/frame/mapped_view",
        "kept_triangles",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, ALPHA_BILINEAR = 1, ALPHA_WRAP_X = 1, ALPHA_WRAP_Y = 3, WORKGROUP = 64,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        alpha: u32 = 0, "ALPHA",
        lookups: u32 = 5, "LOOKUPS",
        bias: f32 = 1e-5, "BIAS",
        words: u32 = 1, "WORDS",
    }
    entry_point! { "kept_triangles", "look_up", [64, 1, 1], SOURCE, Constants => LookUp, LookUpProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 id_keys: Read<'a, u32>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        5 triangle_keys: Read<'a, u32>,
        6 visibility: Write<'a, f32>,
    } }
    entries! {
        LookUp,
    }
}

/// `kernels/light_layers.wgsl`.
pub mod light_layers {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/raster/rect",
        "shared/raster/work_items", "shared/raster/front_split", "shared/raster/span", "shared/raster/block_bits",
        "shared/frame/facing", "shared/alpha", "shared/raster/undivided", "shared/roles", "shared/raster/hole",
        "shared/raster/front_fan", "shared/raster/conservative", "shared/raster/cover_cells",
        "shared/frame/frame_copy", "light_layers",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, BLOCK = 8, BLOCK_SHIFT = 3, STRIDE = 8, HEAD = 5, OWNERS = 64, FRONT = 0, BACK = 1,
        UNSURE = 2, DROPPED = 3, ALPHA_BILINEAR = 1, ALPHA_WRAP_X = 1, ALPHA_WRAP_Y = 3, ROLE_UNSEEN = 65536,
        WORKGROUP = 64, NEAREST_TRIANGLE = 3,
    }
    overrides! {
        alpha: u32 = 0, "ALPHA",
        layers: u32 = 2, "LAYERS",
        marks: u32 = 1, "MARKS",
    }
    entry_point! { "light_layers", "raster", [64, 1, 1], SOURCE, Constants => Raster, RasterProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 triangles: Read<'a, [u32; 4]>,
        2 map_points: Read<'a, [f32; 4]>,
        3 light_rects: Read<'a, [u32; 2]>,
        4 work_offsets: Read<'a, u32>,
        5 nearest_keys: Write<'a, u32>,
        6 second_keys: Write<'a, u32>,
        7 mask: Write<'a, u32>,
        8 facing: Read<'a, u32>,
    } }
    entry_point! { "light_layers", "raster_cut", [64, 1, 1], SOURCE, Constants => RasterCut, RasterCutProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 triangles: Read<'a, [u32; 4]>,
        2 map_points: Read<'a, [f32; 4]>,
        3 light_rects: Read<'a, [u32; 2]>,
        4 work_offsets: Read<'a, u32>,
        5 nearest_keys: Write<'a, u32>,
        6 second_keys: Write<'a, u32>,
        8 facing: Read<'a, u32>,
    } }
    entry_point! { "light_layers", "raster_nearest", [64, 1, 1], SOURCE, Constants => RasterNearest, RasterNearestProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 triangles: Read<'a, [u32; 4]>,
        2 map_points: Read<'a, [f32; 4]>,
        3 light_rects: Read<'a, [u32; 2]>,
        4 work_offsets: Read<'a, u32>,
        5 nearest_keys: Write<'a, u32>,
        6 second_keys: Write<'a, u32>,
        7 mask: Write<'a, u32>,
        8 facing: Read<'a, u32>,
    } }
    group! { Blocks {
        work_offsets: Read<'a, u32>,
        triangles: Read<'a, [u32; 4]>,
        map_points: Read<'a, [f32; 4]>,
        frame: Uniform<'a, crate::frame::Frame>,
        light_rects: Read<'a, [u32; 2]>,
        nearest_keys: Write<'a, u32>,
        second_keys: Write<'a, u32>,
        mask: Write<'a, u32>,
        facing: Read<'a, u32>,
    } }
    subset! { Raster => RasterCut { frame, triangles, map_points, light_rects, work_offsets, nearest_keys, second_keys, facing } }
    subset! { Raster => RasterNearest { frame, triangles, map_points, light_rects, work_offsets, nearest_keys, second_keys, mask, facing } }
    subset! { Raster => Blocks { work_offsets, triangles, map_points, frame, light_rects, nearest_keys, second_keys, mask, facing } }
    subset! { RasterNearest => Raster { frame, triangles, map_points, light_rects, work_offsets, nearest_keys, second_keys, mask, facing } }
    subset! { RasterNearest => RasterCut { frame, triangles, map_points, light_rects, work_offsets, nearest_keys, second_keys, facing } }
    subset! { RasterNearest => Blocks { work_offsets, triangles, map_points, frame, light_rects, nearest_keys, second_keys, mask, facing } }
    subset! { Blocks => Raster { frame, triangles, map_points, light_rects, work_offsets, nearest_keys, second_keys, mask, facing } }
    subset! { Blocks => RasterCut { frame, triangles, map_points, light_rects, work_offsets, nearest_keys, second_keys, facing } }
    subset! { Blocks => RasterNearest { frame, triangles, map_points, light_rects, work_offsets, nearest_keys, second_keys, mask, facing } }
    entries! {
        Raster, RasterCut, RasterNearest,
    }
}

/// `kernels/light_lists.wgsl`.
pub mod light_lists {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/frame/pixel_ray",
        "shared/facet/facet", "shared/frame/facing", "shared/frame/vertex", "shared/frame/strip",
        "light_lists/light_part", "light_lists/light_reach", "light_lists",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FACET_ALONE = 16777216, FACET_AWAY = 33554432, STATE_EMPTY = 0, STATE_DARK = 1,
        STATE_LIT = 2, STATE_SHADOWED = 3, STATE_UNDECIDED = 4, STATE_MERGED = 5, STATE_BITS = 7, WAS_SETTLED = 16,
        WAS_HELD = 32, WAS_MERGED = 8, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, REACH_NONE = 0, REACH_SOME = 1,
        REACH_ALL = 2, WORKGROUP = 64, LIST_HEAD = 4, LIST_ENTRY = 18, TILE_LACKS = 2147483648,
    }
    overrides! {
        words: u32 = 1, "WORDS",
    }
    entry_point! { "light_lists", "share", [64, 1, 1], SOURCE, Constants => Share, ShareProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 part: Uniform<'a, crate::stages::light_lists::LightPart>,
        2 samples: Uniform<'a, [f32; 4]>,
        3 facets: Read<'a, crate::stages::facet_classify::Facet>,
        4 masks: Read<'a, u32>,
        5 pixel_facets: Read<'a, u32>,
        6 triangles: Read<'a, [u32; 4]>,
        7 positions: Read<'a, [f32; 4]>,
        8 shares: Write<'a, u32>,
    } }
    entry_point! { "light_lists", "share_centres", [64, 1, 1], SOURCE, Constants => ShareCentres, ShareCentresProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 part: Uniform<'a, crate::stages::light_lists::LightPart>,
        6 triangles: Read<'a, [u32; 4]>,
        7 positions: Read<'a, [f32; 4]>,
        8 shares: Write<'a, u32>,
        9 id_keys: Read<'a, u32>,
        10 visibility: Read<'a, f32>,
    } }
    entry_point! { "light_lists", "begin", [64, 1, 1], SOURCE, Constants => Begin, BeginProgram {
        1 part: Uniform<'a, crate::stages::light_lists::LightPart>,
        15 lists: Write<'a, u32>,
    } }
    entry_point! { "light_lists", "mark", [64, 1, 1], SOURCE, Constants => Mark, MarkProgram {
        1 part: Uniform<'a, crate::stages::light_lists::LightPart>,
        11 given: Read<'a, u32>,
        12 counts: Write<'a, u32>,
        15 lists: Write<'a, u32>,
    } }
    entry_point! { "light_lists", "emit", [64, 1, 1], SOURCE, Constants => Emit, EmitProgram {
        1 part: Uniform<'a, crate::stages::light_lists::LightPart>,
        11 given: Read<'a, u32>,
        13 marks: Read<'a, u32>,
        14 offsets: Read<'a, u32>,
        15 lists: Write<'a, u32>,
        16 need: Write<'a, u32>,
    } }
    subset! { Mark => Begin { part, lists } }
    subset! { Emit => Begin { part, lists } }
    entries! {
        Share, ShareCentres, Begin, Mark, Emit,
    }
}

/// `kernels/map_moments.wgsl`.
pub mod map_moments {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/raster/front_split", "shared/raster/moments",
        "map_moments",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, WORKGROUP = 256, TILE = 32, HALF = 16, LEVELS = 5,
    }
    overrides! {
        layers: u32 = 0, "LAYERS",
        terms: u32 = 0, "TERMS",
        first: u32 = 0, "FIRST",
        warp: f32 = 0.0, "WARP",
        four: u32 = 0, "FOUR",
    }
    entry_point! { "map_moments", "reduce", [256, 1, 1], SOURCE, Constants => Reduce, ReduceProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 levels: Uniform<'a, crate::stages::map_moments::MapLevels>,
        2 nearest_keys: Read<'a, u32>,
        3 moments: Write<'a, [f32; 2]>,
    } }
    entries! {
        Reduce,
    }
}

/// `kernels/moment_shadows.wgsl`.
pub mod moment_shadows {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "shared/raster/front_split", "shared/raster/moments", "moment_shadows",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, QUERY_DEPTHS = 0, QUERY_MEAN = 1, QUERY_BOTH = 2, QUERY_FOUR = 3,
        QUERY_LAYERS = 4, QUERY_WAVES = 5, MOST_PROBES = 16, WORKGROUP = 64,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        layers: u32 = 0, "LAYERS",
        terms: u32 = 0, "TERMS",
        bias_constant: f32 = 5e-5, "BIAS_CONSTANT",
        bleeding: f32 = 0.0, "BLEEDING",
        grazing: f32 = 0.0, "GRAZING",
        query: u32 = 0, "QUERY",
        exponent: f32 = 0.0, "EXPONENT",
        ringing: f32 = 1.0, "RINGING",
        flattest: f32 = 0.001, "FLATTEST",
    }
    entry_point! { "moment_shadows", "filter_moments", [64, 1, 1], SOURCE, Constants => FilterMoments, FilterMomentsProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 levels: Uniform<'a, crate::stages::map_moments::MapLevels>,
        3 id_keys: Read<'a, u32>,
        4 triangles: Read<'a, [u32; 4]>,
        5 points: Read<'a, [f32; 4]>,
        6 nearest_keys: Read<'a, u32>,
        7 moments: Read<'a, [f32; 2]>,
        8 visibility: Write<'a, f32>,
    } }
    entries! {
        FilterMoments,
    }
}

/// `kernels/page_casters.wgsl`.
pub mod page_casters {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/raster/rect",
        "shared/raster/work_items", "shared/raster/front_split", "shared/raster/flat_caster", "shared/raster/span",
        "shared/raster/block_bits", "shared/raster/undivided", "shared/frame/facing", "shared/alpha",
        "shared/roles", "shared/raster/hole", "shared/raster/front_fan", "shared/raster/page_tree",
        "shared/raster/summed_area", "shared/frame/frame_copy", "page_casters",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, BLOCK = 8, BLOCK_SHIFT = 3, STRIDE = 8, HEAD = 5, OWNERS = 64, FRONT = 0, BACK = 1,
        UNSURE = 2, DROPPED = 3, ALPHA_BILINEAR = 1, ALPHA_WRAP_X = 1, ALPHA_WRAP_Y = 3, ROLE_UNSEEN = 65536,
        PAGE = 32, PAGE_SHIFT = 5, PAGE_TEXELS = 1024, WORKGROUP = 64,
    }
    overrides! {
        alpha: u32 = 0, "ALPHA",
        page_base: u32 = 3, "PAGE_BASE",
        page_last: u32 = 8, "PAGE_LAST",
        budget: u32 = 64, "BUDGET",
    }
    entry_point! { "page_casters", "count", [64, 1, 1], SOURCE, Constants => Count, CountProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 triangles: Read<'a, [u32; 4]>,
        2 map_points: Read<'a, [f32; 4]>,
        3 light_rects: Read<'a, [u32; 2]>,
        4 masks: Read<'a, u32>,
        5 sat: Read<'a, u32>,
        6 page_rects: Write<'a, [u32; 2]>,
        7 page_items: Write<'a, u32>,
    } }
    entry_point! { "page_casters", "raster", [64, 1, 1], SOURCE, Constants => Raster, RasterProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 triangles: Read<'a, [u32; 4]>,
        2 map_points: Read<'a, [f32; 4]>,
        4 masks: Read<'a, u32>,
        5 sat: Read<'a, u32>,
        8 boxes: Read<'a, [u32; 2]>,
        9 work_offsets: Read<'a, u32>,
        10 table: Read<'a, u32>,
        11 pages: Write<'a, u32>,
    } }
    entries! {
        Count, Raster,
    }
}

/// `kernels/page_query.wgsl`.
pub mod page_query {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "shared/raster/page_tree", "page_query",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, PAGE = 32, PAGE_SHIFT = 5, PAGE_TEXELS = 1024, WORKGROUP = 64, THIRDS = 3,
        TABLE_TAIL = 2,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        page_base: u32 = 3, "PAGE_BASE",
        page_last: u32 = 8, "PAGE_LAST",
        bias_constant: f32 = 2e-5, "BIAS_CONSTANT",
        bias_slope: f32 = 1.0, "BIAS_SLOPE",
    }
    entry_point! { "page_query", "compare", [64, 1, 1], SOURCE, Constants => Compare, CompareProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 id_keys: Read<'a, u32>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        5 levels: Read<'a, u32>,
        6 table: Read<'a, u32>,
        7 pages: Read<'a, u32>,
        8 visibility: Write<'a, f32>,
    } }
    entries! {
        Compare,
    }
}

/// `kernels/page_refinement.wgsl`.
pub mod page_refinement {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "shared/facet/map_footprint", "shared/raster/page_tree", "shared/facet/page_asked",
        "shared/frame/pass", "page_refinement",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, PAGE = 32, PAGE_SHIFT = 5, PAGE_TEXELS = 1024, THIRDS = 3, WORKGROUP = 64,
        CLASSES = 128,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        page_base: u32 = 3, "PAGE_BASE",
        page_last: u32 = 8, "PAGE_LAST",
        finer: u32 = 0, "FINER",
        first: u32 = 0, "FIRST",
        changed: u32 = 1, "CHANGED",
        budget: u32 = 64, "BUDGET",
        bias_constant: f32 = 2e-5, "BIAS_CONSTANT",
        bias_slope: f32 = 1.0, "BIAS_SLOPE",
    }
    entry_point! { "page_refinement", "ask", [64, 1, 1], SOURCE, Constants => Ask, AskProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        3 id_keys: Read<'a, u32>,
        4 triangles: Read<'a, [u32; 4]>,
        5 points: Read<'a, [f32; 4]>,
        6 requests: Write<'a, u32>,
        7 levels: Write<'a, u32>,
        8 changes: Write<'a, u32>,
    } }
    entry_point! { "page_refinement", "choose", [64, 1, 1], SOURCE, Constants => Choose, ChooseProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        6 requests: Write<'a, u32>,
        9 flags: Write<'a, u32>,
        10 masks: Write<'a, u32>,
        11 totals: Write<'a, u32>,
    } }
    entry_point! { "page_refinement", "compare", [64, 1, 1], SOURCE, Constants => Compare, CompareProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        3 id_keys: Read<'a, u32>,
        4 triangles: Read<'a, [u32; 4]>,
        5 points: Read<'a, [f32; 4]>,
        7 levels: Write<'a, u32>,
        8 changes: Write<'a, u32>,
        12 table: Read<'a, u32>,
        13 pages: Read<'a, u32>,
        14 visibility: Write<'a, f32>,
    } }
    entries! {
        Ask, Choose, Compare,
    }
}

/// `kernels/page_requests.wgsl`.
pub mod page_requests {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "shared/facet/map_footprint", "shared/raster/page_tree", "shared/facet/page_asked",
        "shared/raster/summed_area", "page_requests",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, PAGE = 32, PAGE_SHIFT = 5, PAGE_TEXELS = 1024, THIRDS = 3, WORKGROUP = 64,
        REQUEST_HEAD = 32, TABLE_TAIL = 2, MOST_CELLS = 5, WEIGHTS = 31, EDGE_WEIGHT = 8,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        page_base: u32 = 3, "PAGE_BASE",
        page_last: u32 = 8, "PAGE_LAST",
        finer: u32 = 0, "FINER",
        fitted: u32 = 0, "FITTED",
        tiled: u32 = 0, "TILED",
        edges: u32 = 0, "EDGES",
        budget: u32 = 64, "BUDGET",
    }
    entry_point! { "page_requests", "request", [64, 1, 1], SOURCE, Constants => Request, RequestProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 id_keys: Read<'a, u32>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        5 requests: Write<'a, u32>,
        6 levels: Write<'a, u32>,
        10 sat: Read<'a, u32>,
    } }
    entry_point! { "page_requests", "weigh", [64, 1, 1], SOURCE, Constants => Weigh, WeighProgram {
        5 requests: Write<'a, u32>,
    } }
    entry_point! { "page_requests", "fit", [64, 1, 1], SOURCE, Constants => Fit, FitProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 id_keys: Read<'a, u32>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        5 requests: Write<'a, u32>,
        6 levels: Write<'a, u32>,
    } }
    entry_point! { "page_requests", "spread", [64, 1, 1], SOURCE, Constants => Spread, SpreadProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        5 requests: Write<'a, u32>,
    } }
    entry_point! { "page_requests", "choose", [64, 1, 1], SOURCE, Constants => Choose, ChooseProgram {
        5 requests: Write<'a, u32>,
        7 flags: Write<'a, u32>,
        8 masks: Write<'a, u32>,
        9 table: Write<'a, u32>,
    } }
    subset! { Request => Weigh { requests } }
    subset! { Request => Fit { frame, id_keys, triangles, points, requests, levels } }
    subset! { Request => Spread { frame, requests } }
    subset! { Fit => Weigh { requests } }
    subset! { Fit => Spread { frame, requests } }
    subset! { Spread => Weigh { requests } }
    subset! { Choose => Weigh { requests } }
    entries! {
        Request, Weigh, Fit, Spread, Choose,
    }
}

/// `kernels/paraboloid_casters.wgsl`.
pub mod paraboloid_casters {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/raster/rect",
        "shared/raster/work_items", "shared/raster/front_split", "shared/frame/facing", "shared/alpha",
        "shared/roles", "shared/raster/paraboloid", "shared/frame/mapped_view", "shared/frame/frame_copy",
        "paraboloid_casters",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, BLOCK = 8, BLOCK_SHIFT = 3, STRIDE = 8, HEAD = 5, OWNERS = 64, FRONT = 0, BACK = 1,
        UNSURE = 2, DROPPED = 3, ALPHA_BILINEAR = 1, ALPHA_WRAP_X = 1, ALPHA_WRAP_Y = 3, ROLE_UNSEEN = 65536,
        WORKGROUP = 64,
    }
    overrides! {
        alpha: u32 = 0, "ALPHA",
        paraboloids: u32 = 1, "PARABOLOIDS",
    }
    entry_point! { "paraboloid_casters", "count", [64, 1, 1], SOURCE, Constants => Count, CountProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 triangles: Read<'a, [u32; 4]>,
        2 points: Read<'a, [f32; 4]>,
        3 curved_rects: Write<'a, [u32; 2]>,
        4 curved_items: Write<'a, u32>,
    } }
    entry_point! { "paraboloid_casters", "raster", [64, 1, 1], SOURCE, Constants => Raster, RasterProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 triangles: Read<'a, [u32; 4]>,
        2 points: Read<'a, [f32; 4]>,
        5 boxes: Read<'a, [u32; 2]>,
        6 work_offsets: Read<'a, u32>,
        7 nearest_keys: Write<'a, u32>,
    } }
    entries! {
        Count, Raster,
    }
}

/// `kernels/pixel_counts.wgsl`.
pub mod pixel_counts {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/frame/pixel_ray",
        "shared/facet/facet", "shared/raster/candidates", "pixel_counts",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FACET_ALONE = 16777216, FACET_AWAY = 33554432, STATE_EMPTY = 0, STATE_DARK = 1,
        STATE_LIT = 2, STATE_SHADOWED = 3, STATE_UNDECIDED = 4, STATE_MERGED = 5, STATE_BITS = 7, WAS_SETTLED = 16,
        WAS_HELD = 32, WAS_MERGED = 8, SEEN = 65536, TALLY_PAIRS = 0, TALLY_CANDIDATES = 1, TALLY_DOUBTS = 2,
        TALLY_LONGEST = 3, TALLY_CUTS = 4, TALLY_TESTS = 5, WORKGROUP = 64,
    }
    overrides! {
        tile_shift: u32 = 1, "TILE_SHIFT",
    }
    entry_point! { "pixel_counts", "count_pairs", [64, 1, 1], SOURCE, Constants => CountPairs, CountPairsProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        3 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        4 pairs: Read<'a, [u32; 2]>,
        5 candidates: Write<'a, u32>,
        7 counts: Write<'a, crate::stages::pixel_counts::PixelCounts>,
    } }
    entry_point! { "pixel_counts", "count_candidates", [64, 1, 1], SOURCE, Constants => CountCandidates, CountCandidatesProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        3 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        5 candidates: Write<'a, u32>,
        7 counts: Write<'a, crate::stages::pixel_counts::PixelCounts>,
    } }
    entry_point! { "pixel_counts", "count_facets", [64, 1, 1], SOURCE, Constants => CountFacets, CountFacetsProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 facets: Read<'a, crate::stages::facet_classify::Facet>,
        2 pixel_facets: Read<'a, u32>,
        7 counts: Write<'a, crate::stages::pixel_counts::PixelCounts>,
    } }
    entry_point! { "pixel_counts", "count_classes", [64, 1, 1], SOURCE, Constants => CountClasses, CountClassesProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        6 classes: Read<'a, u32>,
        7 counts: Write<'a, crate::stages::pixel_counts::PixelCounts>,
    } }
    subset! { CountPairs => CountCandidates { frame, undecided, candidates, counts } }
    entries! {
        CountPairs, CountCandidates, CountFacets, CountClasses,
    }
}

/// `kernels/pixel_coverage.wgsl`.
pub mod pixel_coverage {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/frame/pixel_ray",
        "shared/frame/facing", "shared/math/double_float", "shared/frame/vertex", "shared/frame/facing_46",
        "shared/facet/eye_edges", "shared/frame/near_distance", "shared/facet/eye_order_46",
        "shared/facet/eye_view", "shared/alpha", "shared/raster/pixel_pair", "shared/raster/covering",
        "shared/math/word_masks", "shared/frame/frame_copy", "shared/frame/sample_copy", "shared/frame/mapped_view",
        "pixel_coverage/covered_samples", "pixel_coverage",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ALPHA_BILINEAR = 1, ALPHA_WRAP_X = 1,
        ALPHA_WRAP_Y = 3, WORKGROUP = 64,
    }
    overrides! {
        alpha: u32 = 0, "ALPHA",
        samples: u32 = 32, "SAMPLES",
        words: u32 = 1, "WORDS",
    }
    entry_point! { "pixel_coverage", "cover", [64, 1, 1], SOURCE, Constants => Cover, CoverProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 triangles: Read<'a, [u32; 4]>,
        3 points: Read<'a, [f32; 4]>,
        4 positions: Read<'a, [f32; 4]>,
        5 pixel_offsets: Read<'a, u32>,
        6 pixel_list: Read<'a, crate::stages::pixel_triangles::PixelPair>,
        7 pixel_counts: Write<'a, u32>,
        8 coverings: Write<'a, crate::stages::pixel_coverage::Covering>,
        9 covering_masks: Write<'a, u32>,
    } }
    entries! {
        Cover,
    }
}

/// `kernels/pixel_filter.wgsl`.
pub mod pixel_filter {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "pixel_filter",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, WORKGROUP = 64, NOWHERE = 4294967295,
    }
    overrides! {
        words: u32 = 1, "WORDS",
        reach: u32 = 1, "REACH",
    }
    entry_point! { "pixel_filter", "pixel_filter", [64, 1, 1], SOURCE, Constants => PixelFilter, PixelFilterProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 lit: Read<'a, u32>,
        2 seen: Read<'a, u32>,
        3 weights: Read<'a, f32>,
        4 visibility: Write<'a, f32>,
    } }
    entries! {
        PixelFilter,
    }
}

/// `kernels/pixel_receivers.wgsl`.
pub mod pixel_receivers {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/frame/strip",
        "shared/frame/facing", "shared/math/finite", "shared/frame/vertex", "shared/raster/rect",
        "shared/raster/work_items", "shared/alpha", "shared/frame/mapped_view", "shared/frame/given_place",
        "pixel_receivers/receiver_triangle", "pixel_receivers",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, BLOCK = 8, BLOCK_SHIFT = 3, STRIDE = 8,
        HEAD = 5, OWNERS = 64, ALPHA_BILINEAR = 1, ALPHA_WRAP_X = 1, ALPHA_WRAP_Y = 3, GIVEN_POSITIONS = 1,
        GIVEN_NORMALS = 2, GIVEN_IDS = 4, GIVEN_SAMPLES = 8, GIVEN_NORMAL_SAMPLES = 16, NOTHING = 0, SURFACE = 1,
        FAULT = 2, WORKGROUP = 64, FAULT_UNKNOWN = 2, FAULT_UNUSABLE = 3, OPEN = 4294967295, CLAIMED = 1073741824,
        MOST_STEPS = 4,
    }
    overrides! {
        alpha: u32 = 0, "ALPHA",
    }
    entry_point! { "pixel_receivers", "find", [64, 1, 1], SOURCE, Constants => Find, FindProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::pixel_receivers::PixelReceiversParams>,
        2 place: TextureFloat<'a>,
        6 id_keys: Read<'a, u32>,
        8 positions: Write<'a, [f32; 4]>,
        11 claims: Write<'a, u32>,
        14 triangles: Read<'a, [u32; 4]>,
        15 place_samples: TextureFloatSamples<'a>,
    } }
    entry_point! { "pixel_receivers", "claim", [64, 1, 1], SOURCE, Constants => Claim, ClaimProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::pixel_receivers::PixelReceiversParams>,
        2 place: TextureFloat<'a>,
        8 positions: Write<'a, [f32; 4]>,
        11 claims: Write<'a, u32>,
        12 camera_rects: Read<'a, [u32; 2]>,
        13 work_offsets: Read<'a, u32>,
        14 triangles: Read<'a, [u32; 4]>,
        15 place_samples: TextureFloatSamples<'a>,
    } }
    entry_point! { "pixel_receivers", "take", [64, 1, 1], SOURCE, Constants => Take, TakeProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::pixel_receivers::PixelReceiversParams>,
        2 place: TextureFloat<'a>,
        3 normals: TextureFloat<'a>,
        4 ids: TextureUint<'a>,
        5 numbers: Read<'a, u32>,
        7 made_triangles: Write<'a, [u32; 4]>,
        8 positions: Write<'a, [f32; 4]>,
        9 keys: Write<'a, u32>,
        10 faults: Write<'a, u32>,
        11 claims: Write<'a, u32>,
        15 place_samples: TextureFloatSamples<'a>,
        16 normal_samples: TextureFloatSamples<'a>,
    } }
    entries! {
        Find, Claim, Take,
    }
}

/// `kernels/pixel_texel_pairs.wgsl`.
pub mod pixel_texel_pairs {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/pass", "shared/math/divide",
        "shared/raster/rect", "shared/raster/work_items", "shared/frame/pixel_ray", "shared/facet/facet",
        "shared/frame/from_lamp", "shared/facet/facet_outline", "shared/frame/facing", "shared/raster/front_split",
        "shared/facet/only_receiver", "shared/raster/block_bits", "shared/raster/places", "shared/raster/append",
        "shared/raster/map_ends", "shared/frame/frame_copy", "pixel_texel_pairs",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, BLOCK = 8, BLOCK_SHIFT = 3, STRIDE = 8, HEAD = 5, OWNERS = 64, FACET_ALONE = 16777216,
        FACET_AWAY = 33554432, STATE_EMPTY = 0, STATE_DARK = 1, STATE_LIT = 2, STATE_SHADOWED = 3,
        STATE_UNDECIDED = 4, STATE_MERGED = 5, STATE_BITS = 7, WAS_SETTLED = 16, WAS_HELD = 32, WAS_MERGED = 8,
        FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, MOST_SPLITS = 256, WORKGROUP = 64,
    }
    overrides! {
        tile_shift: u32 = 0, "TILE_SHIFT",
    }
    entry_point! { "pixel_texel_pairs", "count", [64, 1, 1], SOURCE, Constants => Count, CountProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        2 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        3 work_offsets: Read<'a, u32>,
        4 splits: Read<'a, f32>,
        5 place_counts: Write<'a, u32>,
        6 place_deepest: Write<'a, u32>,
        12 touched: Write<'a, [u32; 2]>,
    } }
    entry_point! { "pixel_texel_pairs", "emit", [64, 1, 1], SOURCE, Constants => Emit, EmitProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        2 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        3 work_offsets: Read<'a, u32>,
        5 place_counts: Write<'a, u32>,
        7 pair_offsets: Read<'a, u32>,
        8 pairs: Write<'a, [u32; 2]>,
        12 touched: Write<'a, [u32; 2]>,
    } }
    entry_point! { "pixel_texel_pairs", "emit_rest", [64, 1, 1], SOURCE, Constants => EmitRest, EmitRestProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        2 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        3 work_offsets: Read<'a, u32>,
        4 splits: Read<'a, f32>,
        5 place_counts: Write<'a, u32>,
        7 pair_offsets: Read<'a, u32>,
        8 pairs: Write<'a, [u32; 2]>,
    } }
    entry_point! { "pixel_texel_pairs", "append", [64, 1, 1], SOURCE, Constants => Append, AppendProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        3 work_offsets: Read<'a, u32>,
        4 splits: Read<'a, f32>,
        6 place_deepest: Write<'a, u32>,
        9 appended: Write<'a, u32>,
        10 keys: Write<'a, u32>,
        11 values: Write<'a, u32>,
    } }
    group! { Pairs {
        work_offsets: Read<'a, u32>,
        splits: Read<'a, f32>,
        frame: Uniform<'a, crate::frame::Frame>,
        step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        place_counts: Write<'a, u32>,
        place_deepest: Write<'a, u32>,
        pair_offsets: Read<'a, u32>,
        pairs: Write<'a, [u32; 2]>,
        touched: Write<'a, [u32; 2]>,
    } }
    subset! { Pairs => Count { frame, step, undecided, work_offsets, splits, place_counts, place_deepest, touched } }
    subset! { Pairs => Emit { frame, step, undecided, work_offsets, place_counts, pair_offsets, pairs, touched } }
    subset! { Pairs => EmitRest { frame, step, undecided, work_offsets, splits, place_counts, pair_offsets, pairs } }
    entries! {
        Count, Emit, EmitRest, Append,
    }
}

/// `kernels/pixel_triangles.wgsl`.
pub mod pixel_triangles {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/status", "shared/frame/pass",
        "shared/math/divide", "shared/raster/rect", "shared/raster/work_items", "shared/frame/facing",
        "shared/facet/eye_edges", "shared/raster/block_bits", "shared/frame/near_distance",
        "pixel_triangles/over_square", "shared/raster/pixel_pair", "pixel_triangles",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, BLOCK = 8, BLOCK_SHIFT = 3, STRIDE = 8, HEAD = 5, OWNERS = 64, FRONT = 0, BACK = 1,
        UNSURE = 2, DROPPED = 3, WORKGROUP = 64,
    }
    entry_point! { "pixel_triangles", "cover", [64, 1, 1], SOURCE, () => Cover, CoverProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 triangles: Read<'a, [u32; 4]>,
        3 points: Read<'a, [f32; 4]>,
        4 camera_rects: Read<'a, [u32; 2]>,
        5 work_offsets: Read<'a, u32>,
        6 cover_keys: Write<'a, u32>,
    } }
    entry_point! { "pixel_triangles", "cover_blocks", [64, 1, 1], SOURCE, () => CoverBlocks, CoverBlocksProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        6 cover_keys: Write<'a, u32>,
    } }
    entry_point! { "pixel_triangles", "count", [64, 1, 1], SOURCE, () => Count, CountProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        2 triangles: Read<'a, [u32; 4]>,
        3 points: Read<'a, [f32; 4]>,
        4 camera_rects: Read<'a, [u32; 2]>,
        5 work_offsets: Read<'a, u32>,
        6 cover_keys: Write<'a, u32>,
        7 pixel_counts: Write<'a, u32>,
        13 touched: Write<'a, [u32; 2]>,
        14 id_keys: Write<'a, u32>,
    } }
    entry_point! { "pixel_triangles", "emit", [64, 1, 1], SOURCE, () => Emit, EmitProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        4 camera_rects: Read<'a, [u32; 2]>,
        5 work_offsets: Read<'a, u32>,
        7 pixel_counts: Write<'a, u32>,
        8 pixel_offsets: Read<'a, u32>,
        9 pixel_list: Write<'a, crate::stages::pixel_triangles::PixelPair>,
        13 touched: Write<'a, [u32; 2]>,
    } }
    entry_point! { "pixel_triangles", "emit_rest", [64, 1, 1], SOURCE, () => EmitRest, EmitRestProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        2 triangles: Read<'a, [u32; 4]>,
        3 points: Read<'a, [f32; 4]>,
        4 camera_rects: Read<'a, [u32; 2]>,
        5 work_offsets: Read<'a, u32>,
        6 cover_keys: Write<'a, u32>,
        7 pixel_counts: Write<'a, u32>,
        8 pixel_offsets: Read<'a, u32>,
        9 pixel_list: Write<'a, crate::stages::pixel_triangles::PixelPair>,
    } }
    entry_point! { "pixel_triangles", "judge", [64, 1, 1], SOURCE, () => Judge, JudgeProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        6 cover_keys: Write<'a, u32>,
        7 pixel_counts: Write<'a, u32>,
        10 complex_flags: Write<'a, u32>,
        11 facet_counts: Write<'a, u32>,
        12 status: Write<'a, u32>,
    } }
    group! { Raster {
        work_offsets: Read<'a, u32>,
        points: Read<'a, [f32; 4]>,
        frame: Uniform<'a, crate::frame::Frame>,
        triangles: Read<'a, [u32; 4]>,
        step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        camera_rects: Read<'a, [u32; 2]>,
        cover_keys: Write<'a, u32>,
        pixel_counts: Write<'a, u32>,
        pixel_offsets: Read<'a, u32>,
        pixel_list: Write<'a, crate::stages::pixel_triangles::PixelPair>,
        touched: Write<'a, [u32; 2]>,
        id_keys: Write<'a, u32>,
    } }
    subset! { Cover => CoverBlocks { frame, cover_keys } }
    subset! { Count => Cover { frame, triangles, points, camera_rects, work_offsets, cover_keys } }
    subset! { Count => CoverBlocks { frame, cover_keys } }
    subset! { EmitRest => Cover { frame, triangles, points, camera_rects, work_offsets, cover_keys } }
    subset! { EmitRest => CoverBlocks { frame, cover_keys } }
    subset! { Judge => CoverBlocks { frame, cover_keys } }
    subset! { Raster => Cover { frame, triangles, points, camera_rects, work_offsets, cover_keys } }
    subset! { Raster => CoverBlocks { frame, cover_keys } }
    subset! { Raster => Count { frame, step, triangles, points, camera_rects, work_offsets, cover_keys, pixel_counts, touched, id_keys } }
    subset! { Raster => Emit { frame, step, camera_rects, work_offsets, pixel_counts, pixel_offsets, pixel_list, touched } }
    subset! { Raster => EmitRest { frame, step, triangles, points, camera_rects, work_offsets, cover_keys, pixel_counts, pixel_offsets, pixel_list } }
    entries! {
        Cover, CoverBlocks, Count, Emit, EmitRest, Judge,
    }
}

/// `kernels/pixel_views.wgsl`.
pub mod pixel_views {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/pass", "shared/frame/facing",
        "shared/frame/from_lamp", "shared/math/divide", "shared/frame/pixel_ray", "shared/roles",
        "shared/raster/paraboloid", "shared/facet/receiver", "shared/facet/view_choice", "pixel_views",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, WORKGROUP = 64,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        reach: f32 = 1.0, "REACH",
        stride: u32 = 1, "STRIDE",
        skip: u32 = 0, "SKIP",
    }
    entry_point! { "pixel_views", "choose", [64, 1, 1], SOURCE, Constants => Choose, ChooseProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 views: Uniform<'a, crate::stages::pixel_views::LightViews>,
        4 id_keys: Read<'a, u32>,
        5 triangles: Read<'a, [u32; 4]>,
        6 points: Read<'a, [f32; 4]>,
        7 view_of: Write<'a, u32>,
    } }
    entry_point! { "pixel_views", "keep", [64, 1, 1], SOURCE, Constants => Keep, KeepProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        4 id_keys: Read<'a, u32>,
        7 view_of: Write<'a, u32>,
        8 view_keys: Write<'a, u32>,
    } }
    entry_point! { "pixel_views", "take", [64, 1, 1], SOURCE, Constants => Take, TakeProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        7 view_of: Write<'a, u32>,
        9 left: Read<'a, u32>,
        10 taken: Write<'a, u32>,
    } }
    entries! {
        Choose, Keep, Take,
    }
}

/// `kernels/polygon_ids.wgsl`.
pub mod polygon_ids {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "shared/facet/beside", "polygon_ids",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, WORKGROUP = 64, NAME = 2147483647,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        lookups: u32 = 1, "LOOKUPS",
    }
    entry_point! { "polygon_ids", "compare", [64, 1, 1], SOURCE, Constants => Compare, CompareProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 id_keys: Read<'a, u32>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        5 triangle_keys: Read<'a, u32>,
        6 surfaces: Read<'a, u32>,
        7 visibility: Write<'a, f32>,
    } }
    entries! {
        Compare,
    }
}

/// `kernels/prefix_scan.wgsl`.
pub mod prefix_scan {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/dispatch", "prefix_scan/workgroup_scan", "prefix_scan",
    }
    constants! {
        WORKGROUP = 64, SIDE = 8, QUADS = 16, BLOCK = 4096, SPINE_CHUNK = 4, SATURATED = 4294967295,
    }
    entry_point! { "prefix_scan", "reduce", [64, 1, 1], SOURCE, () => Reduce, ReduceProgram {
        0 params: Uniform<'a, crate::stages::prefix_scan::PrefixScanParams>,
        1 counts: Read<'a, u32>,
        2 input: Read<'a, [u32; 4]>,
        3 sums: Write<'a, [u32; 2]>,
    } }
    entry_point! { "prefix_scan", "spine", [64, 1, 1], SOURCE, () => Spine, SpineProgram {
        0 params: Uniform<'a, crate::stages::prefix_scan::PrefixScanParams>,
        3 sums: Write<'a, [u32; 2]>,
        5 total: Write<'a, u32>,
    } }
    entry_point! { "prefix_scan", "downsweep", [64, 1, 1], SOURCE, () => Downsweep, DownsweepProgram {
        0 params: Uniform<'a, crate::stages::prefix_scan::PrefixScanParams>,
        1 counts: Read<'a, u32>,
        2 input: Read<'a, [u32; 4]>,
        3 sums: Write<'a, [u32; 2]>,
        4 output: Write<'a, [u32; 4]>,
    } }
    subset! { Downsweep => Reduce { params, counts, input, sums } }
    entries! {
        Reduce, Spine, Downsweep,
    }
}

/// `kernels/radix_sort.wgsl`.
pub mod radix_sort {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/dispatch", "radix_sort",
    }
    constants! {
        WORKGROUP = 64, PAIRS = 64, BLOCK = 4096, DIGIT_BITS = 6, MAX_BINS = 64, COLUMN = 65,
    }
    entry_point! { "radix_sort", "count", [64, 1, 1], SOURCE, () => Count, CountProgram {
        0 params: Uniform<'a, crate::stages::radix_sort::RadixSortParams>,
        1 counts: Read<'a, u32>,
        2 keys_in: Read<'a, [u32; 4]>,
        4 histogram: Write<'a, u32>,
    } }
    entry_point! { "radix_sort", "scatter", [64, 1, 1], SOURCE, () => Scatter, ScatterProgram {
        0 params: Uniform<'a, crate::stages::radix_sort::RadixSortParams>,
        1 counts: Read<'a, u32>,
        2 keys_in: Read<'a, [u32; 4]>,
        3 values_in: Read<'a, [u32; 4]>,
        5 offsets: Read<'a, u32>,
        6 keys_out: Write<'a, u32>,
        7 values_out: Write<'a, u32>,
    } }
    group! { Digits {
        params: Uniform<'a, crate::stages::radix_sort::RadixSortParams>,
        counts: Read<'a, u32>,
        keys_in: Read<'a, [u32; 4]>,
        values_in: Read<'a, [u32; 4]>,
        histogram: Write<'a, u32>,
        offsets: Read<'a, u32>,
        keys_out: Write<'a, u32>,
        values_out: Write<'a, u32>,
    } }
    subset! { Digits => Count { params, counts, keys_in, histogram } }
    subset! { Digits => Scatter { params, counts, keys_in, values_in, offsets, keys_out, values_out } }
    entries! {
        Count, Scatter,
    }
}

/// `kernels/requested_blocks.wgsl`.
pub mod requested_blocks {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/raster/rect",
        "shared/frame/pixel_ray", "shared/facet/facet", "shared/frame/facing", "shared/math/double_float",
        "shared/frame/vertex", "shared/frame/facing_46", "shared/raster/front_split", "shared/facet/only_receiver",
        "shared/frame/from_lamp", "shared/raster/view_sides", "shared/facet/facet_box", "shared/facet/facet_extent",
        "shared/frame/frame_copy", "requested_blocks",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, BLOCK = 8, BLOCK_SHIFT = 3, FACET_ALONE = 16777216, FACET_AWAY = 33554432,
        STATE_EMPTY = 0, STATE_DARK = 1, STATE_LIT = 2, STATE_SHADOWED = 3, STATE_UNDECIDED = 4, STATE_MERGED = 5,
        STATE_BITS = 7, WAS_SETTLED = 16, WAS_HELD = 32, WAS_MERGED = 8, FRONT = 0, BACK = 1, UNSURE = 2,
        DROPPED = 3, MOST_SPLITS = 256, WORKGROUP = 64, MOST_WORDS = 1024,
    }
    overrides! {
        clamped: u32 = 2, "CLAMPED",
        receivers: u32 = 1, "RECEIVERS",
    }
    entry_point! { "requested_blocks", "begin", [1, 1, 1], SOURCE, Constants => Begin, BeginProgram {
        5 requested: Write<'a, u32>,
    } }
    entry_point! { "requested_blocks", "request", [64, 1, 1], SOURCE, Constants => Request, RequestProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 triangles: Read<'a, [u32; 4]>,
        2 positions: Read<'a, [f32; 4]>,
        4 facets: Write<'a, crate::stages::facet_classify::Facet>,
        5 requested: Write<'a, u32>,
    } }
    subset! { Request => Begin { requested } }
    entries! {
        Begin, Request,
    }
}

/// `kernels/resolve.wgsl`.
pub mod resolve {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/status", "shared/math/divide",
        "shared/frame/pixel_ray", "shared/facet/facet", "resolve",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FACET_ALONE = 16777216, FACET_AWAY = 33554432, STATE_EMPTY = 0, STATE_DARK = 1,
        STATE_LIT = 2, STATE_SHADOWED = 3, STATE_UNDECIDED = 4, STATE_MERGED = 5, STATE_BITS = 7, WAS_SETTLED = 16,
        WAS_HELD = 32, WAS_MERGED = 8, WORKGROUP = 64,
    }
    overrides! {
        words: u32 = 1, "WORDS",
    }
    entry_point! { "resolve", "resolve", [64, 1, 1], SOURCE, Constants => Resolve, ResolveProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 facets: Read<'a, crate::stages::facet_classify::Facet>,
        2 masks: Read<'a, u32>,
        3 pixel_facets: Read<'a, u32>,
        4 visibility: Write<'a, f32>,
        5 lit: Write<'a, u32>,
        6 status: Write<'a, u32>,
    } }
    entry_point! { "resolve", "seen_samples", [64, 1, 1], SOURCE, Constants => SeenSamples, SeenSamplesProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 facets: Read<'a, crate::stages::facet_classify::Facet>,
        2 masks: Read<'a, u32>,
        3 pixel_facets: Read<'a, u32>,
        7 seen: Write<'a, u32>,
    } }
    entries! {
        Resolve, SeenSamples,
    }
}

/// `kernels/sample_bins.wgsl`.
pub mod sample_bins {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/pass", "shared/math/divide",
        "shared/raster/rect", "shared/raster/work_items", "shared/raster/undivided", "shared/raster/conservative",
        "shared/raster/span", "shared/frame/pixel_ray", "shared/facet/facet", "shared/frame/facing",
        "shared/math/double_float", "shared/frame/vertex", "shared/frame/facing_46", "shared/raster/map_ends",
        "shared/frame/from_lamp", "shared/frame/frame_copy", "shared/lines/shadow_lines",
        "shared/lines/shadow_lines_46", "shared/alpha", "shared/roles", "shared/lines/shadow_ray",
        "sample_bins/mesh_caster", "sample_bins/bin_tests", "sample_bins",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, BLOCK = 8, BLOCK_SHIFT = 3, STRIDE = 8, HEAD = 5, OWNERS = 64, FACET_ALONE = 16777216,
        FACET_AWAY = 33554432, STATE_EMPTY = 0, STATE_DARK = 1, STATE_LIT = 2, STATE_SHADOWED = 3,
        STATE_UNDECIDED = 4, STATE_MERGED = 5, STATE_BITS = 7, WAS_SETTLED = 16, WAS_HELD = 32, WAS_MERGED = 8,
        FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ALPHA_BILINEAR = 1, ALPHA_WRAP_X = 1, ALPHA_WRAP_Y = 3,
        ROLE_UNSEEN = 65536, FREE = 0, BLOCKED = 1, DOUBTFUL = 2, CROWD = 2048, WORKGROUP = 64, LANES = 8,
        MOST_SAMPLES = 2097152,
    }
    overrides! {
        alpha: u32 = 0, "ALPHA",
        words: u32 = 1, "WORDS",
    }
    entry_point! { "sample_bins", "bin", [64, 1, 1], SOURCE, Constants => Bin, BinProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        3 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        4 triangles: Read<'a, [u32; 4]>,
        6 masks: Write<'a, u32>,
        7 texel_ends: Write<'a, u32>,
        8 bins: Write<'a, [u32; 4]>,
        11 listed: Read<'a, u32>,
        12 listed_total: Read<'a, u32>,
    } }
    entry_point! { "sample_bins", "ask", [1, 1, 1], SOURCE, Constants => Ask, AskProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        7 texel_ends: Write<'a, u32>,
        8 bins: Write<'a, [u32; 4]>,
        10 work_offsets: Read<'a, u32>,
        13 wanted: Write<'a, u32>,
    } }
    entry_point! { "sample_bins", "occlude", [64, 1, 1], SOURCE, Constants => Occlude, OccludeProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        3 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        4 triangles: Read<'a, [u32; 4]>,
        5 positions: Read<'a, [f32; 4]>,
        6 masks: Write<'a, u32>,
        7 texel_ends: Write<'a, u32>,
        8 bins: Write<'a, [u32; 4]>,
        9 light_rects: Read<'a, [u32; 2]>,
        10 work_offsets: Read<'a, u32>,
    } }
    entry_point! { "sample_bins", "occlude_crowds", [64, 1, 1], SOURCE, Constants => OccludeCrowds, OccludeCrowdsProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        3 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        4 triangles: Read<'a, [u32; 4]>,
        5 positions: Read<'a, [f32; 4]>,
        6 masks: Write<'a, u32>,
        7 texel_ends: Write<'a, u32>,
        8 bins: Write<'a, [u32; 4]>,
        9 light_rects: Read<'a, [u32; 2]>,
        10 work_offsets: Read<'a, u32>,
    } }
    entry_point! { "sample_bins", "refine", [64, 1, 1], SOURCE, Constants => Refine, RefineProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        3 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        4 triangles: Read<'a, [u32; 4]>,
        5 positions: Read<'a, [f32; 4]>,
        6 masks: Write<'a, u32>,
        7 texel_ends: Write<'a, u32>,
        8 bins: Write<'a, [u32; 4]>,
    } }
    entry_point! { "sample_bins", "refine_all", [64, 1, 1], SOURCE, Constants => RefineAll, RefineAllProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        3 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        4 triangles: Read<'a, [u32; 4]>,
        5 positions: Read<'a, [f32; 4]>,
        6 masks: Write<'a, u32>,
        7 texel_ends: Write<'a, u32>,
        8 bins: Write<'a, [u32; 4]>,
        9 light_rects: Read<'a, [u32; 2]>,
        10 work_offsets: Read<'a, u32>,
    } }
    entry_point! { "sample_bins", "refine_crowds", [64, 1, 1], SOURCE, Constants => RefineCrowds, RefineCrowdsProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        3 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        4 triangles: Read<'a, [u32; 4]>,
        5 positions: Read<'a, [f32; 4]>,
        6 masks: Write<'a, u32>,
        7 texel_ends: Write<'a, u32>,
        8 bins: Write<'a, [u32; 4]>,
        9 light_rects: Read<'a, [u32; 2]>,
        10 work_offsets: Read<'a, u32>,
    } }
    group! { Bins {
        work_offsets: Read<'a, u32>,
        positions: Read<'a, [f32; 4]>,
        frame: Uniform<'a, crate::frame::Frame>,
        undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        triangles: Read<'a, [u32; 4]>,
        samples: Uniform<'a, [f32; 4]>,
        masks: Write<'a, u32>,
        texel_ends: Write<'a, u32>,
        bins: Write<'a, [u32; 4]>,
        step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        light_rects: Read<'a, [u32; 2]>,
        listed: Read<'a, u32>,
        listed_total: Read<'a, u32>,
        wanted: Write<'a, u32>,
    } }
    subset! { Occlude => OccludeCrowds { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { Occlude => Refine { frame, samples, undecided, triangles, positions, masks, texel_ends, bins } }
    subset! { Occlude => RefineAll { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { Occlude => RefineCrowds { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { OccludeCrowds => Occlude { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { OccludeCrowds => Refine { frame, samples, undecided, triangles, positions, masks, texel_ends, bins } }
    subset! { OccludeCrowds => RefineAll { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { OccludeCrowds => RefineCrowds { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { RefineAll => Occlude { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { RefineAll => OccludeCrowds { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { RefineAll => Refine { frame, samples, undecided, triangles, positions, masks, texel_ends, bins } }
    subset! { RefineAll => RefineCrowds { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { RefineCrowds => Occlude { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { RefineCrowds => OccludeCrowds { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { RefineCrowds => Refine { frame, samples, undecided, triangles, positions, masks, texel_ends, bins } }
    subset! { RefineCrowds => RefineAll { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { Bins => Bin { frame, samples, step, undecided, triangles, masks, texel_ends, bins, listed, listed_total } }
    subset! { Bins => Ask { frame, texel_ends, bins, work_offsets, wanted } }
    subset! { Bins => Occlude { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { Bins => OccludeCrowds { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { Bins => Refine { frame, samples, undecided, triangles, positions, masks, texel_ends, bins } }
    subset! { Bins => RefineAll { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    subset! { Bins => RefineCrowds { frame, samples, undecided, triangles, positions, masks, texel_ends, bins, light_rects, work_offsets } }
    entries! {
        Bin, Ask, Occlude, OccludeCrowds, Refine, RefineAll, RefineCrowds,
    }
}

/// `kernels/sample_surfaces.wgsl`.
pub mod sample_surfaces {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/frame/pixel_ray",
        "shared/facet/facet", "shared/frame/facing", "shared/math/double_float", "shared/frame/vertex",
        "shared/frame/facing_46", "shared/facet/eye_edges", "shared/frame/near_distance",
        "shared/facet/eye_order_46", "shared/raster/covering", "shared/math/word_masks", "shared/frame/frame_copy",
        "shared/frame/sample_copy", "sample_surfaces/surface_step", "sample_surfaces/word_offsets",
        "sample_surfaces/pixel_entries", "sample_surfaces/nearest_entry", "sample_surfaces/contested_entry",
        "sample_surfaces/facet_span", "sample_surfaces",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FACET_ALONE = 16777216, FACET_AWAY = 33554432, STATE_EMPTY = 0, STATE_DARK = 1,
        STATE_LIT = 2, STATE_SHADOWED = 3, STATE_UNDECIDED = 4, STATE_MERGED = 5, STATE_BITS = 7, WAS_SETTLED = 16,
        WAS_HELD = 32, WAS_MERGED = 8, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, WORKGROUP = 64,
        SEVERAL = 2147483648,
    }
    overrides! {
        samples: u32 = 32, "SAMPLES",
        words: u32 = 1, "WORDS",
        round_length: u32 = 512, "ROUND_LENGTH",
        merge: u32 = 0, "MERGE",
    }
    entry_point! { "sample_surfaces", "begin", [64, 1, 1], SOURCE, Constants => Begin, BeginProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        5 pixel_offsets: Read<'a, u32>,
        7 complex_pixels: Read<'a, u32>,
        8 complex_total: Read<'a, u32>,
        18 pixel_counts: Write<'a, u32>,
        20 slots: Write<'a, crate::stages::sample_surfaces::PixelSlot>,
    } }
    entry_point! { "sample_surfaces", "nearest", [64, 1, 1], SOURCE, Constants => Nearest, NearestProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 step: Uniform<'a, crate::stages::sample_surfaces::SurfaceStep>,
        6 coverings: Write<'a, crate::stages::pixel_coverage::Covering>,
        10 covering_masks: Write<'a, u32>,
        19 contested: Write<'a, u32>,
        20 slots: Write<'a, crate::stages::sample_surfaces::PixelSlot>,
    } }
    entry_point! { "sample_surfaces", "settle", [64, 1, 1], SOURCE, Constants => Settle, SettleProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 step: Uniform<'a, crate::stages::sample_surfaces::SurfaceStep>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        6 coverings: Write<'a, crate::stages::pixel_coverage::Covering>,
        9 positions: Read<'a, [f32; 4]>,
        10 covering_masks: Write<'a, u32>,
        19 contested: Write<'a, u32>,
        20 slots: Write<'a, crate::stages::sample_surfaces::PixelSlot>,
    } }
    entry_point! { "sample_surfaces", "gather", [64, 1, 1], SOURCE, Constants => Gather, GatherProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 step: Uniform<'a, crate::stages::sample_surfaces::SurfaceStep>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        6 coverings: Write<'a, crate::stages::pixel_coverage::Covering>,
        10 covering_masks: Write<'a, u32>,
        11 facet_counts: Write<'a, u32>,
        17 surfaces: Read<'a, u32>,
        20 slots: Write<'a, crate::stages::sample_surfaces::PixelSlot>,
    } }
    entry_point! { "sample_surfaces", "emit", [64, 1, 1], SOURCE, Constants => Emit, EmitProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        6 coverings: Write<'a, crate::stages::pixel_coverage::Covering>,
        10 covering_masks: Write<'a, u32>,
        13 pixel_facets: Read<'a, u32>,
        14 facets: Write<'a, crate::stages::facet_classify::Facet>,
        15 masks: Write<'a, u32>,
        16 id_keys: Write<'a, u32>,
        17 surfaces: Read<'a, u32>,
        20 slots: Write<'a, crate::stages::sample_surfaces::PixelSlot>,
    } }
    entry_point! { "sample_surfaces", "emit_single", [64, 1, 1], SOURCE, Constants => EmitSingle, EmitSingleProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        12 complex_flags: Read<'a, u32>,
        13 pixel_facets: Read<'a, u32>,
        14 facets: Write<'a, crate::stages::facet_classify::Facet>,
        15 masks: Write<'a, u32>,
        16 id_keys: Write<'a, u32>,
    } }
    group! { Search {
        positions: Read<'a, [f32; 4]>,
        points: Read<'a, [f32; 4]>,
        frame: Uniform<'a, crate::frame::Frame>,
        samples: Uniform<'a, [f32; 4]>,
        step: Uniform<'a, crate::stages::sample_surfaces::SurfaceStep>,
        covering_masks: Write<'a, u32>,
        coverings: Write<'a, crate::stages::pixel_coverage::Covering>,
        triangles: Read<'a, [u32; 4]>,
        contested: Write<'a, u32>,
        slots: Write<'a, crate::stages::sample_surfaces::PixelSlot>,
    } }
    subset! { Settle => Nearest { frame, samples, step, coverings, covering_masks, contested, slots } }
    subset! { Settle => Search { positions, points, frame, samples, step, covering_masks, coverings, triangles, contested, slots } }
    subset! { Search => Nearest { frame, samples, step, coverings, covering_masks, contested, slots } }
    subset! { Search => Settle { frame, samples, step, triangles, points, coverings, positions, covering_masks, contested, slots } }
    entries! {
        Begin, Nearest, Settle, Gather, Emit, EmitSingle,
    }
}

/// `kernels/seen_depths.wgsl`.
pub mod seen_depths {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/math/divide",
        "shared/frame/pixel_ray", "shared/facet/eye_edges", "shared/frame/status", "seen_depths",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, WORKGROUP = 64,
    }
    entry_point! { "seen_depths", "gather", [64, 1, 1], SOURCE, () => Gather, GatherProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 id_keys: Read<'a, u32>,
        2 triangles: Read<'a, [u32; 4]>,
        3 points: Read<'a, [f32; 4]>,
        4 status: Write<'a, u32>,
    } }
    entries! {
        Gather,
    }
}

/// `kernels/seen_texels.wgsl`.
pub mod seen_texels {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "shared/spsm/seen_texels", "shared/math/cross_sign", "shared/spsm/spsm_record",
        "shared/spsm/spsm_sheet", "shared/spsm/spsm_border", "shared/spsm/spsm_footprint",
        "shared/spsm/spsm_settle", "seen_texels",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, SEEN_WON = 0, SEEN_CHOSEN = 1, SEEN_AGAIN = 2, SEEN_LOST = 3, SEEN_MISSED = 4,
        SEEN_BASE = 6, SEEN_BITS = 8, EMPTY_WORD = 4294967295, BEHIND = 0, BEFORE = 1, EITHER = 2, CLASS_EMPTY = 0,
        CLASS_DARK = 1, CLASS_LIT = 2, CLASS_SHADOWED = 3, CLASS_UNCERTAIN = 4, COVERS_ONE = 1, COVERS_TEXEL = 2,
        WORKGROUP = 64,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        encoding: u32 = 1, "ENCODING",
        split: u32 = 1, "SPLIT",
        bias: f32 = 1e-5, "BIAS",
        many: u32 = 1, "MANY",
        radius: i32 = 1, "RADIUS",
        reach: i32 = 0, "REACH",
    }
    entry_point! { "seen_texels", "mark", [64, 1, 1], SOURCE, Constants => Mark, MarkProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 id_keys: Read<'a, u32>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        6 seen: Write<'a, u32>,
    } }
    entry_point! { "seen_texels", "around", [64, 1, 1], SOURCE, Constants => Around, AroundProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 id_keys: Read<'a, u32>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        5 kept: Read<'a, u32>,
        6 seen: Write<'a, u32>,
        7 slopes: Uniform<'a, [f32; 4]>,
        8 upper_records: Read<'a, [u32; 4]>,
        9 lower_records: Read<'a, [u32; 4]>,
    } }
    entry_point! { "seen_texels", "all_texels", [64, 1, 1], SOURCE, Constants => AllTexels, AllTexelsProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        6 seen: Write<'a, u32>,
    } }
    subset! { Mark => AllTexels { frame, seen } }
    subset! { Around => Mark { frame, id_keys, triangles, points, seen } }
    subset! { Around => AllTexels { frame, seen } }
    entries! {
        Mark, Around, AllTexels,
    }
}

/// `kernels/shadow_map.wgsl`.
pub mod shadow_map {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "shadow_map",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, WORKGROUP = 64,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        kernel: u32 = 1, "KERNEL",
        bias_constant: f32 = 2e-5, "BIAS_CONSTANT",
        bias_slope: f32 = 1.0, "BIAS_SLOPE",
        receiver_plane: u32 = 0, "RECEIVER_PLANE",
        taps: u32 = 0, "TAPS",
        turned: u32 = 0, "TURNED",
    }
    entry_point! { "shadow_map", "compare", [64, 1, 1], SOURCE, Constants => Compare, CompareProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 id_keys: Read<'a, u32>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        5 nearest_keys: Read<'a, u32>,
        6 disc: Uniform<'a, [f32; 4]>,
        7 visibility: Write<'a, f32>,
    } }
    entries! {
        Compare,
    }
}

/// `kernels/shadow_rays.wgsl`.
pub mod shadow_rays {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/frame/pixel_ray",
        "shared/facet/facet", "shared/frame/facing", "shared/math/double_float", "shared/frame/vertex",
        "shared/frame/facing_46", "shadow_rays/caster_tree", "shared/frame/frame_copy", "shared/lines/shadow_lines",
        "shared/lines/shadow_lines_46", "shared/alpha", "shared/roles", "shared/lines/shadow_ray",
        "shadow_rays/leaf_caster", "shadow_rays/ray_doubts", "shadow_rays/facet_cut", "shadow_rays",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FACET_ALONE = 16777216, FACET_AWAY = 33554432, STATE_EMPTY = 0, STATE_DARK = 1,
        STATE_LIT = 2, STATE_SHADOWED = 3, STATE_UNDECIDED = 4, STATE_MERGED = 5, STATE_BITS = 7, WAS_SETTLED = 16,
        WAS_HELD = 32, WAS_MERGED = 8, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, STACK = 24, MOST_STEPS = 60000,
        INNER = 4278190080, ALPHA_BILINEAR = 1, ALPHA_WRAP_X = 1, ALPHA_WRAP_Y = 3, ROLE_UNSEEN = 65536, FREE = 0,
        BLOCKED = 1, DOUBTFUL = 2, TESTED = 2147483648, WORK_HEAD = 4, WORKGROUP = 64,
    }
    overrides! {
        alpha: u32 = 0, "ALPHA",
        words: u32 = 1, "WORDS",
    }
    entry_point! { "shadow_rays", "trace", [64, 1, 1], SOURCE, Constants => Trace, TraceProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 tree: Uniform<'a, crate::stages::shadow_rays::TreePlace>,
        3 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        4 listed: Read<'a, u32>,
        5 work: Write<'a, u32>,
        6 nodes: Read<'a, [u32; 4]>,
        7 casters: Read<'a, [f32; 4]>,
        8 triangles: Read<'a, [u32; 4]>,
        9 positions: Read<'a, [f32; 4]>,
        10 masks: Write<'a, u32>,
    } }
    entry_point! { "shadow_rays", "refine", [64, 1, 1], SOURCE, Constants => Refine, RefineProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        3 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        4 listed: Read<'a, u32>,
        5 work: Write<'a, u32>,
        7 casters: Read<'a, [f32; 4]>,
        8 triangles: Read<'a, [u32; 4]>,
        9 positions: Read<'a, [f32; 4]>,
        10 masks: Write<'a, u32>,
    } }
    entry_point! { "shadow_rays", "refine_all", [64, 1, 1], SOURCE, Constants => RefineAll, RefineAllProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 tree: Uniform<'a, crate::stages::shadow_rays::TreePlace>,
        3 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        4 listed: Read<'a, u32>,
        5 work: Write<'a, u32>,
        6 nodes: Read<'a, [u32; 4]>,
        7 casters: Read<'a, [f32; 4]>,
        8 triangles: Read<'a, [u32; 4]>,
        9 positions: Read<'a, [f32; 4]>,
        10 masks: Write<'a, u32>,
    } }
    entry_point! { "shadow_rays", "cut_facets", [64, 1, 1], SOURCE, Constants => CutFacets, CutFacetsProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 tree: Uniform<'a, crate::stages::shadow_rays::TreePlace>,
        3 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        4 listed: Read<'a, u32>,
        5 work: Write<'a, u32>,
        6 nodes: Read<'a, [u32; 4]>,
        7 casters: Read<'a, [f32; 4]>,
        8 triangles: Read<'a, [u32; 4]>,
        9 positions: Read<'a, [f32; 4]>,
        10 masks: Write<'a, u32>,
    } }
    subset! { Trace => Refine { frame, samples, undecided, listed, work, casters, triangles, positions, masks } }
    subset! { Trace => RefineAll { frame, samples, tree, undecided, listed, work, nodes, casters, triangles, positions, masks } }
    subset! { Trace => CutFacets { frame, samples, tree, undecided, listed, work, nodes, casters, triangles, positions, masks } }
    subset! { RefineAll => Trace { frame, samples, tree, undecided, listed, work, nodes, casters, triangles, positions, masks } }
    subset! { RefineAll => Refine { frame, samples, undecided, listed, work, casters, triangles, positions, masks } }
    subset! { RefineAll => CutFacets { frame, samples, tree, undecided, listed, work, nodes, casters, triangles, positions, masks } }
    subset! { CutFacets => Trace { frame, samples, tree, undecided, listed, work, nodes, casters, triangles, positions, masks } }
    subset! { CutFacets => Refine { frame, samples, undecided, listed, work, casters, triangles, positions, masks } }
    subset! { CutFacets => RefineAll { frame, samples, tree, undecided, listed, work, nodes, casters, triangles, positions, masks } }
    entries! {
        Trace, Refine, RefineAll, CutFacets,
    }
}

/// `kernels/silhouette_map.wgsl`.
pub mod silhouette_map {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "silhouette_map",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, WORKGROUP = 64,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        bias_constant: f32 = 5e-5, "BIAS_CONSTANT",
        bias_slope: f32 = 1.05, "BIAS_SLOPE",
    }
    entry_point! { "silhouette_map", "compare", [64, 1, 1], SOURCE, Constants => Compare, CompareProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 id_keys: Read<'a, u32>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        5 nearest_keys: Read<'a, u32>,
        6 point_keys: Read<'a, u32>,
        7 visibility: Write<'a, f32>,
    } }
    entries! {
        Compare,
    }
}

/// `kernels/silhouette_mask.wgsl`.
pub mod silhouette_mask {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/status", "shared/raster/edge",
        "shared/math/divide", "shared/raster/rect", "shared/raster/work_items", "shared/raster/front_split",
        "shared/frame/facing", "shared/raster/span", "shared/raster/block_bits", "shared/raster/mask_rows",
        "shared/raster/requested_part", "shared/raster/clusters", "silhouette_mask",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, BLOCK = 8, BLOCK_SHIFT = 3, STRIDE = 8, HEAD = 5, OWNERS = 64, FRONT = 0, BACK = 1,
        UNSURE = 2, DROPPED = 3, MOST_WORDS = 64, CLUSTER_SIZE = 64, PART_TRIANGLES = 0, PART_EDGES = 1,
        PART_VERTICES = 2, PARTS = 3, KEPT_HEAD = 8, ALL_CLUSTERS = 4294967295, WORKGROUP = 64,
    }
    entry_point! { "silhouette_mask", "classify", [64, 1, 1], SOURCE, () => Classify, ClassifyProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 edges: Read<'a, crate::scene::Edge>,
        2 facing: Read<'a, u32>,
        3 map_points: Read<'a, [f32; 4]>,
        4 edge_rects: Write<'a, [u32; 2]>,
        5 edge_items: Write<'a, u32>,
        10 status: Write<'a, u32>,
        11 requested: Read<'a, u32>,
        12 kept_clusters: Read<'a, u32>,
    } }
    entry_point! { "silhouette_mask", "raster", [64, 1, 1], SOURCE, () => Raster, RasterProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 edges: Read<'a, crate::scene::Edge>,
        3 map_points: Read<'a, [f32; 4]>,
        4 edge_rects: Write<'a, [u32; 2]>,
        6 work_offsets: Read<'a, u32>,
        7 nearest_keys: Read<'a, u32>,
        8 second_keys: Read<'a, u32>,
        9 mask: Write<'a, u32>,
    } }
    entries! {
        Classify, Raster,
    }
}

/// `kernels/silhouette_points.wgsl`.
pub mod silhouette_points {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/raster/edge", "shared/math/divide",
        "shared/raster/rect", "shared/raster/work_items", "shared/raster/front_split", "silhouette_points",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, BLOCK = 8, BLOCK_SHIFT = 3, STRIDE = 8, HEAD = 5, OWNERS = 64, WORKGROUP = 64,
    }
    entry_point! { "silhouette_points", "raster", [64, 1, 1], SOURCE, () => Raster, RasterProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 edges: Read<'a, crate::scene::Edge>,
        2 map_points: Read<'a, [f32; 4]>,
        3 edge_rects: Read<'a, [u32; 2]>,
        4 work_offsets: Read<'a, u32>,
        5 nearest_keys: Read<'a, u32>,
        6 edge_keys: Write<'a, u32>,
        7 point_keys: Write<'a, u32>,
    } }
    entries! {
        Raster,
    }
}

/// `kernels/smsr.wgsl`.
pub mod smsr {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "smsr/map_borders", "smsr",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, WORKGROUP = 64, DARK = 0, LIT = 1, SEVERAL = 2,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        bias_slope: f32 = 0.5, "BIAS_SLOPE",
        reach: u32 = 16, "REACH",
        midpoints: u32 = 1, "MIDPOINTS",
        bias_constant: f32 = 5e-5, "BIAS_CONSTANT",
    }
    entry_point! { "smsr", "revectorize", [64, 1, 1], SOURCE, Constants => Revectorize, RevectorizeProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 id_keys: Read<'a, u32>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        5 nearest_keys: Read<'a, u32>,
        6 visibility: Write<'a, f32>,
    } }
    entries! {
        Revectorize,
    }
}

/// `kernels/sorted_pairs.wgsl`.
pub mod sorted_pairs {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/dispatch", "sorted_pairs",
    }
    constants! {
        WORKGROUP = 64,
    }
    entry_point! { "sorted_pairs", "bounds", [64, 1, 1], SOURCE, () => Bounds, BoundsProgram {
        0 params: Uniform<'a, crate::stages::sorted_pairs::SortedPairsParams>,
        1 counts: Read<'a, u32>,
        2 keys: Read<'a, u32>,
        4 texel_counts: Write<'a, u32>,
    } }
    entry_point! { "sorted_pairs", "join", [64, 1, 1], SOURCE, () => Join, JoinProgram {
        0 params: Uniform<'a, crate::stages::sorted_pairs::SortedPairsParams>,
        1 counts: Read<'a, u32>,
        2 keys: Read<'a, u32>,
        3 values: Read<'a, u32>,
        5 pairs: Write<'a, [u32; 2]>,
    } }
    entries! {
        Bounds, Join,
    }
}

/// `kernels/spsm_map.wgsl`.
pub mod spsm_map {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/dispatch", "spsm_map/keys", "shared/frame/frame", "shared/frame/pass",
        "spsm_map/spsm_bindings", "shared/math/divide", "shared/raster/rect", "shared/raster/work_items",
        "shared/raster/undivided", "shared/raster/conservative", "shared/raster/span", "shared/raster/block_bits",
        "shared/raster/cover_cells", "shared/math/cross_sign", "shared/spsm/spsm_record", "spsm_map/spsm_cut",
        "shared/spsm/seen_texels", "spsm_map/spsm_raster", "spsm_map/spsm_encode", "spsm_map",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, WORKGROUP = 64, BLOCK = 8, BLOCK_SHIFT = 3, STRIDE = 8, HEAD = 5, OWNERS = 64,
        EMPTY_WORD = 4294967295, SEEN_WON = 0, SEEN_CHOSEN = 1, SEEN_AGAIN = 2, SEEN_LOST = 3, SEEN_MISSED = 4,
        SEEN_BASE = 6, SEEN_BITS = 8, PASS_AGAIN = 1, PASS_LAST = 2,
    }
    overrides! {
        encoding: u32 = 1, "ENCODING",
        split: u32 = 1, "SPLIT",
    }
    entry_point! { "spsm_map", "encode", [64, 1, 1], SOURCE, Constants => Encode, EncodeProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        2 slopes: Uniform<'a, [f32; 4]>,
        3 triangles: Read<'a, [u32; 4]>,
        4 map_points: Read<'a, [f32; 4]>,
        7 keys: Write<'a, u32>,
        8 upper_records: Write<'a, [u32; 4]>,
        9 lower_records: Write<'a, [u32; 4]>,
        10 seen: Write<'a, u32>,
    } }
    entry_point! { "spsm_map", "raster", [64, 1, 1], SOURCE, Constants => Raster, RasterProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        3 triangles: Read<'a, [u32; 4]>,
        4 map_points: Read<'a, [f32; 4]>,
        5 light_rects: Read<'a, [u32; 2]>,
        6 work_offsets: Read<'a, u32>,
        7 keys: Write<'a, u32>,
        10 seen: Write<'a, u32>,
        11 won: Write<'a, [u32; 4]>,
    } }
    entry_point! { "spsm_map", "divide", [1, 1, 1], SOURCE, Constants => Divide, DivideProgram {
        10 seen: Write<'a, u32>,
        11 won: Write<'a, [u32; 4]>,
    } }
    entry_point! { "spsm_map", "again", [1, 1, 1], SOURCE, Constants => Again, AgainProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        6 work_offsets: Read<'a, u32>,
        10 seen: Write<'a, u32>,
    } }
    entry_point! { "spsm_map", "choose", [64, 1, 1], SOURCE, Constants => Choose, ChooseProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        3 triangles: Read<'a, [u32; 4]>,
        4 map_points: Read<'a, [f32; 4]>,
        7 keys: Write<'a, u32>,
        10 seen: Write<'a, u32>,
        11 won: Write<'a, [u32; 4]>,
    } }
    group! { Map {
        keys: Write<'a, u32>,
        frame: Uniform<'a, crate::frame::Frame>,
        step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        slopes: Uniform<'a, [f32; 4]>,
        triangles: Read<'a, [u32; 4]>,
        map_points: Read<'a, [f32; 4]>,
        light_rects: Read<'a, [u32; 2]>,
        work_offsets: Read<'a, u32>,
        upper_records: Write<'a, [u32; 4]>,
        lower_records: Write<'a, [u32; 4]>,
        seen: Write<'a, u32>,
        won: Write<'a, [u32; 4]>,
    } }
    subset! { Raster => Divide { seen, won } }
    subset! { Raster => Again { frame, work_offsets, seen } }
    subset! { Raster => Choose { frame, triangles, map_points, keys, seen, won } }
    subset! { Choose => Divide { seen, won } }
    subset! { Map => Encode { frame, step, slopes, triangles, map_points, keys, upper_records, lower_records, seen } }
    subset! { Map => Raster { frame, step, triangles, map_points, light_rects, work_offsets, keys, seen, won } }
    subset! { Map => Divide { seen, won } }
    subset! { Map => Again { frame, work_offsets, seen } }
    subset! { Map => Choose { frame, triangles, map_points, keys, seen, won } }
    entries! {
        Encode, Raster, Divide, Again, Choose,
    }
}

/// `kernels/spsm_map_64.wgsl`.
pub mod spsm_map_64 {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/dispatch", "spsm_map/keys_64", "shared/frame/frame", "shared/frame/pass",
        "spsm_map/spsm_bindings", "shared/math/divide", "shared/raster/rect", "shared/raster/work_items",
        "shared/raster/undivided", "shared/raster/conservative", "shared/raster/span", "shared/raster/block_bits",
        "shared/raster/cover_cells", "shared/math/cross_sign", "shared/spsm/spsm_record", "spsm_map/spsm_cut",
        "shared/spsm/seen_texels", "spsm_map/spsm_raster", "spsm_map/spsm_encode", "spsm_map_64",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, WORKGROUP = 64, BLOCK = 8, BLOCK_SHIFT = 3, STRIDE = 8, HEAD = 5, OWNERS = 64,
        EMPTY_WORD = 4294967295, SEEN_WON = 0, SEEN_CHOSEN = 1, SEEN_AGAIN = 2, SEEN_LOST = 3, SEEN_MISSED = 4,
        SEEN_BASE = 6, SEEN_BITS = 8, PASS_AGAIN = 1, PASS_LAST = 2,
    }
    overrides! {
        encoding: u32 = 1, "ENCODING",
        split: u32 = 1, "SPLIT",
    }
    entry_point! { "spsm_map_64", "encode", [64, 1, 1], SOURCE, Constants => Encode, EncodeProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        2 slopes: Uniform<'a, [f32; 4]>,
        3 triangles: Read<'a, [u32; 4]>,
        4 map_points: Read<'a, [f32; 4]>,
        7 keys: Write<'a, u64>,
        8 upper_records: Write<'a, [u32; 4]>,
        9 lower_records: Write<'a, [u32; 4]>,
        10 seen: Write<'a, u32>,
    } }
    entry_point! { "spsm_map_64", "raster", [64, 1, 1], SOURCE, Constants => Raster, RasterProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        3 triangles: Read<'a, [u32; 4]>,
        4 map_points: Read<'a, [f32; 4]>,
        5 light_rects: Read<'a, [u32; 2]>,
        6 work_offsets: Read<'a, u32>,
        7 keys: Write<'a, u64>,
        10 seen: Write<'a, u32>,
    } }
    group! { Map {
        keys: Write<'a, u64>,
        frame: Uniform<'a, crate::frame::Frame>,
        step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        slopes: Uniform<'a, [f32; 4]>,
        triangles: Read<'a, [u32; 4]>,
        map_points: Read<'a, [f32; 4]>,
        light_rects: Read<'a, [u32; 2]>,
        work_offsets: Read<'a, u32>,
        upper_records: Write<'a, [u32; 4]>,
        lower_records: Write<'a, [u32; 4]>,
        seen: Write<'a, u32>,
    } }
    subset! { Map => Encode { frame, step, slopes, triangles, map_points, keys, upper_records, lower_records, seen } }
    subset! { Map => Raster { frame, step, triangles, map_points, light_rects, work_offsets, keys, seen } }
    entries! {
        Encode, Raster,
    }
}

/// `kernels/spsm_query.wgsl`.
pub mod spsm_query {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/math/cross_sign",
        "shared/spsm/spsm_record", "shared/spsm/seen_texels", "shared/frame/from_lamp", "shared/math/divide",
        "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid", "shared/facet/receiver",
        "shared/spsm/spsm_sheet", "shared/spsm/spsm_border", "spsm_query/spsm_search", "shared/spsm/spsm_footprint",
        "shared/spsm/spsm_settle", "spsm_query/spsm_recovery", "spsm_query",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, EMPTY_WORD = 4294967295, SEEN_WON = 0,
        SEEN_CHOSEN = 1, SEEN_AGAIN = 2, SEEN_LOST = 3, SEEN_MISSED = 4, SEEN_BASE = 6, SEEN_BITS = 8,
        ROLE_UNSEEN = 65536, SEEN_NONE = 0, SEEN_DARK = 1, SEEN_OPEN = 2, BEHIND = 0, BEFORE = 1, EITHER = 2,
        CLASS_EMPTY = 0, CLASS_DARK = 1, CLASS_LIT = 2, CLASS_SHADOWED = 3, CLASS_UNCERTAIN = 4, COVERS_ONE = 1,
        COVERS_TEXEL = 2, WORKGROUP = 64,
    }
    overrides! {
        encoding: u32 = 1, "ENCODING",
        paraboloids: u32 = 1, "PARABOLOIDS",
        split: u32 = 1, "SPLIT",
        bias: f32 = 1e-5, "BIAS",
        radius: i32 = 1, "RADIUS",
        stretch: i32 = 0, "STRETCH",
        many: u32 = 1, "MANY",
        words: u32 = 1, "WORDS",
        recovery: u32 = 1, "RECOVERY",
    }
    entry_point! { "spsm_query", "classify", [64, 1, 1], SOURCE, Constants => Classify, ClassifyProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 slopes: Uniform<'a, [f32; 4]>,
        4 id_keys: Read<'a, u32>,
        5 triangles: Read<'a, [u32; 4]>,
        6 points: Read<'a, [f32; 4]>,
        7 upper_records: Read<'a, [u32; 4]>,
        8 lower_records: Read<'a, [u32; 4]>,
        11 marks: Write<'a, u32>,
        13 seen: Write<'a, u32>,
    } }
    entry_point! { "spsm_query", "settle", [64, 1, 1], SOURCE, Constants => Settle, SettleProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 slopes: Uniform<'a, [f32; 4]>,
        4 id_keys: Read<'a, u32>,
        5 triangles: Read<'a, [u32; 4]>,
        6 points: Read<'a, [f32; 4]>,
        7 upper_records: Read<'a, [u32; 4]>,
        8 lower_records: Read<'a, [u32; 4]>,
        11 marks: Write<'a, u32>,
        12 kept: Read<'a, u32>,
        13 seen: Write<'a, u32>,
    } }
    entry_point! { "spsm_query", "paint", [64, 1, 1], SOURCE, Constants => Paint, PaintProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        9 visibility: Write<'a, f32>,
        10 lit: Write<'a, u32>,
        11 marks: Write<'a, u32>,
    } }
    entry_point! { "spsm_query", "recover", [64, 1, 1], SOURCE, Constants => Recover, RecoverProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 slopes: Uniform<'a, [f32; 4]>,
        3 patterns: Uniform<'a, [u32; 4]>,
        4 id_keys: Read<'a, u32>,
        5 triangles: Read<'a, [u32; 4]>,
        6 points: Read<'a, [f32; 4]>,
        7 upper_records: Read<'a, [u32; 4]>,
        8 lower_records: Read<'a, [u32; 4]>,
        9 visibility: Write<'a, f32>,
        10 lit: Write<'a, u32>,
        13 seen: Write<'a, u32>,
    } }
    group! { Texels {
        frame: Uniform<'a, crate::frame::Frame>,
        slopes: Uniform<'a, [f32; 4]>,
        triangles: Read<'a, [u32; 4]>,
        id_keys: Read<'a, u32>,
        points: Read<'a, [f32; 4]>,
        samples: Uniform<'a, [f32; 4]>,
        seen: Write<'a, u32>,
        upper_records: Read<'a, [u32; 4]>,
        lower_records: Read<'a, [u32; 4]>,
        patterns: Uniform<'a, [u32; 4]>,
        visibility: Write<'a, f32>,
        lit: Write<'a, u32>,
        marks: Write<'a, u32>,
        kept: Read<'a, u32>,
    } }
    subset! { Settle => Classify { frame, slopes, id_keys, triangles, points, upper_records, lower_records, marks, seen } }
    subset! { Texels => Classify { frame, slopes, id_keys, triangles, points, upper_records, lower_records, marks, seen } }
    subset! { Texels => Settle { frame, slopes, id_keys, triangles, points, upper_records, lower_records, marks, kept, seen } }
    subset! { Texels => Paint { frame, visibility, lit, marks } }
    subset! { Texels => Recover { frame, samples, slopes, patterns, id_keys, triangles, points, upper_records, lower_records, visibility, lit, seen } }
    entries! {
        Classify, Settle, Paint, Recover,
    }
}

/// `kernels/summed_area.wgsl`.
pub mod summed_area {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/dispatch", "shared/raster/summed_area", "summed_area",
    }
    constants! {
        WORKGROUP = 64, MAX_STRIP_ROWS = 4096, MAX_SIDE = 16384,
    }
    overrides! {
        packed: bool = true, "PACKED",
    }
    entry_point! { "summed_area", "rows", [64, 1, 1], SOURCE, Constants => Rows, RowsProgram {
        0 params: Uniform<'a, crate::stages::summed_area::SummedAreaParams>,
        1 texels: Read<'a, u32>,
        2 row_sums: Write<'a, u32>,
    } }
    entry_point! { "summed_area", "strips", [64, 1, 1], SOURCE, Constants => Strips, StripsProgram {
        0 params: Uniform<'a, crate::stages::summed_area::SummedAreaParams>,
        1 texels: Read<'a, u32>,
        2 row_sums: Write<'a, u32>,
        3 strip_sums: Write<'a, [u32; 4]>,
    } }
    entry_point! { "summed_area", "columns", [64, 1, 1], SOURCE, Constants => Columns, ColumnsProgram {
        0 params: Uniform<'a, crate::stages::summed_area::SummedAreaParams>,
        1 texels: Read<'a, u32>,
        2 row_sums: Write<'a, u32>,
        3 strip_sums: Write<'a, [u32; 4]>,
        4 sat_quads: Write<'a, [u32; 4]>,
    } }
    entry_point! { "summed_area", "columns_ragged", [64, 1, 1], SOURCE, Constants => ColumnsRagged, ColumnsRaggedProgram {
        0 params: Uniform<'a, crate::stages::summed_area::SummedAreaParams>,
        1 texels: Read<'a, u32>,
        2 row_sums: Write<'a, u32>,
        3 strip_sums: Write<'a, [u32; 4]>,
        4 sat: Write<'a, u32>,
    } }
    entry_point! { "summed_area", "query", [64, 1, 1], SOURCE, Constants => Query, QueryProgram {
        0 params: Uniform<'a, crate::stages::summed_area::SummedAreaParams>,
        4 sat: Write<'a, u32>,
        5 rects: Read<'a, [u32; 4]>,
        6 rect_sums: Write<'a, u32>,
    } }
    subset! { Strips => Rows { params, texels, row_sums } }
    subset! { Columns => Rows { params, texels, row_sums } }
    subset! { Columns => Strips { params, texels, row_sums, strip_sums } }
    subset! { ColumnsRagged => Rows { params, texels, row_sums } }
    subset! { ColumnsRagged => Strips { params, texels, row_sums, strip_sums } }
    entries! {
        Rows, Strips, Columns, ColumnsRagged, Query,
    }
}

/// `kernels/surface_receivers.wgsl`.
pub mod surface_receivers {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/frame/strip",
        "shared/math/finite", "shared/frame/pixel_ray", "shared/frame/vertex", "shared/frame/facing",
        "shared/frame/near_distance", "shared/facet/eye_edges", "shared/facet/eye_view", "shared/frame/given_place",
        "shared/raster/covering", "shared/raster/pixel_pair", "surface_receivers/neighbour_pixels",
        "surface_receivers",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, GIVEN_POSITIONS = 1, GIVEN_NORMALS = 2,
        GIVEN_IDS = 4, GIVEN_SAMPLES = 8, GIVEN_NORMAL_SAMPLES = 16, NOTHING = 0, SURFACE = 1, FAULT = 2, OWN = 12,
        NEXT = 8, AROUND = 24, MOST = 8, NONE = 25, WORKGROUP = 64,
    }
    overrides! {
        words: u32 = 1, "WORDS",
    }
    entry_point! { "surface_receivers", "own", [64, 1, 1], SOURCE, Constants => Own, OwnProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        4 keys: Read<'a, u32>,
        5 positions: Read<'a, [f32; 4]>,
        7 made_points: Write<'a, [f32; 4]>,
        8 cover_keys: Write<'a, u32>,
        9 id_keys: Write<'a, u32>,
        10 pixel_counts: Write<'a, u32>,
        11 chosen: Write<'a, u32>,
    } }
    entry_point! { "surface_receivers", "choose", [64, 1, 1], SOURCE, Constants => Choose, ChooseProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::pixel_receivers::PixelReceiversParams>,
        3 place: TextureFloat<'a>,
        4 keys: Read<'a, u32>,
        6 points: Read<'a, [f32; 4]>,
        8 cover_keys: Write<'a, u32>,
        9 id_keys: Write<'a, u32>,
        10 pixel_counts: Write<'a, u32>,
        11 chosen: Write<'a, u32>,
        18 place_samples: TextureFloatSamples<'a>,
    } }
    entry_point! { "surface_receivers", "list", [64, 1, 1], SOURCE, Constants => List, ListProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        10 pixel_counts: Write<'a, u32>,
        11 chosen: Write<'a, u32>,
        12 pixel_offsets: Read<'a, u32>,
        13 pixel_list: Write<'a, crate::stages::pixel_triangles::PixelPair>,
    } }
    entry_point! { "surface_receivers", "cover", [64, 1, 1], SOURCE, Constants => Cover, CoverProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::pixel_receivers::PixelReceiversParams>,
        2 samples: Uniform<'a, [f32; 4]>,
        3 place: TextureFloat<'a>,
        6 points: Read<'a, [f32; 4]>,
        10 pixel_counts: Write<'a, u32>,
        11 chosen: Write<'a, u32>,
        12 pixel_offsets: Read<'a, u32>,
        14 complex_pixels: Read<'a, u32>,
        15 complex_total: Read<'a, u32>,
        16 coverings: Write<'a, crate::stages::pixel_coverage::Covering>,
        17 covering_masks: Write<'a, u32>,
        18 place_samples: TextureFloatSamples<'a>,
    } }
    entries! {
        Own, Choose, List, Cover,
    }
}

/// `kernels/texel_group.wgsl`.
pub mod texel_group {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/dispatch", "texel_group",
    }
    constants! {
        WORKGROUP = 64, CLEARED = 16, QUAD = 4,
    }
    entry_point! { "texel_group", "clear", [64, 1, 1], SOURCE, () => Clear, ClearProgram {
        5 cleared: Write<'a, [u32; 4]>,
    } }
    entry_point! { "texel_group", "count", [64, 1, 1], SOURCE, () => Count, CountProgram {
        0 params: Uniform<'a, crate::stages::texel_group::TexelGroupParams>,
        1 counts: Read<'a, u32>,
        2 keys: Read<'a, [u32; 4]>,
        4 ranks: Write<'a, [u32; 4]>,
        5 key_counts: Write<'a, u32>,
    } }
    entry_point! { "texel_group", "scatter", [64, 1, 1], SOURCE, () => Scatter, ScatterProgram {
        0 params: Uniform<'a, crate::stages::texel_group::TexelGroupParams>,
        1 counts: Read<'a, u32>,
        2 keys: Read<'a, [u32; 4]>,
        3 values: Read<'a, [u32; 4]>,
        4 ranks: Write<'a, [u32; 4]>,
        6 offsets: Read<'a, u32>,
        7 grouped: Write<'a, u32>,
    } }
    group! { Group {
        params: Uniform<'a, crate::stages::texel_group::TexelGroupParams>,
        counts: Read<'a, u32>,
        keys: Read<'a, [u32; 4]>,
        values: Read<'a, [u32; 4]>,
        ranks: Write<'a, [u32; 4]>,
        key_counts: Write<'a, u32>,
        offsets: Read<'a, u32>,
        grouped: Write<'a, u32>,
    } }
    subset! { Group => Count { params, counts, keys, ranks, key_counts } }
    subset! { Group => Scatter { params, counts, keys, values, ranks, offsets, grouped } }
    entries! {
        Clear, Count, Scatter,
    }
}

/// `kernels/triangle_ids.wgsl`.
pub mod triangle_ids {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/frame/strip", "triangle_ids",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, WORKGROUP = 64, FAULT_UNKNOWN = 2,
    }
    entry_point! { "triangle_ids", "take", [64, 1, 1], SOURCE, () => Take, TakeProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 params: Uniform<'a, crate::stages::triangle_ids::TriangleIdsParams>,
        2 ids: TextureUint<'a>,
        3 numbers: Read<'a, u32>,
        4 id_keys: Write<'a, u32>,
        5 faults: Write<'a, u32>,
    } }
    entries! {
        Take,
    }
}

/// `kernels/triangle_setup.wgsl`.
pub mod triangle_setup {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/raster/rect",
        "shared/frame/facing", "shared/frame/from_lamp", "shared/raster/view_sides", "shared/raster/map_ends",
        "shared/raster/requested_part", "shared/roles", "shared/raster/clusters", "shared/frame/frame_copy",
        "triangle_setup",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, BLOCK = 8, BLOCK_SHIFT = 3, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, MOST_WORDS = 64,
        ROLE_UNSEEN = 65536, CLUSTER_SIZE = 64, PART_TRIANGLES = 0, PART_EDGES = 1, PART_VERTICES = 2, PARTS = 3,
        KEPT_HEAD = 8, ALL_CLUSTERS = 4294967295, WORKGROUP = 64,
    }
    entry_point! { "triangle_setup", "setup_camera", [64, 1, 1], SOURCE, () => SetupCamera, SetupCameraProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 triangles: Read<'a, [u32; 4]>,
        2 points: Read<'a, [f32; 4]>,
        5 camera_rects: Write<'a, [u32; 2]>,
        7 camera_items: Write<'a, u32>,
        10 kept_clusters: Read<'a, u32>,
    } }
    entry_point! { "triangle_setup", "setup_light", [64, 1, 1], SOURCE, () => SetupLight, SetupLightProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 triangles: Read<'a, [u32; 4]>,
        2 points: Read<'a, [f32; 4]>,
        3 map_points: Read<'a, [f32; 4]>,
        4 facing: Write<'a, u32>,
        6 light_rects: Write<'a, [u32; 2]>,
        8 light_items: Write<'a, u32>,
        9 requested: Read<'a, u32>,
        10 kept_clusters: Read<'a, u32>,
    } }
    entries! {
        SetupCamera, SetupLight,
    }
}

/// `kernels/triangle_texel_pairs.wgsl`.
pub mod triangle_texel_pairs {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/pass", "shared/raster/work_items",
        "shared/math/divide", "shared/raster/rect", "shared/raster/undivided", "shared/raster/conservative",
        "shared/raster/span", "shared/raster/block_bits", "shared/raster/cover_cells", "shared/raster/places",
        "shared/raster/tile_cells", "shared/raster/append", "shared/raster/map_ends", "shared/frame/frame_copy",
        "triangle_texel_pairs",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, STRIDE = 8, HEAD = 5, OWNERS = 64, BLOCK = 8, BLOCK_SHIFT = 3, WORKGROUP = 64,
    }
    overrides! {
        tile_shift: u32 = 0, "TILE_SHIFT",
    }
    entry_point! { "triangle_texel_pairs", "count", [64, 1, 1], SOURCE, Constants => Count, CountProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        2 triangles: Read<'a, [u32; 4]>,
        3 map_points: Read<'a, [f32; 4]>,
        4 light_rects: Read<'a, [u32; 2]>,
        5 work_offsets: Read<'a, u32>,
        6 place_deepest: Read<'a, u32>,
        7 place_counts: Write<'a, u32>,
        13 touched: Write<'a, [u32; 2]>,
    } }
    entry_point! { "triangle_texel_pairs", "emit", [64, 1, 1], SOURCE, Constants => Emit, EmitProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        2 triangles: Read<'a, [u32; 4]>,
        3 map_points: Read<'a, [f32; 4]>,
        4 light_rects: Read<'a, [u32; 2]>,
        5 work_offsets: Read<'a, u32>,
        7 place_counts: Write<'a, u32>,
        8 pair_offsets: Read<'a, u32>,
        9 pair_triangles: Write<'a, u32>,
        13 touched: Write<'a, [u32; 2]>,
    } }
    entry_point! { "triangle_texel_pairs", "emit_rest", [64, 1, 1], SOURCE, Constants => EmitRest, EmitRestProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        2 triangles: Read<'a, [u32; 4]>,
        3 map_points: Read<'a, [f32; 4]>,
        4 light_rects: Read<'a, [u32; 2]>,
        5 work_offsets: Read<'a, u32>,
        6 place_deepest: Read<'a, u32>,
        7 place_counts: Write<'a, u32>,
        8 pair_offsets: Read<'a, u32>,
        9 pair_triangles: Write<'a, u32>,
    } }
    entry_point! { "triangle_texel_pairs", "append", [64, 1, 1], SOURCE, Constants => Append, AppendProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 triangles: Read<'a, [u32; 4]>,
        3 map_points: Read<'a, [f32; 4]>,
        4 light_rects: Read<'a, [u32; 2]>,
        5 work_offsets: Read<'a, u32>,
        6 place_deepest: Read<'a, u32>,
        10 appended: Write<'a, u32>,
        11 keys: Write<'a, u32>,
        12 values: Write<'a, u32>,
    } }
    group! { Pairs {
        work_offsets: Read<'a, u32>,
        frame: Uniform<'a, crate::frame::Frame>,
        step: Uniform<'a, crate::stages::camera_visibility::Pass>,
        triangles: Read<'a, [u32; 4]>,
        map_points: Read<'a, [f32; 4]>,
        light_rects: Read<'a, [u32; 2]>,
        place_deepest: Read<'a, u32>,
        place_counts: Write<'a, u32>,
        pair_offsets: Read<'a, u32>,
        pair_triangles: Write<'a, u32>,
        touched: Write<'a, [u32; 2]>,
    } }
    subset! { Pairs => Count { frame, step, triangles, map_points, light_rects, work_offsets, place_deepest, place_counts, touched } }
    subset! { Pairs => Emit { frame, step, triangles, map_points, light_rects, work_offsets, place_counts, pair_offsets, pair_triangles, touched } }
    subset! { Pairs => EmitRest { frame, step, triangles, map_points, light_rects, work_offsets, place_deepest, place_counts, pair_offsets, pair_triangles } }
    entries! {
        Count, Emit, EmitRest, Append,
    }
}

/// `kernels/vertex_project.wgsl`.
pub mod vertex_project {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/finite", "shared/frame/from_lamp",
        "shared/raster/clusters", "shared/frame/frame_copy", "vertex_project",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, CLUSTER_SIZE = 64, PART_TRIANGLES = 0, PART_EDGES = 1, PART_VERTICES = 2, PARTS = 3,
        KEPT_HEAD = 8, ALL_CLUSTERS = 4294967295, WORKGROUP = 64,
    }
    entry_point! { "vertex_project", "place", [64, 1, 1], SOURCE, () => Place, PlaceProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 positions: Read<'a, [f32; 4]>,
        2 points: Write<'a, [f32; 4]>,
    } }
    entry_point! { "vertex_project", "project", [64, 1, 1], SOURCE, () => Project, ProjectProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        2 points: Write<'a, [f32; 4]>,
        3 map_points: Write<'a, [f32; 4]>,
        4 kept_clusters: Read<'a, u32>,
    } }
    entries! {
        Place, Project,
    }
}

/// `kernels/visibility_masks.wgsl`.
pub mod visibility_masks {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/frame/pixel_ray",
        "shared/facet/facet", "shared/frame/facing", "shared/math/double_float", "shared/frame/vertex",
        "shared/frame/facing_46", "shared/raster/candidates", "shared/frame/frame_copy",
        "shared/lines/shadow_lines", "shared/lines/shadow_lines_46", "shared/frame/sample_copy",
        "visibility_masks/sample_masks", "visibility_masks/two_step", "visibility_masks/facet_masks",
        "shared/alpha", "shared/frame/mapped_view", "shared/roles", "visibility_masks/solid_samples",
        "visibility_masks",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FACET_ALONE = 16777216, FACET_AWAY = 33554432, STATE_EMPTY = 0, STATE_DARK = 1,
        STATE_LIT = 2, STATE_SHADOWED = 3, STATE_UNDECIDED = 4, STATE_MERGED = 5, STATE_BITS = 7, WAS_SETTLED = 16,
        WAS_HELD = 32, WAS_MERGED = 8, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, SEEN = 65536, TALLY_PAIRS = 0,
        TALLY_CANDIDATES = 1, TALLY_DOUBTS = 2, TALLY_LONGEST = 3, TALLY_CUTS = 4, TALLY_TESTS = 5,
        ALPHA_BILINEAR = 1, ALPHA_WRAP_X = 1, ALPHA_WRAP_Y = 3, ROLE_UNSEEN = 65536, WORKGROUP = 64,
        CUT_GROUPS = 256,
    }
    overrides! {
        samples: u32 = 32, "SAMPLES",
        words: u32 = 1, "WORDS",
        angles: u32 = 0, "ANGLES",
        offsets: u32 = 0, "OFFSETS",
        cuts: u32 = 1, "CUTS",
        alpha: u32 = 0, "ALPHA",
        two_step: u32 = 0, "TWO_STEP",
    }
    entry_point! { "visibility_masks", "cut_facets", [64, 1, 1], SOURCE, Constants => CutFacets, CutFacetsProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        3 candidates: Write<'a, u32>,
        4 triangles: Read<'a, [u32; 4]>,
        5 positions: Read<'a, [f32; 4]>,
        6 masks: Write<'a, u32>,
        8 table: Read<'a, u32>,
        9 cuts: Write<'a, u32>,
    } }
    entry_point! { "visibility_masks", "evaluate", [64, 1, 1], SOURCE, Constants => Evaluate, EvaluateProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        3 candidates: Write<'a, u32>,
        4 triangles: Read<'a, [u32; 4]>,
        5 positions: Read<'a, [f32; 4]>,
        6 masks: Write<'a, u32>,
        7 doubts: Write<'a, u32>,
        8 table: Read<'a, u32>,
        9 cuts: Write<'a, u32>,
    } }
    entry_point! { "visibility_masks", "refine", [64, 1, 1], SOURCE, Constants => Refine, RefineProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 undecided: Read<'a, crate::stages::facet_classify::Undecided>,
        3 candidates: Write<'a, u32>,
        4 triangles: Read<'a, [u32; 4]>,
        5 positions: Read<'a, [f32; 4]>,
        6 masks: Write<'a, u32>,
        7 doubts: Write<'a, u32>,
        8 table: Read<'a, u32>,
    } }
    subset! { Evaluate => CutFacets { frame, samples, undecided, candidates, triangles, positions, masks, table, cuts } }
    subset! { Evaluate => Refine { frame, samples, undecided, candidates, triangles, positions, masks, doubts, table } }
    entries! {
        CutFacets, Evaluate, Refine,
    }
}

/// `kernels/visibility_texture.wgsl`.
pub mod visibility_texture {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/status", "shared/math/divide",
        "shared/frame/strip", "visibility_texture",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, WORKGROUP = 64,
    }
    overrides! {
        bits: u32 = 32, "BITS",
    }
    entry_point! { "visibility_texture", "judge", [64, 1, 1], SOURCE, Constants => Judge, JudgeProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        3 lists: Uniform<'a, crate::stages::visibility_texture::Lists>,
        4 status: Write<'a, u32>,
        5 faults: Read<'a, u32>,
        6 verdict: Write<'a, u32>,
    } }
    entry_point! { "visibility_texture", "hold", [64, 1, 1], SOURCE, Constants => Hold, HoldProgram {
        6 verdict: Write<'a, u32>,
        7 latest: Read<'a, u32>,
        8 held: Write<'a, u32>,
    } }
    entry_point! { "visibility_texture", "store", [64, 1, 1], SOURCE, Constants => Store, StoreProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 visibility: Read<'a, f32>,
        2 target_texture: TextureStoreR32Float<'a>,
    } }
    entry_point! { "visibility_texture", "pack", [64, 1, 1], SOURCE, Constants => Pack, PackProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 visibility: Read<'a, f32>,
        9 rows: Uniform<'a, crate::stages::visibility_texture::PackedRows>,
        10 packed: Write<'a, u32>,
    } }
    entry_point! { "visibility_texture", "pack_channel", [64, 1, 1], SOURCE, Constants => PackChannel, PackChannelProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 visibility: Read<'a, f32>,
        9 rows: Uniform<'a, crate::stages::visibility_texture::PackedRows>,
        10 packed: Write<'a, u32>,
    } }
    entry_point! { "visibility_texture", "add", [64, 1, 1], SOURCE, Constants => Add, AddProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        11 part: Uniform<'a, crate::stages::visibility_texture::PointShare>,
        12 share: Write<'a, f32>,
        13 sums: Write<'a, f32>,
    } }
    subset! { Pack => PackChannel { frame, visibility, rows, packed } }
    subset! { PackChannel => Pack { frame, visibility, rows, packed } }
    entries! {
        Judge, Hold, Store, Pack, PackChannel, Add,
    }
}

/// `kernels/warped_casters.wgsl`.
pub mod warped_casters {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/math/divide", "shared/raster/rect",
        "shared/raster/work_items", "shared/raster/front_split", "shared/raster/flat_caster",
        "shared/raster/block_bits", "shared/raster/undivided", "shared/frame/facing", "shared/alpha",
        "shared/roles", "shared/raster/hole", "shared/raster/front_fan", "shared/raster/axis_table",
        "shared/frame/frame_copy", "warped_casters",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, BLOCK = 8, BLOCK_SHIFT = 3, STRIDE = 8, HEAD = 5, OWNERS = 64, FRONT = 0, BACK = 1,
        UNSURE = 2, DROPPED = 3, ALPHA_BILINEAR = 1, ALPHA_WRAP_X = 1, ALPHA_WRAP_Y = 3, ROLE_UNSEEN = 65536,
        AXIS_CELLS = 1024, WORKGROUP = 64,
    }
    overrides! {
        alpha: u32 = 0, "ALPHA",
    }
    entry_point! { "warped_casters", "count", [64, 1, 1], SOURCE, Constants => Count, CountProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 triangles: Read<'a, [u32; 4]>,
        2 map_points: Read<'a, [f32; 4]>,
        3 light_rects: Read<'a, [u32; 2]>,
        4 axes: Read<'a, u32>,
        5 borders: Read<'a, f32>,
        6 warped_rects: Write<'a, [u32; 2]>,
        7 warped_items: Write<'a, u32>,
    } }
    entry_point! { "warped_casters", "raster", [64, 1, 1], SOURCE, Constants => Raster, RasterProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 triangles: Read<'a, [u32; 4]>,
        2 map_points: Read<'a, [f32; 4]>,
        5 borders: Read<'a, f32>,
        8 boxes: Read<'a, [u32; 2]>,
        9 work_offsets: Read<'a, u32>,
        10 keys: Write<'a, u32>,
    } }
    entries! {
        Count, Raster,
    }
}

/// `kernels/warped_query.wgsl`.
pub mod warped_query {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/frame", "shared/frame/dispatch", "shared/frame/facing", "shared/frame/from_lamp",
        "shared/math/divide", "shared/frame/pixel_ray", "shared/roles", "shared/raster/paraboloid",
        "shared/facet/receiver", "shared/raster/axis_table", "warped_query",
    }
    constants! {
        FLAG_CULL_BACK = 1, FLAG_VALIDITY = 2, FLAG_PERSPECTIVE = 4, FLAG_ALL_UNDECIDED = 8, FLAG_CLAMP = 16,
        FLAG_BEYOND = 32, FLAG_CLOSED = 64, FLAG_MORE_VIEWS = 128, FLAG_FURTHER_VIEW = 256, FLAG_CUT_LAYERS = 65536,
        FLAG_ENDS = 1024, FLAG_PARABOLOID = 262144, FLAG_MAPPED = 524288, FLAG_NOTHING_CASTS = 16384,
        FLAG_BACKS_HIDDEN = 131072, FLAG_NO_VIEW = 32768, FLAG_ONE_OF_SEVERAL = 512, NO_TRIANGLE = 4294967295,
        FAR = 2139095040, FRONT = 0, BACK = 1, UNSURE = 2, DROPPED = 3, ROLE_UNSEEN = 65536, SEEN_NONE = 0,
        SEEN_DARK = 1, SEEN_OPEN = 2, AXIS_CELLS = 1024, WORKGROUP = 64,
    }
    overrides! {
        paraboloids: u32 = 1, "PARABOLOIDS",
        bias_constant: f32 = 2e-5, "BIAS_CONSTANT",
        bias_slope: f32 = 1.0, "BIAS_SLOPE",
    }
    entry_point! { "warped_query", "compare", [64, 1, 1], SOURCE, Constants => Compare, CompareProgram {
        0 frame: Uniform<'a, crate::frame::Frame>,
        1 samples: Uniform<'a, [f32; 4]>,
        2 id_keys: Read<'a, u32>,
        3 triangles: Read<'a, [u32; 4]>,
        4 points: Read<'a, [f32; 4]>,
        5 axes: Read<'a, u32>,
        6 borders: Read<'a, f32>,
        7 keys: Read<'a, u32>,
        8 visibility: Write<'a, f32>,
    } }
    entries! {
        Compare,
    }
}

/// `kernels/work_owners.wgsl`.
pub mod work_owners {
    use crate::entry_point;
    use crate::gpu::bindings::*;

    source! {
        "shared/frame/dispatch", "shared/raster/work_items", "shared/raster/clusters", "work_owners",
    }
    constants! {
        STRIDE = 8, HEAD = 5, OWNERS = 64, CLUSTER_SIZE = 64, PART_TRIANGLES = 0, PART_EDGES = 1, PART_VERTICES = 2,
        PARTS = 3, KEPT_HEAD = 8, ALL_CLUSTERS = 4294967295, WORKGROUP = 64,
    }
    entry_point! { "work_owners", "list", [64, 1, 1], SOURCE, () => List, ListProgram {
        0 params: Uniform<'a, crate::stages::work_owners::WorkOwnersParams>,
        1 work_offsets: Write<'a, u32>,
        2 kept_clusters: Read<'a, u32>,
    } }
    entry_point! { "work_owners", "list_clusters", [64, 1, 1], SOURCE, () => ListClusters, ListClustersProgram {
        0 params: Uniform<'a, crate::stages::work_owners::WorkOwnersParams>,
        1 work_offsets: Write<'a, u32>,
        2 kept_clusters: Read<'a, u32>,
    } }
    group! { Lists {
        work_offsets: Write<'a, u32>,
        kept_clusters: Read<'a, u32>,
        params: Uniform<'a, crate::stages::work_owners::WorkOwnersParams>,
    } }
    subset! { List => ListClusters { params, work_offsets, kept_clusters } }
    subset! { List => Lists { work_offsets, kept_clusters, params } }
    subset! { ListClusters => List { params, work_offsets, kept_clusters } }
    subset! { ListClusters => Lists { work_offsets, kept_clusters, params } }
    subset! { Lists => List { params, work_offsets, kept_clusters } }
    subset! { Lists => ListClusters { params, work_offsets, kept_clusters } }
    entries! {
        List, ListClusters,
    }
}

/// Stem, text and entry points of every kernel.
pub const ALL: &[(&str, super::Source, &[super::program::Entry])] = &[
    ("axis_density", axis_density::SOURCE, axis_density::ENTRIES),
    ("camera_visibility", camera_visibility::SOURCE, camera_visibility::ENTRIES),
    ("candidate_pairs", candidate_pairs::SOURCE, candidate_pairs::ENTRIES),
    ("caster_positions", caster_positions::SOURCE, caster_positions::ENTRIES),
    ("cluster_bounds", cluster_bounds::SOURCE, cluster_bounds::ENTRIES),
    ("cluster_culling", cluster_culling::SOURCE, cluster_culling::ENTRIES),
    ("compact", compact::SOURCE, compact::ENTRIES),
    ("compared_depths", compared_depths::SOURCE, compared_depths::ENTRIES),
    ("deep_map", deep_map::SOURCE, deep_map::ENTRIES),
    ("deep_shadows", deep_shadows::SOURCE, deep_shadows::ENTRIES),
    ("dispatch_args", dispatch_args::SOURCE, dispatch_args::ENTRIES),
    ("facet_classify", facet_classify::SOURCE, facet_classify::ENTRIES),
    ("front_layer", front_layer::SOURCE, front_layer::ENTRIES),
    ("gbuffer_triangles", gbuffer_triangles::SOURCE, gbuffer_triangles::ENTRIES),
    ("history", history::SOURCE, history::ENTRIES),
    ("instance_positions", instance_positions::SOURCE, instance_positions::ENTRIES),
    ("kept_triangles", kept_triangles::SOURCE, kept_triangles::ENTRIES),
    ("light_layers", light_layers::SOURCE, light_layers::ENTRIES),
    ("light_lists", light_lists::SOURCE, light_lists::ENTRIES),
    ("map_moments", map_moments::SOURCE, map_moments::ENTRIES),
    ("moment_shadows", moment_shadows::SOURCE, moment_shadows::ENTRIES),
    ("page_casters", page_casters::SOURCE, page_casters::ENTRIES),
    ("page_query", page_query::SOURCE, page_query::ENTRIES),
    ("page_refinement", page_refinement::SOURCE, page_refinement::ENTRIES),
    ("page_requests", page_requests::SOURCE, page_requests::ENTRIES),
    ("paraboloid_casters", paraboloid_casters::SOURCE, paraboloid_casters::ENTRIES),
    ("pixel_counts", pixel_counts::SOURCE, pixel_counts::ENTRIES),
    ("pixel_coverage", pixel_coverage::SOURCE, pixel_coverage::ENTRIES),
    ("pixel_filter", pixel_filter::SOURCE, pixel_filter::ENTRIES),
    ("pixel_receivers", pixel_receivers::SOURCE, pixel_receivers::ENTRIES),
    ("pixel_texel_pairs", pixel_texel_pairs::SOURCE, pixel_texel_pairs::ENTRIES),
    ("pixel_triangles", pixel_triangles::SOURCE, pixel_triangles::ENTRIES),
    ("pixel_views", pixel_views::SOURCE, pixel_views::ENTRIES),
    ("polygon_ids", polygon_ids::SOURCE, polygon_ids::ENTRIES),
    ("prefix_scan", prefix_scan::SOURCE, prefix_scan::ENTRIES),
    ("radix_sort", radix_sort::SOURCE, radix_sort::ENTRIES),
    ("requested_blocks", requested_blocks::SOURCE, requested_blocks::ENTRIES),
    ("resolve", resolve::SOURCE, resolve::ENTRIES),
    ("sample_bins", sample_bins::SOURCE, sample_bins::ENTRIES),
    ("sample_surfaces", sample_surfaces::SOURCE, sample_surfaces::ENTRIES),
    ("seen_depths", seen_depths::SOURCE, seen_depths::ENTRIES),
    ("seen_texels", seen_texels::SOURCE, seen_texels::ENTRIES),
    ("shadow_map", shadow_map::SOURCE, shadow_map::ENTRIES),
    ("shadow_rays", shadow_rays::SOURCE, shadow_rays::ENTRIES),
    ("silhouette_map", silhouette_map::SOURCE, silhouette_map::ENTRIES),
    ("silhouette_mask", silhouette_mask::SOURCE, silhouette_mask::ENTRIES),
    ("silhouette_points", silhouette_points::SOURCE, silhouette_points::ENTRIES),
    ("smsr", smsr::SOURCE, smsr::ENTRIES),
    ("sorted_pairs", sorted_pairs::SOURCE, sorted_pairs::ENTRIES),
    ("spsm_map", spsm_map::SOURCE, spsm_map::ENTRIES),
    ("spsm_map_64", spsm_map_64::SOURCE, spsm_map_64::ENTRIES),
    ("spsm_query", spsm_query::SOURCE, spsm_query::ENTRIES),
    ("summed_area", summed_area::SOURCE, summed_area::ENTRIES),
    ("surface_receivers", surface_receivers::SOURCE, surface_receivers::ENTRIES),
    ("texel_group", texel_group::SOURCE, texel_group::ENTRIES),
    ("triangle_ids", triangle_ids::SOURCE, triangle_ids::ENTRIES),
    ("triangle_setup", triangle_setup::SOURCE, triangle_setup::ENTRIES),
    ("triangle_texel_pairs", triangle_texel_pairs::SOURCE, triangle_texel_pairs::ENTRIES),
    ("vertex_project", vertex_project::SOURCE, vertex_project::ENTRIES),
    ("visibility_masks", visibility_masks::SOURCE, visibility_masks::ENTRIES),
    ("visibility_texture", visibility_texture::SOURCE, visibility_texture::ENTRIES),
    ("warped_casters", warped_casters::SOURCE, warped_casters::ENTRIES),
    ("warped_query", warped_query::SOURCE, warped_query::ENTRIES),
    ("work_owners", work_owners::SOURCE, work_owners::ENTRIES),
];
