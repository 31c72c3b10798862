// visibility_texture: writes the visibility of every pixel into a texture of the application's.
// Reads `visibility` (row by row from the top). Writes `target_texture` (r32float, a texel a pixel), of a strip
// of rows those that are its own.

//@import frame
//@import dispatch
//@import divide
//@import strip

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> visibility: array<f32>;
@group(0) @binding(2) var target_texture: texture_storage_2d<r32float, write>;

@compute @workgroup_size(WORKGROUP)
fn store(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let at = place_in_strip(pixel);
    if !is_own(at.y) { return; }
    textureStore(target_texture, texel_of_image(at), vec4(visibility[pixel], 0.0, 0.0, 1.0));
}
