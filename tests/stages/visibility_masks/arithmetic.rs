//! Pairs of single-precision numbers.

use super::*;
use subpixel_shadows::gpu::Source;

const ARITHMETIC: &str = concat!(
    include_str!("../../../kernels/shared/frame/frame.wgsl"),
    "@group(0) @binding(0) var<uniform> frame: Frame;\n",
    include_str!("../../../kernels/shared/math/double_float.wgsl"),
    "
@group(0) @binding(1) var<storage, read> inputs: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> outputs: array<vec2<f32>>;
@compute @workgroup_size(64) fn work(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&inputs) { return; }
    let v = inputs[id.x];
    outputs[5u * id.x] = df_add(v.xy, v.zw);
    outputs[5u * id.x + 1u] = df_sub(v.xy, v.zw);
    outputs[5u * id.x + 2u] = df_add_fast(v.xy, v.zw);
    outputs[5u * id.x + 3u] = df_mul(v.xy, v.zw);
    outputs[5u * id.x + 4u] = df_scale(v.xy, v.z);
}
"
);

entry_point! { "test", "work", [64, 1, 1], Source(&[ARITHMETIC]), () => Arithmetic, ArithmeticProgram {
    0 frame: Uniform<'a, Frame>,
    1 inputs: Read<'a, [f32; 4]>,
    2 outputs: Write<'a, [f32; 2]>,
} }

/// Arithmetic of two `f32` on this adapter: 2^-44 of the exact result, of the fast sum 2^-44 of the numbers added.
#[gpu_test]
fn double_floats_keep_44_bits() {
    const COUNT: usize = 120_000;
    let mut random = Random::new(68);
    let number = |random: &mut Random| -> [f32; 2] {
        let high = f32::from_bits(random.word() & 0x807f_ffff | (127 - 12 + random.below(24)) << 23);
        let ulp = f32::from_bits((high.to_bits() & 0x7f80_0000).max(24 << 23) - (23 << 23));
        let low = (unit(random) as f32 - 0.5) * ulp * 0.999;
        [high, if random.below(8) == 0 { 0.0 } else { low }]
    };
    let inputs: Vec<[f32; 4]> = (0..COUNT)
        .map(|k| {
            let (a, mut b) = (number(&mut random), number(&mut random));
            if k % 4 == 0 {
                // Numbers that nearly cancel.
                b = [-a[0] * (1.0 + (random.below(9) as f32 - 4.0) * 1.2e-7), b[1] * (a[0] / b[0])];
                let ulp = b[0].abs() * 5e-8;
                b[1] = b[1].clamp(-ulp, ulp);
            }
            [a[0], a[1], b[0], b[1]]
        })
        .collect();
    let program = ArithmeticProgram::new(&gpu().device, ());
    let (input, output) =
        (upload(gpu(), &inputs), Buffer::<[f32; 2]>::storage(&gpu().device, "test.output", 5 * COUNT));
    let (output, frame) = (output.expect("memory"), uniform(gpu(), &Default::default()));
    let bindings = Arithmetic { frame: frame.as_uniform(), inputs: input.as_read(), outputs: output.as_write() };
    run(gpu(), |s| s.run(&program, bindings, Groups::Items(COUNT as u64)));
    let outputs = output.read(gpu()).expect("readback");
    // Sums in units of 2^-90, exactly; products as sums of exact products, the largest parts first.
    let fixed = |v: f32| (f64::from(v) * 2f64.powi(90)) as i128;
    let worst = |inputs: &[[f32; 4]], outputs: &[[f32; 2]]| {
        let mut worst = [0f64; 5];
        for (i, o) in inputs.iter().zip(outputs.chunks(5)) {
            let [a, al, b, bl] = i.map(fixed);
            let (sum, difference) = (a + al + b + bl, a + al - b - bl);
            for (k, exact, whole) in [(0, sum, sum), (1, difference, difference), (2, sum, a.abs().max(b.abs()))] {
                let error = (exact - fixed(o[k][0]) - fixed(o[k][1])).unsigned_abs() as f64;
                let relative = if error == 0.0 { 0.0 } else { error / whole.unsigned_abs() as f64 };
                worst[k] = worst[k].max(relative);
            }
            let [a, al, b, bl] = i.map(f64::from);
            for (k, bl) in [(3, bl), (4, 0.0)] {
                let [p, pl] = o[k].map(f64::from);
                let error = (a * b - p) + (a * bl + al * b - pl) + al * bl;
                worst[k] = worst[k].max((error / (a * b)).abs());
            }
        }
        worst
    };
    let found = worst(&inputs, &outputs);
    println!("relative errors of sum, difference, fast sum, product, multiple: 2^{:?}", found.map(f64::log2));
    assert!(found.iter().all(|&e| e <= 2f64.powi(-44)), "2^{:?}", found.map(f64::log2));
    for k in 0..5 {
        let mut corrupted = outputs.clone();
        corrupted[5 + k][1] += corrupted[5 + k][0] * 2f32.powi(-40);
        assert!(worst(&inputs, &corrupted)[k] > 2f64.powi(-44), "a corrupted result {k} passes");
    }
}
