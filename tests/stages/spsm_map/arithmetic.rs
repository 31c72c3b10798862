//! Divisions, codes and edge tests of the records, exactly.

use super::*;
use subpixel_shadows::gpu::Source;

const DIVIDE: &str = concat!(
    "@group(0) @binding(0) var<storage, read> inputs: array<vec2<u32>>;
@group(0) @binding(1) var<storage, read_write> outputs: array<vec2<u32>>;
",
    include_str!("../../../kernels/shared/math/divide.wgsl"),
    "
@compute @workgroup_size(64) fn work(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&inputs) { outputs[id.x] = divided(inputs[id.x].x, inputs[id.x].y); }
}
"
);

entry_point! { "test", "work", [64, 1, 1], Source(&[DIVIDE]), () => Divide, DivideProgram {
    0 inputs: Read<'a, [u32; 2]>,
    1 outputs: Write<'a, [u32; 2]>,
} }

/// Rows and places in them, divided through floats, are those of integers.
#[gpu_test]
fn division_is_exact() {
    let mut random = Random::new(9);
    let mut inputs = Vec::new();
    for by in (1..300).chain([640, 1023, 1280, 4096, 8191, 16_384, 65_535, (1 << 30) - 1]) {
        let most = u64::from(by) * ((1 << 22) - 1) + u64::from(by) - 1;
        let most = most.min(u64::from(u32::MAX)) as u32;
        for k in 0..200 {
            let row = if k < 100 { random.word() % (most / by + 1) } else { (most / by).saturating_sub(k - 100) };
            // Both ends of a row, and anywhere.
            inputs.extend([[row * by, by], [(row * by).saturating_sub(1), by], [random.word() % most.max(1), by]]);
        }
        inputs.push([most, by]);
    }
    let input = upload(gpu(), &inputs);
    let output = Buffer::<[u32; 2]>::storage(&gpu().device, "test.output", inputs.len()).expect("memory");
    let program = DivideProgram::new(&gpu().device, ());
    let bindings = Divide { inputs: input.as_read(), outputs: output.as_write() };
    run(gpu(), |s| s.run(&program, bindings, Groups::Items(inputs.len() as u64)));
    for (&[index, by], got) in inputs.iter().zip(output.read(gpu()).expect("readback")) {
        assert_eq!(got, [index / by, index % by], "{index} by {by}");
    }
}

const CODES: &str = concat!(
    include_str!("../../../kernels/shared/frame/frame.wgsl"),
    "override ENCODING: u32 = 1u;
@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> slopes: array<vec4<f32>, 256>;
@group(0) @binding(2) var<storage, read> inputs: array<f32>;
@group(0) @binding(3) var<storage, read_write> outputs: array<u32>;
",
    include_str!("../../../kernels/shared/math/cross_sign.wgsl"),
    include_str!("../../../kernels/shared/spsm/spsm_record.wgsl"),
    "
@compute @workgroup_size(64) fn work(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let k = id.y * 64u * groups.x + id.x;
    if k >= arrayLength(&inputs) { return; }
    let v = inputs[k];
    let w = clamp(v, -1.0, 1.0);
    let slope = slope_code(v);
    let wide = slope_code_16(v);
    outputs[4u * k] = slope | (wide << 8u);
    outputs[4u * k + 1u] = bitcast<u32>(slope_of_16(wide));
    outputs[4u * k + 2u] = direction_code(vec2(w, 1.0 - abs(w))) | (direction_code(vec2(w, abs(w) - 1.0)) << 12u);
    outputs[4u * k + 3u] = distance_code(v) | (unorm_code(v, 65535.0) << 12u);
}
"
);

entry_point! { "test", "work", [64, 1, 1], Source(&[CODES]), () => Codes, CodesProgram {
    0 frame: Uniform<'a, Frame>,
    1 slopes: Uniform<'a, [f32; 4]>,
    2 inputs: Read<'a, f32>,
    3 outputs: Write<'a, [u32; 4]>,
} }

fn slopes_of(code: &SlopeCode) -> Buffer<[f32; 4]> {
    let slopes = Buffer::uniform(&gpu().device, "test.slopes", 256).expect("memory");
    slopes.write(&gpu().queue, &code.words());
    slopes
}

/// Codes of the GPU, word for word, of the inputs in order.
fn words_of(v: f32, slopes: &SlopeCode) -> [u32; 4] {
    let w = v.clamp(-1.0, 1.0);
    let wide = slope_code_16(v);
    [
        slopes.encode(v) | wide << 8,
        slope_of_16(wide).to_bits(),
        direction_code(w, 1.0 - w.abs()) | direction_code(w, w.abs() - 1.0) << 12,
        distance_code(v) | unorm_code(v, 65_535.0) << 12,
    ]
}

/// Every code of 2^24 numbers is the same on CPU and GPU, rises with the number, and is decoded within its bound.
#[gpu_test]
fn codes_agree_bit_for_bit() {
    const PART: usize = 1 << 20;
    let program = CodesProgram::new(&gpu().device, ());
    let code = SlopeCode::new(5);
    let slopes = slopes_of(&code);
    let frame = uniform(gpu(), &Default::default());
    let output = Buffer::<[u32; 4]>::storage(&gpu().device, "test.output", PART).expect("memory");
    // Every 256th finite number, so 2^24 of them, from the lowest up.
    let number = |k: u32| {
        let bits = k << 8 | 0x55;
        f32::from_bits(if bits >> 31 == 0 { !bits } else { bits & 0x7fff_ffff })
    };
    let mut last: Option<(f32, u32, f32)> = None;
    for part in 0..16u32 {
        let inputs: Vec<f32> = (0..PART as u32).map(|k| number(part * PART as u32 + k)).collect();
        let input = upload(gpu(), &inputs);
        let bindings = Codes {
            frame: frame.as_uniform(),
            slopes: slopes.as_uniform(),
            inputs: input.as_read(),
            outputs: output.as_write(),
        };
        run(gpu(), |s| s.run(&program, bindings, Groups::Items(PART as u64)));
        let outputs = output.read(gpu()).expect("readback");
        for (&v, got) in inputs.iter().zip(&outputs).filter(|(v, _)| v.is_finite()) {
            // Numbers below the normal ones may be taken for 0.
            if v.abs() < f32::MIN_POSITIVE {
                continue;
            }
            let want = words_of(v, &code);
            assert_eq!(*got, want, "{v}");
            let (narrow, wide) = (got[0] & 255, f32::from_bits(got[1]));
            if let Some((before, code, slope)) = last {
                assert!(v > before && narrow >= code && wide >= slope, "{v} after {before}");
            }
            // 2^-20 itself is the code of 0.
            if (1e-6..2048.0).contains(&v.abs()) {
                assert!((wide - v).abs() <= v.abs() / 2048.0, "{v} is decoded as {wide}");
            }
            last = Some((v, narrow, wide));
        }
    }
    assert!(last.is_some_and(|(v, narrow, _)| v > 1e38 && narrow == 254));
    let mut spoilt = words_of(0.7, &code);
    spoilt[0] ^= 1;
    assert_ne!(spoilt, words_of(0.7, &code), "a flipped bit shows");
}

const SIDES: &str = concat!(
    include_str!("../../../kernels/shared/frame/frame.wgsl"),
    "override ENCODING: u32 = 0u;
@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> slopes: array<vec4<f32>, 256>;
@group(0) @binding(2) var<storage, read> inputs: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read_write> outputs: array<u32>;
",
    include_str!("../../../kernels/shared/math/cross_sign.wgsl"),
    include_str!("../../../kernels/shared/spsm/spsm_record.wgsl"),
    "
@compute @workgroup_size(64) fn work(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let k = id.y * 64u * groups.x + id.x;
    if k >= arrayLength(&inputs) { return; }
    let v = inputs[k];
    let texel = vec2(v.w & 0xffffu, v.w >> 16u);
    let sheet = decode_record(vec4(v.xyz, 0u), vec2<f32>(texel) + 0.5);
    let sides = vec3<i32>(sign(vec3(sheet.edges[0].z, sheet.edges[1].z, sheet.edges[2].z))) + 1;
    outputs[k] = u32(sides.x | (sides.y << 2u) | (sides.z << 4u));
}
"
);

entry_point! { "test", "work", [64, 1, 1], Source(&[SIDES]), () => Sides, SidesProgram {
    0 frame: Uniform<'a, Frame>,
    1 slopes: Uniform<'a, [f32; 4]>,
    2 inputs: Read<'a, [u32; 4]>,
    3 outputs: Write<'a, u32>,
} }

/// A vertex of 16 bits relative to a texel's centre, in units of 1 / 131070 texel.
fn steps_to(vertex: u32, texel: u32, size: u32) -> [i64; 2] {
    let step = |shift: u32| {
        let [code, texel] = [vertex, texel].map(|v| i64::from(v >> shift & 0xffff));
        code * 2 * i64::from(size) - (2 * texel + 1) * 65_535
    };
    [step(0), step(16)]
}

fn cross(a: [i64; 2], b: [i64; 2]) -> i64 {
    a[0] * b[1] - a[1] * b[0]
}

/// On which side of the three edges of a coded triangle the centre of a texel lies, two bits each: 0 outside, 1 on the edge,
/// 2 inside.
fn sides_of([a, b, c, texel]: [u32; 4], size: u32) -> u32 {
    let [p, q, r] = [a, b, c].map(|v| steps_to(v, texel, size));
    let area = cross([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
    let turn = if area > 0 { 1 } else { -1 };
    // Without an edge, or an area, the centre is outside.
    let side = |a, b| if a == b { 0 } else { (turn * cross(a, b).signum() + 1) as u32 };
    (if area == 0 { 0 } else { side(p, q) }) | side(q, r) << 2 | side(r, p) << 4
}

/// Which side of an edge between two vertices of 16 bits the texel's centre lies on, in more than 10^7 tests, against integers of
/// 64 bits: of triangles anywhere, of small ones around the texel, of slivers, and of edges right through the centre.
#[gpu_test]
fn edge_tests_have_no_wrong_sign() {
    const PART: usize = 1 << 20;
    let program = SidesProgram::new(&gpu().device, ());
    let slopes = slopes_of(&SlopeCode::new(5));
    let output = Buffer::<u32>::storage(&gpu().device, "test.output", PART).expect("memory");
    let mut random = Random::new(31);
    let (mut tests, mut on_edge, mut single) = (0, 0, 0);
    for size in [512, 2048, 4096, 8192] {
        let frame = uniform(gpu(), &Frame { map_size: size, ..Default::default() });
        let inputs: Vec<[u32; 4]> = (0..PART).map(|k| coded_triangle(k % 4, size, &mut random)).collect();
        let input = upload(gpu(), &inputs);
        let bindings = Sides {
            frame: frame.as_uniform(),
            slopes: slopes.as_uniform(),
            inputs: input.as_read(),
            outputs: output.as_write(),
        };
        run(gpu(), |s| s.run(&program, bindings, Groups::Items(PART as u64)));
        for (&given, got) in inputs.iter().zip(output.read(gpu()).expect("readback")) {
            let want = sides_of(given, size);
            assert_eq!(got, want, "{given:?}, map {size}");
            tests += 3;
            on_edge += usize::from([0, 2, 4].iter().any(|shift| want >> shift & 3 == 1));
            // The first edge in single precision alone.
            let [a, b, _, texel] = given;
            let rough = [a, b].map(|v| {
                let at = |shift: u32| {
                    (v >> shift & 0xffff) as f32 * (size as f32 / 65_535.0) - ((texel >> shift & 0xffff) as f32 + 0.5)
                };
                [at(0), at(16)]
            });
            let rough = rough[0][0] * rough[1][1] - rough[0][1] * rough[1][0];
            let exact = cross(steps_to(a, texel, size), steps_to(b, texel, size));
            single += usize::from((rough > 0.0) != (exact > 0) || (rough < 0.0) != (exact < 0));
        }
    }
    assert!(tests > 10_000_000 && on_edge > 1000, "{tests} tests, {on_edge} on an edge");
    assert!(single > 100, "single precision alone would be wrong in {single}");
}
