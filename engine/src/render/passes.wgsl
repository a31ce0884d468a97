// Radiance, irradiance and Sun fraction of each pixel, and what its centre sees.

struct ViewParameters {
    // Rows of the rotation from camera axes to body-fixed axes.
    from_camera_x: vec4f,
    from_camera_y: vec4f,
    from_camera_z: vec4f,
    // Camera over the spheroid's radii; w is |.|^2 - 1.
    scaled_camera: vec4f,
    // The spheroid's radii, and the camera's body-fixed position.
    radii_m: vec4f,
    camera_m: vec4f,
    pixels: u32,
    // Of each pixel's rays those that this pass follows.
    first_ray: u32,
    until_ray: u32,
    // See `cut_short`.
    turns: u32,
}

// A luminous disc as one map (or the body, last) sees it.
struct LightParameters {
    // Direction from the centre of projection, and 1/distance.
    direction: vec4f,
    // Angular radius; irradiance of a plane that faces it.
    radius_rad: f32,
    irradiance_w_m2: f32,
    padding: vec2u,
}

struct Pixel {
    radiance: f32,
    irradiance: f32,
    fraction: f32,
    // Share of the samples that met the body; -1 where one met a gap, CUT_SHORT where loops were. Until the last ray is
    // followed all of these are sums.
    hit: f32,
}

const CUT_SHORT: f32 = -2.0;

struct Centre {
    ground: u32,
    level: u32,
    cell: u32,
    padding: u32,
    fraction: vec2f,
    distance_m: f32,
    padding_2: f32,
}

@group(0) @binding(4) var<storage, read> view: ViewParameters;
@group(0) @binding(5) var<storage, read> map_faces: array<MapFace>;
@group(0) @binding(6) var<storage, read> map_levels: array<MapLevel>;
@group(0) @binding(7) var<storage, read> lights: array<LightParameters>;
@group(0) @binding(8) var<storage, read> reflectance: ReflectanceParameters;
@group(0) @binding(9) var<storage, read> disk_tables: array<f32>;
@group(0) @binding(10) var<storage, read> heights_m: array<f32>;
// Two pages of 2^GRADIENT_PAGE_BITS nodes.
@group(0) @binding(11) var<storage, read> gradients: array<vec2f>;
@group(0) @binding(17) var<storage, read> more_gradients: array<vec2f>;
@group(0) @binding(12) var<storage, read> maxima_m: array<f32>;
@group(0) @binding(13) var<storage, read> albedos: array<f32>;
@group(0) @binding(18) var<storage, read> skies: array<f32>;
// Radiance over irradiance under an even sky: SKY_KNOTS over the root of the cosine of emission, SKY_ROWS times where
// ALBEDO_IS_W.
@group(0) @binding(21) var<storage, read> sky_reflectance: array<f32>;
// Vectors of bounced light by level, point and sector: three numbers each.
@group(0) @binding(22) var<storage, read> bounced: array<f32>;
// Which rays the depths of the coarse mesh are of, and those depths.
@group(0) @binding(19) var<storage, read> window: RayWindow;
@group(0) @binding(20) var<storage, read> depths: array<f32>;
@group(0) @binding(14) var<storage, read> rays: array<vec2f>;
@group(0) @binding(15) var<storage, read_write> pixels_out: array<Pixel>;
@group(0) @binding(16) var<storage, read_write> centres_out: array<Centre>;

// Rays of each pixel, how many of them (the first ones) are samples, and which one goes through the
// centre (RAYS where none is wanted).
override RAYS: u32;
override SAMPLES: u32;
override CENTRE: u32;
override FACES: u32;
override LIGHTS: u32;
override ALBEDO_MAP: bool;
// Whether its values are Hapke's w rather than factors on the reflectance.
override ALBEDO_IS_W: bool;
// Irradiance of a facet that sees the whole sky.
override SKY_W_M2: f32;
// Whether ground lights other ground.
override BOUNCES: bool;
override GRADIENT_PAGE_BITS: u32;
override MORE_GRADIENTS: bool;

const SKY_KNOTS = 65u;
const SKY_ROWS = 17u;
const SECTORS = 8u;

fn gradient(node: u32) -> vec2f {
    if MORE_GRADIENTS && (node >> GRADIENT_PAGE_BITS) > 0u {
        return more_gradients[node - (1u << GRADIENT_PAGE_BITS)];
    }
    return gradients[node];
}

// A place on the ground with all that lighting needs, in the axes of `frame` (a map, or FACES: the body).
struct Facet {
    frame: u32,
    up: vec3f,
    normal: vec3f,
    // From the centre of projection, in metres.
    position_m: vec3f,
    // On the map; the map's radius.
    at_m: vec2f,
    radius_m: f32,
    level: u32,
    // In nodes of the level's seen part.
    grid: vec2f,
    // Lifted.
    height_m: f32,
    // What multiplies the reflectance.
    albedo: f32,
    // Share of the sky that lights it.
    sky: f32,
    gap: bool,
}

// A direction in camera axes turned into body-fixed ones.
fn body_direction(camera_d: vec3f) -> vec3f {
    return vec3f(
        dot(view.from_camera_x.xyz, camera_d),
        dot(view.from_camera_y.xyz, camera_d),
        dot(view.from_camera_z.xyz, camera_d),
    );
}

// The first map from `from_face` on that a ray (camera axes) may meet; `FACES`: none. Apart from the walk over that map, for devices
// that run through code that none of their rays need.
fn next_face(from_face: u32, camera_d: vec3f) -> u32 {
    var face = from_face;
    while face < FACES && dot(map_faces[face].cone.xyz, camera_d) < map_faces[face].cone.w {
        face++;
    }
    return face;
}

fn first_hit(camera_d: vec3f, body_d: vec3f, start_m: f32) -> SurfaceHit {
    var nearest = no_hit();
    for (var face = next_face(0u, camera_d); face < FACES; face = next_face(face + 1u, camera_d)) {
        let hit = hit_face(face, camera_d, start_m);
        if hit.distance_m < nearest.distance_m {
            nearest = hit;
        }
    }
    let bare_m = bare_distance(view.scaled_camera, body_d / view.radii_m.xyz);
    if bare_m < nearest.distance_m && bare_m >= 0.0 {
        var covered = false;
        for (var face = next_face(0u, camera_d); face < FACES && !covered; face = next_face(face + 1u, camera_d)) {
            let map = map_faces[face];
            covered = is_covered(map, map.camera_m.xyz + bare_m * map_direction(map, camera_d));
        }
        if !covered {
            nearest = SurfaceHit(BARE, 0u, vec2i(0), vec2f(0.0), bare_m);
        }
    }
    return nearest;
}

// The slope of the smooth surface through a cell's nodes along one axis, as in terrain/patch.rs: at f.x along it and f.y
// across, from the rises over both sides and the corners' slopes along and across.
fn patch_slope(f: vec2f, rises: vec2f, low: vec2f, high: vec2f, low_above: vec2f, high_above: vec2f) -> f32 {
    let u = f.x;
    let v = f.y;
    let rise = mix(rises.x, rises.y, v * v * (3.0 - 2.0 * v))
        + v * (1.0 - v) * ((1.0 - v) * (high.y - low.y) - v * (high_above.y - low_above.y));
    return 6.0 * u * (1.0 - u) * rise
        + (1.0 + u * (3.0 * u - 4.0)) * mix(low.x, low_above.x, v)
        + u * (3.0 * u - 2.0) * mix(high.x, high_above.x, v);
}

fn dem_facet(hit: SurfaceHit) -> Facet {
    let level = map_levels[hit.level];
    let radius_m = map_faces[level.face].camera_m.w;
    let node = level.heights_offset + u32(hit.cell.y) * level.columns + u32(hit.cell.x);
    let g00 = gradient(node);
    let g10 = gradient(node + 1u);
    let g01 = gradient(node + level.columns);
    let g11 = gradient(node + level.columns + 1u);
    let steepest = max(max(abs(g00.x), abs(g10.x)), max(abs(g01.x), abs(g11.x)));
    let f = hit.fraction;
    let h00 = heights_m[node];
    let h10 = heights_m[node + 1u];
    let h01 = heights_m[node + level.columns];
    let h11 = heights_m[node + level.columns + 1u];
    let height_m = mix(mix(h00, h10, f.x), mix(h01, h11, f.x), f.y);
    let slope = vec2f(
        patch_slope(f, vec2f(h10 - h00, h11 - h01) / level.posting_m, g00, g10, g01, g11),
        patch_slope(f.yx, vec2f(h01 - h00, h11 - h10) / level.posting_m, g00.yx, g01.yx, g10.yx, g11.yx),
    );
    var facet: Facet;
    facet.frame = level.face;
    facet.level = hit.level;
    facet.grid = vec2f(hit.cell) + f;
    facet.at_m = level.south_west_m + facet.grid * level.posting_m;
    facet.radius_m = radius_m;
    facet.height_m = height_m;
    facet.up = normalize(vec3f(facet.at_m, radius_m));
    facet.normal = normalize(vec3f(-slope, 1.0 + (dot(slope, facet.at_m) - height_m) / radius_m));
    facet.position_m = vec3f(facet.at_m, radius_m) * (radius_m / (radius_m - height_m));
    facet.gap = steepest > GAP_SLOPE;
    facet.albedo = 1.0;
    if ALBEDO_MAP {
        let below = mix(albedos[node], albedos[node + 1u], f.x);
        let above = mix(albedos[node + level.columns], albedos[node + level.columns + 1u], f.x);
        facet.albedo = mix(below, above, f.y);
    }
    facet.sky = 1.0;
    if SKY_W_M2 > 0.0 {
        let below = mix(skies[node], skies[node + 1u], f.x);
        let above = mix(skies[node + level.columns], skies[node + level.columns + 1u], f.x);
        facet.sky = mix(below, above, f.y);
    }
    return facet;
}

fn bare_facet(hit: SurfaceHit, body_d: vec3f) -> Facet {
    var facet: Facet;
    facet.frame = FACES;
    facet.position_m = view.camera_m.xyz + hit.distance_m * body_d;
    facet.normal = normalize(facet.position_m / (view.radii_m.xyz * view.radii_m.xyz));
    facet.up = facet.normal;
    // Outside the map nothing changes, or the law's own w holds.
    facet.albedo = select(1.0, reflectance.single_scattering_albedo, ALBEDO_IS_W);
    facet.sky = 1.0;
    facet.gap = false;
    return facet;
}

// What is seen of a light's disc above the terrain and above the facet's own plane.
fn light_seen(facet: Facet, index: u32, light: LightParameters, s: vec3f, plane: vec3f) -> DiskLight {
    if facet.frame == FACES {
        return disk_light(-1.0e3, 0.0, plane);
    }
    // The shadow method's own: see shadow/device.rs.
    return light_over_terrain(facet, index, light, s, plane);
}

struct Sample {
    radiance: f32,
    irradiance: f32,
    fraction: f32,
}

// Radiance over irradiance of ground with a value of the map of albedos.
fn ground_sr(albedo: f32, mu0: f32, mu: f32, phase_cosine: f32) -> f32 {
    if ALBEDO_IS_W {
        var ground = reflectance;
        ground.single_scattering_albedo = clamp(albedo, 0.0, 1.0);
        return brdf_sr(ground, mu0, mu, phase_cosine);
    }
    return albedo * brdf_sr(reflectance, mu0, mu, phase_cosine);
}

// The value at x, 0 to 1, between even knots of the table for an even sky.
fn sky_along(row: u32, x: f32) -> f32 {
    let place = x * f32(SKY_KNOTS - 1u);
    let low = min(u32(place), SKY_KNOTS - 2u);
    let first = row * SKY_KNOTS + low;
    return mix(sky_reflectance[first], sky_reflectance[first + 1u], place - f32(low));
}

// Radiance over irradiance of ground with a value of the map of albedos, under an even sky.
fn sky_sr(albedo: f32, mu: f32) -> f32 {
    let x = sqrt(clamp(mu, 0.0, 1.0));
    if ALBEDO_IS_W {
        let w = clamp(albedo, 0.0, 1.0);
        let place = sqrt(1.0 - w) * f32(SKY_ROWS - 1u);
        let low = min(u32(place), SKY_ROWS - 2u);
        return w * mix(sky_along(low, x), sky_along(low + 1u, x), place - f32(low));
    }
    return albedo * sky_along(0u, x);
}

// Of a sector of a point.
fn bounced_vector(first: u32) -> vec3f {
    return vec3f(bounced[first], bounced[first + 1u], bounced[first + 2u]);
}

// Radiance by light from other ground: of each sector as from one direction.
fn bounced_radiance(facet: Facet, to_camera: vec3f, mu: f32) -> f32 {
    let level = map_levels[facet.level];
    let step = level.bounced.y;
    let last = vec2u(level.columns, level.rows) - 1u;
    let points = (last - 1u) / step + 2u;
    let at = clamp(facet.grid, vec2f(0.0), vec2f(last));
    let low = min(vec2u(at) / step, points - 2u);
    let low_node = vec2f(low * step);
    let f = (at - low_node) / (min(low_node + f32(step), vec2f(last)) - low_node);
    let point = level.bounced.x + 3u * SECTORS * (low.y * points.x + low.x);
    let above = point + 3u * SECTORS * points.x;
    var radiance = 0.0;
    for (var sector = 0u; sector < SECTORS; sector++) {
        let number = 3u * sector;
        let south = mix(bounced_vector(point + number), bounced_vector(point + 3u * SECTORS + number), f.x);
        let north = mix(bounced_vector(above + number), bounced_vector(above + 3u * SECTORS + number), f.x);
        let vector = mix(south, north, f.y);
        let irradiance = dot(facet.normal, vector);
        if irradiance > 0.0 {
            let towards = normalize(vector);
            let mu0 = min(dot(facet.normal, towards), 1.0);
            radiance += ground_sr(facet.albedo, mu0, mu, dot(towards, to_camera)) * irradiance;
        }
    }
    return radiance;
}

fn shade(facet: Facet, to_camera: vec3f) -> Sample {
    var sample = Sample(0.0, 0.0, 0.0);
    for (var index = 0u; index < LIGHTS; index++) {
        let light = lights[facet.frame * LIGHTS + index];
        let s = normalize(light.direction.xyz - facet.position_m * light.direction.w);
        let rise = facet.up - dot(facet.up, s) * s;
        let e_y = rise * inverseSqrt(max(dot(rise, rise), 1.0e-20));
        let e_x = cross(e_y, s);
        let plane = vec3f(dot(facet.normal, s) / light.radius_rad, dot(facet.normal, e_x), dot(facet.normal, e_y));
        let seen = light_seen(facet, index, light, s, plane);
        let irradiance = light.irradiance_w_m2 * irradiance_factor(seen, plane, light.radius_rad);
        if irradiance > 0.0 {
            let mu0 = min(irradiance / (light.irradiance_w_m2 * seen.fraction), 1.0);
            let mu = max(dot(facet.normal, to_camera), 0.0);
            sample.radiance += ground_sr(facet.albedo, mu0, mu, dot(s, to_camera)) * irradiance;
        }
        if index == 0u {
            sample.irradiance = irradiance;
            sample.fraction = seen.fraction;
        }
    }
    let mu = max(dot(facet.normal, to_camera), 0.0);
    if SKY_W_M2 > 0.0 {
        sample.radiance += sky_sr(facet.albedo, mu) * SKY_W_M2 * facet.sky;
    }
    if BOUNCES && facet.frame < FACES {
        sample.radiance += bounced_radiance(facet, to_camera, mu);
    }
    return sample;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let pixel = id.y * groups.x * 64u + id.x;
    if pixel >= view.pixels {
        return;
    }
    var sum = Sample(0.0, 0.0, 0.0);
    var hits = 0.0;
    var gap = false;
    if view.first_ray > 0u {
        let so_far = pixels_out[pixel];
        if so_far.hit == CUT_SHORT {
            return;
        }
        sum = Sample(so_far.radiance, so_far.irradiance, so_far.fraction);
        hits = max(so_far.hit, 0.0);
        gap = so_far.hit < 0.0;
    }
    for (var ray = view.first_ray; ray < view.until_ray; ray++) {
        let plane_d = rays[pixel * RAYS + ray];
        // The optics see nothing here.
        if plane_d.x > 1.0e20 {
            if ray == CENTRE {
                centres_out[pixel] = Centre(MISS, 0u, 0u, 0u, vec2f(0.0), 0.0, 0.0);
            }
            continue;
        }
        let camera_d = normalize(vec3f(plane_d, 1.0));
        let body_d = body_direction(camera_d);
        var hit = first_hit(camera_d, body_d, start_distance(plane_d));
        var facet: Facet;
        if hit.ground == DEM {
            facet = dem_facet(hit);
            if facet.gap {
                hit.ground = GAP;
            }
        } else if hit.ground == BARE {
            facet = bare_facet(hit, body_d);
        }
        if ray == CENTRE {
            let cell = u32(hit.cell.y) * map_levels[hit.level].columns + u32(hit.cell.x);
            centres_out[pixel] = Centre(hit.ground, hit.level, cell, 0u, hit.fraction, hit.distance_m, 0.0);
        }
        if ray >= SAMPLES || hit.ground == MISS {
            continue;
        }
        hits += 1.0;
        gap = gap || hit.ground == GAP;
        if hit.ground == GAP {
            continue;
        }
        var to_camera = -body_d;
        if facet.frame < FACES {
            to_camera = -map_direction(map_faces[facet.frame], camera_d);
        }
        let sample = shade(facet, to_camera);
        sum.radiance += sample.radiance;
        sum.irradiance += sample.irradiance;
        sum.fraction += sample.fraction;
    }
    var ground = 1.0;
    var samples = 1.0;
    if view.until_ray == RAYS {
        ground = max(hits, 1.0);
        samples = f32(SAMPLES);
    }
    let hit = select(hits / samples, -1.0, gap);
    pixels_out[pixel] = Pixel(
        sum.radiance / samples,
        sum.irradiance / ground,
        sum.fraction / ground,
        select(hit, CUT_SHORT, cut_short(view.turns)),
    );
}
