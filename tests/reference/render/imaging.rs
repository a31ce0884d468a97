//! Lens and shutter against closed forms: the limb of an evenly bright sphere is a straight edge of known place.

use glam::{DQuat, DVec2, DVec3};
use libm::erf;
use perilune_engine::camera::{Camera as Optics, Pose, PosedCamera, Psf, PsfComponent, Shutter};
use perilune_engine::geometry::{Body, Position, Rotation};
use perilune_engine::quantity::LUNAR_RADIUS_M;
use perilune_engine::render::{Ambient, Imaging, Quantity, Renderer, Scene, Timing, View};

use crate::conformance::gpu;
use crate::scenes;

const FOCAL_PX: f64 = 2000.0;
const FROM_CENTRE_M: f64 = 5e6;

/// A sphere that is equally bright everywhere: a Lambert ground under an even sky. Its limb is 2000 px from the centre.
fn even() -> Scene {
    scenes::scene(scenes::bare(Body::moon())).with_ambient(Ambient { radiance_w_m2_sr: 1.0, shares: Vec::new() })
}

/// A camera that looks at it in hardly any sunlight, from a pose that others replace.
fn camera(columns: u32, rows: u32, samples_per_side: usize, quantities: &[Quantity]) -> View {
    let mut sun = scenes::light(DVec3::X);
    sun.irradiance_w_m2 = 1e-9;
    scenes::view(limb(0.0), vec![sun])
        .with_optics(scenes::pinhole(columns, rows, FOCAL_PX))
        .with_samples_per_side(samples_per_side)
        .with_quantities(quantities)
}

/// Looks at the limb, which stands upright in the middle of the image, turned by an angle towards the sphere.
fn limb(turned_rad: f64) -> Pose {
    let tangent_rad = (LUNAR_RADIUS_M / FROM_CENTRE_M).asin();
    let at = DQuat::from_rotation_z(turned_rad - tangent_rad);
    let (forward, down) = (at * -DVec3::X, -DVec3::Z);
    Pose {
        position: Position::from_m(FROM_CENTRE_M * DVec3::X),
        camera_from_body: Rotation::from_axes(down.cross(forward), down, forward),
    }
}

/// The named plane as each renderer makes it, with poses by time.
fn taken(
    camera: &View,
    imaging: &Imaging,
    exposure_s: f64,
    pose: impl Fn(f64) -> Pose,
) -> Vec<(&'static str, Vec<Vec<f32>>)> {
    let times_s = imaging.timing.times_s(exposure_s);
    let of_band = |times: &Vec<f64>| times.iter().map(|&time| camera.from(&pose(time))).collect();
    let views: Vec<Vec<View>> = times_s.iter().map(of_band).collect();
    let scene = even();
    let take = |renderer: Renderer| {
        let mut session = renderer.session(&scene).unwrap();
        let taken = imaging.take(&mut session, views.clone()).unwrap();
        taken.image(&scene, None).planes.into_iter().map(|plane| plane.values).collect()
    };
    let mut all = vec![("reference", take(Renderer::Reference))];
    if let Some(gpu) = gpu() {
        all.push(("pass", take(Renderer::on(gpu))));
    }
    all
}

fn imaging(rows: u32, shutter: Shutter, moments: usize, psf: Option<Psf>) -> Imaging {
    Imaging { timing: Timing { rows, shutter, moments }, psf }
}

/// A row's light over that of the sphere, which is on the left or on the right, as light from the right.
fn profile(radiance: &[f32]) -> Vec<f64> {
    let (first, last) = (f64::from(radiance[0]), f64::from(radiance[radiance.len() - 1]));
    radiance.iter().map(|value| (f64::from(*value) - first) / (last - first)).collect()
}

/// Where a profile's edge is, and the mean square of its width.
fn edge(profile: &[f64]) -> (f64, f64) {
    let steps = || profile.windows(2).enumerate().map(|(i, pair)| (i as f64 + 0.5, pair[1] - pair[0]));
    let middle: f64 = steps().map(|(x, step)| x * step).sum();
    (middle, steps().map(|(x, step)| (x - middle).powi(2) * step).sum())
}

/// A turn at a known rate smears the edge over rate · time · focal length. The mean square width of `m` steps is
/// `L²/12 (1 − 1/m²)`; pixels add 1/6 on average, and 1/12 at most to that or from it.
#[test]
fn the_blur_is_as_long_as_the_turn() {
    let (rate_rad_s, exposure_s) = (0.4, 12.0 / FOCAL_PX / 0.4);
    let camera = camera(64, 2, 8, &[Quantity::Radiance, Quantity::Hit]);
    for moments in [1, 9, 31] {
        let imaging = imaging(2, Shutter::Global, moments, None);
        for (renderer, planes) in taken(&camera, &imaging, exposure_s, |time_s| limb(rate_rad_s * time_s)) {
            let (middle, square) = edge(&profile(&planes[0][..64]));
            let expected = 12.0 * (1.0 - 1.0 / (moments * moments) as f64) + 1.0 / 6.0;
            println!("{renderer}, {moments} moments: {:.3} px long", (12.0 * (square - 1.0 / 6.0).max(0.0)).sqrt());
            assert!((square - expected).abs() < 1.0 / 6.0 + 1e-3, "{renderer}, {moments}: {square} {expected}");
            assert!((middle - 31.5).abs() < 0.1, "{renderer}: the middle of the exposure stays: {middle}");
            // Coverage is the ground truth of the middle: as sharp as without motion.
            let (middle, square) = edge(&profile(&planes[1][..64]));
            assert!((middle - 31.5).abs() < 0.1 && square < 0.3, "{renderer}: {middle} {square}");
        }
    }
}

/// physics.md, case 49: an upright edge is sheared by rate · line time · focal length a row.
#[test]
fn a_rolling_shutter_shears_an_upright_edge() {
    let (rate_rad_s, line_time_s, rows) = (0.5, 0.4 / FOCAL_PX / 0.5, 32);
    let camera = camera(64, rows, 16, &[Quantity::Radiance]);
    let sheared = |shutter: Shutter| -> Vec<(&'static str, Vec<f64>)> {
        let imaging = imaging(rows, shutter, 1, None);
        let row = |planes: &[Vec<f32>], row: usize| edge(&profile(&planes[0][64 * row..][..64])).0;
        taken(&camera, &imaging, 0.0, |time_s| limb(rate_rad_s * time_s))
            .into_iter()
            .map(|(renderer, planes)| (renderer, (0..rows as usize).map(|r| row(&planes, r)).collect()))
            .collect()
    };
    let rolling = |rows_per_pose, upwards| Shutter::Rolling { line_time_s, rows_per_pose, upwards };
    // Samples are 1/16 px apart. The limb is a circle: its own curve, 0.2 px at the ends, is taken away.
    let allowed = 0.1;
    let curves = sheared(Shutter::Global);
    assert!(curves[0].1.iter().all(|edge| (edge - 31.5).abs() < 0.3), "{curves:?}");
    for (shutter, steps, sign) in
        [(rolling(1, false), 1, 1.0), (rolling(1, true), 1, -1.0), (rolling(4, false), 4, 1.0)]
    {
        for ((renderer, edges), (_, curve)) in sheared(shutter).into_iter().zip(&curves) {
            for (row, (edge, still)) in edges.iter().zip(curve).enumerate() {
                let block = (row / steps * steps) as f64 + 0.5 * (steps as f64 - 1.0);
                let expected = sign * 0.4 * (block - 15.5);
                let got = edge - still;
                assert!((got - expected).abs() < allowed, "{renderer}, {shutter:?}, {row}: {got} {expected}");
            }
        }
    }
    let stated_px = rolling(4, false).block_time_s() * rate_rad_s * FOCAL_PX;
    assert!((stated_px - 0.6).abs() < 1e-9, "rows that share a pose are off by up to 1.5 lines: {stated_px}");
}

/// Over the pixel, the mean of Φ about the edge. Rays an eighth of a pixel apart place the edge within 1/16.
#[test]
fn the_limb_through_a_gaussian_is_the_error_function() {
    let sigma_px = 2.0;
    let psf = Psf::new(&[PsfComponent::Gaussian { sigma_px }], None, 8).unwrap();
    let camera = camera(48, 4, 8, &[Quantity::Radiance, Quantity::Hit]);
    let imaging = imaging(4, Shutter::Global, 1, Some(psf));
    for (renderer, planes) in taken(&camera, &imaging, 0.0, limb) {
        let (place, _) = edge(&profile(&planes[1][48..96]));
        let below = |x: f64| {
            let z = (x - place) / sigma_px;
            let cumulative = 0.5 * (1.0 + erf(z * std::f64::consts::FRAC_1_SQRT_2));
            sigma_px * (z * cumulative + (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt())
        };
        for (column, got) in profile(&planes[0][48..96]).into_iter().enumerate() {
            let x = column as f64;
            let expected = below(x + 0.5) - below(x - 0.5);
            assert!((got - expected).abs() < 0.2 / 16.0, "{renderer}, {column}: {got} {expected}");
        }
    }
}

/// What lies beyond the image's edge sends its light into it: a part of an image is what the image has there.
#[test]
fn a_part_of_a_blurred_image_is_what_the_whole_has_there() {
    let psf = Psf::new(&[PsfComponent::Disc { diameter_px: 7.0 }], None, 2).unwrap();
    let whole = camera(40, 12, 2, &[Quantity::Radiance, Quantity::Range]);
    let part = whole.clone().with_optics(whole.optics.part([15, 3], 10, 6));
    let [whole, part] = [(&whole, 12), (&part, 6)]
        .map(|(camera, rows)| taken(camera, &imaging(rows, Shutter::Global, 3, Some(psf.clone())), 1e-3, limb));
    for ((renderer, whole), (_, part)) in whole.iter().zip(&part) {
        for (whole, part) in whole.iter().zip(part) {
            for (index, got) in part.iter().enumerate() {
                let expected = whole[(index / 10 + 3) * 40 + index % 10 + 15];
                let same = (got - expected).abs() <= 1e-5 * expected.abs() || got.is_nan() && expected.is_nan();
                assert!(same, "{renderer}, {index}: {got} {expected}");
            }
        }
    }
}

/// A flight over the sphere that turns meanwhile.
fn flight(time_s: f64) -> Pose {
    let up = DQuat::from_rotation_y(-0.05 * time_s) * DVec3::new(0.8, 0.6, 0.0);
    let forward = DQuat::from_rotation_z(0.02 * time_s) * -up;
    let right = forward.cross(DVec3::Z).normalize();
    Pose {
        position: Position::from_m((LUNAR_RADIUS_M + 50_000.0 + 100.0 * time_s) * up),
        camera_from_body: Rotation::from_axes(right, forward.cross(right), forward),
    }
}

/// Where a ray meets the sphere: the smaller root of |o + s d| = R.
fn on_sphere(origin: DVec3, direction: DVec3) -> (f64, DVec3) {
    let b = origin.dot(direction);
    let distance_m = -b - (b * b - origin.length_squared() + LUNAR_RADIUS_M * LUNAR_RADIUS_M).sqrt();
    (distance_m, origin + distance_m * direction)
}

/// Each pixel looks where the camera of an ISD with the same poses does ([`PosedCamera`]), and where its ray meets the sphere
/// by a formula written here.
#[test]
fn scanners_look_where_their_poses_say() {
    let optics: Optics = scenes::pinhole(24, 1, 60.0);
    let frames = [
        (Shutter::LineScan { line_time_s: 0.05, upwards: false }, 1),
        (Shutter::LineScan { line_time_s: 0.05, upwards: true }, 1),
        (Shutter::PushFrame { interval_s: 0.4, framelet_rows: 6, upwards: false }, 6),
    ];
    for (shutter, rows) in frames {
        let optics = Optics::pinhole(24, rows, optics.focal_px).unwrap();
        let camera = camera(24, rows, 1, &[Quantity::Range, Quantity::Latitude]).with_optics(optics.clone());
        let imaging = imaging(18, shutter, 1, None);
        let poses: Vec<Pose> = imaging.timing.times_s(0.0).iter().map(|times| flight(times[0])).collect();
        let posed = PosedCamera { optics: optics.clone(), poses };
        assert_eq!(posed.rows(), 18);
        for (renderer, planes) in taken(&camera, &imaging, 0.0, flight) {
            assert_eq!(planes[0].len(), 24 * 18);
            for (index, (range, latitude)) in planes[0].iter().zip(&planes[1]).enumerate() {
                let pixel = DVec2::new((index % 24) as f64, (index / 24) as f64);
                let (position, direction) = posed.ray(pixel).unwrap();
                let (range_m, at) = on_sphere(position.vector_m(), direction.unit());
                let latitude_deg = (at.z / at.length()).asin().to_degrees();
                let (got_m, got_deg) = (f64::from(*range), f64::from(*latitude));
                // The pass counts distances in f32.
                assert!((got_m / range_m - 1.0).abs() < 1e-5, "{renderer}, {shutter:?}, {pixel}: {got_m} {range_m}");
                assert!((got_deg - latitude_deg).abs() < 2e-5, "{renderer}, {pixel}: {got_deg} {latitude_deg}");
            }
        }
    }
}
