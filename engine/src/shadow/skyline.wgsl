// The light above a straight skyline.

// Unit map direction towards a light at a facet; 0 where it stands in the zenith.
fn direction_to_light(facet: Facet, s: vec3f) -> vec2f {
    let direction = s.xy - facet.at_m * (s.z / facet.radius_m);
    let length_2 = dot(direction, direction);
    if length_2 < 1.0e-12 {
        return vec2f(0.0);
    }
    return direction / sqrt(length_2);
}

// What is seen of a disc above a skyline of an elevation and a slope by map azimuth, given in the direction of the light.
fn light_above_skyline(facet: Facet, skyline: vec2f, towards: vec2f, s: vec3f, radius_rad: f32, plane: vec3f) -> DiskLight {
    let slope = skyline.y * azimuth_ratio(facet.at_m, facet.radius_m, towards);
    let sin_elevation = dot(s, facet.up);
    let cos_elevation = sqrt(max(1.0 - sin_elevation * sin_elevation, 0.0));
    let line = horizon_line(skyline.x, slope, sin_elevation, cos_elevation, radius_rad);
    return disk_light(line.x, line.y, plane);
}
