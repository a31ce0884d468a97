// Which rays an image of depths holds.

// What part of the plane z = 1 of the camera an image of depths shows.
struct RayWindow {
    low: vec2f,
    // Texels per unit.
    scale: vec2f,
    columns: u32,
    rows: u32,
    // Depths of a row. 0: the camera is under the mesh, and rays start at it.
    pitch: u32,
    // Depth times distance along the camera's axis.
    near_m: f32,
}
