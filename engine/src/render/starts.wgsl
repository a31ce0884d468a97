// Where view rays may start: before the coarse mesh that no ground stands out of, and how they step from there.

// Steps of a ray before it is cast exactly from where it is; 0: rays are cast exactly from the camera.
override STEPS: u32;

// Narrowings of the step that went through the ground: halvings and false positions in turns, a false position at last.
const NARROWINGS: u32 = 6u;
// Depths are interpolated with 24 bits.
const START_SHARE: f32 = 0.999;

// The distance before which a ray meets no maps; FAR_AWAY where it meets none at all. The mesh is sampled once a texel, so
// the nearest of nine is taken.
fn start_distance(plane_d: vec2f) -> f32 {
    if STEPS == 0u || window.pitch == 0u {
        return 0.0;
    }
    let at = vec2i(floor((plane_d - window.low) * window.scale));
    let last = vec2i(i32(window.columns), i32(window.rows)) - 1;
    var depth = 0.0;
    for (var row = max(at.y - 1, 0); row <= min(at.y + 1, last.y); row++) {
        for (var column = max(at.x - 1, 0); column <= min(at.x + 1, last.x); column++) {
            depth = max(depth, depths[u32(row) * window.pitch + u32(column)]);
        }
    }
    if depth == 0.0 {
        return FAR_AWAY;
    }
    return START_SHARE * window.near_m / depth * length(vec3f(plane_d, 1.0));
}

// The ground below a point of a ray.
struct GroundBelow {
    level: u32,
    cell: vec2i,
    height_m: f32,
}

// In the finest level that has it; the outermost one's edge beyond all.
fn ground_below(face: MapFace, ray: LiftedRay, sigma: f32) -> GroundBelow {
    let outermost = face.first_level + face.levels - 1u;
    for (var index = face.first_level; index <= outermost; index++) {
        let level = map_levels[index];
        let at = level_start(face, level, ray) + sigma * ray.step.xy / level.posting_m;
        let cells = vec2i(i32(level.columns), i32(level.rows)) - 1;
        let inside = vec2i(floor(at)) + level.base;
        let cell = clamp(inside, vec2i(0), cells - 1);
        if all(cell == inside) || index == outermost {
            let f = clamp(at - vec2f(cell - level.base), vec2f(0.0), vec2f(1.0));
            let low = mix(node_m(level, cell), node_m(level, cell + vec2i(1, 0)), f.x);
            let high = mix(node_m(level, cell + vec2i(0, 1)), node_m(level, cell + vec2i(1, 1)), f.x);
            return GroundBelow(index, cell, mix(low, high, f.y));
        }
    }
    return GroundBelow(outermost, vec2i(0), -FAR_AWAY);
}

// How far a ray is above the ground.
fn clearance_m(face: MapFace, ray: LiftedRay, sigma: f32) -> f32 {
    return ray.start.z + sigma * ray.step.z - ground_below(face, ray, sigma).height_m;
}

// What stepping has found. Where STEPS do not suffice there is no hit, and `sigma` is where the ray has come to.
struct Stepped {
    hit: SurfaceHit,
    sigma: f32,
}

// Steps of a cell's width from `ray.near` until the ground is above the ray.
fn step_to_ground(face: MapFace, ray: LiftedRay) -> Stepped {
    var above = ray.near;
    var sigma = ray.near;
    let speed = length(ray.step);
    for (var step = 0u; step < STEPS; step++) {
        let below = ground_below(face, ray, sigma);
        if ray.start.z + sigma * ray.step.z <= below.height_m {
            return Stepped(narrowed(face, ray, above, sigma), sigma);
        }
        above = sigma;
        if sigma >= ray.far {
            break;
        }
        sigma = min(sigma + map_levels[below.level].posting_m / speed, ray.far);
    }
    return Stepped(no_hit(), above);
}

// The meeting between a point above the ground and one below it.
fn narrowed(face: MapFace, ray: LiftedRay, above: f32, below: f32) -> SurfaceHit {
    var high = above;
    var low = below;
    var above_m = clearance_m(face, ray, high);
    var below_m = clearance_m(face, ray, low);
    for (var narrowing = 0u; narrowing < NARROWINGS; narrowing++) {
        let middle = select(0.5 * (high + low), false_position(high, low, above_m, below_m), (narrowing & 1u) == 1u);
        let clear_m = clearance_m(face, ray, middle);
        if clear_m <= 0.0 {
            low = middle;
            below_m = clear_m;
        } else {
            high = middle;
            above_m = clear_m;
        }
    }
    let sigma = false_position(high, low, above_m, below_m);
    let found = ground_below(face, ray, sigma);
    let level = map_levels[found.level];
    let at = level_start(face, level, ray) + sigma * ray.step.xy / level.posting_m;
    let fraction = clamp(at - vec2f(found.cell - level.base), vec2f(0.0), vec2f(1.0));
    let distance_m = ray.skipped_m + sigma * ray.z_m / (face.camera_m.w - sigma * ray.rate);
    return SurfaceHit(DEM, found.level, found.cell, fraction, distance_m);
}

// Where a line between two clearances passes zero.
fn false_position(high: f32, low: f32, above_m: f32, below_m: f32) -> f32 {
    return mix(high, low, above_m / max(above_m - below_m, 1.0e-30));
}

// The ray's parameter at a distance from the camera.
fn sigma_at(face: MapFace, ray: LiftedRay, distance_m: f32) -> f32 {
    let t = max(distance_m - ray.skipped_m, 0.0);
    let height_m = ray.z_m + t * ray.rate;
    return select(FAR_AWAY, face.camera_m.w * t / height_m, height_m > 0.0);
}
