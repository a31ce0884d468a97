//! What holds for any renderer.

use std::sync::Arc;

use glam::{DMat3, DVec2, DVec3};
use perilune_engine::ephemeris::Source;
use perilune_engine::geometry::{Body, BodyFixed, Direction, Position, Rotation};
use perilune_engine::horizon::Settings;
use perilune_engine::quantity::{ASTRONOMICAL_UNIT_M, SOLAR_RADIUS_M};
use perilune_engine::render::{Light, Samples, Scene, View};
use perilune_engine::shadow::{ShadowMethod, registry};
use perilune_engine::terrain::Terrain;

use crate::scenes::{self, Grid, map};

fn hills(at: DVec2) -> f64 {
    60.0 * (at.x / 130.0).sin() * (at.y / 170.0).cos() + 15.0 * (at.x / 37.0 + at.y / 45.0).sin()
}

fn terrain() -> Terrain {
    Grid::square(1200.0, 15.0).terrain(&Body::moon(), hills)
}

/// Hills 1500 m below the camera, the Sun 8° high.
fn view() -> View {
    let map = map(&Body::moon());
    scenes::nadir(&map, DVec2::new(20.0, -35.0), 1500.0, scenes::sun(&map, 0.8, 8f64.to_radians()))
        .with_optics(scenes::pinhole(64, 64, 80.0))
}

fn hilly(shadows: impl Fn(&Terrain) -> Arc<dyn ShadowMethod>) -> Scene {
    scenes::scene(terrain()).with_shadows(shadows(&terrain()))
}

/// Share of pixels whose radiances differ by no more than a share of the larger.
fn alike(a: &Samples, b: &Samples, relative: f32) -> f64 {
    let close = |p: f32, q: f32| (p - q).abs() <= relative * p.abs().max(q.abs());
    let pixels = a.pixels.iter().zip(&b.pixels);
    let same = pixels.filter(|(p, q)| close(p.radiance_w_m2_sr, q.radiance_w_m2_sr)).count();
    same as f64 / a.pixels.len() as f64
}

fn turned(view: &View, turn: DMat3) -> View {
    let place = |position: Position<BodyFixed>| Position::from_m(turn * position.vector_m());
    let body_turn: Rotation<BodyFixed, BodyFixed> = Rotation::from_matrix(turn);
    let lights = view.lights.iter().map(|light| Light { position: place(light.position), ..light.clone() }).collect();
    View {
        camera_position: place(view.camera_position),
        camera_from_body: view.camera_from_body * body_turn.inverse(),
        lights,
        ..view.clone()
    }
}

/// Longitude is a name. In f64 all pixels agree to a rounding of their f32 radiance; in f32 rays hit the ground elsewhere by
/// 1e-6, which shows only at shadow edges.
#[test]
fn turning_terrain_camera_and_sun_about_the_pole_changes_no_image() {
    let (scene, mut other) = (hilly(scenes::fourier), hilly(scenes::fourier));
    let turn = DMat3::from_rotation_z(2.3);
    let body_turn: Rotation<BodyFixed, BodyFixed> = Rotation::from_matrix(turn);
    let map = &mut Arc::make_mut(&mut other.surface).terrain.faces[0].map;
    map.map_from_body = map.map_from_body * body_turn.inverse();
    let pairs = scenes::samples(&scene, &view()).into_iter().zip(scenes::samples(&other, &turned(&view(), turn)));
    for ((renderer, a), (_, b)) in pairs {
        let (share, relative) = if renderer == "reference" { (1.0, 1e-6) } else { (0.995, 1e-3) };
        assert!(alike(&a, &b, relative) >= share, "{renderer}: {}", alike(&a, &b, relative));
    }
}

/// A world four times as large, seen from four times as far away. Powers of two keep all heights' digits.
#[test]
fn a_larger_world_looks_the_same() {
    let scene = hilly(scenes::fourier);
    let mut other = hilly(scenes::fourier);
    let body = Body { equatorial_radius_m: 4.0 * 1_737_400.0, polar_radius_m: 4.0 * 1_737_400.0, ..Body::moon() };
    let mut terrain = other.surface.terrain.clone();
    terrain.body = body;
    let face = &mut terrain.faces[0];
    face.map.radius_m *= 4.0;
    let level = &mut face.levels[0];
    for length_m in [&mut level.posting_m, &mut level.west_m, &mut level.south_m] {
        *length_m *= 4.0;
    }
    level.heights_m.iter_mut().for_each(|height_m| *height_m *= 4.0);
    other.surface = Arc::new(perilune_engine::terrain::Surface::new(terrain));
    let mut far = view();
    far.camera_position = Position::from_m(4.0 * far.camera_position.vector_m());
    far.lights[0].position = Position::from_m(4.0 * far.lights[0].position.vector_m());
    let pairs = scenes::samples(&scene, &view()).into_iter().zip(scenes::samples(&other, &far));
    for ((renderer, a), (_, b)) in pairs {
        let (share, relative) = if renderer == "reference" { (1.0, 1e-6) } else { (0.995, 1e-3) };
        assert!(alike(&a, &b, relative) >= share, "{renderer}: {}", alike(&a, &b, relative));
    }
}

/// Where the whole disc is seen. Its size enters by the penumbra alone.
#[test]
fn twice_the_distance_of_the_sun_is_a_quarter_of_the_radiance() {
    let scene = hilly(|_| registry::no_shadows());
    let at = |distance_m: f64| {
        let mut view = view();
        let light = &mut view.lights[0];
        let towards = light.position.vector_m().normalize();
        let angular_radius_rad = (SOLAR_RADIUS_M / distance_m).asin();
        let source = Source { direction: Direction::new(towards).unwrap(), distance_m, angular_radius_rad };
        light.irradiance_w_m2 = source.irradiance_w_m2(1361.0);
        light.angular_radius_rad = angular_radius_rad;
        scenes::samples(&scene, &view)
    };
    let pairs = at(ASTRONOMICAL_UNIT_M).into_iter().zip(at(2.0 * ASTRONOMICAL_UNIT_M));
    for ((renderer, near), (_, far)) in pairs {
        for (p, q) in near.pixels.iter().zip(&far.pixels).filter(|(p, _)| p.sun_fraction == 1.0) {
            let ratio = p.radiance_w_m2_sr / q.radiance_w_m2_sr;
            assert!((ratio - 4.0).abs() < 1e-4, "{renderer}: {ratio}");
        }
    }
}

/// Traced: a series rings where a mountain is added, and brightens some azimuths.
#[test]
fn a_mountain_added_towards_the_sun_brightens_nothing() {
    let azimuth_rad = 0.8f64;
    let peak_m = 900.0 * DVec2::new(azimuth_rad.sin(), azimuth_rad.cos());
    let mountain = |at: DVec2| hills(at) + 250.0 * (-(at - peak_m).length_squared() / 200f64.powi(2)).exp();
    let optics = scenes::pinhole(24, 24, 60.0);
    let [bare, other] = [terrain(), Grid::square(1200.0, 15.0).terrain(&Body::moon(), mountain)].map(|terrain| {
        let shadowed = scenes::scene(terrain).with_shadows(registry::reference(Settings::default()));
        scenes::samples(&shadowed, &view().with_optics(optics.clone())).swap_remove(0).1
    });
    let mut darker = 0;
    for (p, q) in bare.pixels.iter().zip(&other.pixels) {
        // The mountain's foot lifts the ground seen here by 250 exp(−9) = 3 cm.
        assert!(q.sun_fraction <= p.sun_fraction + 0.01, "{p:?} {q:?}");
        darker += usize::from(q.sun_fraction < p.sun_fraction - 0.5);
    }
    assert!(darker > 20, "the mountain shades {darker} pixels");
}

/// A hundredth of a pixel changes the image in proportion: 1 cm by a tenth of what 10 cm do. A camera that f32 places to
/// 12 cm would leave the image as it is, or let it jump.
#[test]
fn a_camera_moved_by_centimetres_changes_the_image_in_proportion() {
    let scene = hilly(scenes::fourier);
    let moved = |distance_m: f64| {
        let mut moved = view();
        let step_m = distance_m * DVec3::new(0.6, -0.64, 0.48);
        moved.camera_position = Position::from_m(moved.camera_position.vector_m() + step_m);
        scenes::samples(&scene, &moved)
    };
    let changes = |distance_m: f64| -> Vec<f64> {
        moved(0.0).iter().zip(moved(distance_m)).map(|((_, a), (_, b))| change(a, &b)).collect()
    };
    for (one, ten) in changes(0.01).into_iter().zip(changes(0.1)) {
        println!("1 cm: {one:.2e}, 10 cm: {ten:.2e} of the radiance");
        assert!((one / ten / 0.1 - 1.0).abs() < 0.2, "{one} {ten}");
    }
}

/// Mean change of the radiance as a share of the mean radiance.
fn change(a: &Samples, b: &Samples) -> f64 {
    let radiances =
        |samples: &Samples| samples.pixels.iter().map(|p| f64::from(p.radiance_w_m2_sr)).collect::<Vec<_>>();
    let (a, b) = (radiances(a), radiances(b));
    a.iter().zip(&b).map(|(a, b)| (a - b).abs()).sum::<f64>() / a.iter().sum::<f64>()
}
