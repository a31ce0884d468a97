// Runs over maximum mipmaps towards a light, at each sample. Twin of mipmaps.rs.

// Mips of each run, four bits each, the nearest run in the lowest ones; 0 ends them.
override MIPMAP_RUNS_1: u32 = 0u;
override MIPMAP_RUNS_2: u32 = 0u;
override MIPMAP_SLOPE_COST: bool = false;

const NOTHING_M: f32 = -3.0e38;
const STEEPEST_COST: f32 = 3.0e38;
const MIP_SLACK: f32 = 1.0e-3;

fn cells_of(level: MapLevel) -> vec2i {
    return vec2i(i32(level.columns), i32(level.rows)) - 1;
}

fn is_inside(level: MapLevel, grid: vec2f) -> bool {
    return all(grid >= vec2f(0.0)) && all(grid <= vec2f(cells_of(level)));
}

// The maximum of the block of a mip that holds a grid point, or the surface itself; blocks begin at `offset`.
fn highest_m(level: MapLevel, grid: vec2f, mip: i32, offset: u32) -> f32 {
    let cells = cells_of(level);
    let cell = clamp(vec2i(floor(grid)), vec2i(0), cells - 1);
    if mip == 0 {
        let f = grid - vec2f(cell);
        let low = mix(node_m(level, cell), node_m(level, cell + vec2i(1, 0)), f.x);
        let high = mix(node_m(level, cell + vec2i(0, 1)), node_m(level, cell + vec2i(1, 1)), f.x);
        return mix(low, high, f.y);
    }
    let blocks = (cells + vec2i((1 << u32(mip)) - 1)) >> vec2u(u32(mip));
    let block = cell >> vec2u(u32(mip));
    return maxima_m[offset + u32(block.y * blocks.x + block.x)];
}

// The same at a distance from a facet: of the finest level from its own on that sees the point.
fn highest_along(facet: Facet, own: MapLevel, towards: vec2f, at_m: f32, mip: i32, offset: u32) -> f32 {
    let grid = facet.grid + towards * (at_m / own.posting_m);
    if is_inside(own, grid) {
        return highest_m(own, grid, min(mip, i32(own.mips) - 1), offset);
    }
    let face = map_faces[own.face];
    for (var index = facet.level + 1u; index < face.first_level + face.levels; index++) {
        let level = map_levels[index];
        let beyond = (facet.at_m + towards * at_m - level.south_west_m) / level.posting_m;
        if is_inside(level, beyond) {
            let ratio = f32(1u << u32(mip)) * own.posting_m / level.posting_m;
            let its_mip = clamp(i32(floor(log2(ratio) + MIP_SLACK)), 0, i32(level.mips) - 1);
            return highest_m(level, beyond, its_mip, level.maxima_offset + mip_offset(cells_of(level), its_mip));
        }
    }
    return NOTHING_M;
}

// Slope of the terrain where a run ends, NOTHING_M where it leaves the terrain.
fn run_slope(facet: Facet, towards: vec2f, light_slope: f32, start_m: f32, mips: i32) -> f32 {
    let own = map_levels[facet.level];
    let length_m = own.posting_m * f32(1u << u32(mips - 1));
    var until = 1.0;
    var half = 0.5;
    var slope = NOTHING_M;
    for (var mip = mips - 1; mip >= 0; mip--) {
        let its_mip = min(mip, i32(own.mips) - 1);
        let offset = own.maxima_offset + mip_offset(cells_of(own), its_mip);
        var least = STEEPEST_COST;
        var best = 0.0;
        for (var i = 0; i < 3; i++) {
            let t = until - f32(i) * half;
            let at_m = start_m + t * length_m;
            let high_m = highest_along(facet, own, towards, at_m, mip, offset);
            if high_m == NOTHING_M {
                continue;
            }
            let its_slope = (high_m - facet.height_m) / at_m;
            let cost = select((light_slope - its_slope) * at_m, -its_slope, MIPMAP_SLOPE_COST);
            if cost < least {
                least = cost;
                best = t;
                slope = its_slope;
            }
        }
        if least == STEEPEST_COST {
            return NOTHING_M;
        }
        until = best + half;
        half *= 0.5;
    }
    return slope;
}

// Height of the skyline in the disc's plane, in disc radii; it is level across the disc.
fn mipmap_line(facet: Facet, towards: vec2f, s: vec3f, radius_rad: f32) -> vec2f {
    let x = facet.at_m / facet.radius_m;
    let h = facet.height_m / facet.radius_m;
    let square = dot(x, x);
    let q = dot(x, towards) * inverseSqrt(1.0 + square);
    let cosine = sqrt(1.0 - q * q);
    let radius_ratio = sqrt(1.0 + square) / (1.0 - h);
    let sin_elevation = dot(s, facet.up);
    let cos_elevation = sqrt(max(1.0 - sin_elevation * sin_elevation, 1.0e-12));
    let light_slope = (sin_elevation / cos_elevation * cosine - q) / radius_ratio;
    var steepest = NOTHING_M;
    var start_m = map_levels[facet.level].posting_m;
    for (var run = 0u; run < 16u; run++) {
        let packed = select(MIPMAP_RUNS_1, MIPMAP_RUNS_2, run >= 8u);
        let mips = (packed >> (4u * (run & 7u))) & 15u;
        if mips == 0u {
            break;
        }
        steepest = max(steepest, run_slope(facet, towards, light_slope, start_m, i32(mips)));
        start_m += map_levels[facet.level].posting_m * f32(1u << (mips - 1u));
    }
    // The bare sphere lies beyond; who stands below it sees the plain through his feet.
    let above = max(square + h * (2.0 - h), 0.0) / ((1.0 - h) * (1.0 - h));
    let tangent = max((max(steepest, -1.0e6) * radius_ratio + q) / cosine, -sqrt(above));
    let secant = inverseSqrt(1.0 + tangent * tangent);
    let distance_sine = (tangent * cos_elevation - sin_elevation) * secant;
    let distance_cosine = max((cos_elevation + tangent * sin_elevation) * secant, FARTHEST_COSINE);
    return vec2f(distance_sine / (distance_cosine * radius_rad), 0.0);
}
