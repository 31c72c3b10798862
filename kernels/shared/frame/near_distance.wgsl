// Where rays begin to see surfaces: at the near distance, and beyond the oblique near plane, if there is one.

//@import frame facing
//@needs var<uniform> frame: Frame;

// Inverse view depth of the oblique near plane on a ray; not above 0 where the ray does not come through it.
fn inverse_near(ray: vec3<f32>) -> f32 {
    return dot(ray, frame.near_plane.xyz) + frame.near_plane.w;
}

// View depth from which on surfaces are seen along a ray.
fn near_along(ray: vec3<f32>) -> f32 {
    let inverse = inverse_near(ray);
    return max(frame.forward.w, select(3.0e38, 1.0 / inverse, inverse > 0.0));
}

// Lower bound of `inverse_near` over the square of a pixel, from the ray of its centre.
fn least_inverse_near(centre: vec3<f32>) -> f32 {
    let n = frame.near_plane.xyz;
    let step = abs(dot(n, frame.ray_x.xyz)) + abs(dot(n, frame.ray_y.xyz));
    return inverse_near(centre) - 0.5 * step - 2e-6 * largest(n) * largest(centre);
}
