//! Edges of shadows, traced and from horizon maps.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use glam::DVec2;
use perilune_engine::geometry::Body;
use perilune_engine::horizon::Settings;
use perilune_engine::render::{Quantity, Scene, planes};
use perilune_engine::shadow::{ShadowMethod, registry};
use perilune_engine::terrain::Terrain;

use crate::scenes::{self, Grid, Row, SOLAR_RADIUS_RAD, flat_body, map};

/// The Sun stands in the west, its light travels towards map +X.
const WEST_RAD: f64 = -FRAC_PI_2;

/// Edges along a row for each kind of shadow and each renderer.
fn edges_m(scenes: &[Scene], row: Row, sun: &perilune_engine::render::Light) -> Vec<(String, Vec<f64>)> {
    let map = scenes[0].surface.terrain.faces[0].map.clone();
    let view = row.view(&map, sun.clone());
    let of_scene = |scene: &Scene| -> Vec<(String, Vec<f64>)> {
        let all = scenes::samples(scene, &view);
        all.iter().map(|(renderer, samples)| (scenes::name(scene, renderer), row.edges_m(samples))).collect()
    };
    scenes.iter().flat_map(of_scene).collect()
}

/// How far an edge may lie from its closed form: a tenth of the posting where traced, all of it from a horizon map.
fn bound_m(name: &str, posting_m: f64) -> f64 {
    if name.contains("traced") { 0.1 * posting_m } else { posting_m }
}

/// A plateau 100 m high that ends at x = 0, over level ground, 8 km long.
fn step() -> Terrain {
    let grid = Grid { west_m: -400.0, south_m: -4000.0, columns: 141, rows: 401, posting_m: 20.0 };
    grid.terrain(&flat_body(), |at_m| if at_m.x <= 0.0 { 100.0 } else { 0.0 })
}

/// Reach across the edge: H cot e cos(A − A_wall). The posting is 20 m.
#[test]
fn the_shadow_of_a_step_ends_where_trigonometry_says() {
    let scenes = scenes::shadowed(step());
    let map = map(&flat_body());
    for (elevation_deg, turn_deg) in [(4.0f64, 0.0f64), (6.0, 0.0), (10.0, 0.0), (6.0, 40.0), (6.0, -40.0)] {
        let expected_m = 100.0 / elevation_deg.to_radians().tan() * turn_deg.to_radians().cos();
        let sun = scenes::sun(&map, WEST_RAD + turn_deg.to_radians(), elevation_deg.to_radians());
        let row = Row { west_m: expected_m - 200.0, east_m: expected_m + 200.0 };
        for (name, edges_m) in edges_m(&scenes, row, &sun) {
            println!("{elevation_deg}° {turn_deg}° {name}: {edges_m:?}, expected {expected_m:.1} m");
            assert_eq!(edges_m.len(), 1, "{name}");
            assert!(
                (edges_m[0] - expected_m).abs() < bound_m(&name, 20.0),
                "{name}: {edges_m:?}, expected {expected_m} m"
            );
        }
    }
}

/// A wall hides the Earth as it hides the Sun, here 10° below the horizon: with each kind of shadow the ground is dark up to where
/// the Earth's light comes over the edge.
#[test]
fn a_wall_hides_the_earth_as_it_hides_the_sun() {
    let map = map(&flat_body());
    let sun = scenes::sun(&map, 0.0, -10_f64.to_radians());
    let earth = scenes::sun(&map, WEST_RAD, 6_f64.to_radians());
    let earth = perilune_engine::render::Light { angular_radius_rad: 0.0166, irradiance_w_m2: 0.07, ..earth };
    let edge_m = 100.0 / 6_f64.to_radians().tan();
    let mut view = Row { west_m: edge_m - 500.0, east_m: edge_m + 500.0 }.view(&map, sun);
    view.lights.push(earth);
    let full = 0.07 * 6_f64.to_radians().sin() * 0.2 / std::f64::consts::PI;
    for scene in scenes::shadowed(step()) {
        for (renderer, samples) in scenes::samples(&scene, &view) {
            let name = scenes::name(&scene, renderer);
            for (at_m, _) in scenes::profile(&samples) {
                let pixel = samples.centres.iter().position(|hit| matches!(hit, Some(hit) if on(hit, at_m))).unwrap();
                let radiance = f64::from(samples.pixels[pixel].radiance_w_m2_sr);
                match at_m.x - edge_m {
                    // The disc is 2° wide: 150 m of penumbra to either side.
                    ..-300.0 => assert!(radiance < 0.01 * full, "{name} at {at_m}: {radiance}"),
                    400.0.. => assert!((radiance / full - 1.0).abs() < 0.01, "{name} at {at_m}: {radiance}"),
                    _ => {}
                }
            }
        }
    }
}

fn on(hit: &perilune_engine::terrain::Hit, at_m: DVec2) -> bool {
    matches!(hit.ground, perilune_engine::terrain::Ground::Dem { lifted, .. } if lifted.truncate() == at_m)
}

/// V(h) of the disc darkened as at 550 nm, six digits, where the plateau's skyline stands h radii above the
/// Sun's centre. Columns meet a smooth skyline to 1e-3. In the horizon map 15 harmonics end
/// jump/(15 π) = 5e-4 rad = 0.1 radii off, for the wall ends 65° to both sides: 0.06 of the disc.
#[test]
fn the_penumbra_of_a_straight_edge_is_the_share_of_the_disc() {
    let table = [
        (-0.90, 0.988485),
        (-0.50, 0.825893),
        (0.0, 0.5),
        (0.25, 0.328644),
        (0.50, 0.174107),
        (0.75, 0.055286),
        (0.90, 0.011515),
    ];
    let elevation_rad = 3f64.to_radians();
    let row = Row { west_m: 1700.0, east_m: 2150.0 };
    let map = map(&flat_body());
    let view = row.view(&map, scenes::sun(&map, WEST_RAD, elevation_rad));
    for scene in scenes::shadowed(step()) {
        let scene = scene.with_disk(scenes::disk(0.507909));
        let bound = if scene.shadows.is_exact() { 2e-3 } else { 0.06 };
        for (renderer, samples) in scenes::samples(&scene, &view) {
            let fractions = row.fractions(&samples);
            for (height, expected) in table {
                let at_m = 100.0 / (elevation_rad + height * SOLAR_RADIUS_RAD).tan();
                let next = fractions.partition_point(|(x_m, _)| *x_m < at_m);
                let [(x0, f0), (x1, f1)] = [fractions[next - 1], fractions[next]];
                let got = f0 + (f1 - f0) * (at_m - x0) / (x1 - x0);
                let name = scenes::name(&scene, renderer);
                assert!((got - expected).abs() < bound, "{name}, h = {height}: {got}, expected {expected}");
            }
        }
    }
}

/// The map's series rounds the plateau's corners off; its bounds know. Where refined, the device's light is the host's; elsewhere
/// it may be off by what bounds leave out.
#[test]
fn refinement_settles_what_horizon_maps_leave_open_and_sigma_says_where() {
    let row = Row { west_m: 1700.0, east_m: 2370.0 };
    let map = map(&flat_body());
    let view = row.view(&map, scenes::sun(&map, WEST_RAD, 3f64.to_radians()));
    let view = view.with_quantities([Quantity::SunFractionSigma]);
    let scene = |shadows: Arc<dyn ShadowMethod>| scenes::scene(step()).with_shadows(shadows);
    let traced = scene(registry::reference(Settings::default()));
    let truth = &scenes::samples(&traced, &view)[0].1;
    let maps = scene(scenes::fourier(&step()));
    let sigma = |scene: &Scene, samples: &_| planes::image(scene, &view, samples).planes[0].values.clone();
    assert!(sigma(&traced, truth).iter().all(|sigma| *sigma == 0.0));
    let rms = |samples: &planes::Samples| {
        let pairs = samples.pixels.iter().zip(&truth.pixels);
        let sum: f64 = pairs.map(|(a, b)| f64::from(a.sun_fraction - b.sun_fraction).powi(2)).sum();
        (sum / truth.pixels.len() as f64).sqrt()
    };
    let unrefined: Vec<_> = scenes::samples(&maps, &view).iter().map(|(_, samples)| rms(samples)).collect();
    let uncertain = sigma(&maps, &scenes::samples(&maps, &view)[0].1);
    let (lit, penumbra) = (uncertain[399], uncertain.iter().copied().fold(0.0, f32::max));
    assert!(lit == 0.0 && penumbra > 0.001, "{lit} {penumbra}");
    let refined = maps.with_refinement(Settings::default());
    for ((name, samples), unrefined) in scenes::samples(&refined, &view).iter().zip(unrefined) {
        println!("{name}: RMS {unrefined} of the disc, refined {}", rms(samples));
        assert!(rms(samples) < 0.1 * unrefined, "{name}: {} {unrefined}", rms(samples));
        assert!(sigma(&refined, samples).iter().all(|sigma| *sigma < 1e-6));
    }
    let swept = scene(scenes::towards().into_iter().next().unwrap());
    assert!(sigma(&swept, truth).iter().all(|sigma| sigma.is_nan()));
}

/// Apex 200 m above level ground, base radius 400 m, under a Sun 20° high and nearly a point: the tip lies at
/// H cot e. A truncated series rounds the skyline's peak off: its slopes jump by 2 (H/d) cot t with
/// t = asin(a/d), which costs jump/(π 15.5) = 0.014 rad there.
#[test]
fn the_tip_of_a_cones_shadow_lies_at_height_times_cotangent() {
    let terrain = Grid::square(800.0, 10.0).terrain(&flat_body(), |at| (200.0 * (1.0 - at.length() / 400.0)).max(0.0));
    let scenes = scenes::shadowed(terrain);
    let map = map(&flat_body());
    let elevation_rad = 20f64.to_radians();
    let expected_m = 200.0 / elevation_rad.tan();
    let sun = perilune_engine::render::Light { angular_radius_rad: 1e-4, ..scenes::sun(&map, WEST_RAD, elevation_rad) };
    for (name, edges_m) in edges_m(&scenes, Row { west_m: 405.0, east_m: 700.0 }, &sun) {
        let bound_m = if name.contains("traced") { 10.0 } else { 200.0 * 0.014 / elevation_rad.sin().powi(2) };
        assert_eq!(edges_m.len(), 1, "{name}");
        assert!((edges_m[0] - expected_m).abs() < bound_m, "{name}: {edges_m:?}, expected {expected_m} m");
    }
}

/// A spherical cap of depth 0.2 of its diameter: on the Sun's meridian the edge lies at x = Rc sin(2e − β),
/// towards the Sun positive.
#[test]
fn the_shadow_in_a_bowl_is_its_mirrored_rim() {
    let (rim_m, depth_m) = (1000.0f64, 400.0);
    let radius_m = (rim_m * rim_m + depth_m * depth_m) / (2.0 * depth_m);
    let beta_rad = (rim_m / radius_m).asin();
    let bowl = |at: DVec2| {
        let inside = radius_m * radius_m - at.length_squared();
        if at.length() < rim_m { radius_m - depth_m - inside.sqrt() } else { 0.0 }
    };
    let scenes = scenes::shadowed(Grid::square(1200.0, 20.0).terrain(&flat_body(), bowl));
    let map = map(&flat_body());
    for elevation_deg in [5.0f64, 10.0, 20.0, 30.0] {
        let x_m = radius_m * (2.0 * elevation_deg.to_radians() - beta_rad).sin();
        let sun = scenes::sun(&map, WEST_RAD, elevation_deg.to_radians());
        // The Sun stands towards −X.
        let row = Row { west_m: -x_m - 90.0, east_m: -x_m + 90.0 };
        for (name, edges_m) in edges_m(&scenes, row, &sun) {
            println!("{elevation_deg}° {name}: {edges_m:?}, expected {:.1} m", -x_m);
            assert!(edges_m.len() == 1, "{name} at {elevation_deg}°: {edges_m:?}");
            assert!(
                (edges_m[0] + x_m).abs() < bound_m(&name, 20.0),
                "{name} at {elevation_deg}°: {edges_m:?}, expected {} m",
                -x_m
            );
        }
    }
}

/// A straight step of 1 km along a great circle of the Moon: the ray over its top lands at R (e − acos((1 + H/R)
/// cos e)), at 2° Sun elevation 46 330 m and not 28 636 m away. The posting is 500 m. In the horizon map, a skyline
/// that ends 38° to both sides is met to 2e-4 rad, which at 2° is 3 % of the length.
#[test]
fn a_kilometre_high_step_shades_46_km_of_the_moon() {
    let grid = Grid { west_m: -4000.0, south_m: -150_000.0, columns: 121, rows: 601, posting_m: 500.0 };
    let terrain = grid.terrain(&Body::moon(), |at_m| if at_m.x <= 0.0 { 1000.0 } else { 0.0 });
    let scenes = scenes::shadowed(terrain);
    let map = map(&Body::moon());
    for (elevation_deg, expected_m) in [(2.0f64, 46_330.0), (3.0, 21_657.0), (5.0, 11_896.0)] {
        let sun = scenes::sun(&map, WEST_RAD, elevation_deg.to_radians());
        let row = Row { west_m: expected_m - 4000.0, east_m: expected_m + 4000.0 };
        for (name, edges_m) in edges_m(&scenes, row, &sun) {
            println!("{elevation_deg}° {name}: {edges_m:?}, expected {expected_m} m");
            let bound_m = bound_m(&name, 500.0).max(if name.contains("traced") { 0.0 } else { 0.03 * expected_m });
            assert_eq!(edges_m.len(), 1, "{name} {elevation_deg}");
            // The map stretches arcs: x = R tan(arc/R), 11 m here.
            assert!((edges_m[0] - expected_m).abs() < bound_m, "{name}: {edges_m:?}, expected {expected_m} m");
        }
    }
}

/// z = A sin kx, A = 100 m, wavelength 2 km: the shadow begins where the slope is the Sun's and ends on the next rise.
/// Expected values by bisection, three decimals. The posting is 25 m.
#[test]
fn ridges_shade_each_other_from_graze_to_landing() {
    let ridges = |at: DVec2| 100.0 * (TAU * at.x / 2000.0).sin();
    let scenes = scenes::shadowed(Grid::square(3000.0, 25.0).terrain(&flat_body(), ridges));
    let map = map(&flat_body());
    for (elevation_deg, begins_m, ends_m) in [(5.0f64, 589.832, 1931.544), (10.0, 689.686, 1657.863)] {
        let sun = scenes::sun(&map, WEST_RAD, elevation_deg.to_radians());
        for (name, edges_m) in edges_m(&scenes, Row { west_m: 450.0, east_m: 2100.0 }, &sun) {
            println!("{elevation_deg}° {name}: {edges_m:?}");
            assert_eq!(edges_m.len(), 2, "{name} {elevation_deg}: {edges_m:?}");
            assert!((edges_m[0] - begins_m).abs() < bound_m(&name, 25.0), "{name}: {edges_m:?}, expected {begins_m}");
            assert!((edges_m[1] - ends_m).abs() < bound_m(&name, 25.0), "{name}: {edges_m:?}, expected {ends_m}");
        }
    }
}

/// Neither acne nor a gap: a plane that slopes by 10° towards map −X is lit wholly or not at all, but for a
/// penumbra of one radius around the Sun in its plane. Half floats move it by 0.02 radii.
#[test]
fn a_constant_slope_shades_itself_at_once_or_not_at_all() {
    let slope = 10f64.to_radians().tan();
    let terrain = Grid::square(1000.0, 20.0).terrain(&flat_body(), |at_m| slope * at_m.x);
    let normal = glam::DVec3::new(-slope, 0.0, 1.0).normalize();
    let map = map(&flat_body());
    for scene in scenes::shadowed(terrain) {
        for azimuth_deg in (0..360).step_by(45) {
            for elevation_deg in [0.5f64, 2.0, 5.0, 9.0, 9.6, 10.4, 11.0, 20.0, 60.0] {
                let (azimuth_rad, elevation_rad) = (f64::from(azimuth_deg).to_radians(), elevation_deg.to_radians());
                let view = scenes::nadir(&map, DVec2::ZERO, 1500.0, scenes::sun(&map, azimuth_rad, elevation_rad));
                let view = view.with_optics(scenes::pinhole(12, 12, 24.0));
                let sun = map.map_from_body.turn(view.lights[0].position.vector_m()).normalize();
                let above_radii = normal.dot(sun).asin() / SOLAR_RADIUS_RAD;
                let expected = match above_radii {
                    x if x > 1.02 => 1.0,
                    x if x < -1.02 => 0.0,
                    _ => continue,
                };
                for (renderer, samples) in scenes::samples(&scene, &view) {
                    for (at_m, fraction) in scenes::profile(&samples) {
                        let name = scenes::name(&scene, renderer);
                        let error = (fraction - expected).abs();
                        assert!(error < 1e-3, "{name} {azimuth_deg}° {elevation_deg}° at {at_m}: {fraction}");
                    }
                }
            }
        }
    }
}

/// Only one of the eight ways to turn and mirror an image of an L-shaped wall's shadow fits the shadow that the Sun
/// casts: azimuths run clockwise from map +Y, rows up the map, image rows down.
#[test]
fn an_l_shaped_wall_casts_its_shadow_the_right_way_round() {
    const PIXELS: usize = 60;
    let inside = |p: DVec2| {
        let bar = |x: f64, y: f64| (-40.0..=x).contains(&p.x) && (-40.0..=y).contains(&p.y);
        bar(200.0, 0.0) || bar(0.0, 120.0)
    };
    let terrain = Grid::square(500.0, 10.0).terrain(&flat_body(), |at| if inside(at) { 80.0 } else { 0.0 });
    let map = map(&flat_body());
    let (azimuth_rad, elevation_rad) = (65f64.to_radians(), 20f64.to_radians());
    let towards = DVec2::new(azimuth_rad.sin(), azimuth_rad.cos());
    // 600 m across, from 6 km: relief moves the wall's top by less than a pixel.
    let focal_px = PIXELS as f64 * 6000.0 / 600.0;
    let view = scenes::nadir(&map, DVec2::ZERO, 6000.0, scenes::sun(&map, azimuth_rad, elevation_rad))
        .with_optics(scenes::pinhole(PIXELS as u32, PIXELS as u32, focal_px));
    let shaded = |column: usize, row: usize| {
        let middle = (PIXELS as f64 - 1.0) / 2.0;
        let p = 10.0 * DVec2::new(column as f64 - middle, middle - row as f64);
        let reach_m = 80.0 / elevation_rad.tan();
        !inside(p) && (0..1000).any(|i| inside(p + towards * (reach_m * f64::from(i) / 1000.0)))
    };
    for scene in scenes::shadowed(terrain) {
        for (renderer, samples) in scenes::samples(&scene, &view) {
            let agreement = |turn: usize| {
                let alike = |index: usize| {
                    let (mut column, mut row) = (index % PIXELS, index / PIXELS);
                    if turn >= 4 {
                        column = PIXELS - 1 - column;
                    }
                    for _ in 0..turn % 4 {
                        (column, row) = (row, PIXELS - 1 - column);
                    }
                    (samples.pixels[row * PIXELS + column].sun_fraction < 0.5) == shaded(index % PIXELS, index / PIXELS)
                };
                (0..PIXELS * PIXELS).filter(|&index| alike(index)).count() as f64 / (PIXELS * PIXELS) as f64
            };
            let scores: Vec<f64> = (0..8).map(agreement).collect();
            println!("{}: {scores:.3?}", scenes::name(&scene, renderer));
            let others = scores[1..].iter().copied().fold(0.0, f64::max);
            assert!(scores[0] > 0.93 && others < scores[0] - 0.03, "{} {scores:?}", scenes::name(&scene, renderer));
        }
    }
}

/// A hole filled with a 5 km tower, 500 m towards the Sun, changes nothing: gaps do not occlude.
#[test]
fn a_hole_in_the_dem_shades_nothing_far_away() {
    let grid = Grid::square(800.0, 20.0);
    let whole = grid.terrain(&flat_body(), |at| 5.0 * (at.x / 90.0).sin() * (at.y / 70.0).cos());
    let mut holed = whole.clone();
    let level = &mut holed.faces[0].levels[0];
    for (column, row) in [(15, 40), (15, 41), (16, 40)] {
        let index = level.index(column, row);
        (level.gap[index], level.heights_m[index]) = (true, 5000.0);
    }
    let map = map(&flat_body());
    let view = scenes::nadir(&map, DVec2::ZERO, 300.0, scenes::sun(&map, WEST_RAD, 3f64.to_radians()));
    let view = view.with_optics(scenes::pinhole(16, 16, 32.0));
    let pairs = scenes::shadowed(whole).into_iter().zip(scenes::shadowed(holed));
    for (whole, holed) in pairs {
        let pairs = scenes::samples(&whole, &view).into_iter().zip(scenes::samples(&holed, &view));
        for ((renderer, a), (_, b)) in pairs {
            assert!(a.pixels.iter().any(|pixel| pixel.sun_fraction > 0.1), "a scene with light");
            for (p, q) in a.pixels.iter().zip(&b.pixels) {
                // Series truncate a hill's absence differently: 2e-4 rad here.
                let bound = if whole.shadows.is_exact() { 1e-6 } else { 0.05 };
                assert!((p.sun_fraction - q.sun_fraction).abs() < bound, "{}", scenes::name(&whole, renderer));
            }
        }
    }
}
