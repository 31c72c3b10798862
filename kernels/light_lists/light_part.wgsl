// A light of which entries are listed.

// A light, and where its entries go.
struct LightPart {
    axis: vec3<f32>,   // of the cone
    cosine: f32,       // of half its angle
    range: f32,        // world units
    everywhere: u32,   // not 0: neither range nor cone is asked
    light: u32,        // its number
    capacity: u32,     // entries that there is room for
    tiles_across: u32,
    tiles: u32,
    pad_0: u32,
    pad_1: u32,
}
