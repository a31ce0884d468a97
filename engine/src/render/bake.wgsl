// Series evaluated once per node towards a light: elevation and slope by map azimuth, or a lighting factor and 0.

struct BakeParameters {
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

@group(0) @binding(4) var<storage, read> bake: BakeParameters;
@group(0) @binding(5) var<storage, read_write> fields: array<vec4u>;
@group(0) @binding(6) var<storage, read> disk_tables: array<f32>;

override FACTORS: bool;

fn baked_skyline(node: u32) -> vec2f {
    let grid = vec2f(f32(node % bake.columns), f32(node / bake.columns));
    let at_m = bake.south_west_m + grid * bake.posting_m;
    let s = bake.direction.xyz - vec3f(at_m, bake.radius_m) * bake.direction.w;
    let direction = s.xy - at_m * (s.z / bake.radius_m);
    let horizon = HorizonGrid(bake.columns, bake.rows, bake.horizon_table, bake.horizon.x, bake.horizon.y, bake.horizon.z, bake.horizon.w);
    if FACTORS {
        let poise = Poise(at_m, bake.radius_m, normalize(vec3f(at_m, bake.radius_m)), normalize(s), bake.radius_rad);
        return vec2f(visible_share(horizon_profile(horizon, grid), poise), 0.0);
    }
    let towards = direction * inverseSqrt(max(dot(direction, direction), 1.0e-30));
    return horizon_elevation(horizon, grid, towards);
}

// Two nodes an invocation.
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let node = 2u * (id.y * groups.x * 64u + id.x);
    let nodes = bake.columns * bake.rows;
    if node >= nodes {
        return;
    }
    let even = baked_skyline(node);
    let odd = baked_skyline(min(node + 1u, nodes - 1u));
    fields[bake.offset + node / 2u] = bitcast<vec4u>(vec4f(even, odd));
}
