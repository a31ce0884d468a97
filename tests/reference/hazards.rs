//! What a lander stands on, on surfaces whose best plane is known.

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use perilune_engine::geometry::{Body, Position};
use perilune_engine::labels::{Footprint, Hazards, Limits, footprint, footprint_in_space, shadow_change};
use perilune_engine::render::planes::Radiometry;
use perilune_engine::render::reference;
use perilune_engine::render::{Quantity, Renderer, Scene};
use perilune_engine::shadow::{Skylines, registry};
use perilune_engine::terrain::{Hit, Surface};

use crate::scenes::{Grid, flat_body, map, nadir, pinhole, scene, sun};

const FOOTPRINT_M: f64 = 20.0;
const RADIUS_M: f64 = FOOTPRINT_M / 2.0;

/// The ground about a map point, on a grid fine enough for the shape.
fn ground(body: &Body, at_m: DVec2, height_m: impl Fn(DVec2) -> f64) -> (Surface, Hit) {
    let terrain = Grid { west_m: at_m.x - 40.0, south_m: at_m.y - 40.0, columns: 321, rows: 321, posting_m: 0.25 };
    let surface = Surface::new(terrain.terrain(body, height_m));
    let map = map(body);
    let above = map.body_from_lifted(at_m.extend(map.lifted_height_m(at_m, map.radius_m)));
    let hit = surface.ground_below(Position::from_m(above.vector_m()));
    (surface, hit)
}

/// By the lattice in lifted coordinates, and by points in space on a lattice four times as fine.
fn both(surface: &Surface, hit: &Hit) -> [Footprint; 2] {
    [footprint(surface, hit, FOOTPRINT_M).unwrap(), footprint_in_space(surface, hit, FOOTPRINT_M, 0.25).unwrap()]
}

/// Heights of a body of 1e9 m are f32 of metres about the map's centre: 1e-6 m. The lattice of `D/20` = 1 m holds 317 points: means over
/// the disc are off by some per cent.
#[test]
fn planes_steps_cones_and_bumps_have_the_slopes_and_roughnesses_of_their_formulas() {
    let body = flat_body();
    let (slope, step_m, cone, bump_m) = (0.3f64, 2.0f64, 0.4, 100.0);
    // Least squares over a disc of radius a: a step h has the slope 8h/(3πa) and is h/2 off at its edge; a cone of slope k is
    // 2ka/3 off at its tip; a bump r²/2R is a²/4R off at middle and rim.
    let step_slope = (8.0 * step_m / (3.0 * PI * RADIUS_M)).atan();
    type Height = Box<dyn Fn(DVec2) -> f64>;
    let cases: [(&str, Height, f64, f64); 4] = [
        ("plane", Box::new(move |at: DVec2| slope * (0.6 * at.x + 0.8 * at.y)), slope.atan(), 0.0),
        (
            "step",
            Box::new(move |at: DVec2| if at.x > 0.0 { step_m } else { 0.0 }),
            step_slope,
            step_m / 2.0 * step_slope.cos(),
        ),
        ("cone", Box::new(move |at: DVec2| -cone * at.length()), 0.0, 2.0 / 3.0 * cone * RADIUS_M),
        (
            "bump",
            Box::new(move |at: DVec2| -at.length_squared() / (2.0 * bump_m)),
            0.0,
            RADIUS_M * RADIUS_M / (4.0 * bump_m),
        ),
    ];
    for (name, height_m, slope_rad, roughness_m) in cases {
        let (surface, hit) = ground(&body, DVec2::ZERO, height_m);
        for found in both(&surface, &hit) {
            println!(
                "{name}: {:.4} rad, {slope_rad:.4}; {:.4} m, {roughness_m:.4}",
                found.slope_rad, found.roughness_m
            );
            assert!((found.slope_rad - slope_rad).abs() < 0.05 * slope_rad + 1e-4, "{name}: {found:?}");
            assert!((found.roughness_m - roughness_m).abs() < 0.12 * roughness_m + 1e-4, "{name}: {found:?}");
        }
    }
}

/// Far from the map's centre, where the map stretches, on the Moon. Both see the same ground; one samples it more finely.
#[test]
fn the_fit_on_the_map_is_the_fit_in_space() {
    let body = Body::moon();
    let hills = |at: DVec2| 30.0 * (at.x / 31.0).sin() * (at.y / 23.0).cos() + 0.2 * at.x;
    for at_m in [DVec2::ZERO, DVec2::new(300e3, -200e3), DVec2::new(-50e3, 600e3)] {
        let (surface, hit) = ground(&body, at_m, |at| hills(at - at_m));
        let found = footprint(&surface, &hit, FOOTPRINT_M).unwrap();
        let believed = footprint_in_space(&surface, &hit, FOOTPRINT_M, 1.0).unwrap();
        println!("{at_m}: {found:?}, in space {believed:?}");
        assert!((found.slope_rad - believed.slope_rad).abs() < 0.01 * believed.slope_rad, "{found:?} {believed:?}");
        assert!(
            (found.roughness_m - believed.roughness_m).abs() < 0.05 * believed.roughness_m,
            "{found:?} {believed:?}"
        );
        // Without the map's stretch a footprint of 20 m would be one of 18 m there.
        let smaller = footprint(&surface, &hit, 18.0).unwrap();
        assert!((smaller.roughness_m - believed.roughness_m).abs() > 0.05 * believed.roughness_m);
    }
}

#[test]
fn a_footprint_over_the_edge_of_the_terrain_is_unknown() {
    let (surface, hit) = ground(&flat_body(), DVec2::ZERO, |_| 0.0);
    assert!(footprint(&surface, &hit, 70.0).is_some());
    assert_eq!(footprint(&surface, &hit, 90.0), None);
    assert_eq!(footprint_in_space(&surface, &hit, 90.0, 1.0), None);
}

/// A wall of 20 m in the east, the Sun behind it 45° high: the ground before it is dark for 20 m, then lit.
fn shaded() -> (Scene, perilune_engine::render::View) {
    let body = flat_body();
    let terrain = Grid::square(200.0, 1.0).terrain(&body, |at_m| if at_m.x > 20.0 { 20.0 } else { 0.0 });
    let map = map(&body);
    let scene = scene(terrain).with_shadows(registry::reference(Default::default()));
    // 60 pixels of 1 m, from −30 to +30 m.
    let view = nadir(&map, DVec2::ZERO, 60.0, sun(&map, TAU / 4.0, TAU / 8.0))
        .with_optics(pinhole(60, 1, 60.0))
        .with_quantities([Quantity::Hazard]);
    (scene, view)
}

#[test]
fn half_of_a_footprint_on_a_shadows_edge_is_lit() {
    let (scene, view) = shaded();
    let centres = Renderer::Reference.samples(&scene, &view).unwrap().centres;
    let limits = Limits { footprint_m: 8.0, slope_rad: 0.2, roughness_m: 0.5, sunlit_share: 0.9 };
    let shadow = reference::shadow(&scene, &view, &Skylines::default()).unwrap();
    let found = Hazards::of(&scene, &view, shadow.as_deref(), &centres, &limits, true);
    // Columns look at −29.5, −28.5, …; the wall's top is at x = 21, so the shadow ends at x = 1, within its
    // penumbra of 0.2 m and a posting.
    let at = |x_m: f64| (x_m + 29.5).round() as usize;
    assert_eq!((found.sunlit_share[at(-10.5)], found.sunlit_share[at(10.5)]), (1.0, 0.0));
    let edge = (found.sunlit_share[at(0.5)] + found.sunlit_share[at(1.5)]) / 2.0;
    assert!((edge - 0.5).abs() < 0.07, "{edge}");
    // Each limit alone: light, the wall's slope and roughness, and nothing.
    assert_eq!((found.hazard[at(-10.5)], found.hazard[at(10.5)]), (0.0, 1.0));
    let dark = Limits { sunlit_share: 0.0, ..limits };
    let found = Hazards::of(&scene, &view, None, &centres, &dark, false);
    assert!(found.sunlit_share.is_empty());
    assert_eq!((found.hazard[at(10.5)], found.hazard[at(19.5)]), (0.0, 1.0));
    let sturdy = Limits { slope_rad: 1.5, roughness_m: 50.0, ..dark };
    assert_eq!(Hazards::of(&scene, &view, None, &centres, &sturdy, false).hazard[at(19.5)], 0.0);
}

#[test]
fn shadows_change_where_the_sun_comes_and_goes() {
    let pixel = |sun_fraction: f32| Radiometry { radiance_w_m2_sr: 1.0, irradiance_w_m2: 1.0, sun_fraction, hit: 1.0 };
    let before = [0.0, 1.0, 0.4, 0.6, f32::NAN, 0.9].map(pixel);
    let now = [1.0, 0.0, 0.45, 0.55, 1.0, f32::NAN].map(pixel);
    let change = shadow_change(&now, Some(&before));
    assert_eq!(change[..4], [1.0, -1.0, 0.0, 0.0]);
    assert!(change[4].is_nan() && change[5].is_nan());
    assert!(shadow_change(&now, None).iter().all(|value| value.is_nan()));
}
