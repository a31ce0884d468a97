// The terrain around a sample: the steepest slope to the bilinear surface within a few cells, cell by cell.

// Postings that are looked at, along the axis that a direction is nearer to.
override NEAR: u32;

// A disc is looked at no further than this to each side.
const WIDEST_RAD: f32 = 0.2;
const PLACE: f32 = 0.70710678;
const NOTHING: f32 = -1.0e30;
// As in `near.rs`.
const LOWEST_RADII: f32 = 2.0;
const LOWEST: f32 = 1.0e-3;
const SLACK: f32 = 2.0e-3;

// Elevation and slope by map azimuth of the skyline across a disc, from those of what stands farther away.
fn over_near_terrain(facet: Facet, far: vec2f, towards: vec2f, s: vec3f, radius_rad: f32) -> vec2f {
    let sin_elevation = dot(s, facet.up);
    let level = sqrt(max(1.0 - sin_elevation * sin_elevation, 1.0e-12));
    let lowest = arc_tangent(sin_elevation / level) - LOWEST_RADII * radius_rad - LOWEST;
    // Small angles by their series: a device's sines may be off by 2^-11.
    let sine = min(radius_rad / level, WIDEST_RAD);
    let half_width = min(sine * (1.0 + sine * sine / 6.0) * azimuth_ratio(facet.at_m, facet.radius_m, towards), WIDEST_RAD);
    let turn = PLACE * half_width;
    let aside = turn * (1.0 - turn * turn / 6.0) * vec2f(towards.y, -towards.x);
    let ahead = (1.0 - 0.5 * turn * turn) * towards;
    let left = over_near_slope(facet, ahead - aside, max(far.x - far.y * turn, lowest));
    let middle = over_near_slope(facet, towards, max(far.x, lowest));
    let right = over_near_slope(facet, ahead + aside, max(far.x + far.y * turn, lowest));
    let slope = select(0.0, (right - left) * PLACE / half_width, half_width > 0.0);
    return vec2f(0.25 * (left + right) + 0.5 * middle, slope);
}

// The larger of an elevation and that of the near terrain's skyline in a unit map direction.
fn over_near_slope(facet: Facet, direction: vec2f, known: f32) -> f32 {
    let own = map_levels[facet.level];
    let face = map_faces[own.face];
    let reach_m = f32(NEAR) * own.posting_m / max(abs(direction.x), abs(direction.y));
    // Cells that reach no higher are passed over; the tangent is allowed to be coarse.
    let least = slope_of(facet, direction, known) - SLACK;
    var slope = least;
    var from_m = 0.0;
    // Heights count from a node of the sample's own cell: their differences keep their digits.
    let cell = min(vec2i(facet.grid), vec2i(i32(own.columns), i32(own.rows)) - 2);
    let datum_m = node_m(own, cell);
    let corners = cell_corners_m(own, cell) - datum_m;
    let place = facet.grid - vec2f(cell);
    let foot_m = mix(mix(corners.x, corners.y, place.x), mix(corners.z, corners.w, place.x), place.y);
    for (var index = facet.level; index < face.first_level + face.levels && from_m < reach_m; index++) {
        let level = map_levels[index];
        let start = select((facet.at_m - level.south_west_m) / level.posting_m, facet.grid, index == facet.level);
        let out_m = min(exit_m(level, start, direction), reach_m);
        slope = near_slope(level, start, direction, vec2f(from_m, out_m), datum_m, foot_m, slope);
        from_m = max(from_m, out_m);
    }
    if slope == least {
        return known;
    }
    return max(known, arc_tangent(near_tangent(facet, direction, slope)));
}

// The lifted slope of an elevation: the inverse of `near_tangent`.
fn slope_of(facet: Facet, direction: vec2f, elevation: f32) -> f32 {
    let k = 1.0 + dot(facet.at_m, facet.at_m) / (facet.radius_m * facet.radius_m);
    let p = dot(facet.at_m, direction) / facet.radius_m;
    let h = 1.0 - facet.height_m / facet.radius_m;
    return (tan(elevation) * sqrt(k - p * p) - p) * h / k;
}

// As `Gnomonic::elevation_tangent`.
fn near_tangent(facet: Facet, direction: vec2f, slope: f32) -> f32 {
    let k = 1.0 + dot(facet.at_m, facet.at_m) / (facet.radius_m * facet.radius_m);
    let p = dot(facet.at_m, direction) / facet.radius_m;
    let h = 1.0 - facet.height_m / facet.radius_m;
    return (slope * k / h + p) / sqrt(k - p * p);
}

// Where a line leaves a level.
fn exit_m(level: MapLevel, start: vec2f, direction: vec2f) -> f32 {
    let last = vec2f(f32(level.columns - 1u), f32(level.rows - 1u));
    let along = direction != vec2f(0.0);
    let sides = select(vec2f(0.0), last, direction > vec2f(0.0));
    let rate = select(vec2f(1.0), direction, along);
    let exits = select(vec2f(FAR_AWAY), (sides - start) * level.posting_m / rate, along);
    return min(exits.x, exits.y);
}

// Heights at (0, 0), (1, 0), (0, 1) and (1, 1) of a cell.
fn cell_corners_m(level: MapLevel, cell: vec2i) -> vec4f {
    return vec4f(
        node_m(level, cell), node_m(level, cell + vec2i(1, 0)),
        node_m(level, cell + vec2i(0, 1)), node_m(level, cell + vec2i(1, 1)),
    );
}

// The highest corner of a cell.
fn highest_m(level: MapLevel, cell: vec2i) -> f32 {
    return maxima_m[level.maxima_offset + u32(cell.y) * (level.columns - 1u) + u32(cell.x)];
}

// Whether a node has no height of its own.
fn is_gap(level: MapLevel, cell: vec2i) -> bool {
    return abs(gradient(level.heights_offset + u32(cell.y) * level.columns + u32(cell.x)).x) > GAP_SLOPE;
}

// The larger of a slope and the steepest one to a level between two distances.
fn near_slope(
    level: MapLevel, start: vec2f, direction: vec2f, interval_m: vec2f, datum_m: f32, foot_m: f32, before: f32,
) -> f32 {
    var slope = before;
    if interval_m.x >= interval_m.y {
        return slope;
    }
    let rate = direction / level.posting_m;
    let up = direction > vec2f(0.0);
    let last = vec2i(i32(level.columns), i32(level.rows)) - 2;
    let here = start + rate * interval_m.x;
    var cell = clamp(select(vec2i(ceil(here)) - 1, vec2i(floor(here)), direction >= vec2f(0.0)), vec2i(0), last);
    var from_m = interval_m.x;
    for (var count = 0u; count < 2u * NEAR + 4u; count++) {
        let edges = vec2f(select(cell, cell + 1, up));
        let along = direction != vec2f(0.0);
        let crossings_m = select(vec2f(FAR_AWAY), (edges - start) / select(vec2f(1.0), rate, along), along);
        let to_m = clamp(min(crossings_m.x, crossings_m.y), from_m, interval_m.y);
        let rise_m = (highest_m(level, cell) - datum_m) - foot_m;
        if rise_m > min(slope * from_m, slope * to_m) {
            slope = max(slope, slope_in_cell(level, cell, start - vec2f(cell), rate, from_m, to_m, datum_m, foot_m));
        }
        if to_m >= interval_m.y {
            break;
        }
        let step = select(vec2i(-1), vec2i(1), up);
        if crossings_m.x <= crossings_m.y {
            cell.x += step.x;
        } else {
            cell.y += step.y;
        }
        if any(cell < vec2i(0)) || any(cell > last) {
            break;
        }
        from_m = to_m;
    }
    return slope;
}

// The steepest slope to a cell between two distances; cells that touch a gap do not occlude.
fn slope_in_cell(
    level: MapLevel, cell: vec2i, origin: vec2f, rate: vec2f, from_m: f32, to_m: f32, datum_m: f32, foot_m: f32,
) -> f32 {
    if to_m <= from_m {
        return NOTHING;
    }
    if is_gap(level, cell) || is_gap(level, cell + vec2i(1, 0)) || is_gap(level, cell + vec2i(0, 1)) || is_gap(level, cell + vec2i(1, 1)) {
        return NOTHING;
    }
    let corners = (cell_corners_m(level, cell) - datum_m) - foot_m;
    let east = corners.y - corners.x;
    let north = corners.z - corners.x;
    let twist = corners.x - corners.y - corners.z + corners.w;
    let near = origin + rate * from_m;
    let run_m = to_m - from_m;
    let rise_m = corners.x + east * near.x + north * near.y + twist * near.x * near.y;
    let b = east * rate.x + north * rate.y + twist * (near.x * rate.y + near.y * rate.x);
    let c = twist * rate.x * rate.y;
    let end_m = rise_m + run_m * (b + c * run_m);
    if from_m == 0.0 {
        // The sample's own cell: the slope tends to the facet's.
        return max(end_m / to_m, b);
    }
    var slope = max(rise_m / from_m, end_m / to_m);
    if c < 0.0 {
        // Steepest where (rise(t) / t)' = 0, t from the sample.
        let q = (rise_m - b * from_m) / c;
        let after_m = q / (from_m + sqrt(max(from_m * from_m + q, 0.0)));
        if after_m > 0.0 && after_m < run_m {
            slope = max(slope, (rise_m + after_m * (b + c * after_m)) / (from_m + after_m));
        }
    }
    return slope;
}
