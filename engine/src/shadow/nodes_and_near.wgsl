// Skylines of nodes, interpolated, and what they leave out: see `near.rs`.

fn light_over_terrain(facet: Facet, index: u32, light: LightParameters, s: vec3f, plane: vec3f) -> DiskLight {
    let towards = direction_to_light(facet, s);
    if all(towards == vec2f(0.0)) {
        return disk_light(-1.0e3, 0.0, plane);
    }
    let far = field_at(map_levels[facet.level], index, facet.grid);
    let skyline = over_near_terrain(facet, far, towards, s, light.radius_rad);
    return light_above_skyline(facet, skyline, towards, s, light.radius_rad, plane);
}
