//! A bare sphere: limb, terminator, light of the whole disc.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3};
use perilune_engine::geometry::Body;
use perilune_engine::photometry::quadrature::{gauss_legendre, integrate};
use perilune_engine::photometry::{DiscFunction, Reflectance};
use perilune_engine::quantity::LUNAR_RADIUS_M;
use perilune_engine::render::{Scene, View};

use crate::scenes::{self, SOLAR_IRRADIANCE_W_M2, SOLAR_RADIUS_RAD};

/// Area of a disc about the origin within half a unit of the x axis.
fn strip(radius: f64) -> f64 {
    2.0 * (0.5 * (radius * radius - 0.25).sqrt() + radius * radius * (0.5 / radius).asin())
}

/// The limb stands at the dip below the horizontal, cos dip = R/(R + h): the row of pixels through nadir is covered as
/// far as a disc of f cot(dip) pixels reaches. 128² samples a pixel resolve 0.004 pixels.
#[test]
fn the_limb_stands_at_the_dip() {
    for (height_m, focal_px) in [(1e5, 15.0), (5e6, 150.0)] {
        let dip_rad = (LUNAR_RADIUS_M / (LUNAR_RADIUS_M + height_m)).acos();
        let radius_px = focal_px / dip_rad.tan();
        let scene = scenes::scene(scenes::bare(Body::moon()));
        let camera_m = (LUNAR_RADIUS_M + height_m) * DVec3::new(0.6, -0.48, 0.64);
        let view = scenes::towards_centre(camera_m, vec![scenes::light(DVec3::X)])
            .with_optics(scenes::pinhole(101, 1, focal_px))
            .with_samples_per_side(128)
            .with_quantities([]);
        for (renderer, samples) in scenes::samples(&scene, &view) {
            let covered_px: f64 = samples.pixels.iter().map(|pixel| f64::from(pixel.hit)).sum();
            let error_px = (covered_px - strip(radius_px)) / 2.0;
            println!("{renderer} from {height_m} m: limb {error_px:.4} px off, of {radius_px:.2}");
            assert!(error_px.abs() < 0.01, "{renderer} from {height_m} m: {error_px} px");
        }
    }
}

/// What a camera of one pixel, 10 km above a place with the Sun at an elevation, measures of the ground.
fn irradiance_w_m2(scene: &Scene, sine_of_elevation: f64) -> Vec<(&'static str, f64)> {
    let up = DVec3::new(0.36, 0.48, -0.8);
    let level = up.any_orthonormal_vector();
    let sun = sine_of_elevation * up + (1.0 - sine_of_elevation * sine_of_elevation).sqrt() * level;
    let view = scenes::towards_centre((LUNAR_RADIUS_M + 1e4) * up, vec![scenes::light(sun)])
        .with_optics(scenes::pinhole(1, 1, 10.0));
    let all = scenes::samples(scene, &view);
    all.iter().map(|(renderer, samples)| (*renderer, f64::from(samples.pixels[0].irradiance_w_m2))).collect()
}

/// E = E_n r [x V(−x) + M(x)] for an elevation of x radii. The tables of the shader resolve 4e-5 of the disc, so
/// 4e-5 · 1361 r = 3e-4 W/m².
#[test]
fn the_terminator_fades_as_the_disc_sets() {
    let table = [(-0.5, 0.25369, 0.20765), (0.0, 1.34312, 1.25653), (0.5, 3.41834, 3.37230), (1.0, 6.32930, 6.32930)];
    for (radii, uniform_w_m2, darkened_w_m2) in table {
        for (alpha, expected_w_m2) in [(0.0, uniform_w_m2), (0.507909, darkened_w_m2)] {
            let scene = scenes::scene(scenes::bare(Body::moon())).with_disk(scenes::disk(alpha));
            for (renderer, got_w_m2) in irradiance_w_m2(&scene, radii * SOLAR_RADIUS_RAD) {
                let bound_w_m2 = if renderer == "reference" { 2e-5 } else { 5e-4 };
                let error_w_m2 = (got_w_m2 - expected_w_m2).abs();
                assert!(error_w_m2 < bound_w_m2, "{renderer} at {radii} radii: {got_w_m2}, not {expected_w_m2} W/m²");
            }
        }
    }
}

/// ∫ E dA over the sphere is what its cross-section catches, and 4.8e-6 more, which is second order in the Sun's radius:
/// 2 ∫ E d(sin e) = E_n (1 + 4.8e-6).
#[test]
fn a_sphere_catches_the_light_of_its_cross_section() {
    let scene = scenes::scene(scenes::bare(Body::moon()));
    let rule = gauss_legendre(24);
    let renderers = irradiance_w_m2(&scene, 0.5).len();
    for index in 0..renderers {
        let at = |sine: f64| irradiance_w_m2(&scene, sine)[index].1;
        let penumbra_w_m2 = integrate(&rule, -SOLAR_RADIUS_RAD, SOLAR_RADIUS_RAD, at);
        let day_w_m2 = integrate(&gauss_legendre(4), SOLAR_RADIUS_RAD, 1.0, at);
        let share = 2.0 * (penumbra_w_m2 + day_w_m2) / SOLAR_IRRADIANCE_W_M2;
        assert!((share - 1.0).abs() < 1e-5, "{index}: {share}");
    }
}

/// Radiance times solid angle over the image, in units of E_n R²/D²: the disc-integrated I/F times π.
fn light_of_disc(scene: &Scene, view: &View) -> Vec<(&'static str, f64)> {
    let columns = view.optics.columns as usize;
    let distance = view.camera_position.vector_m().length() / LUNAR_RADIUS_M;
    let of_pixel =
        |index: usize| view.optics.solid_angle_sr(DVec2::new((index % columns) as f64, (index / columns) as f64));
    let all = scenes::samples(scene, view);
    let sum = |samples: &perilune_engine::render::Samples| -> f64 {
        (0..)
            .zip(&samples.pixels)
            .map(|(index, pixel)| f64::from(pixel.radiance_w_m2_sr) * of_pixel(index).unwrap())
            .sum()
    };
    all.iter().map(|(name, samples)| (*name, sum(samples) * distance * distance / SOLAR_IRRADIANCE_W_M2)).collect()
}

/// Phase integrals: Lambert p Φ = ⅔ A [sin α + (π − α) cos α]/π, Lommel–Seeliger with 2 μ0/(μ0 + μ)
/// p Φ = A [1 − sin(α/2) tan(α/2) ln cot(α/4)].
fn disc_integrated(law: Reflectance, phase_rad: f64) -> f64 {
    let half = phase_rad / 2.0;
    match law {
        Reflectance::Empirical { normal_albedo, disc: DiscFunction::Lambert, .. } => {
            normal_albedo * 2.0 / 3.0 * (phase_rad.sin() + (PI - phase_rad) * phase_rad.cos()) / PI
        }
        Reflectance::Empirical { normal_albedo, disc: DiscFunction::LommelSeeliger, .. } => {
            normal_albedo * (1.0 - half.sin() * half.tan() * (1.0 / (half / 2.0).tan()).ln())
        }
        law => panic!("no closed form for {law:?}"),
    }
}

/// The same seen from `distance` radii, where less than half of the sphere is seen: summed over the sphere by the angle
/// from the point below the camera and by the azimuth about it.
fn disc_integrated_from(law: Reflectance, phase_rad: f64, distance: f64) -> f64 {
    let (steps, mut sum) = (1500, 0.0);
    let sun = DVec3::new(phase_rad.sin(), 0.0, phase_rad.cos());
    let lowest = 1.0 / distance;
    for i in 0..steps {
        let z = lowest + (1.0 - lowest) * (f64::from(i) + 0.5) / f64::from(steps);
        for j in 0..steps {
            let azimuth_rad = PI * (f64::from(j) + 0.5) / f64::from(steps);
            let p = DVec3::new((1.0 - z * z).sqrt() * azimuth_rad.cos(), (1.0 - z * z).sqrt() * azimuth_rad.sin(), z);
            let to_camera = DVec3::new(0.0, 0.0, distance) - p;
            let (mu0, mu) = (p.dot(sun), p.dot(to_camera.normalize()));
            if mu0 > 0.0 {
                let brdf_sr = match law {
                    Reflectance::Empirical { normal_albedo, disc: DiscFunction::Lambert, .. } => normal_albedo / PI,
                    Reflectance::Empirical { normal_albedo, disc: DiscFunction::LommelSeeliger, .. } => {
                        normal_albedo / PI * 2.0 / (mu0 + mu)
                    }
                    law => panic!("no closed form for {law:?}"),
                };
                sum += brdf_sr * mu0 * mu * (distance / to_camera.length()).powi(2);
            }
        }
    }
    sum * 2.0 * PI * (1.0 - lowest) / f64::from(steps * steps)
}

#[test]
fn the_sum_over_the_sphere_tends_to_the_phase_integral() {
    for law in [Reflectance::lambert(0.2), Reflectance::empirical(0.2, DiscFunction::LommelSeeliger)] {
        for phase_rad in [0.1, 1.0, FRAC_PI_2, 2.4] {
            let ratio = disc_integrated_from(law, phase_rad, 1e7) / disc_integrated(law, phase_rad);
            assert!((ratio - 1.0).abs() < 1e-4, "{law:?} {phase_rad} {ratio}");
        }
    }
}

/// To 0.1 %, from 20 radii (both renderers) and from 20 000 (in f64: in f32 the sphere is lost in the distance).
#[test]
fn the_whole_disc_shines_as_its_phase_integral_says() {
    for law in [Reflectance::lambert(0.2), Reflectance::empirical(0.2, DiscFunction::LommelSeeliger)] {
        for phase_rad in [0.1, 1.0, FRAC_PI_2, 2.0] {
            for distance in [20.0, 2e4] {
                let (pixels, far) = (96u32, distance > 100.0);
                // The outermost samples fall onto the limb; rows that just miss it would cost 7e-4.
                let focal_px = 0.4705 * f64::from(pixels) * (distance * distance - 1.0f64).sqrt();
                let scene = scenes::scene(scenes::bare(Body::moon()));
                let towards = DVec3::new(0.48, 0.6, 0.64);
                let sun = phase_rad.cos() * towards + phase_rad.sin() * towards.any_orthonormal_vector();
                let view = scenes::towards_centre(distance * LUNAR_RADIUS_M * towards, vec![scenes::light(sun)])
                    .with_optics(scenes::pinhole(pixels, pixels, focal_px))
                    .with_reflectance(law)
                    .with_samples_per_side(6)
                    .with_quantities([]);
                let expected = match far {
                    true => disc_integrated(law, phase_rad),
                    false => disc_integrated_from(law, phase_rad, distance),
                };
                for (renderer, got) in light_of_disc(&scene, &view) {
                    if far && renderer != "reference" {
                        continue;
                    }
                    println!("{renderer} {law:?} {phase_rad} rad from {distance} R: {:.6}", got / expected);
                    assert!((got / expected - 1.0).abs() < 1e-3, "{renderer} {law:?} {phase_rad} {distance}: {got}");
                }
            }
        }
    }
}
