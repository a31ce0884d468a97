// Fields of two numbers for each node of each level towards each light.

@group(0) @binding(0) var<storage, read> fields: array<vec2f>;

// Bilinear between the nodes of a field; fields begin at whole texels of two nodes.
fn field_at(level: MapLevel, light: u32, grid: vec2f) -> vec2f {
    let far = vec2f(f32(level.columns - 1u), f32(level.rows - 1u));
    let at = clamp(grid, vec2f(0.0), far);
    let low = min(vec2u(at), vec2u(far) - 1u);
    let share = at - vec2f(low);
    let node = 2u * level.horizon[light] + low.y * level.columns + low.x;
    let south = mix(fields[node], fields[node + 1u], share.x);
    let north = mix(fields[node + level.columns], fields[node + level.columns + 1u], share.x);
    return mix(south, north, share.y);
}
