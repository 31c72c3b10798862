// Points as the rows of the light's view take them.

//@import frame
//@needs var<uniform> frame: Frame;

// A point seen from the light, where that is at a point: next to it rounding is small, too.
fn from_lamp(p: vec3<f32>) -> vec4<f32> {
    return vec4(p - frame.lamp.xyz, 1.0);
}
