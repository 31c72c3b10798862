// Sum over a rectangle of texels, both corners included, from an inclusive summed-area table of frame.map_size squared.

fn table_at(x: i32, y: i32) -> u32 {
    if x < 0 || y < 0 { return 0u; }
    return summed_area[u32(y) * frame.map_size + u32(x)];
}

fn rect_sum(low: vec2<u32>, high: vec2<u32>) -> u32 {
    let l = vec2<i32>(low) - 1;
    let h = vec2<i32>(high);
    return table_at(h.x, h.y) - table_at(l.x, h.y) - table_at(h.x, l.y) + table_at(l.x, l.y);
}
