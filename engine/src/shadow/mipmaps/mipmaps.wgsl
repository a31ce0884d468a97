// Runs over maximum mipmaps towards a light, at each sample. Twin of mipmaps.rs.

// Mips of each run, four bits each, the nearest run in the lowest ones; 0 ends them.
override MIPMAP_RUNS_1: u32 = 0u;
override MIPMAP_RUNS_2: u32 = 0u;
// Uniform stepping in their place: how many steps, of how many postings.
override UNIFORM_STEPS: u32 = 0u;
override UNIFORM_SPACING: f32 = 1.0;

const NOTHING: f32 = -3.0e38;
const FARTHEST_M: f32 = 3.0e38;
const MIP_SLACK: f32 = 1.0e-3;
// As in mipmaps.rs.
const NUDGE: f32 = 4.0e-3;
const BLOCKS: u32 = 8u;
const NO_LEVEL: u32 = 0xffffffffu;

fn cells_of(level: MapLevel) -> vec2i {
    return vec2i(i32(level.columns), i32(level.rows)) - 1;
}

fn is_inside(level: MapLevel, grid: vec2f) -> bool {
    return all(grid >= vec2f(0.0)) && all(grid <= vec2f(cells_of(level)));
}

// The finest level from a facet's own on that sees a point at a distance.
fn level_along(facet: Facet, towards: vec2f, at_m: f32) -> u32 {
    let own = map_levels[facet.level];
    if is_inside(own, facet.grid + towards * (at_m / own.posting_m)) {
        return facet.level;
    }
    let face = map_faces[own.face];
    let end = face.first_level + face.levels;
    for (var index = facet.level + 1u; index < end; index++) {
        let level = map_levels[index];
        if is_inside(level, (facet.at_m + towards * at_m - level.south_west_m) / level.posting_m) {
            return index;
        }
    }
    return NO_LEVEL;
}

fn surface_m(level: MapLevel, grid: vec2f) -> f32 {
    let cells = cells_of(level);
    let at = clamp(grid, vec2f(0.0), vec2f(cells));
    let cell = min(vec2i(at), cells - 1);
    let f = at - vec2f(cell);
    let low = mix(node_m(level, cell), node_m(level, cell + vec2i(1, 0)), f.x);
    let high = mix(node_m(level, cell + vec2i(0, 1)), node_m(level, cell + vec2i(1, 1)), f.x);
    return mix(low, high, f.y);
}

// Where a ray leaves the block that holds `inside`, along one axis.
fn way_end(start: f32, rate: f32, inside: f32, size: f32, cells: f32) -> f32 {
    if rate > 0.0 {
        return (min((floor(inside / size) + 1.0) * size, cells) - start) / rate;
    }
    if rate < 0.0 {
        return (max((ceil(inside / size) - 1.0) * size, 0.0) - start) / rate;
    }
    return FARTHEST_M;
}

// Steepest line of sight where a run ends, NOTHING where it leaves the terrain.
fn run_slope(facet: Facet, towards: vec2f, light_slope: f32, start_m: f32, mips: i32) -> f32 {
    let own_m = map_levels[facet.level].posting_m;
    var interval = vec2f(start_m, start_m + own_m * f32(1u << u32(mips - 1)));
    var slope = NOTHING;
    for (var step = mips - 1; step >= 0; step--) {
        let size_m = own_m * f32(1u << u32(step));
        let nudge_m = NUDGE * size_m;
        var least = FARTHEST_M;
        var best = interval;
        var at_m = interval.x;
        var last = NO_LEVEL;
        var level: MapLevel;
        var mip = 0;
        var offset = 0u;
        var start: vec2f;
        for (var block = 0u; block < BLOCKS && at_m < interval.y - nudge_m; block++) {
            let index = level_along(facet, towards, at_m + nudge_m);
            if index == NO_LEVEL {
                break;
            }
            if index != last {
                last = index;
                level = map_levels[index];
                mip = clamp(i32(floor(log2(size_m / level.posting_m) + MIP_SLACK)), 0, i32(level.mips) - 1);
                offset = level.maxima_offset + mip_offset(cells_of(level), mip);
                start = facet.grid;
                if index != facet.level {
                    start = (facet.at_m - level.south_west_m) / level.posting_m;
                }
            }
            let rate = towards / level.posting_m;
            let inside = start + rate * (at_m + nudge_m);
            let cells = cells_of(level);
            let size = f32(1u << u32(mip));
            let exit_x = way_end(start.x, rate.x, inside.x, size, f32(cells.x));
            let exit_y = way_end(start.y, rate.y, inside.y, size, f32(cells.y));
            let next_m = max(min(min(exit_x, exit_y), interval.y), at_m + nudge_m);
            var heights_m: vec2f;
            if mip == 0 {
                heights_m = vec2f(surface_m(level, start + rate * at_m), surface_m(level, start + rate * next_m));
            } else {
                let its = clamp(vec2i(inside), vec2i(0), cells - 1) >> vec2u(u32(mip));
                let blocks = (cells + vec2i((1 << u32(mip)) - 1)) >> vec2u(u32(mip));
                heights_m = vec2f(maxima_m[offset + u32(its.y * blocks.x + its.x)]);
            }
            let ends_m = vec2f(at_m, next_m);
            let slopes = (heights_m - facet.height_m) / ends_m;
            let clear_m = (light_slope - slopes) * ends_m;
            if min(clear_m.x, clear_m.y) < least {
                least = min(clear_m.x, clear_m.y);
                best = ends_m;
                slope = max(slopes.x, slopes.y);
            }
            at_m = next_m;
        }
        if least == FARTHEST_M {
            return NOTHING;
        }
        interval = best;
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
    var steepest = NOTHING;
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
    let step_m = UNIFORM_SPACING * map_levels[facet.level].posting_m;
    for (var step = 1u; step <= UNIFORM_STEPS; step++) {
        let at_m = f32(step) * step_m;
        let index = level_along(facet, towards, at_m);
        if index == NO_LEVEL {
            break;
        }
        let level = map_levels[index];
        var grid = facet.grid + towards * (at_m / level.posting_m);
        if index != facet.level {
            grid = (facet.at_m + towards * at_m - level.south_west_m) / level.posting_m;
        }
        steepest = max(steepest, (surface_m(level, grid) - facet.height_m) / at_m);
    }
    // The bare sphere lies beyond; who stands below it sees the plain through his feet.
    let above = max(square + h * (2.0 - h), 0.0) / ((1.0 - h) * (1.0 - h));
    let tangent = max((max(steepest, -1.0e6) * radius_ratio + q) / cosine, -sqrt(above));
    let secant = inverseSqrt(1.0 + tangent * tangent);
    let distance_sine = (tangent * cos_elevation - sin_elevation) * secant;
    let distance_cosine = max((cos_elevation + tangent * sin_elevation) * secant, FARTHEST_COSINE);
    return vec2f(distance_sine / (distance_cosine * radius_rad), 0.0);
}

fn light_over_terrain(facet: Facet, index: u32, light: LightParameters, s: vec3f, plane: vec3f) -> DiskLight {
    let towards = direction_to_light(facet, s);
    if all(towards == vec2f(0.0)) {
        return disk_light(-1.0e3, 0.0, plane);
    }
    let line = mipmap_line(facet, towards, s, light.radius_rad);
    return disk_light(line.x, line.y, plane);
}
