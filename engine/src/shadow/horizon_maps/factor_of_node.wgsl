// A lighting factor, and 0.

@group(0) @binding(6) var<storage, read> disk_tables: array<f32>;

fn node_value(horizon: HorizonGrid, grid: vec2f, at_m: vec2f, s: vec3f) -> vec2f {
    let geometry = DiscGeometry(at_m, nodes.radius_m, normalize(vec3f(at_m, nodes.radius_m)), normalize(s), nodes.radius_rad);
    return vec2f(visible_share(horizon_profile(horizon, grid), geometry), 0.0);
}
