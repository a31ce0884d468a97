// Encodings that are read anew for each azimuth: a profile is where to read.

struct HorizonProfile {
    horizon: HorizonGrid,
    grid: vec2f,
}

fn horizon_profile(horizon: HorizonGrid, grid: vec2f) -> HorizonProfile {
    return HorizonProfile(horizon, grid);
}

fn horizon_towards(profile: HorizonProfile, towards: vec2f) -> vec2f {
    return horizon_elevation(profile.horizon, profile.grid, towards);
}
