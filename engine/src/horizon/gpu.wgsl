// The steepest slope from each receiver to the surface along one azimuth, and the elevation of its skyline: branch and
// bound over pyramids of maxima, as `exact` does it for many receivers at once. One invocation is one receiver.
//
// Grid coordinates are (major, minor), in nodes; distances along a line are metres of the map.

struct Ray {
    direction: vec2f,
    // Map (major, minor) of the first receiver, the end of the terrain in this direction, and the spacing, in map radii.
    first: vec2f,
    end: vec2f,
    spacing: f32,
    search_m: f32,
    radius_m: f32,
    datum_m: f32,
    // Receivers along both axes, and from row to row.
    majors: u32,
    minors: u32,
    stride: u32,
    // Whether a receiver stands on his facet.
    on_ground: u32,
    levels: u32,
    // See `cut_short`.
    turns: u32,
}

struct Level {
    // Where the first receiver stands in the level's grid, and the receivers' spacing there.
    start: vec2f,
    spacing: f32,
    posting_m: f32,
    nodes: vec2i,
    stride: u32,
    first_height: u32,
    first_mip: u32,
    mips: u32,
    unused: vec2u,
}

struct Mip {
    first: u32,
    stride: u32,
}

@group(0) @binding(0) var<uniform> ray: Ray;
@group(0) @binding(1) var<storage, read> levels: array<Level>;
@group(0) @binding(2) var<storage, read> mips: array<Mip>;
@group(0) @binding(3) var<storage, read> heights_m: array<f32>;
// Of the blocks of 2, 4, 8 … cells of every level.
@group(0) @binding(4) var<storage, read> maxima_m: array<f32>;
@group(0) @binding(5) var<storage, read> observers_m: array<f32>;
@group(0) @binding(6) var<storage, read_write> elevations_rad: array<f32>;

const NEVER: f32 = -1e30;
// Heights below have a gap in them.
const ABSENT_M: f32 = -1e10;
const FAR_M: f32 = 1e30;
// The elevation where loops were cut short.
const CUT_SHORT: f32 = 1e30;
// A gap with a smaller share is rounding.
const LEAST_SHARE: f32 = 1e-3;

@compute @workgroup_size(64, 1) fn main(@builtin(global_invocation_id) id: vec3u) {
    let at = vec2u(id.y, id.x);
    if at.x >= ray.majors || at.y >= ray.minors { return; }
    let receiver = at.x * ray.stride + at.y;
    let observer_m = observers_m[receiver];
    var slope = NEVER;
    for (var index = 0u; index < ray.levels; index++) {
        let level = levels[index];
        let whole_m = stretch_m(level, at);
        var from_m = whole_m.x;
        while from_m < whole_m.y {
            let to_m = uncovered_m(index, at, vec2f(from_m, whole_m.y));
            slope = steepest(level, start_of(level, at), observer_m, from_m, to_m.x, slope);
            from_m = to_m.y;
        }
    }
    let found = elevation(at, (observer_m + ray.datum_m) / ray.radius_m, slope);
    elevations_rad[receiver] = select(found, CUT_SHORT, cut_short(ray.turns));
}

// Where a receiver stands in a level's grid.
fn start_of(level: Level, at: vec2u) -> vec2f {
    return level.start + level.spacing * vec2f(at);
}

// Where the line enters and leaves a level; 0 and 0 where it does not.
fn stretch_m(level: Level, at: vec2u) -> vec2f {
    let start = start_of(level, at);
    let far = vec2f(level.nodes - 1);
    let outside = (start < vec2f(0.0)) | (start > far);
    if any(outside & (ray.direction == vec2f(0.0))) { return vec2f(0.0); }
    let up = ray.direction > vec2f(0.0);
    let exits_m = crossings_m(level, start, select(vec2f(0.0), far, up));
    let sides_m = crossings_m(level, start, select(far, vec2f(0.0), up));
    let entries_m = select(vec2f(0.0), sides_m, ray.direction != vec2f(0.0));
    return max(vec2f(max(entries_m.x, entries_m.y), min(exits_m.x, exits_m.y)), vec2f(0.0));
}

// From a distance on: where a finer level begins to cover a level, or ends to; and from where to look on.
fn uncovered_m(index: u32, at: vec2u, whole_m: vec2f) -> vec2f {
    var to_m = whole_m.y;
    for (var finer = 0u; finer < index; finer++) {
        let covered_m = stretch_m(levels[finer], at);
        if covered_m.x <= whole_m.x && whole_m.x < covered_m.y { return vec2f(whole_m.x, covered_m.y); }
        if covered_m.x > whole_m.x && covered_m.x < covered_m.y { to_m = min(to_m, covered_m.x); }
    }
    return vec2f(to_m);
}

// Distances at which the line crosses a row and a column.
fn crossings_m(level: Level, start: vec2f, lines: vec2f) -> vec2f {
    let along = ray.direction != vec2f(0.0);
    let rate = select(vec2f(1.0), ray.direction, along);
    return select(vec2f(FAR_M), (lines - start) * level.posting_m / rate, along);
}

fn steepest(level: Level, start: vec2f, observer_m: f32, begin_m: f32, end_m: f32, steepest_before: f32) -> f32 {
    var slope = steepest_before;
    if begin_m >= end_m { return slope; }
    let rate = ray.direction / level.posting_m;
    let up = ray.direction > vec2f(0.0);
    let last = level.nodes - 2;
    let here = start + rate * begin_m;
    var cell = clamp(select(vec2i(ceil(here)) - 1, vec2i(floor(here)), ray.direction >= vec2f(0.0)), vec2i(0), last);
    var from_m = begin_m;
    var mip = 0u;
    loop {
        let size = vec2u(mip);
        let block = cell >> size;
        let edges = select(block, block + 1, up) << size;
        let crossed_m = crossings_m(level, start, vec2f(edges));
        let to_m = clamp(min(crossed_m.x, crossed_m.y), from_m, end_m);
        let rise_m = highest_m(level, block, mip) - observer_m;
        if rise_m > min(slope * from_m, slope * to_m) {
            if mip > 0u {
                mip -= 1u;
                continue;
            }
            if to_m > ray.search_m { break; }
            slope = in_cell(level, start, rate, cell, observer_m, from_m, to_m, slope);
        }
        if to_m >= end_m || to_m > ray.search_m { break; }
        // Into the next block; rounding must not lead out of this one's sides.
        let by_major = crossed_m.x <= crossed_m.y;
        let beyond = select(edges - 1, edges, up);
        let inside = clamp(vec2i(floor(start + rate * to_m)), block << size, ((block + 1) << size) - 1);
        cell = clamp(select(vec2i(inside.x, beyond.y), vec2i(beyond.x, inside.y), by_major), vec2i(0), last);
        from_m = to_m;
        // A longer block begins where its parent does.
        let edge = select(edges.y, edges.x, by_major);
        if ((edge >> mip) & 1) == 0 && mip < level.mips { mip += 1u; }
    }
    return slope;
}

// Upper bound of the surface over a block.
fn highest_m(level: Level, block: vec2i, mip: u32) -> f32 {
    if mip == 0u {
        let corners = corners_m(level, block);
        return max(max(corners.x, corners.y), max(corners.z, corners.w));
    }
    let table = mips[level.first_mip + mip - 1u];
    return maxima_m[table.first + u32(block.x) * table.stride + u32(block.y)];
}

// Heights at (0, 0), (1, 0), (0, 1) and (1, 1) of a cell.
fn corners_m(level: Level, cell: vec2i) -> vec4f {
    let at = level.first_height + u32(cell.x) * level.stride + u32(cell.y);
    return vec4f(heights_m[at], heights_m[at + level.stride], heights_m[at + 1u], heights_m[at + level.stride + 1u]);
}

// The larger of a slope and the steepest one to a cell between two distances.
fn in_cell(
    level: Level, start: vec2f, rate: vec2f, cell: vec2i, observer_m: f32, from_m: f32, to_m: f32, before: f32,
) -> f32 {
    if to_m <= from_m { return before; }
    let corners = corners_m(level, cell) - observer_m;
    let origin = start - vec2f(cell);
    let rises_m = vec2f(rise_m(corners, origin + rate * from_m), rise_m(corners, origin + rate * to_m));
    var slope = max(before, rises_m.y / to_m);
    if from_m > 0.0 { slope = max(slope, rises_m.x / from_m); }
    // Beside a gap the edges count, the cell does not.
    if min(min(corners.x, corners.y), min(corners.z, corners.w)) < ABSENT_M { return slope; }
    let run_m = to_m - from_m;
    let c = (corners.x - corners.y - corners.z + corners.w) * rate.x * rate.y;
    let b = (rises_m.y - rises_m.x) / run_m - c * run_m;
    if from_m == 0.0 && ray.on_ground != 0u { return max(slope, b); }
    if c >= 0.0 { return slope; }
    let q = (rises_m.x - b * from_m) / c;
    let after_m = q / (from_m + sqrt(max(from_m * from_m + q, 0.0)));
    let inside = after_m > 0.0 && after_m < run_m;
    return select(slope, max(slope, (rises_m.x + after_m * (b + c * after_m)) / (from_m + after_m)), inside);
}

// The bilinear rise at a place in a cell.
fn rise_m(corners: vec4f, place: vec2f) -> f32 {
    let f = clamp(place, vec2f(0.0), vec2f(1.0));
    let shares = vec4f((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
    let gaps = corners < vec4f(ABSENT_M);
    if any(gaps & (shares > vec4f(LEAST_SHARE))) { return NEVER; }
    return dot(select(corners, vec4f(0.0), gaps), shares);
}

// From a lifted slope to the elevation above the local horizontal, the bare sphere included (`sweep::angle`).
fn elevation(at: vec2u, h: f32, slope: f32) -> f32 {
    let place = ray.first + ray.spacing * vec2f(at);
    let tangent = max(tangent_of(place, h, slope), tangent_of(place, h, sphere_slope(place, h)));
    return arc_tangent(tangent);
}

fn tangent_of(place: vec2f, h: f32, slope: f32) -> f32 {
    let k = 1.0 + dot(place, place);
    let p = dot(place, ray.direction);
    return (slope * k + p * (1.0 - h)) / ((1.0 - h) * sqrt(k - p * p));
}

// The bare sphere beyond the end of the terrain (`sphere`).
fn sphere_slope(place: vec2f, h: f32) -> f32 {
    let square = dot(place, place);
    let k = 1.0 + square;
    let m = 1.0 - h;
    let p = dot(place, ray.direction);
    let above = square + h * (2.0 - h);
    let along = ray.direction != vec2f(0.0);
    let runs = select(vec2f(FAR_M), (ray.end - place) / select(vec2f(1.0), ray.direction, along), along);
    let edge = max(min(runs.x, runs.y), 0.0);
    let edge_reach = sqrt(k + edge * (2.0 * p + edge));
    if above <= 0.0 { return -m / sqrt(k) * (2.0 * p + edge) / (edge_reach + sqrt(k)); }
    let touch = (p * above + m * sqrt(above * (k - p * p))) / (m * m - p * p);
    if touch >= edge { return -(p + touch) / sqrt(k + touch * (2.0 * p + touch)); }
    return -(above + edge * (2.0 * p + edge)) / ((m + edge_reach) * edge);
}
