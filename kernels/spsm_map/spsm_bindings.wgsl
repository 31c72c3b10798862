// Bindings and constants of spsm_map, but for `keys`, which keys or keys_64 binds.

//@import frame pass

override ENCODING: u32 = 1u;
override SPLIT: u32 = 1u;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<uniform> slopes: array<vec4<f32>, 256>;
@group(0) @binding(3) var<storage, read> triangles: array<vec3<u32>>;
@group(0) @binding(4) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> light_rects: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(8) var<storage, read_write> upper_records: array<vec4<u32>>;
@group(0) @binding(9) var<storage, read_write> lower_records: array<vec4<u32>>;
@group(0) @binding(10) var<storage, read_write> seen: array<atomic<u32>>;
