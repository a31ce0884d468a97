// The share of a disc above a skyline, from the skyline's elevations at a few azimuths. Twin of `visibility.rs`.

// 0: middle value, 1: circular segment, 2: boxes, 3: line.
override VISIBILITY: u32 = 0u;
override BOXES: u32 = 1u;

// Least cosine of an elevation: nearer to the zenith the disc spans all azimuths.
const LEAST_LEVEL = 1.0e-6;

// A disc over a place of a map: where the place is, upward and towards the disc's centre, all in the map's axes.
struct DiscGeometry {
    at_m: vec2f,
    map_radius_m: f32,
    up: vec3f,
    s: vec3f,
    radius_rad: f32,
}

fn visible_share(profile: HorizonProfile, geometry: DiscGeometry) -> f32 {
    if DISK_PARTS == 1u {
        return visible_share_of_part(profile, geometry);
    }
    var share = 0.0;
    for (var part = 0u; part < DISK_PARTS; part++) {
        disk_part = part * (4u + 2u * DISK_KNOTS + 2u * DISK_COLUMNS);
        share += disk_tables[disk_part + 3u] * visible_share_of_part(profile, geometry);
    }
    disk_part = 0u;
    return clamp(share, 0.0, 1.0);
}

fn visible_share_of_part(profile: HorizonProfile, geometry: DiscGeometry) -> f32 {
    if VISIBILITY == 0u {
        return share_above(skyline_height(profile, geometry, 0.0));
    }
    if VISIBILITY == 1u {
        let start = skyline_height(profile, geometry, -1.0);
        let end = skyline_height(profile, geometry, 1.0);
        let slope = 0.5 * (end - start);
        return share_above(0.5 * (start + end) * inverseSqrt(1.0 + slope * slope));
    }
    if VISIBILITY == 2u {
        var light = 0.0;
        var weights = 0.0;
        for (var i = 0u; i < BOXES; i++) {
            let x = f32(2u * i + 1u) / f32(BOXES) - 1.0;
            let square = 1.0 - x * x;
            let chord = sqrt(square);
            let weight = pow(square, 0.5 * (disk_tables[disk_part] + 1.0));
            let height = clamp(skyline_height(profile, geometry, x) / chord, -1.0, 1.0);
            light += weight * disk_table(disk_part + 4u + DISK_KNOTS, height);
            weights += weight;
        }
        return light / weights;
    }
    let sine = dot(geometry.s, geometry.up);
    let horizon = horizon_towards(profile, beside(geometry, 0.0));
    let slope = horizon.y * azimuth_ratio(geometry.at_m, geometry.map_radius_m, beside(geometry, 0.0));
    let line = horizon_line(horizon.x, slope, sine, sqrt(max(1.0 - sine * sine, 0.0)), geometry.radius_rad);
    return share_above(line.x * inverseSqrt(1.0 + line.y * line.y));
}

// Height of the skyline at a column of the disc above the disc's centre, in radii.
fn skyline_height(profile: HorizonProfile, geometry: DiscGeometry, x: f32) -> f32 {
    let sun_sine = dot(geometry.s, geometry.up);
    let sun_cosine = sqrt(max(1.0 - sun_sine * sun_sine, 0.0));
    let offset_sine = clamp(small_sine(x * geometry.radius_rad) / max(sun_cosine, LEAST_LEVEL), -1.0, 1.0);
    let elevation_rad = horizon_towards(profile, beside(geometry, offset_sine)).x;
    let above_sine = small_sine(elevation_rad) * sun_cosine - small_cosine(elevation_rad) * sun_sine;
    return small_arcsine(above_sine) / geometry.radius_rad;
}

// The unit map direction of an azimuth, clockwise from that of the disc's centre by the angle of this sine.
fn beside(geometry: DiscGeometry, sine: f32) -> vec2f {
    let cosine = sqrt(max(1.0 - sine * sine, 0.0));
    let s = geometry.s;
    let turned = cosine * s + sine * cross(s, geometry.up) + (1.0 - cosine) * dot(s, geometry.up) * geometry.up;
    let direction = turned.xy - geometry.at_m * (turned.z / geometry.map_radius_m);
    return direction * inverseSqrt(max(dot(direction, direction), 1.0e-30));
}

// Taylor series to 1e-6 up to 0.3; beyond that it only has to be large.
fn small_arcsine(x: f32) -> f32 {
    let z = x * x;
    return x * (1.0 + z * (1.0 / 6.0 + z * (3.0 / 40.0 + z * (15.0 / 336.0 + z * (105.0 / 3456.0)))));
}
