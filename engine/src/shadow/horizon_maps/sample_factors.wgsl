// Lighting factors of horizon maps, found at every sample.

fn light_over_terrain(facet: Facet, index: u32, light: LightParameters, s: vec3f, plane: vec3f) -> DiskLight {
    if plane.x <= 0.0 {
        return NO_LIGHT;
    }
    let level = map_levels[facet.level];
    let grid = HorizonGrid(level.columns, level.rows, level.horizon_table, level.horizon.x, level.horizon.y, level.horizon.z, level.horizon.w);
    let geometry = DiscGeometry(facet.at_m, facet.radius_m, facet.up, s, light.radius_rad);
    return DiskLight(visible_share(horizon_profile(grid, facet.grid), geometry), vec2f(0.0));
}
