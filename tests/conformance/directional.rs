//! Skylines found towards a still light: by steps, by sweeps, from swaths, against each other and against traced ones.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use perilune_engine::geometry::{Direction, Position};
use perilune_engine::horizon::Settings;
use perilune_engine::horizon::settings::direction as direction_of;
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::photometry::{Facet, HorizonLine, SunAxes};
use perilune_engine::render::{Renderer, Scene, View};
use perilune_engine::shadow::fan::{THREE, line_of_three};
use perilune_engine::shadow::towards_sun::single_azimuth::{lanes, reference};
use perilune_engine::shadow::towards_sun::swath::Plan;
use perilune_engine::shadow::towards_sun::{Edge, SingleAzimuth, Swath, Swept};
use perilune_engine::shadow::{QuantizedLight, ShadowMethod, SkylineSource, UnpreparedLight, registry};
use perilune_engine::terrain::{Surface, Terrain};

use super::render::{cube, scenes};

const STEP_RAD: f64 = 0.15 * std::f64::consts::PI / 180.0;

fn sweep() -> Swept {
    Swept { settings: Settings::default(), step_rad: STEP_RAD }
}

fn stepping(edge: Edge) -> SingleAzimuth {
    SingleAzimuth { settings: Settings::default(), spacing: 1.0, edge }
}

fn swath(surface: &Surface, lights: &[QuantizedLight], folder: &std::path::Path) -> Swath {
    let exposures: Vec<_> = lights.iter().map(|light| vec![*light]).collect();
    let plan = Plan::new(surface, &exposures, STEP_RAD);
    plan.open_or_build(surface, &Settings::default(), folder, &|_, _| ()).unwrap()
}

/// The nested terrain with a hole, seen obliquely, the Sun at 3°.
fn nested() -> (Scene, View, QuantizedLight) {
    let (_, scene, view) = scenes().swap_remove(0);
    let light = view.quantized_lights()[0];
    (scene, view, light)
}

/// Floats keep heights to 8 µm here; four of them make 2e-6 of half a posting of 40 m. Slopes and places cost as much
/// again: 3e-6 rad, 1/1500 of the Sun's radius.
#[test]
fn nodes_side_by_side_see_what_the_papers_loop_sees() {
    let (scene, ..) = nested();
    let face = &scene.surface.terrain.faces[0];
    for (spacing, observer_height_m, search_m) in [(1.0, 0.0, None), (2.5, 2.0, None), (0.5, 0.0, Some(3000.0))] {
        let settings = Settings { observer_height_m, search_m, ..Settings::default() };
        let (mut worst_rad, mut highest_rad) = (0.0_f64, f64::MIN);
        for level in 0..face.levels.len() {
            let lines = lanes::Lines::new(&scene.surface, 0, level, spacing, &settings);
            let (columns, rows) = lines.seen();
            for (index, azimuth_deg) in (0..360).step_by(15).chain([1, 44, 359]).enumerate() {
                let towards = direction_of(f64::from(azimuth_deg).to_radians());
                for block in 0..20 {
                    let first = [(block * 37 + index * 16) % (columns - 8), (block * 53 + index * 29) % rows];
                    let count = lanes::LANES.min(columns - first[0]);
                    let found = lines.elevations_rad(first, count, towards);
                    for (lane, got_rad) in found.iter().take(count).enumerate() {
                        let point = lines.point([first[0] + lane, first[1]]);
                        let expected = reference::elevation_rad(face, level, point, towards, spacing, &settings);
                        worst_rad = worst_rad.max((got_rad - expected).abs());
                        highest_rad = highest_rad.max(expected);
                    }
                }
            }
        }
        println!("spacing {spacing}: {worst_rad:e} rad, highest {highest_rad} rad");
        assert!(worst_rad < 3e-6, "spacing {spacing}: {worst_rad} rad");
        assert!(highest_rad > 0.1, "a terrain without skylines");
    }
}

/// The share of the disc that each pixel sees.
fn shares(scene: &Scene, view: &View) -> Vec<f64> {
    Renderer::Reference.samples(scene, view).unwrap().pixels.iter().map(|pixel| f64::from(pixel.sun_fraction)).collect()
}

/// How often two renderings agree on whether half of the disc is seen, and their mean difference in it.
fn agreement(a: &[f64], b: &[f64]) -> (f64, f64) {
    let pairs: Vec<_> = a.iter().zip(b).filter(|(a, b)| a.is_finite() && b.is_finite()).collect();
    let same = pairs.iter().filter(|(a, b)| (**a >= 0.5) == (**b >= 0.5)).count();
    let mean = pairs.iter().map(|(a, b)| (**a - **b).abs()).sum::<f64>() / pairs.len() as f64;
    (same as f64 / pairs.len() as f64, mean)
}

/// Between nodes skylines are interpolated: an edge is met to a fraction of a cell, and a pixel is a cell here.
#[test]
fn skylines_towards_the_sun_light_what_traced_skylines_light() {
    let (mut scene, view, light) = nested();
    let view = view.with_samples_per_side(1);
    let folder = tempfile::tempdir().unwrap();
    scene = scene.with_shadows(registry::reference(Settings::default()));
    let truth = shares(&scene, &view);
    let swath = swath(&scene.surface, &[light], folder.path());
    let methods: [Arc<dyn ShadowMethod>; 4] =
        [Arc::new(swath), Arc::new(sweep()), Arc::new(stepping(Edge::Sloped)), Arc::new(stepping(Edge::Level))];
    for method in methods {
        let name = method.name();
        scene = scene.with_shadows(method);
        let (same, mean) = agreement(&truth, &shares(&scene, &view));
        println!("{name}: {same} {mean}");
        assert!(same > 0.985 && mean < 0.012, "{name}: {same} {mean}");
    }
    scene = scene.with_shadows(Arc::new(stepping(Edge::Hard)));
    let (same, mean) = agreement(&truth, &shares(&scene, &view));
    println!("hard: {same} {mean}");
    assert!(same > 0.98 && mean < 0.03, "hard: {same} {mean}");
    scene = scene.with_shadows(registry::no_shadows());
    let (same, mean) = agreement(&truth, &shares(&scene, &view));
    assert!(same < 0.9 && mean > 0.1, "the comparison sees no shadows at all: {same} {mean}");
}

/// How well a skyline across the disc is told by less than itself, at nodes in the penumbra: by its height at the disc's
/// middle, by the line through three azimuths, by planes 0.15° apart in columns. In shares of the disc, RMS.
#[test]
fn a_line_across_the_disc_tells_more_than_a_level_one_and_less_than_planes_in_columns() {
    let (scene, view, light) = nested();
    let face = &scene.surface.terrain.faces[0];
    let (map, level) = (&face.map, &face.levels[0]);
    let tracer = Tracer::new(face, &Settings::default()).with_pyramids(&scene.surface.pyramids[0]);
    let facing = Facet { height: 200.0, slope: DVec2::ZERO };
    let radius_rad = view.lights[0].angular_radius_rad;
    let mut squares = [0.0; 3];
    let mut count = 0.0;
    for node in (0..level.columns * level.rows).step_by(7) {
        let point = level.lifted_node(node % level.columns, node / level.columns);
        let (towards, direction) = light.from(map, point);
        let up = map.up(point.truncate());
        let axes = SunAxes::new(direction, up);
        let elevation_rad = |towards: DVec2| tracer.skyline(point, towards).elevation_rad;
        // Only where the disc may be cut at all.
        let pointing = light.pointing(map, point);
        let middle_rad = elevation_rad(towards);
        if (middle_rad - pointing.elevation_rad).abs() > 1.5 * radius_rad {
            continue;
        }
        let in_columns = |skyline_rad: &dyn Fn(DVec2) -> f64| {
            let height = |x: f64| {
                let column = Direction::new(direction.unit() + radius_rad * x * axes.x.unit()).unwrap();
                let column_rad = up.unit().dot(column.unit()).asin();
                let towards = map.map_direction(point.truncate(), column).normalize();
                (skyline_rad(towards) - column_rad).tan() / radius_rad
            };
            scene.disk.light_above(&height, facing).fraction
        };
        let truth = in_columns(&elevation_rad);
        if !(0.02..0.98).contains(&truth) {
            continue;
        }
        let planes = in_columns(&|towards: DVec2| {
            let steps = towards.x.atan2(towards.y) / STEP_RAD;
            let at = |step: f64| elevation_rad(direction_of(step * STEP_RAD));
            at(steps.floor()) + (steps - steps.floor()) * (at(steps.floor() + 1.0) - at(steps.floor()))
        });
        let line = |elevation_rad: f64, slope: f64| {
            let slope = slope * map.azimuth_ratio(point.truncate(), towards);
            let line = HorizonLine::new(elevation_rad, slope, pointing.elevation_rad, radius_rad);
            scene.disk.light(line, facing).fraction
        };
        let turned = |x: f64| DVec2::from_angle(-x * pointing.half_width_rad).rotate(towards);
        let [elevation, slope] = line_of_three(THREE.map(|x| elevation_rad(turned(x))), pointing.half_width_rad);
        let told = [line(middle_rad, 0.0), line(f64::from(elevation), f64::from(slope)), planes];
        for (square, told) in squares.iter_mut().zip(told) {
            *square += (told - truth).powi(2);
        }
        count += 1.0;
    }
    let [level, line, planes] = squares.map(|square: f64| (square / count).sqrt());
    println!("{count} nodes: level {level:.5}, line {line:.5}, planes {planes:.5} of the disc");
    assert!(count > 100.0 && line < level && planes < line && line < 0.03, "{level} {line} {planes}");
}

/// A swath for three Suns and a sweep for one share their planes: what differs is their rounding to 16 bits.
#[test]
fn a_swath_holds_what_the_sweep_finds_for_every_exposure() {
    let (scene, _, light) = nested();
    let surface = &scene.surface;
    let folder = tempfile::tempdir().unwrap();
    let turned = |angle_rad: f64| {
        let vector_m = glam::DQuat::from_rotation_z(angle_rad) * light.position.vector_m();
        QuantizedLight::new(Position::from_m(vector_m), light.angular_radius_rad)
    };
    let lights = [0.0, 0.004, -0.002].map(turned);
    let swath = swath(surface, &lights, folder.path());
    let rounding_rad = swath.rounding_rad();
    assert!(rounding_rad < 1e-5, "{rounding_rad} rad");
    let nodes: usize = surface.terrain.faces[0].levels.iter().map(|level| level.columns * level.rows).sum();
    println!("{} bytes a node", swath.bytes() / nodes);
    assert!(swath.bytes() <= 2 * 10 * nodes);
    for light in &lights {
        for level in 0..2 {
            let (a, b) =
                (swath.field(surface, 0, level, light).unwrap(), sweep().field(surface, 0, level, light).unwrap());
            let worst_rad = a.iter().zip(&b).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f32::max);
            // 4 · Σ|xᵢ|wᵢ · rounding / half width.
            let worst_slope = a.iter().zip(&b).map(|(a, b)| (a[1] - b[1]).abs()).fold(0.0, f32::max);
            assert!(worst_rad <= rounding_rad + 1e-6, "level {level}: {worst_rad} rad");
            assert!(worst_slope <= 2.0 * (rounding_rad + 1e-6) / 0.0046, "level {level}: {worst_slope}");
        }
    }
    let other = turned(0.1);
    assert_eq!(swath.field(surface, 0, 1, &other), Err(UnpreparedLight { face: 0, level: 1 }));
}

/// Planes are kept, whole or not at all; a damaged one is swept again, to the same bytes.
#[test]
fn a_swath_is_made_once_and_mended_where_it_is_damaged() {
    let (scene, _, light) = nested();
    let folder = tempfile::tempdir().unwrap();
    let files = || {
        let mut files: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        files.into_iter().map(|path| (path.clone(), std::fs::read(path).unwrap())).collect::<Vec<_>>()
    };
    let first = swath(&scene.surface, &[light], folder.path()).field(&scene.surface, 0, 0, &light).unwrap();
    let made = files();
    let modified = || made.iter().map(|(path, _)| path.metadata().unwrap().modified().unwrap()).collect::<Vec<_>>();
    let before = modified();
    assert_eq!(swath(&scene.surface, &[light], folder.path()).field(&scene.surface, 0, 0, &light).unwrap(), first);
    assert_eq!(modified(), before, "planes that were there were made again");

    let (path, bytes) = &made[0];
    for damage in ["middle", "end", "gone"] {
        match damage {
            "middle" => {
                let mut bytes = bytes.clone();
                let middle = bytes.len() / 2;
                bytes[middle] ^= 0x55;
                std::fs::write(path, bytes).unwrap();
            }
            "end" => std::fs::write(path, &bytes[..bytes.len() / 3]).unwrap(),
            _ => std::fs::remove_file(path).unwrap(),
        }
        assert_eq!(swath(&scene.surface, &[light], folder.path()).field(&scene.surface, 0, 0, &light).unwrap(), first);
        assert!(files() == made, "{damage}");
    }
}

/// Suns in the zenith of a face and of its corner, on the limb, below all horizons, and across map north; the pole
/// within a map. Finite, and in the zenith no skyline stands higher than the terrain is steep.
#[test]
fn no_sun_makes_a_skyline_that_is_no_number() {
    let surface = Surface::new(cube(12));
    let corner = DVec3::new(1.0, 1.0, 1.0).normalize();
    let axes: Vec<DVec3> = surface.terrain.faces.iter().map(|face| face.map.map_from_body.matrix().row(2)).collect();
    let near_pole = DVec3::new(1e-9, -1e-9, 1.0);
    let suns = [axes[0], corner, DVec3::Z, -DVec3::Z, near_pole, (axes[0] + 1e-3 * axes[1]).normalize()];
    for towards in suns {
        let light = QuantizedLight::new(Position::from_m(1.5e11 * towards), 0.00465);
        let few = Swept { step_rad: 0.1, ..sweep() };
        let methods: [&dyn ShadowMethod; 4] =
            [&few, &stepping(Edge::Sloped), &stepping(Edge::Level), &stepping(Edge::Hard)];
        for method in methods {
            for (face, levels) in surface.terrain.faces.iter().enumerate() {
                for level in 0..levels.levels.len() {
                    for [elevation_rad, slope] in
                        method.skylines().unwrap().field(&surface, face, level, &light).unwrap()
                    {
                        let name = method.name();
                        assert!(elevation_rad.is_finite() && slope.is_finite(), "{name} under {towards}");
                        let bound = if name.ends_with("hard") { FRAC_PI_2 + 1.0 } else { 1.0 };
                        assert!(f64::from(elevation_rad).abs() < bound, "{name}: {elevation_rad} under {towards}");
                    }
                }
            }
        }
    }
}

/// A level whose own nodes lie in a hole still has skylines.
#[test]
fn holes_have_skylines_too() {
    let (scene, _, light) = nested();
    let mut terrain: Terrain = scene.surface.terrain.clone();
    terrain.faces[0].levels[0].gap.iter_mut().for_each(|gap| *gap = true);
    let surface = Surface::new(terrain);
    for method in [&sweep() as &dyn ShadowMethod, &stepping(Edge::Sloped)] {
        let field = method.skylines().unwrap().field(&surface, 0, 0, &light).unwrap();
        assert!(field.iter().flatten().all(|value| value.is_finite()), "{}", method.name());
    }
}
