//! Bounced light against the closed form of a bowl, and against a hemisphere of traced rays.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use perilune_engine::camera::Pose;
use perilune_engine::geometry::{Direction, Position};
use perilune_engine::horizon::Settings;
use perilune_engine::photometry::{Hapke, Reflectance};
use perilune_engine::render::direct::irradiance_w_m2;
use perilune_engine::render::{AlbedoRole, Bounce, Light, Renderer, Scene, View, planes};
use perilune_engine::shadow::Skylines;
use perilune_engine::shadow::traced::TracedShadow;
use perilune_engine::terrain::{Ground, Hit, Terrain};

use crate::conformance::gpu;
use crate::scenes::{self, Grid, SOLAR_IRRADIANCE_W_M2, SOLAR_RADIUS_RAD, flat_body, map};

/// A Sun at an elevation, in the direction of map +X, far away.
fn sun(elevation_deg: f64) -> Light {
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    let map = map(&flat_body());
    let towards = map.map_from_body.inverse().turn(DVec3::new(cos, 0.0, sin));
    let centre_m = map.body_from_lifted(DVec3::ZERO).vector_m();
    Light {
        position: Position::from_m(centre_m + 1.496e11 * towards),
        angular_radius_rad: SOLAR_RADIUS_RAD,
        irradiance_w_m2: SOLAR_IRRADIANCE_W_M2,
    }
}

fn with_bounce(terrain: Terrain, azimuths: usize, elevations: usize) -> Scene {
    let shadows = scenes::fourier(&terrain);
    let scene = scenes::scene(terrain);
    let bounce = Bounce::new(&scene.surface, shadows.maps().unwrap(), azimuths, elevations);
    scene.with_shadows(shadows).with_bounce(bounce)
}

/// Straight down from a height, onto the map's centre.
fn view(light: Light, height_m: f64) -> View {
    let map = map(&flat_body());
    let camera_position = map.body_from_lifted(DVec3::new(0.0, 0.0, height_m));
    let axes = [DVec3::X, -DVec3::Y, -DVec3::Z].map(|axis| map.map_from_body.inverse().turn(axis));
    let camera_from_body = perilune_engine::geometry::Rotation::from_axes(axes[0], axes[1], axes[2]);
    scenes::view(Pose { position: camera_position, camera_from_body }, vec![light])
        .with_optics(scenes::pinhole(33, 33, 40.0))
}

const RIM_M: f64 = 1000.0;

/// A spherical bowl of depth 400 m in a plain.
fn bowl() -> Terrain {
    let depth_m = 400.0;
    let radius_m = (RIM_M * RIM_M + depth_m * depth_m) / (2.0 * depth_m);
    Grid::square(1200.0, 20.0).terrain(&flat_body(), |at| {
        let inside = radius_m * radius_m - at.length_squared();
        if at.length() < RIM_M { radius_m - depth_m - inside.sqrt() } else { 0.0 }
    })
}

/// Bounced irradiance at a map point.
fn bounced(scene: &Scene, view: &View, at_m: DVec2) -> f64 {
    let shadow = perilune_engine::render::reference::shadow(scene, view, &Skylines::default()).unwrap();
    let light = scene.bounce.as_ref().unwrap().light(scene, view, shadow.as_deref());
    light.irradiance_w_m2(scene, &ground_at(scene, at_m))
}

/// The ground at a map point.
fn ground_at(scene: &Scene, at_m: DVec2) -> Hit {
    let face = &scene.surface.terrain.faces[0];
    let lifted = at_m.extend(face.levels[0].bilinear_m(face.levels[0].grid_from_map(at_m)).unwrap());
    Hit {
        ground: Ground::Dem { face: 0, level: 0, lifted },
        position: face.map.body_from_lifted(lifted),
        distance_m: 0.0,
    }
}

/// `E = A F₀ sin e f (1 − f)`, uniform over the bowl, with f = 1/(1 + (d/D)²/4), whether parts of it lie in shadow or not. The
/// lower the Sun, the smaller the sunlit part and the fewer the rays that meet it.
#[test]
fn a_bowl_bounces_the_same_light_onto_all_of_itself() {
    let f = 1.0 / (1.0 + 25.0 / 4.0);
    let places = [DVec2::ZERO, DVec2::new(300.0, 0.0), DVec2::new(-500.0, 200.0), DVec2::new(0.0, -700.0)];
    let worst = |azimuths: usize, elevations: usize, elevation_deg: f64| {
        let scene = with_bounce(bowl(), azimuths, elevations);
        let expected = 0.2 * SOLAR_IRRADIANCE_W_M2 * elevation_deg.to_radians().sin() * f * (1.0 - f);
        let view = view(sun(elevation_deg), 3000.0);
        let errors = places.map(|at_m| bounced(&scene, &view, at_m) / expected - 1.0);
        println!("{azimuths} × {elevations}, Sun at {elevation_deg}°: {expected:.3} W/m2, {errors:+.4?}");
        errors.into_iter().map(f64::abs).fold(0.0, f64::max)
    };
    for (elevation_deg, coarse, fine) in [(60.0, 0.015, 0.013), (30.0, 0.035, 0.028), (15.0, 0.14, 0.04)] {
        assert!(worst(16, 2, elevation_deg) < coarse, "{elevation_deg}°");
        assert!(worst(32, 4, elevation_deg) < fine, "{elevation_deg}°");
    }
}

/// The believed bounce at a node: 64 × 16 rays of equal form factor over the facet's hemisphere, each to the ground that it
/// meets, with that ground's own traced shadow.
fn by_rays(scene: &Scene, view: &View, node: [usize; 2]) -> f64 {
    let face = &scene.surface.terrain.faces[0];
    let lifted = face.levels[0].lifted_node(node[0], node[1]);
    let hit = |lifted: DVec3| Hit {
        ground: Ground::Dem { face: 0, level: 0, lifted },
        position: face.map.body_from_lifted(lifted),
        distance_m: 0.0,
    };
    let start = hit(lifted);
    let shadow = TracedShadow { surface: &scene.surface, settings: Settings::default() };
    PI * over_the_hemisphere(scene, view, &shadow, &start, |_, radiance| radiance)
}

/// The mean of something of the direction and the radiance of ground over rays of equal form factor.
fn over_the_hemisphere(
    scene: &Scene,
    view: &View,
    shadow: &TracedShadow,
    start: &Hit,
    of_ray: impl Fn(DVec3, f64) -> f64,
) -> f64 {
    let (azimuths, rings) = (64, 16);
    let normal = planes::normal(scene, start).unit();
    let (x, y) = normal.any_orthonormal_pair();
    let above = Position::from_m(start.position.vector_m() + 0.02 * normal);
    let mut sum = 0.0;
    for ring in 0..rings {
        let sine_2 = (f64::from(ring) + 0.5) / f64::from(rings);
        for azimuth in 0..azimuths {
            let turn = TAU * (f64::from(azimuth) + 0.5) / f64::from(azimuths);
            let direction = (turn.cos() * x + turn.sin() * y) * sine_2.sqrt() + (1.0 - sine_2).sqrt() * normal;
            let Some(met) = scene.surface.intersect(above, Direction::new(direction).unwrap()) else { continue };
            if !matches!(met.ground, Ground::Dem { .. }) {
                continue;
            }
            let irradiance_w_m2 = irradiance_w_m2(scene, Some(shadow), &met, (0, &view.lights[0]));
            let there = planes::normal(scene, &met).unit();
            let to_sun = met.position.direction_to(view.lights[0].position).unwrap().unit();
            let [mu0, mu] = [to_sun, -direction].map(|towards| there.dot(towards).max(0.0));
            let radiance = view.reflectance.brdf_sr(mu0, mu, to_sun.dot(-direction)) * irradiance_w_m2;
            sum += of_ray(direction, radiance);
        }
    }
    sum / f64::from(rings * azimuths)
}

/// Rough ground of waves under a low Sun: single points are off by what their few rays meet, the mean hardly.
#[test]
fn rough_ground_bounces_what_a_hemisphere_of_traced_rays_meets() {
    let waves = |at: DVec2| {
        let [a, b, c] = [(0.011, 0.004), (-0.006, 0.013), (0.021, -0.017)].map(|(x, y)| (at.x * x + at.y * y).sin());
        60.0 * a + 45.0 * b + 20.0 * c
    };
    let nodes: Vec<[usize; 2]> =
        (20..=100).step_by(16).flat_map(|row| (20..=100).step_by(16).map(move |column| [column, row])).collect();
    for law in [Reflectance::lambert(0.2), Reflectance::Hapke(Hapke::moon())] {
        let mut believed = Vec::new();
        for (azimuths, elevations, most_bias, most_rms) in [(16, 2, 0.07, 0.2), (32, 4, 0.015, 0.09)] {
            let terrain = Grid::square(1200.0, 20.0).terrain(&flat_body(), waves);
            let scene = with_bounce(terrain, azimuths, elevations);
            let view = view(sun(25.0), 3000.0).with_reflectance(law);
            if believed.is_empty() {
                believed = nodes.iter().map(|node| by_rays(&scene, &view, *node)).collect();
            }
            let shadow = perilune_engine::render::reference::shadow(&scene, &view, &Skylines::default()).unwrap();
            let light = scene.bounce.as_ref().unwrap().light(&scene, &view, shadow.as_deref());
            let level = &scene.surface.terrain.faces[0].levels[0];
            let at = |[column, row]: &[usize; 2]| ground_at(&scene, level.node_m(*column, *row));
            let got: Vec<f64> = nodes.iter().map(|node| light.irradiance_w_m2(&scene, &at(node))).collect();
            let mean = believed.iter().sum::<f64>() / believed.len() as f64;
            let bias = got.iter().sum::<f64>() / got.len() as f64 / mean - 1.0;
            let squares: f64 = got.iter().zip(&believed).map(|(a, b)| (a - b).powi(2)).sum();
            let rms = (squares / got.len() as f64).sqrt() / mean;
            println!(
                "{azimuths} × {elevations}: mean {mean:.3} W/m2, bias {:+.2} %, rms {:.1} % {law:?}",
                100.0 * bias,
                100.0 * rms
            );
            assert!(bias.abs() < most_bias && rms < most_rms, "{bias} {rms}");
        }
    }
}

/// In a spherical bowl of Lambert ground each order of light is the same everywhere, and the share `A f` of the one before.
#[test]
fn each_further_order_is_the_share_that_the_bowl_returns() {
    let f = 1.0 / (1.0 + 25.0 / 4.0);
    let view = view(sun(60.0), 3000.0);
    let of_orders = |orders: usize| {
        let scene = with_bounce(bowl(), 32, 4);
        let again = Bounce::new(&scene.surface, scene.shadows.maps().unwrap(), 32, 4).with_orders(orders);
        let scene = scene.with_bounce(again);
        bounced(&scene, &view, DVec2::new(300.0, 0.0))
    };
    let [once, twice, thrice] = [1, 2, 3].map(of_orders);
    let [second, third] = [(twice - once) / once, (thrice - twice) / (twice - once)];
    println!("second over first {second:.4}, third over second {third:.4}, closed form {:.4}", 0.2 * f);
    assert!((second / (0.2 * f) - 1.0).abs() < 0.03 && (third / (0.2 * f) - 1.0).abs() < 0.05);
}

/// Light that a bowl of Hapke's ground gathers from its sunlit wall, reflected towards a camera: by sectors, as if all came along
/// the normal, as if all came from its mean direction, against rays over the hemisphere.
#[test]
fn bounced_light_is_reflected_from_where_it_comes() {
    let law = Reflectance::Hapke(Hapke::moon());
    let scene = with_bounce(bowl(), 32, 4);
    let shadow = TracedShadow { surface: &scene.surface, settings: Settings::default() };
    let mut worst = [0.0_f64; 2];
    for sun_deg in [15.0, 60.0] {
        let view = view(sun(sun_deg), 3000.0).with_reflectance(law);
        let light = scene.bounce.as_ref().unwrap().light(&scene, &view, Some(&shadow));
        for at_m in [DVec2::ZERO, DVec2::new(300.0, 0.0), DVec2::new(-500.0, 200.0), DVec2::new(0.0, -700.0)] {
            let here = ground_at(&scene, at_m);
            let by_rays_w_m2 = PI * over_the_hemisphere(&scene, &view, &shadow, &here, |_, radiance| radiance);
            for towards in [DVec3::Z, DVec3::new(0.5, 0.2, 1.0), DVec3::new(-1.0, 0.3, 1.0), DVec3::new(-0.4, 0.9, 0.8)]
            {
                let towards = map(&flat_body()).map_from_body.inverse().turn(towards.normalize());
                let expected = reflected_by_rays(&scene, &view, &shadow, &here, towards);
                let got = light.radiance(&scene, &view, &here, Direction::new(towards).unwrap());
                let mu = planes::normal(&scene, &here).unit().dot(towards);
                // Over the irradiance, which has an error of its own.
                let expected = expected / by_rays_w_m2;
                let got = got / light.irradiance_w_m2(&scene, &here);
                let along_normal = law.brdf_sr(1.0, mu, mu);
                println!(
                    "Sun at {sun_deg}°, {at_m}: by rays {expected:.4}/sr, by sectors {got:.4}, along the normal {along_normal:.4}"
                );
                for (worst, value) in worst.iter_mut().zip([got, along_normal]) {
                    *worst = worst.max((value / expected - 1.0).abs());
                }
            }
        }
    }
    println!("by sectors off by up to {:.1} %, along the normal {:.1} %", 100.0 * worst[0], 100.0 * worst[1]);
    assert!(worst[0] < 0.1 && worst[1] > 0.5, "{worst:?}");
}

/// Radiance towards a direction of what rays over the hemisphere bring.
fn reflected_by_rays(scene: &Scene, view: &View, shadow: &TracedShadow, here: &Hit, towards: DVec3) -> f64 {
    let normal = planes::normal(scene, here).unit();
    let mu = normal.dot(towards);
    let light = |direction: DVec3, radiance: f64| {
        let mu0 = normal.dot(direction);
        view.reflectance.brdf_sr(mu0, mu, direction.dot(towards)) * radiance
    };
    PI * over_the_hemisphere(scene, view, shadow, here, light)
}

/// Both renderers add the same light, and none where nobody asks.
#[test]
fn renderers_agree_on_bounced_light() {
    let scene = with_bounce(bowl(), 8, 1);
    let view = view(sun(15.0), 3000.0).with_reflectance(Reflectance::Hapke(Hapke::moon()));
    // A map of w beside it: every number that varies over the ground takes part.
    let nodes = scene.surface.terrain.faces[0].levels[0].heights_m.len();
    let albedo = vec![vec![(0..nodes).map(|i| 0.2 + 0.03 * (i % 7) as f32).collect()]];
    let scene = scene.with_albedo(albedo, AlbedoRole::SingleScattering);
    let mean = |samples: &perilune_engine::render::Samples| {
        samples.pixels.iter().map(|pixel| f64::from(pixel.radiance_w_m2_sr)).sum::<f64>() / samples.pixels.len() as f64
    };
    let lit = Renderer::Reference.samples(&scene, &view).unwrap();
    if let Some(gpu) = gpu() {
        let device = Renderer::on(gpu).samples(&scene, &view).unwrap();
        for (a, b) in lit.pixels.iter().zip(&device.pixels) {
            let (a, b) = (a.radiance_w_m2_sr, b.radiance_w_m2_sr);
            assert!((a - b).abs() < 2e-3 * a.abs() + 1e-3, "{a} {b}");
        }
    }
    let scene = Scene { bounce: None, ..scene };
    let without = Renderer::Reference.samples(&scene, &view).unwrap();
    assert!(mean(&lit) > 1.002 * mean(&without), "{} {}", mean(&lit), mean(&without));
}

/// A map of the same `w` everywhere is the law with that `w`.
#[test]
fn an_even_map_of_single_scattering_albedo_is_the_law_with_it() {
    let terrain = bowl();
    let nodes = terrain.faces[0].levels[0].heights_m.len();
    let bright = Reflectance::Hapke(Hapke { single_scattering_albedo: 0.45, ..Hapke::moon() });
    let plain = scenes::scene(terrain);
    let mapped = plain.clone().with_albedo(vec![vec![vec![0.45; nodes]]], AlbedoRole::SingleScattering);
    let view = view(sun(40.0), 3000.0).with_optics(scenes::pinhole(9, 9, 12.0));
    let [a, b] = [(&plain, bright), (&mapped, Reflectance::Hapke(Hapke::moon()))]
        .map(|(scene, law)| Renderer::Reference.samples(scene, &view.clone().with_reflectance(law)).unwrap());
    for (a, b) in a.pixels.iter().zip(&b.pixels) {
        assert!((a.radiance_w_m2_sr / b.radiance_w_m2_sr - 1.0).abs() < 1e-6, "{a:?} {b:?}");
    }
}
