//! Invariants of light: reciprocity, energy, monotony, and the flux through a closed body.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DQuat, DVec2, DVec3};
use perilune_engine::geometry::{BodyFixed, Direction, Local};
use perilune_engine::photometry::quadrature::{gauss_legendre, integrate};
use perilune_engine::photometry::{
    DiscFunction, DiskLight, Facet, Hapke, HorizonLine, LimbDarkening, MultipleScattering, Reflectance, SolarDisk,
    SunAxes,
};

const RADIUS_RAD: f64 = 0.004_65;

fn disk() -> SolarDisk {
    SolarDisk::new(LimbDarkening::hestroffer_magnan(550.0).unwrap()).unwrap()
}

fn laws() -> [Reflectance; 13] {
    let moon = Hapke::moon();
    [
        Reflectance::lambert(0.4),
        Reflectance::empirical(0.25, DiscFunction::LommelSeeliger),
        Reflectance::empirical(0.4, DiscFunction::LunarLambert),
        Reflectance::empirical(0.4, DiscFunction::Minnaert { exponent: 0.7 }),
        Reflectance::empirical(0.25, DiscFunction::Akimov { smoothness: 1.0 }),
        Reflectance::empirical(0.25, DiscFunction::Akimov { smoothness: 0.34 }),
        Reflectance::lunar(0.4, DiscFunction::LunarLambert).unwrap(),
        Reflectance::lunar(0.25, DiscFunction::Akimov { smoothness: 0.34 }).unwrap(),
        Reflectance::Hapke(Hapke::mars()),
        Reflectance::Hapke(Hapke::mercury()),
        Reflectance::Hapke(moon),
        Reflectance::Hapke(Hapke { coherent_amplitude: 0.5, coherent_width: 0.1, filling_factor: 0.3, ..moon }),
        Reflectance::Hapke(Hapke { multiple_scattering: MultipleScattering::Hapke1981, mean_slope_rad: 0.2, ..moon }),
    ]
}

/// Cosine of the angle between two directions at zenith distances `i` and `e` and an azimuth apart.
fn phase_cosine(incidence_rad: f64, emission_rad: f64, azimuth_rad: f64) -> f64 {
    incidence_rad.cos() * emission_rad.cos() + incidence_rad.sin() * emission_rad.sin() * azimuth_rad.cos()
}

/// Helmholtz: swapping Sun and camera changes nothing. Both branches of Hapke's roughness are met.
#[test]
fn reflectance_is_reciprocal() {
    for law in laws() {
        for incidence_deg in [0.0f64, 3.0, 30.0, 59.0, 80.0, 89.9] {
            for emission_deg in [0.0f64, 10.0, 30.0, 60.0, 89.0] {
                for azimuth_deg in [0.0f64, 1.0, 90.0, 170.0, 180.0] {
                    let [i, e, a] = [incidence_deg, emission_deg, azimuth_deg].map(f64::to_radians);
                    let (g, there) = (phase_cosine(i, e, a), i.cos());
                    let (one, other) = (law.brdf_sr(there, e.cos(), g), law.brdf_sr(e.cos(), there, g));
                    assert!((one / other - 1.0).abs() < 1e-12, "{law:?} {incidence_deg} {emission_deg} {azimuth_deg}");
                }
            }
        }
    }
}

/// No surface returns more than it gets. One per cent is what Hapke's `H` is off for grains that absorb nothing.
#[test]
fn directional_hemispherical_albedo_is_at_most_one() {
    let bright = Hapke { single_scattering_albedo: 1.0, ..Hapke::moon() };
    let rule = gauss_legendre(48);
    for law in laws().into_iter().chain([Reflectance::Hapke(Hapke { shadow_hiding_amplitude: 0.0, ..bright })]) {
        for incidence_deg in [0.0f64, 30.0, 60.0, 80.0] {
            let i = incidence_deg.to_radians();
            let albedo = integrate(&rule, 0.0, FRAC_PI_2, |e| {
                integrate(&rule, 0.0, PI, |azimuth| {
                    2.0 * law.brdf_sr(i.cos(), e.cos(), phase_cosine(i, e, azimuth)) * e.cos() * e.sin()
                })
            });
            assert!(albedo > 0.0 && albedo <= 1.01, "{law:?} at {incidence_deg} deg: {albedo}");
        }
    }
}

#[test]
fn a_rising_horizon_only_ever_hides_more() {
    let disk = disk();
    let facet = Facet { height: 0.3, slope: DVec2::new(0.2, 0.9) };
    let mut before = 1.0;
    for i in -120..=120 {
        let light = disk.light(HorizonLine { height: f64::from(i) * 0.01, slope: 0.4 }, facet);
        assert!((0.0..=before).contains(&light.fraction), "{i}: {light:?}");
        before = light.fraction + 1e-12;
        assert!(light.irradiance_factor(facet, RADIUS_RAD) >= 0.0);
    }
}

/// As the Sun shrinks its penumbra narrows in step, and its light becomes that of a point.
#[test]
fn a_small_sun_is_a_point() {
    let (disk, sun_rad) = (disk(), 0.1f64);
    let facet_normal = Direction::<Local>::new(DVec3::Z).unwrap();
    let axes = SunAxes::new(Direction::new(DVec3::new(0.0, sun_rad.cos(), sun_rad.sin())).unwrap(), facet_normal);
    for radius_rad in [1e-3, 1e-6, 1e-9] {
        let lit = |horizon_rad: f64| {
            let facet = axes.facet(facet_normal, radius_rad);
            let light = disk.light(HorizonLine::new(horizon_rad, 0.0, sun_rad, radius_rad), facet);
            (light.fraction, light.irradiance_factor(facet, radius_rad))
        };
        assert_eq!(lit(sun_rad + 2.0 * radius_rad).0, 0.0);
        assert!((lit(sun_rad).0 - 0.5).abs() < 1e-6);
        assert!((lit(sun_rad - 2.0 * radius_rad).1 - sun_rad.sin()).abs() < 1e-15);
    }
}

#[test]
fn turning_the_scene_about_the_vertical_changes_nothing() {
    let light = |turn_rad: f64| {
        let turn = DQuat::from_rotation_z(turn_rad);
        let turned = |v: DVec3| Direction::<Local>::new(turn * v).unwrap();
        let axes = SunAxes::new(turned(DVec3::new(0.3, 0.9, 0.02)), turned(DVec3::Z));
        let facet = axes.facet(turned(DVec3::new(0.2, -0.6, 8.0)), RADIUS_RAD);
        let sun_rad = axes.sun.unit().z.asin();
        disk().light(HorizonLine::new(sun_rad + 0.001, 0.3, sun_rad, RADIUS_RAD), facet)
    };
    for turn_rad in [0.5, 2.0, 4.0] {
        let (one, other) = (light(0.0), light(turn_rad));
        assert!((one.fraction - other.fraction).abs() < 1e-9 && one.moment.distance(other.moment) < 1e-9);
    }
}

/// What a convex body catches is its shadow: `∫ E dA = π R² E_n` over a sphere that is its own horizon. The rim of
/// width `r` past the terminator is lit as well, which the plane at the tangent point adds: 5e-6 here.
#[test]
fn a_sphere_catches_the_flux_of_its_cross_section() {
    let (disk, sun) = (disk(), Direction::<BodyFixed>::new(DVec3::Z).unwrap());
    let rule = gauss_legendre(64);
    let caught = |from_rad: f64, to_rad: f64| {
        integrate(&rule, from_rad, to_rad, |angle_rad| {
            let normal = Direction::new(DVec3::new(angle_rad.sin(), 0.0, angle_rad.cos())).unwrap();
            let facet = SunAxes::new(sun, normal).facet(normal, RADIUS_RAD);
            let light = disk.light(HorizonLine::NONE, facet);
            2.0 * PI * angle_rad.sin() * light.irradiance_factor(facet, RADIUS_RAD)
        })
    };
    let terminator = [FRAC_PI_2 - RADIUS_RAD, FRAC_PI_2 + RADIUS_RAD];
    let sum = caught(0.0, terminator[0]) + caught(terminator[0], terminator[1]);
    assert!((sum / PI - 1.0).abs() < 1e-5, "{}", sum / PI);
}

/// The light that a line leaves on its two sides is all there is, and so is that of facets back to back.
#[test]
fn two_sides_of_a_line_make_the_whole_disc() {
    let disk = disk();
    for (height, direction) in [(0.2, 0.4), (-0.7, 2.0), (0.0, 5.0)] {
        let slope = DVec2::from_angle(direction);
        let [front, back] = [1.0, -1.0].map(|side| {
            disk.light(HorizonLine { height: -0.3, slope: 0.2 }, Facet { height: side * height, slope: side * slope })
        });
        let whole = disk.light(HorizonLine { height: -0.3, slope: 0.2 }, Facet { height: 9.0, slope });
        assert!((front.fraction + back.fraction - whole.fraction).abs() < 1e-8);
        assert!((front.moment + back.moment - whole.moment).length() < 1e-8);
        assert_ne!(front, DiskLight::NONE);
    }
}
