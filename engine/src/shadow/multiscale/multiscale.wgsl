// Skylines of the seen nodes of a level towards a light, from images of heights. Twin of multiscale.rs; an invocation is a
// node. Heights count from the node's own and places from whole texels, so that nothing of planetary size is rounded.

struct Nodes {
    // Towards the light from the centre of projection, in map axes.
    light: vec3f,
    swath_rad: f32,
    // Cosine and sine of half the swath.
    turn: vec2f,
    // The first seen node, and the way to the next one, in map radii.
    first: vec2f,
    spacing: f32,
    radius_m: f32,
    seen: vec2u,
    // Nodes from the level's edge to the first seen one.
    margin: u32,
    // Where the field begins.
    offset: u32,
    levels: u32,
    scales: u32,
}

struct Image {
    // The level's first node on the image, in whole texels and the rest, less a node's half.
    whole: vec2i,
    rest: vec2f,
    texels: vec2i,
    // Texels of a posting: few bits, of which products with whole numbers are exact, and the rest.
    rate: vec2f,
    per_m: f32,
    start: u32,
}

// A point of an image in whole texels, and the rest.
struct Place {
    whole: vec2i,
    rest: vec2f,
}

@group(0) @binding(0) var<storage, read> nodes: Nodes;
// The finest of this level and of each coarser one, then those of every scale.
@group(0) @binding(1) var<storage, read> images: array<Image>;
@group(0) @binding(2) var<storage, read> distances_m: array<f32>;
@group(0) @binding(3) var<storage, read> heights_m: array<f32>;
@group(0) @binding(4) var<storage, read_write> fields: array<vec2f>;

override EDGE: f32;
const NO_LEVEL: u32 = 0xffffffffu;
const NADIR_RAD: f32 = -1.5707964;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.y * groups.x * 64u + id.x;
    if index >= nodes.seen.x * nodes.seen.y { return; }
    let node = vec2u(index % nodes.seen.x, index / nodes.seen.x);
    let at = nodes.first + nodes.spacing * vec2f(node);
    let sideways = nodes.light.xy - at * nodes.light.z;
    let square = dot(sideways, sideways);
    let towards = select(vec2f(0.0, 1.0), sideways * inverseSqrt(square), square > 0.0);
    let along = nodes.turn.x * towards;
    let across = nodes.turn.y * vec2f(-towards.y, towards.x);
    let own = node + nodes.margin;
    let middle_rad = elevation_rad(own, at, towards);
    let left_rad = elevation_rad(own, at, along + across);
    let right_rad = elevation_rad(own, at, along - across);
    fields[nodes.offset + index] = vec2f(middle_rad, (right_rad - left_rad) / nodes.swath_rad);
}

// Of the skyline: the highest of the cubic B-spline over the scales, at them and halfway between.
fn elevation_rad(node: vec2u, at: vec2f, towards: vec2f) -> f32 {
    let own_m = heights_m[images[0].start + node.y * u32(images[0].texels.x) + node.x];
    // The last three elevations, the first and the last standing for what is beyond.
    var last = vec3f(0.0);
    var highest_rad = NADIR_RAD;
    for (var scale = 0u; scale < nodes.scales; scale++) {
        let way_m = towards * distances_m[scale];
        let level = level_at(node, way_m);
        if level == NO_LEVEL { break; }
        let row = (scale + 1u) * nodes.levels;
        let here_m = spline_m(images[row], node, vec2f(0.0), own_m);
        let there_m = spline_m(images[row + level], node, way_m, own_m);
        let tangent = elevation_tangent(at, towards, distances_m[scale], own_m + here_m, there_m - here_m);
        let next_rad = arc_tangent(tangent);
        if scale > 1u { highest_rad = max(highest_rad, highest_of_spline(last, next_rad)); }
        last = select(vec3f(select(last.yz, last.xy, scale == 1u), next_rad), vec3f(next_rad), scale == 0u);
    }
    highest_rad = max(highest_rad, highest_of_spline(last, last.z));
    return max(highest_rad, highest_of_spline(last.yzz, last.z));
}

// At the middle one of three values and halfway to the next.
fn highest_of_spline(last: vec3f, next: f32) -> f32 {
    return max((last.x + 4.0 * last.y + last.z) / 6.0, (last.x + 23.0 * (last.y + last.z) + next) / 48.0);
}

// `Gnomonic::elevation_tangent` of the way to a point at a distance that is higher above the sphere. The sphere's own
// fall is a difference of roots, here without its cancellation.
fn elevation_tangent(at: vec2f, towards: vec2f, distance_m: f32, height_m: f32, rise_m: f32) -> f32 {
    let distance = distance_m / nodes.radius_m;
    let along = dot(at, towards);
    let square = 1.0 + dot(at, at);
    let secant = sqrt(square);
    let bend = distance + 2.0 * along;
    let slope = rise_m / distance_m - bend / (secant + sqrt(square + distance * bend));
    let q = along / secant;
    return (slope * secant / (secant - height_m / nodes.radius_m) + q) / sqrt(1.0 - q * q);
}

// The finest level from the node's own on that holds the point so many metres from it.
fn level_at(node: vec2u, way_m: vec2f) -> u32 {
    for (var level = 0u; level < nodes.levels; level++) {
        let place = place_on(images[level], node, way_m);
        let texel = vec2f(place.whole) + place.rest;
        if all(texel >= vec2f(-EDGE)) && all(texel <= vec2f(images[level].texels - 1) + EDGE) { return level; }
    }
    return NO_LEVEL;
}

// The point so many metres from a node.
fn place_on(image: Image, node: vec2u, way_m: vec2f) -> Place {
    let middle = vec2f(node) + 0.5;
    let exact = image.rate.x * middle;
    let rest = (exact - floor(exact)) + image.rate.y * middle + image.rest + way_m * image.per_m;
    return Place(image.whole + vec2i(floor(exact)) + vec2i(floor(rest)), rest - floor(rest));
}

// The bicubic B-spline over the texels there, less a height.
fn spline_m(image: Image, node: vec2u, way_m: vec2f, less_m: f32) -> f32 {
    let place = place_on(image, node, way_m);
    let x = weights(place.rest.x);
    let y = weights(place.rest.y);
    var sum_m = 0.0;
    for (var row = 0; row < 4; row++) {
        let line = image.start + u32(clamp(place.whole.y + row - 1, 0, image.texels.y - 1) * image.texels.x);
        let columns = vec4u(clamp(place.whole.x + vec4i(-1, 0, 1, 2), vec4i(0), vec4i(image.texels.x - 1)));
        let west_m = vec2f(heights_m[line + columns.x], heights_m[line + columns.y]);
        let east_m = vec2f(heights_m[line + columns.z], heights_m[line + columns.w]);
        sum_m += y[row] * dot(x, vec4f(west_m, east_m) - less_m);
    }
    return sum_m;
}

fn weights(u: f32) -> vec4f {
    let v = 1.0 - u;
    return vec4f(v * v * v, 3.0 * u * u * u - 6.0 * u * u + 4.0, 3.0 * v * v * v - 6.0 * v * v + 4.0, u * u * u) / 6.0;
}
