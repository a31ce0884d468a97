// How azimuths on a gnomonic map grow with those on the ground: the map stretches distances from its centre by 1/cos^2 c
// along and 1/cos c across.
fn azimuth_ratio(at_m: vec2f, map_radius_m: f32, towards: vec2f) -> f32 {
    let stretch = 1.0 + dot(at_m, at_m) / (map_radius_m * map_radius_m);
    let along = dot(at_m, towards) / map_radius_m;
    return (1.0 - along * along / stretch) * sqrt(stretch);
}
