// Skylines of nodes, interpolated.

fn light_over_terrain(facet: Facet, index: u32, light: LightParameters, s: vec3f, plane: vec3f) -> DiskLight {
    let towards = direction_to_light(facet, s);
    if all(towards == vec2f(0.0)) {
        return disk_light(-1.0e3, 0.0, plane);
    }
    let skyline = field_at(map_levels[facet.level], index, facet.grid);
    return light_above_skyline(facet, skyline, towards, s, light.radius_rad, plane);
}
