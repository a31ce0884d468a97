// Share and first moment of the Sun's light above a horizon line and above a facet's own plane.
//
// Lengths are solar radii in the tangent plane at the Sun. A single line across the disc has a closed form; two
// lines that do not cross inside the disc are sums of single ones; else columns parallel to one line are summed.
// Twin of solar_disk.rs and tangent_plane.rs. The pass declares `disk_tables: array<f32>`, filled by
// `SolarDisk::tables`: one table for each part of the disc, whose radiance is a power of the cosine.

override DISK_KNOTS: u32;
override DISK_COLUMNS: u32;
override DISK_PARTS: u32;

// Where the table of the part in hand begins.
var<private> disk_part: u32 = 0u;

struct DiskLight {
    fraction: f32,
    moment: vec2f,
}

// Where dot(normal, q) >= height; the normal has length 1.
struct HalfPlane {
    normal: vec2f,
    height: f32,
}

const NO_LIGHT = DiskLight(0.0, vec2f(0.0, 0.0));
const FULL_LIGHT = DiskLight(1.0, vec2f(0.0, 0.0));

// Beyond this cosine of its distance from the Sun the horizon counts as far off the disc.
const FARTHEST_COSINE = 0.1;
// Sine of the angle under which two lines count as parallel.
const PARALLEL_SINE = 1e-5;
const LEAST_LENGTH = 1e-6;

// Height and slope of the horizon at the Sun's azimuth as a line in the tangent plane, from its elevation, the
// derivative of that with azimuth (clockwise), sine and cosine of the Sun's elevation, and the angular radius.
fn horizon_line(elevation_rad: f32, slope: f32, sun_sine: f32, sun_cosine: f32, radius_rad: f32) -> vec2f {
    let sine = small_sine(elevation_rad);
    let cosine = max(small_cosine(elevation_rad), LEAST_LENGTH);
    let distance_sine = sine * sun_cosine - cosine * sun_sine;
    let distance_cosine = max(cosine * sun_cosine + sine * sun_sine, FARTHEST_COSINE);
    return vec2f(distance_sine / radius_rad, -slope / cosine) / distance_cosine;
}

// Taylor series to 6e-8 within a quarter turn; WGSL promises only 5e-4 of its own functions.
fn small_sine(x: f32) -> f32 {
    let z = x * x;
    return x * (1.0 + z * (-1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0 + z * (1.0 / 362880.0 - z / 39916800.0)))));
}

fn small_cosine(x: f32) -> f32 {
    let z = x * x;
    return 1.0 + z * (-0.5 + z * (1.0 / 24.0 + z * (-1.0 / 720.0 + z * (1.0 / 40320.0
        + z * (-1.0 / 3628800.0 + z / 479001600.0)))));
}

// `facet` is (n·s / r, n·e_x, n·e_y).
fn disk_light(horizon_height: f32, horizon_slope: f32, facet: vec3f) -> DiskLight {
    let horizon = half_plane(-horizon_height, vec2f(-horizon_slope, 1.0));
    let own = half_plane(facet.x, facet.yz);
    if max(horizon.height, own.height) >= 1.0 {
        return NO_LIGHT;
    }
    if max(horizon.height, own.height) <= -1.0 {
        return FULL_LIGHT;
    }
    if DISK_PARTS == 1u {
        return part_light(horizon, own);
    }
    var sum = NO_LIGHT;
    for (var part = 0u; part < DISK_PARTS; part++) {
        disk_part = part * (4u + 2u * DISK_KNOTS + 2u * DISK_COLUMNS);
        let light = part_light(horizon, own);
        sum.fraction += disk_tables[disk_part + 3u] * light.fraction;
        sum.moment += disk_tables[disk_part + 3u] * light.moment;
    }
    disk_part = 0u;
    sum.fraction = clamp(sum.fraction, 0.0, 1.0);
    return sum;
}

// What one part shows between two edges of which at least one cuts the disc, and none hides it.
fn part_light(horizon: HalfPlane, own: HalfPlane) -> DiskLight {
    if own.height <= -1.0 {
        return light_above(horizon);
    }
    if horizon.height <= -1.0 {
        return light_above(own);
    }
    return light_above_both(horizon, own);
}

// Irradiance of a facet over that of a plane that faces the whole Sun.
fn irradiance_factor(light: DiskLight, facet: vec3f, radius_rad: f32) -> f32 {
    return max(radius_rad * (facet.x * light.fraction + dot(facet.yz, light.moment)), 0.0);
}

// Where constant + dot(gradient, q) >= 0.
fn half_plane(constant: f32, gradient: vec2f) -> HalfPlane {
    let inverse = 1.0 / max(length(gradient), LEAST_LENGTH);
    return HalfPlane(gradient * inverse, -constant * inverse);
}

fn light_above(plane: HalfPlane) -> DiskLight {
    return DiskLight(share_above(plane.height), moment_above(plane.height) * plane.normal);
}

fn light_above_both(a: HalfPlane, b: HalfPlane) -> DiskLight {
    let sine = a.normal.x * b.normal.y - a.normal.y * b.normal.x;
    let cosine = dot(a.normal, b.normal);
    if abs(sine) < PARALLEL_SINE {
        if cosine < 0.0 {
            return light_between(a, b);
        }
        if a.height >= b.height {
            return light_above(a);
        }
        return light_above(b);
    }
    if lines_cross(a.height, b.height, sine, cosine) {
        // Columns along the line that hides more: they are shorter.
        if a.height >= b.height {
            return light_in_wedge(a, b, sine, cosine);
        }
        return light_in_wedge(b, a, -sine, cosine);
    }
    let a_above_b = a.height * cosine >= b.height;
    let b_above_a = b.height * cosine >= a.height;
    if a_above_b && b_above_a {
        return light_between(a, b);
    }
    if a_above_b {
        return light_above(a);
    }
    if b_above_a {
        return light_above(b);
    }
    return NO_LIGHT;
}

// What two caps that do not overlap leave of the disc.
fn light_between(a: HalfPlane, b: HalfPlane) -> DiskLight {
    let first = light_above(a);
    let second = light_above(b);
    let fraction = first.fraction + second.fraction - 1.0;
    if fraction <= 0.0 {
        return NO_LIGHT;
    }
    return DiskLight(fraction, first.moment + second.moment);
}

// Whether two lines meet inside the disc: a² + b² − 2ab cos < sin², written so that nearly parallel ones keep digits.
fn lines_cross(a: f32, b: f32, sine: f32, cosine: f32) -> bool {
    let turned = select(-b, b, cosine >= 0.0);
    let gap = a - turned;
    return gap * gap < sine * sine * (1.0 - 2.0 * a * turned / (1.0 + abs(cosine)));
}

// Columns parallel to the edge of `a`, from that edge to where the edge of `b` leaves the disc; the rest is whole.
fn light_in_wedge(a: HalfPlane, b: HalfPlane, sine: f32, cosine: f32) -> DiskLight {
    let side = sign(sine);
    let along = side * vec2f(-a.normal.y, a.normal.x);
    let end = min(b.height * cosine + sqrt(max(1.0 - b.height * b.height, 0.0)) * abs(sine), 1.0);
    let width = max(end - a.height, 0.0);
    let alpha = disk_tables[disk_part];
    var fraction = 0.0;
    var moment = vec2f(0.0, 0.0);
    for (var i = 0u; i < DISK_COLUMNS; i++) {
        let column = disk_part + 4u + 2u * DISK_KNOTS + 2u * i;
        let x = a.height + width * disk_tables[column];
        let square = max(1.0 - x * x, LEAST_LENGTH);
        let chord = sqrt(square);
        let t = clamp((b.height - cosine * x) / (abs(sine) * chord), -1.0, 1.0);
        let weight = width * disk_tables[column + 1u] * pow(square, 0.5 * (alpha + 1.0)) / disk_tables[disk_part + 1u];
        let share = disk_table(disk_part + 4u + DISK_KNOTS, t);
        fraction += weight * share;
        moment += weight * vec2f(x * share, chord * power_of_rest(t, 0.5 * alpha + 1.0) / ((alpha + 2.0) * disk_tables[disk_part + 2u]));
    }
    if cosine >= b.height {
        fraction += share_above(end);
        moment.x += moment_above(end);
    }
    return DiskLight(fraction, moment.x * a.normal + moment.y * along);
}

fn share_above(height: f32) -> f32 {
    return disk_table(disk_part + 4u, height);
}

fn moment_above(height: f32) -> f32 {
    let alpha = disk_tables[disk_part];
    return power_of_rest(height, 0.5 * (alpha + 3.0)) / ((alpha + 3.0) * disk_tables[disk_part + 1u]);
}

// (1 − x²)^exponent, 0 at the ends.
fn power_of_rest(x: f32, exponent: f32) -> f32 {
    let rest = (1.0 - x) * (1.0 + x);
    return select(pow(max(rest, LEAST_LENGTH), exponent), 0.0, rest < LEAST_LENGTH);
}

// A share above `at`, from DISK_KNOTS values of it over √(1 − |at|) from 0 to 1, linear between. Over that variable
// a share has no kink at the limb.
fn disk_table(first: u32, at: f32) -> f32 {
    let place = sqrt(max(1.0 - abs(at), 0.0)) * f32(DISK_KNOTS - 1u);
    let knot = min(u32(place), DISK_KNOTS - 2u);
    let share = mix(disk_tables[first + knot], disk_tables[first + knot + 1u], place - f32(knot));
    return select(share, 1.0 - share, at < 0.0);
}
