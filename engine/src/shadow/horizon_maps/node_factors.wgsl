// Lighting factors of nodes, interpolated.

fn light_over_terrain(facet: Facet, index: u32, light: LightParameters, s: vec3f, plane: vec3f) -> DiskLight {
    if plane.x <= 0.0 {
        return NO_LIGHT;
    }
    return DiskLight(field_at(map_levels[facet.level], index, facet.grid).x, vec2f(0.0));
}
