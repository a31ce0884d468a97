// Fields of two numbers for each node of each level towards each light. They may be larger than one binding: pages of
// 2^FIELD_PAGE_BITS nodes, none of which cuts a field.

@group(0) @binding(0) var<storage, read> field_page_0: array<vec2f>;
@group(0) @binding(1) var<storage, read> field_page_1: array<vec2f>;
@group(0) @binding(2) var<storage, read> field_page_2: array<vec2f>;
@group(0) @binding(3) var<storage, read> field_page_3: array<vec2f>;

override FIELD_PAGE_BITS: u32;

fn field_node(node: u32) -> vec2f {
    let within = node & ((1u << FIELD_PAGE_BITS) - 1u);
    let page = node >> FIELD_PAGE_BITS;
    if page == 0u {
        return field_page_0[within];
    }
    if page == 1u {
        return field_page_1[within];
    }
    if page == 2u {
        return field_page_2[within];
    }
    return field_page_3[within];
}

// Bilinear between the nodes of a field; fields begin at whole texels of two nodes.
fn field_at(level: MapLevel, light: u32, grid: vec2f) -> vec2f {
    let far = vec2f(f32(level.columns - 1u), f32(level.rows - 1u));
    let at = clamp(grid, vec2f(0.0), far);
    let low = min(vec2u(at), vec2u(far) - 1u);
    let share = at - vec2f(low);
    let node = 2u * level.horizon[light] + low.y * level.columns + low.x;
    let south = mix(field_node(node), field_node(node + 1u), share.x);
    let north = mix(field_node(node + level.columns), field_node(node + level.columns + 1u), share.x);
    return mix(south, north, share.y);
}
