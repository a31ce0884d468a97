// Horizon maps evaluated once for each node towards a light: two numbers that `node_value` makes of a map.

struct NodesParameters {
    // Direction of the light from the centre of projection in map axes, and 1/distance.
    direction: vec4f,
    south_west_m: vec2f,
    posting_m: f32,
    radius_m: f32,
    // Where the field begins, in texels.
    offset: u32,
    columns: u32,
    rows: u32,
    horizon_table: u32,
    horizon: vec4u,
    // Of the light's disc.
    radius_rad: f32,
    padding: array<u32, 3>,
}

@group(0) @binding(4) var<storage, read> nodes: NodesParameters;
@group(0) @binding(5) var<storage, read_write> fields: array<vec4u>;

fn value_of(node: u32) -> vec2f {
    let grid = vec2f(f32(node % nodes.columns), f32(node / nodes.columns));
    let at_m = nodes.south_west_m + grid * nodes.posting_m;
    let s = nodes.direction.xyz - vec3f(at_m, nodes.radius_m) * nodes.direction.w;
    let horizon = HorizonGrid(nodes.columns, nodes.rows, nodes.horizon_table, nodes.horizon.x, nodes.horizon.y, nodes.horizon.z, nodes.horizon.w);
    return node_value(horizon, grid, at_m, s);
}

// Two nodes an invocation.
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let node = 2u * (id.y * groups.x * 64u + id.x);
    let count = nodes.columns * nodes.rows;
    if node >= count {
        return;
    }
    let even = value_of(node);
    let odd = value_of(min(node + 1u, count - 1u));
    fields[nodes.offset + node / 2u] = bitcast<vec4u>(vec4f(even, odd));
}
