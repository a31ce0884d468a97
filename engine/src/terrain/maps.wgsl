// The maps of a terrain and their levels.

// A map: how to carry a ray into it, and its levels, finest first.
struct MapFace {
    // Rows of the rotation from camera axes to map axes.
    from_camera_x: vec4f,
    from_camera_y: vec4f,
    from_camera_z: vec4f,
    // Centre of projection to camera, in map axes; w is R.
    camera_m: vec4f,
    // (x0/z0, y0/z0, R/z0) of the camera, and its lifted height; only where `direct`.
    quotient: vec4f,
    // Seen part of the outermost level: west, south, east, north.
    bounds_m: vec4f,
    // Towards its ground, and the bare body there, in camera axes; w is the least cosine with that.
    cone: vec4f,
    first_level: u32,
    levels: u32,
    // 1 where the camera stands well above the map's plane, so that rays start at the camera.
    direct: u32,
    // 1 where the ground beyond the edge is unknown.
    open_edge: u32,
}

// The seen part of a level.
struct MapLevel {
    // The camera's cell, and the camera within it (0 and the raw position where not `direct`).
    base: vec2i,
    camera: vec2f,
    south_west_m: vec2f,
    posting_m: f32,
    columns: u32,
    rows: u32,
    mips: u32,
    heights_offset: u32,
    maxima_offset: u32,
    // Where the horizon map's resolution levels begin.
    horizon: vec4u,
    face: u32,
    horizon_table: u32,
    // Where the numbers of its points of bounced light begin, and nodes from one point to the next.
    bounced: vec2u,
}
