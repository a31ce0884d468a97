// Elevation and slope of the skyline by map azimuth.

fn node_value(horizon: HorizonGrid, grid: vec2f, at_m: vec2f, s: vec3f) -> vec2f {
    let direction = s.xy - at_m * (s.z / nodes.radius_m);
    let towards = direction * inverseSqrt(max(dot(direction, direction), 1.0e-30));
    return horizon_elevation(horizon, grid, towards);
}
