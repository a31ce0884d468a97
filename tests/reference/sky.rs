//! Shares of the sky against closed forms.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};
use perilune_engine::shadow::multiscale::Multiscale;
use perilune_engine::shadow::sky::{AllRound, FromMaps, Harmonic, Harmonics, Wedges, share, wedge};
use perilune_engine::terrain::Surface;

use crate::scenes::{self, Grid, flat_body, map};

/// Level ground under a skyline of elevation ε all round sees cos² ε of the sky, a bare slope of β sees (1 + cos β)/2.
#[test]
fn the_share_of_the_sky_is_that_of_a_ring_and_of_a_slope() {
    let map = map(&flat_body());
    for elevation_deg in [-20.0f64, 0.0, 10.0, 45.0, 90.0] {
        let ring = vec![elevation_deg.to_radians(); 32];
        // The facet hides what lies below its own plane.
        let expected = elevation_deg.max(0.0).to_radians().cos().powi(2);
        assert!((share(&map, DVec2::ZERO, DVec3::Z, &ring) - expected).abs() < 1e-12, "{elevation_deg}°");
    }
    for slope_deg in [0.0f64, 15.0, 35.0, 60.0] {
        let beta = slope_deg.to_radians();
        let got = share(&map, DVec2::ZERO, DVec3::new(beta.sin(), 0.0, beta.cos()), &[-FRAC_PI_2; 64]);
        let own = share(&map, DVec2::ZERO, DVec3::new(beta.sin(), 0.0, beta.cos()), &[0.0; 64]);
        // Without ground below it a slope sees its whole hemisphere; with a level plain all round, half of one and its tilt.
        assert!((got - 1.0).abs() < 2e-3, "{slope_deg}°: {got}");
        assert!((own - 0.5 * (1.0 + beta.cos())).abs() < 2e-3, "{slope_deg}°: {own}");
    }
}

#[test]
fn wedges_from_the_table_are_those_of_the_quadrature() {
    let width_rad = TAU / 16.0;
    let wedges = Wedges::new(width_rad);
    let open = wedge(width_rad, [0.0; 2]).0[0];
    for i in 0..40 {
        let [a, b] = [0.37, 0.61].map(|step: f64| ((f64::from(i) * step).fract() - 0.5) * PI);
        let error = wedges.wedge([a, b]) + wedge(width_rad, [a, b]) * -1.0;
        assert!(error.0.iter().all(|e| e.abs() < 1e-3 * 2.0 * open), "{a} {b}: {error:?}");
    }
    let wrong = wedges.wedge([0.3, 0.3]) + wedge(width_rad, [0.35, 0.3]) * -1.0;
    assert!(wrong.0.iter().any(|e| e.abs() > 1e-3 * 2.0 * open));
}

/// Against a fine sum over the hemisphere: half the sky blocked by a wall up to the zenith, and an open one.
#[test]
fn wedges_sum_to_the_sky_that_is_seen() {
    let wedges = Wedges::new(TAU / 16.0);
    let open = wedges.all_round(&[0.0; 16]);
    let share = |seen: &Harmonics, normal: DVec3| seen.dot(&Harmonics::clamped_cosine(normal)) / PI;
    assert!((share(&open, DVec3::Z) - 1.0).abs() < 1e-4);
    assert!(
        (open.dot(&Harmonics([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
            - TAU * 0.282_094_79)
            .abs()
            < 1e-3
    );
    // An upright facet that looks at the open half sees half of it: order 4 has a quarter with 2 %.
    assert!((share(&open, DVec3::X) - 0.5).abs() < 0.02, "{}", share(&open, DVec3::X));
    // A swath of 11.25° between two others of the same sky: the three of them are what one wide one is.
    let narrow = Wedges::new(TAU / 64.0);
    let [one, rest] = [narrow.swath(0.0, &[0.2; 9]), narrow.swath(9.0 * TAU / 64.0, &[0.2; 54])];
    let whole = narrow.all_round(&[0.2; 64]);
    let missing = whole + (one + rest) * -1.0;
    // Each swath ends in slopes to the zenith that cover half a width outside: their sum is nearly everything.
    assert!(missing.0[0].abs() < 0.04 * whole.0[0], "{} of {}", missing.0[0], whole.0[0]);
}

/// The bottom of a spherical bowl, depth 0.2 of its diameter: skyline β/2 all round, share cos² (β/2) = 1 − D²/(a² + D²).
#[test]
fn both_ways_to_the_sky_agree_with_a_bowl() {
    let (rim_m, depth_m) = (1000.0f64, 400.0);
    let radius_m = (rim_m * rim_m + depth_m * depth_m) / (2.0 * depth_m);
    let bowl = |at: DVec2| {
        let inside = radius_m * radius_m - at.length_squared();
        if at.length() < rim_m { radius_m - depth_m - inside.sqrt() } else { 0.0 }
    };
    let grid = Grid::square(1200.0, 20.0);
    let terrain = grid.terrain(&flat_body(), bowl);
    let method = scenes::fourier(&terrain);
    let maps = method.maps().unwrap();
    let surface = Surface::new(terrain);
    let expected = rim_m * rim_m / (rim_m * rim_m + depth_m * depth_m);
    let middle = [grid.columns / 2; 2];
    let from_maps = FromMaps { maps, azimuths: 32 }.share(&surface, [0, 0], middle);
    let harmonic = |k: u32, o: f64| {
        Harmonic::new(Multiscale::new(&surface.terrain, k, o, 0.0), 16).share(&surface, [0, 0], middle)
    };
    let found = [(1, 1.0), (4, 2.0), (4, 4.0)].map(|(k, o)| harmonic(k, o));
    println!("maps {from_maps:.4}, harmonics {found:.4?}, expected {expected:.4}");
    assert!((from_maps - expected).abs() < 0.005, "{from_maps} {expected}");
    assert!((found[2] - expected).abs() < 0.02, "{found:?} {expected}");
}

/// Figure 6: the sharpest light of order 4 behind a wall. What a whole swath blurs in from the sides a partial one leaves
/// out: its shadow is deeper the narrower it is.
#[test]
fn a_narrower_swath_casts_a_deeper_shadow() {
    let light = Harmonics::towards(DVec3::new(0.8, 0.0, 0.6));
    let level = Harmonics::clamped_cosine(DVec3::Z);
    let wall_rad = |azimuth_rad: f64| if azimuth_rad.cos() > 0.8 { 1.2 } else { 0.0 };
    let lit = |swath_deg: f64| {
        let count = 33;
        let width_rad = swath_deg.to_radians() / f64::from(count);
        let first_rad = -0.5 * f64::from(count - 1) * width_rad;
        let at = |wall: bool| {
            let elevations: Vec<f64> =
                (0..count).map(|i| if wall { wall_rad(first_rad + f64::from(i) * width_rad) } else { 0.0 }).collect();
            Harmonics::triple(&level, &Wedges::new(width_rad).swath(first_rad, &elevations), &light)
        };
        at(true) / at(false)
    };
    let shares = [90.0, 45.0, 22.5, 11.25].map(lit);
    println!("lit behind the wall by swath: {shares:.3?}");
    assert!(shares.windows(2).all(|pair| pair[1] < pair[0] + 1e-3), "{shares:?}");
    assert!(shares[0] > shares[3] + 0.01 && shares[3] < 0.3, "{shares:?}");
}
