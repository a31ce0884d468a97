// What all decoders of horizons share: where a map lies, which texels surround a point, how an angle turns. Twin of
// `series.rs` and `pack.rs`. Needs `fn horizon_texel(index: u32) -> vec4u`, four words of the buffer of maps.

// 1 where each page halves the resolution of the one before, 0 where all are of full resolution.
override HORIZON_HALVING: u32 = 1u;

// A horizon map in that buffer. Page `l` of 0…3 has texels of (1 << l·HORIZON_HALVING) pixels a side, row by row from
// `offset_l` on; rows run up the map.
struct HorizonGrid {
    columns: u32,
    rows: u32,
    // Where the fields of a water-filled pyramid are described.
    table: u32,
    offset_0: u32,
    offset_1: u32,
    offset_2: u32,
    offset_3: u32,
}

// Numbers of the four texels about a point, south-west, south-east, north-west, north-east, and the shares of the
// eastern and the northern ones.
struct HorizonCell {
    texels: vec4u,
    share: vec2f,
}

// Bilinear between texel centres; beyond the edge the edge texel counts.
fn horizon_cell(horizon: HorizonGrid, page: u32, grid: vec2f) -> HorizonCell {
    let shift = page * HORIZON_HALVING;
    let scale = f32(1u << shift);
    let columns = (horizon.columns + (1u << shift) - 1u) >> shift;
    let rows = (horizon.rows + (1u << shift) - 1u) >> shift;
    let last = vec2f(f32(columns - 1u), f32(rows - 1u));
    let at = clamp((grid + 0.5) / scale - 0.5, vec2f(0.0), last);
    let low = vec2u(at);
    let high = min(low + 1u, vec2u(columns - 1u, rows - 1u));
    let south = low.y * columns;
    let north = high.y * columns;
    return HorizonCell(vec4u(south + low.x, south + high.x, north + low.x, north + high.x), at - floor(at));
}

// (cos a, sin a) and (cos b, sin b) to those of a + b.
fn horizon_turn(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}
