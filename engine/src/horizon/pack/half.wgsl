// The skyline from complex coefficients as half floats. Twin of `half.rs`.

override HORIZON_PAGES: u32 = 4u;

// Four complex coefficients, one in each lane.
struct HorizonCoefficients {
    re: vec4f,
    im: vec4f,
}

fn horizon_unpack(texel: vec4u) -> HorizonCoefficients {
    let a = unpack2x16float(texel.x);
    let b = unpack2x16float(texel.y);
    let c = unpack2x16float(texel.z);
    let d = unpack2x16float(texel.w);
    return HorizonCoefficients(vec4f(a.x, b.x, c.x, d.x), vec4f(a.y, b.y, c.y, d.y));
}

fn horizon_mix(a: HorizonCoefficients, b: HorizonCoefficients, share: f32) -> HorizonCoefficients {
    return HorizonCoefficients(mix(a.re, b.re, share), mix(a.im, b.im, share));
}

fn horizon_coefficients(horizon: HorizonGrid, offset: u32, page: u32, grid: vec2f) -> HorizonCoefficients {
    let cell = horizon_cell(horizon, page, grid);
    let south_west = horizon_unpack(horizon_texel(offset + cell.texels.x));
    let south_east = horizon_unpack(horizon_texel(offset + cell.texels.y));
    let north_west = horizon_unpack(horizon_texel(offset + cell.texels.z));
    let north_east = horizon_unpack(horizon_texel(offset + cell.texels.w));
    let south = horizon_mix(south_west, south_east, cell.share.x);
    let north = horizon_mix(north_west, north_east, cell.share.x);
    return horizon_mix(south, north, cell.share.y);
}

// Adds four terms Re Xₖ cos kA − Im Xₖ sin kA and their derivatives by A; `turned` is (cos kA, sin kA) of the first.
fn horizon_terms(coefficients: HorizonCoefficients, first: f32, turned: vec2f, step: vec2f) -> vec2f {
    let t1 = horizon_turn(turned, step);
    let t2 = horizon_turn(t1, step);
    let t3 = horizon_turn(t2, step);
    let cosines = vec4f(turned.x, t1.x, t2.x, t3.x);
    let sines = vec4f(turned.y, t1.y, t2.y, t3.y);
    let orders = first + vec4f(0.0, 1.0, 2.0, 3.0);
    let elevation_rad = dot(coefficients.re, cosines) - dot(coefficients.im, sines);
    let slope = -dot(coefficients.re * orders, sines) - dot(coefficients.im * orders, cosines);
    return vec2f(elevation_rad, slope);
}

// All coefficients at a point: what is read once for any number of azimuths.
struct HorizonProfile {
    page_0: HorizonCoefficients,
    page_1: HorizonCoefficients,
    page_2: HorizonCoefficients,
    page_3: HorizonCoefficients,
}

// At a grid point counted in nodes from the first seen one.
fn horizon_profile(horizon: HorizonGrid, grid: vec2f) -> HorizonProfile {
    var profile: HorizonProfile;
    profile.page_0 = horizon_coefficients(horizon, horizon.offset_0, 0u, grid);
    if HORIZON_PAGES > 1u {
        profile.page_1 = horizon_coefficients(horizon, horizon.offset_1, 1u, grid);
    }
    if HORIZON_PAGES > 2u {
        profile.page_2 = horizon_coefficients(horizon, horizon.offset_2, 2u, grid);
    }
    if HORIZON_PAGES > 3u {
        profile.page_3 = horizon_coefficients(horizon, horizon.offset_3, 3u, grid);
    }
    return profile;
}

// Elevation of the skyline, in radians, and its derivative by map azimuth, towards the unit map direction (X, Y) =
// (sin A, cos A). Angles kA are reached by turning, so no trigonometric function is called.
fn horizon_towards(profile: HorizonProfile, towards: vec2f) -> vec2f {
    let step = towards.yx;
    let two = horizon_turn(step, step);
    let four = horizon_turn(two, two);
    let eight = horizon_turn(four, four);
    let twelve = horizon_turn(eight, four);
    var sum = horizon_terms(profile.page_0, 0.0, vec2f(1.0, 0.0), step);
    if HORIZON_PAGES > 1u {
        sum += horizon_terms(profile.page_1, 4.0, four, step);
    }
    if HORIZON_PAGES > 2u {
        sum += horizon_terms(profile.page_2, 8.0, eight, step);
    }
    if HORIZON_PAGES > 3u {
        sum += horizon_terms(profile.page_3, 12.0, twelve, step);
    }
    return sum;
}

// Both at once.
fn horizon_elevation(horizon: HorizonGrid, grid: vec2f, towards: vec2f) -> vec2f {
    return horizon_towards(horizon_profile(horizon, grid), towards);
}
