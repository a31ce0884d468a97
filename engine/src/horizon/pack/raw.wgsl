// The skyline between sampled azimuths. Twin of `raw.rs`.

// Azimuths, the angle between two, and its half.
override HORIZON_SAMPLES: u32 = 8u;
override HORIZON_SECTOR_RAD: f32 = 0.785398163;
override HORIZON_SECTOR_COS: f32 = 0.707106781;
override HORIZON_SECTOR_SIN: f32 = 0.707106781;
override HORIZON_MIDDLE_COS: f32 = 0.923879533;
override HORIZON_MIDDLE_SIN: f32 = 0.382683432;

// Where in the sectors a direction (cos A, sin A) lies: i + t of `raw.rs`. The nearest middle of a sector is looked for, and
// the angle from there, at most 22.5°, is 2 atan of the tangent of its half: a series to 1e-8, where WGSL's atan2 may be off
// by the Sun's radius.
fn horizon_place(step: vec2f) -> vec2f {
    let sector = vec2f(HORIZON_SECTOR_COS, HORIZON_SECTOR_SIN);
    var middle = vec2f(HORIZON_MIDDLE_COS, HORIZON_MIDDLE_SIN);
    var nearest = middle;
    var index = 0u;
    for (var i = 1u; i < HORIZON_SAMPLES; i++) {
        middle = horizon_turn(middle, sector);
        if dot(middle, step) > dot(nearest, step) {
            nearest = middle;
            index = i;
        }
    }
    let across = nearest.x * step.y - nearest.y * step.x;
    let t = across / (1.0 + dot(nearest, step));
    let t2 = t * t;
    let angle_rad = 2.0 * t * (1.0 - t2 * (1.0 / 3.0 - t2 * (0.2 - t2 * (1.0 / 7.0 - t2 / 9.0))));
    return vec2f(f32(index), 0.5 + angle_rad / HORIZON_SECTOR_RAD);
}

// Elevation of sample `index` of a texel.
fn horizon_sample(offset: u32, texel: u32, index: u32) -> f32 {
    let word = texel * (HORIZON_SAMPLES / 2u) + index / 2u;
    let pair = unpack2x16float(horizon_texel(offset + word / 4u)[word % 4u]);
    return select(pair.x, pair.y, index % 2u == 1u);
}

// Sample `index` at a grid point.
fn horizon_sampled(offset: u32, cell: HorizonCell, index: u32) -> f32 {
    let south_west = horizon_sample(offset, cell.texels.x, index);
    let south_east = horizon_sample(offset, cell.texels.y, index);
    let north_west = horizon_sample(offset, cell.texels.z, index);
    let north_east = horizon_sample(offset, cell.texels.w, index);
    let south = mix(south_west, south_east, cell.share.x);
    let north = mix(north_west, north_east, cell.share.x);
    return mix(south, north, cell.share.y);
}

// Elevation of the skyline, in radians, and its derivative by map azimuth, at a grid point counted in nodes from the
// first seen one, towards the unit map direction (X, Y) = (sin A, cos A).
fn horizon_elevation(horizon: HorizonGrid, grid: vec2f, towards: vec2f) -> vec2f {
    let place = horizon_place(towards.yx);
    let cell = horizon_cell(horizon, 0u, grid);
    let index = u32(place.x);
    let start_rad = horizon_sampled(horizon.offset_0, cell, index);
    let end_rad = horizon_sampled(horizon.offset_0, cell, (index + 1u) % HORIZON_SAMPLES);
    return vec2f(mix(start_rad, end_rad, place.y), (end_rad - start_rad) / HORIZON_SECTOR_RAD);
}
