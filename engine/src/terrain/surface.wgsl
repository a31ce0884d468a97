// Where a ray meets the surface: f32, around the camera, with a stackless walk over maxima.
//
// A ray leaves the camera with direction d in a map's axes. With q = (x0/z0, y0/z0, R/z0) of its start,
// its lifted image is the line (X0, Y0, H0) + sigma (d.x - q.x d.z, d.y - q.y d.z, q.z d.z), where
// sigma = R t/(z0 + t d.z) for the distance t. Grid coordinates count from the camera's cell, so that
// they are small where they must be exact.

// What a ray met.
const MISS: u32 = 0u;
const DEM: u32 = 1u;
const GAP: u32 = 2u;
const BARE: u32 = 3u;

struct SurfaceHit {
    ground: u32,
    level: u32,
    cell: vec2i,
    fraction: vec2f,
    distance_m: f32,
}

// A ray in lifted coordinates of one map.
struct LiftedRay {
    start: vec3f,
    step: vec3f,
    // Distance already covered at sigma = 0, z0 there, and d.z.
    skipped_m: f32,
    z_m: f32,
    rate: f32,
    near: f32,
    far: f32,
    enters_by_edge: bool,
    leaves_by_edge: bool,
}

const FAR_AWAY: f32 = 3.0e38;
// Slopes above this mark gaps (see `passes.rs`).
const GAP_SLOPE: f32 = 1.0e20;

fn no_hit() -> SurfaceHit {
    return SurfaceHit(MISS, 0u, vec2i(0), vec2f(0.0), FAR_AWAY);
}

// A direction in camera axes turned into a map's.
fn map_direction(face: MapFace, camera_d: vec3f) -> vec3f {
    return vec3f(
        dot(face.from_camera_x.xyz, camera_d),
        dot(face.from_camera_y.xyz, camera_d),
        dot(face.from_camera_z.xyz, camera_d),
    );
}

// Narrows [near, far] to where value + rate t >= 0.
fn clip_side(interval: vec2f, value: f32, rate: f32) -> vec2f {
    if rate > 0.0 {
        return vec2f(max(interval.x, -value / rate), interval.y);
    }
    if rate < 0.0 {
        return vec2f(interval.x, min(interval.y, -value / rate));
    }
    if value < 0.0 {
        return vec2f(1.0, 0.0);
    }
    return interval;
}

// The ray over a map whose plane the camera is beside or behind: it starts where it enters the pyramid.
fn entry_distance(face: MapFace, d: vec3f) -> vec2f {
    let c = face.camera_m.xyz;
    let r = face.camera_m.w;
    var t = vec2f(0.0, FAR_AWAY);
    t = clip_side(t, r * c.x - face.bounds_m.x * c.z, r * d.x - face.bounds_m.x * d.z);
    t = clip_side(t, face.bounds_m.z * c.z - r * c.x, face.bounds_m.z * d.z - r * d.x);
    t = clip_side(t, r * c.y - face.bounds_m.y * c.z, r * d.y - face.bounds_m.y * d.z);
    t = clip_side(t, face.bounds_m.w * c.z - r * c.y, face.bounds_m.w * d.z - r * d.y);
    return clip_side(t, c.z - 0.01 * r, d.z);
}

fn lifted_ray(face: MapFace, d: vec3f) -> LiftedRay {
    var ray: LiftedRay;
    let r = face.camera_m.w;
    var quotient = face.quotient.xyz;
    ray.start = vec3f(r * quotient.xy, face.quotient.w);
    ray.skipped_m = 0.0;
    ray.z_m = face.camera_m.z;
    if face.direct == 0u {
        let t = entry_distance(face, d);
        if t.x >= t.y {
            ray.near = 1.0;
            ray.far = 0.0;
            return ray;
        }
        let p = face.camera_m.xyz + t.x * d;
        quotient = vec3f(p.xy, r) / p.z;
        ray.start = vec3f(r * quotient.xy, quotient.z * (p.z - r));
        ray.skipped_m = t.x;
        ray.z_m = p.z;
    }
    ray.step = vec3f(d.xy - quotient.xy * d.z, quotient.z * d.z);
    ray.rate = d.z;
    // Beyond this sigma the ray is at infinity.
    let end = select(FAR_AWAY, r / max(d.z, 1.0e-30), d.z > 0.0);
    var s = vec2f(0.0, end);
    s = clip_side(s, ray.start.x - face.bounds_m.x, ray.step.x);
    s = clip_side(s, face.bounds_m.z - ray.start.x, -ray.step.x);
    s = clip_side(s, ray.start.y - face.bounds_m.y, ray.step.y);
    s = clip_side(s, face.bounds_m.w - ray.start.y, -ray.step.y);
    ray.near = s.x;
    ray.far = s.y;
    ray.enters_by_edge = s.x > 0.0 || ray.skipped_m > 0.0;
    ray.leaves_by_edge = s.y < end;
    return ray;
}

fn node_m(level: MapLevel, cell: vec2i) -> f32 {
    return heights_m[level.heights_offset + u32(cell.y) * level.columns + u32(cell.x)];
}

// Where sigma leaves block `index` of blocks of `size` cells, along one axis.
fn block_exit(start: f32, step: f32, base: i32, index: i32, size: i32) -> f32 {
    if step > 0.0 {
        return (f32((index + 1) * size - base) - start) / step;
    }
    if step < 0.0 {
        return (f32(index * size - base) - start) / step;
    }
    return FAR_AWAY;
}

// The first sigma in [near, far] at which the ray is not above the cell's patch; FAR_AWAY if none.
fn hit_in_cell(level: MapLevel, cell: vec2i, start: vec3f, step: vec3f, near: f32, far: f32) -> f32 {
    let h00 = node_m(level, cell);
    let h10 = node_m(level, cell + vec2i(1, 0));
    let h01 = node_m(level, cell + vec2i(0, 1));
    let twist = h00 - h10 - h01 + node_m(level, cell + vec2i(1, 1));
    let corner = vec2f(cell - level.base);
    let p = start.xy + near * step.xy - corner;
    let w = far - near;
    let q = w * step.xy;
    // Height of the ray above the patch at near + u w: c + b u + a u^2.
    let c = start.z + near * step.z - (h00 + (h10 - h00) * p.x + (h01 - h00) * p.y + twist * p.x * p.y);
    let a = -twist * q.x * q.y;
    let b = w * step.z - (h10 - h00) * q.x - (h01 - h00) * q.y - twist * (p.x * q.y + p.y * q.x);
    if c <= 0.0 {
        return near;
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return FAR_AWAY;
    }
    let denominator = sqrt(discriminant) - b;
    if denominator <= 0.0 || 2.0 * c > denominator {
        return FAR_AWAY;
    }
    return near + w * (2.0 * c / denominator);
}

struct Found {
    sigma: f32,
    cell: vec2i,
}

// Walks a level from `near` to `far`: down a mip where the ray may meet a block, up where it may not.
fn walk_level(level: MapLevel, start: vec3f, step: vec3f, near: f32, far: f32) -> Found {
    let cells = vec2i(i32(level.columns), i32(level.rows)) - 1;
    var mip = i32(level.mips) - 1;
    var s = near;
    let at = start.xy + near * step.xy;
    var cell = clamp(vec2i(floor(at)) + level.base, vec2i(0), cells - 1);
    var block = cell >> vec2u(u32(mip));
    loop {
        let size = 1i << u32(mip);
        let exit_x = block_exit(start.x, step.x, level.base.x, block.x, size);
        let exit_y = block_exit(start.y, step.y, level.base.y, block.y, size);
        let next = clamp(min(exit_x, exit_y), s, far);
        let lowest_m = min(start.z + s * step.z, start.z + next * step.z);
        let blocks = (cells + vec2i(size - 1)) >> vec2u(u32(mip));
        let maximum_m = maxima_m[level.maxima_offset + mip_offset(cells, mip) + u32(block.y * blocks.x + block.x)];
        if lowest_m <= maximum_m {
            if mip > 0 {
                // Descend to the child that holds the ray at s.
                mip--;
                let child = vec2i(floor(start.xy + s * step.xy)) + level.base;
                block = clamp(child >> vec2u(u32(mip)), 2 * block, 2 * block + 1);
                block = min(block, ((cells + vec2i((1 << u32(mip)) - 1)) >> vec2u(u32(mip))) - 1);
                continue;
            }
            let sigma = hit_in_cell(level, block, start, step, s, next);
            if sigma <= far {
                return Found(sigma, block);
            }
        }
        if next >= far {
            break;
        }
        // The step enters a larger block where the new index is even going up, odd going down.
        var larger = false;
        if exit_x <= exit_y {
            block.x += select(-1, 1, step.x > 0.0);
            larger = (block.x & 1) == select(1, 0, step.x > 0.0);
        } else {
            block.y += select(-1, 1, step.y > 0.0);
            larger = (block.y & 1) == select(1, 0, step.y > 0.0);
        }
        if any(block < vec2i(0)) || any(block >= blocks) {
            break;
        }
        s = next;
        if larger && mip < i32(level.mips) - 1 {
            mip++;
            block = block >> vec2u(1u);
        }
    }
    return Found(FAR_AWAY, vec2i(0));
}

// Blocks in all mips below `mip`.
fn mip_offset(cells: vec2i, mip: i32) -> u32 {
    var offset = 0u;
    for (var m = 0; m < mip; m++) {
        let blocks = (cells + vec2i((1 << u32(m)) - 1)) >> vec2u(u32(m));
        offset += u32(blocks.x * blocks.y);
    }
    return offset;
}

// Grid coordinates of the ray's start, counted from the level's base.
fn level_start(face: MapFace, level: MapLevel, ray: LiftedRay) -> vec2f {
    if face.direct == 0u {
        return (ray.start.xy - level.south_west_m) / level.posting_m;
    }
    return level.camera;
}

fn walk_visit(face: MapFace, ray: LiftedRay, index: u32, near: f32, far: f32) -> SurfaceHit {
    if near >= far {
        return no_hit();
    }
    let level = map_levels[index];
    let start = vec3f(level_start(face, level, ray), ray.start.z);
    let step = vec3f(ray.step.xy / level.posting_m, ray.step.z);
    let found = walk_level(level, start, step, near, far);
    if found.sigma >= FAR_AWAY {
        return no_hit();
    }
    let fraction = clamp(start.xy + found.sigma * step.xy - vec2f(found.cell - level.base), vec2f(0.0), vec2f(1.0));
    let distance_m = ray.skipped_m + found.sigma * ray.z_m / (face.camera_m.w - found.sigma * ray.rate);
    return SurfaceHit(DEM, index, found.cell, fraction, distance_m);
}

// Where the ray lies over a level's seen part, inside [ray.near, ray.far].
fn over_level(face: MapFace, ray: LiftedRay, index: u32) -> vec2f {
    let level = map_levels[index];
    let extent = vec2f(f32(level.columns - 1u), f32(level.rows - 1u)) * level.posting_m;
    var s = vec2f(ray.near, ray.far);
    // Distances to the sides keep their digits around the camera.
    var from_low = ray.start.xy - level.south_west_m;
    if face.direct == 1u {
        from_low = (vec2f(level.base) + level.camera) * level.posting_m;
    }
    let to_high = extent - from_low;
    s = clip_side(s, from_low.x, ray.step.x);
    s = clip_side(s, to_high.x, -ray.step.x);
    s = clip_side(s, from_low.y, ray.step.y);
    return clip_side(s, to_high.y, -ray.step.y);
}

// Gap hits at an open edge: entering or leaving the terrain below its ground.
fn edge_gap(face: MapFace, ray: LiftedRay, sigma: f32) -> SurfaceHit {
    let distance_m = ray.skipped_m + sigma * ray.z_m / (face.camera_m.w - sigma * ray.rate);
    return SurfaceHit(GAP, 0u, vec2i(0), vec2f(0.0), distance_m);
}

fn enters_below_ground(face: MapFace, ray: LiftedRay) -> bool {
    let level = map_levels[face.first_level + face.levels - 1u];
    let at = (ray.start.xy + ray.near * ray.step.xy - level.south_west_m) / level.posting_m;
    let cells = vec2i(i32(level.columns), i32(level.rows)) - 1;
    let cell = clamp(vec2i(floor(at)), vec2i(0), cells - 1);
    let f = clamp(at - vec2f(cell), vec2f(0.0), vec2f(1.0));
    let low = mix(node_m(level, cell), node_m(level, cell + vec2i(1, 0)), f.x);
    let high = mix(node_m(level, cell + vec2i(0, 1)), node_m(level, cell + vec2i(1, 1)), f.x);
    return ray.start.z + ray.near * ray.step.z < mix(low, high, f.y);
}

fn leaves_below_sphere(face: MapFace, ray: LiftedRay) -> bool {
    let at = ray.start.xy + ray.far * ray.step.xy;
    let r = face.camera_m.w;
    let square = dot(at, at) / (r * r);
    let sphere_m = -r * square / (1.0 + sqrt(1.0 + square));
    return ray.start.z + ray.far * ray.step.z < sphere_m;
}

// The first meeting of a ray (camera axes) with the maps' ground, which is not nearer than `start_m`.
fn hit_face(index: u32, camera_d: vec3f, start_m: f32) -> SurfaceHit {
    let face = map_faces[index];
    let d = map_direction(face, camera_d);
    var ray = lifted_ray(face, d);
    if ray.near >= ray.far {
        return no_hit();
    }
    let open_edge = face.open_edge == 1u;
    if open_edge && ray.enters_by_edge && enters_below_ground(face, ray) {
        return edge_gap(face, ray, ray.near);
    }
    if start_m >= FAR_AWAY {
        ray.near = ray.far;
    } else if start_m > 0.0 {
        ray.near = clamp(sigma_at(face, ray, start_m), ray.near, ray.far);
        let stepped = step_to_ground(face, ray);
        if stepped.hit.ground != MISS {
            return stepped.hit;
        }
        ray.near = stepped.sigma;
    }
    // Outside in, then back out; `inner` is the interval of the next finer level.
    let outermost = face.first_level + face.levels - 1u;
    var hit = no_hit();
    var interval = vec2f(ray.near, ray.far);
    for (var level = outermost; hit.ground == MISS; level--) {
        var inner = vec2f(interval.y, interval.y);
        if level > face.first_level {
            let over = over_level(face, ray, level - 1u);
            inner = select(inner, over, over.x < over.y);
        }
        hit = walk_visit(face, ray, level, interval.x, inner.x);
        interval = inner;
        if level == face.first_level || inner.x >= inner.y {
            break;
        }
    }
    for (var level = face.first_level + 1u; level <= outermost && hit.ground == MISS; level++) {
        let inner = over_level(face, ray, level - 1u);
        if inner.x < inner.y {
            var far = ray.far;
            if level < outermost {
                far = over_level(face, ray, level).y;
            }
            hit = walk_visit(face, ray, level, inner.y, far);
        }
    }
    if hit.ground == MISS && open_edge && ray.leaves_by_edge && leaves_below_sphere(face, ray) {
        return edge_gap(face, ray, ray.far);
    }
    return hit;
}

// Distance to the bare spheroid, FAR_AWAY where the ray misses it. `scaled_camera` is the camera over the
// radii with |.|^2 - 1 in w, both from f64; `scaled_d` the direction over the radii.
fn bare_distance(scaled_camera: vec4f, scaled_d: vec3f) -> f32 {
    let a = dot(scaled_d, scaled_d);
    let b = dot(scaled_camera.xyz, scaled_d);
    let discriminant = b * b - a * scaled_camera.w;
    if discriminant < 0.0 || b >= 0.0 {
        return FAR_AWAY;
    }
    return scaled_camera.w / (sqrt(discriminant) - b);
}

// True where a map sees the ground in the direction `p` from its centre of projection (map axes).
fn is_covered(face: MapFace, p: vec3f) -> bool {
    if p.z <= 0.0 {
        return false;
    }
    let at = face.camera_m.w * p.xy / p.z;
    return all(at >= face.bounds_m.xy) && all(at <= face.bounds_m.zw);
}
