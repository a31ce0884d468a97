// The coarse mesh that view rays start at, into an image of depths; with `ray_window.wgsl` and `maps.wgsl`.

@group(0) @binding(0) var<storage, read> window: RayWindow;
@group(0) @binding(1) var<storage, read> map_faces: array<MapFace>;
@group(0) @binding(2) var<storage, read> map_levels: array<MapLevel>;
// Column, row and lifted height of each corner.
@group(0) @binding(3) var<storage, read> corners: array<f32>;
// A corner from the camera, in map axes. With v = sigma d of the corner's lifted image (see `surface.wgsl`) it is
// v z0/(R - v.z).
fn from_camera(face: MapFace, level: MapLevel, corner: vec3f) -> vec3f {
    let r = face.camera_m.w;
    if face.direct == 0u {
        let at_m = level.south_west_m + corner.xy * level.posting_m;
        return vec3f(at_m, r) * (r / (r - corner.z)) - face.camera_m.xyz;
    }
    let across_m = (vec2f(vec2i(corner.xy) - level.base) - level.camera) * level.posting_m;
    let down = (corner.z - face.quotient.w) / face.quotient.z;
    let v = vec3f(across_m + face.quotient.xy * down, down);
    return v * (face.camera_m.z / (r - v.z));
}

@vertex
fn corner(@builtin(vertex_index) vertex: u32, @builtin(instance_index) index: u32) -> @builtin(position) vec4f {
    let level = map_levels[index];
    let face = map_faces[level.face];
    let m = from_camera(face, level, vec3f(corners[3u * vertex], corners[3u * vertex + 1u], corners[3u * vertex + 2u]));
    let c = m.x * face.from_camera_x.xyz
        + m.y * face.from_camera_y.xyz + m.z * face.from_camera_z.xyz;
    let size = vec2f(f32(window.columns), f32(window.rows));
    // Texels, times depth along the camera's axis.
    let texel = (c.xy - window.low * c.z) * window.scale;
    return vec4f(2.0 * texel.x / size.x - c.z, c.z - 2.0 * texel.y / size.y, window.near_m, c.z);
}
