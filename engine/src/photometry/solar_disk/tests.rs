use super::*;

fn disk(alpha: f64) -> SolarDisk {
    SolarDisk::new(LimbDarkening::Power { alpha }).unwrap()
}

/// Hestroffer & Magnan at 550 nm.
const ALPHA_550: f64 = 0.507_909_09;

/// Facing the Sun, far from its own plane.
const FACING: Facet = Facet { height: 200.0, slope: DVec2::ZERO };

#[test]
fn a_skyline_in_columns_meets_the_straight_horizon() {
    let disk = disk(0.508);
    let facet = Facet { height: 30.0, slope: DVec2::new(0.1, 0.9) };
    for (height, slope) in [(-0.9, 0.0), (-0.3, 0.4), (0.0, -1.0), (0.6, 0.2), (2.0, 0.0)] {
        let line = disk.light(HorizonLine { height, slope }, facet);
        let columns = disk.light_above(&|x| height + slope * x, facet);
        assert!((line.fraction - columns.fraction).abs() < 1e-3, "{height} {slope}");
        assert!((line.moment - columns.moment).length() < 1e-3, "{height} {slope}");
    }
}

/// Values of the incomplete beta function and of a 2-D quadrature, six digits.
#[test]
fn the_share_above_a_level_line_is_the_incomplete_beta_function() {
    let table = [
        (-0.90, 0.981307, 0.988485),
        (-0.50, 0.804499, 0.825893),
        (0.0, 0.5, 0.5),
        (0.25, 0.342519, 0.328644),
        (0.50, 0.195501, 0.174107),
        (0.75, 0.072147, 0.055286),
        (0.90, 0.018693, 0.011515),
    ];
    for (height, uniform, darkened) in table {
        assert!((disk(0.0).visible_above(height) - uniform).abs() < 6e-7, "{height}");
        assert!((disk(ALPHA_550).visible_above(height) - darkened).abs() < 6e-7, "{height}");
    }
}

/// Max (1988): V = 1/2 − (asin h + h √(1 − h²))/π for the uniform disc. Share and moment to 1e-9.
#[test]
fn the_uniform_disc_has_the_arcsine_share() {
    for i in -100..=100 {
        let height = f64::from(i) * 0.01;
        let expected = 0.5 - (height.asin() + height * (1.0 - height * height).sqrt()) / PI;
        assert!((disk(0.0).visible_above(height) - expected).abs() < 1e-9, "{height}");
    }
    assert!((disk(0.0).moment_above(0.0) - 2.0 / (3.0 * PI)).abs() < 1e-9);
    assert!((disk(ALPHA_550).moment_above(0.0) / 0.5 - 0.3971).abs() < 5e-5, "centroid of half a disc");
}

#[test]
fn tangent_and_distant_lines_hide_all_or_nothing() {
    for alpha in [0.0, ALPHA_550] {
        for beyond in [1.0, 1.0 + 1e-7, 3.0, 1e9, f64::INFINITY] {
            assert_eq!(disk(alpha).visible_above(beyond), 0.0);
            assert!((disk(alpha).visible_above(-beyond) - 1.0).abs() < 1e-14);
            assert_eq!(disk(alpha).light(HorizonLine { height: beyond, slope: 0.0 }, FACING), DiskLight::NONE);
            assert_eq!(disk(alpha).light(HorizonLine { height: -beyond, slope: 0.0 }, FACING), DiskLight::FULL);
        }
    }
}

/// Columns know nothing of rotational symmetry, the closed form rests on it. 1e-8 is the columns' own error
/// where the weight ends like a fractional power.
#[test]
fn columns_of_a_tilted_line_give_the_closed_form() {
    for alpha in [0.0, 0.2690, ALPHA_550, 0.8668] {
        for (height, slope) in [(0.0, 0.0), (0.3, 1.0), (-0.5, -2.0), (2.0, 30.0), (0.0, 1e6), (0.99, 0.0)] {
            let line = HalfPlane::new(DVec2::new(-slope, 1.0), -height);
            let far = HalfPlane { normal: DVec2::X, height: -2.0 };
            let (columns, closed) = (
                disk(alpha).parts[0].believed.light_by_columns([line, far]),
                disk(alpha).parts[0].believed.light_above_line(line),
            );
            assert!((columns.fraction - closed.fraction).abs() < 1e-8, "{alpha} {line:?} {columns:?} {closed:?}");
            assert!((columns.moment - closed.moment).length() < 1e-8, "{alpha} {line:?} {columns:?} {closed:?}");
        }
    }
}

/// Against two million points of a sunflower pattern, each a thing of its own: share within 2e-5.
#[test]
fn two_lines_across_the_disc_leave_what_a_count_of_points_leaves() {
    let (disk, points) = (disk(ALPHA_550), 2_000_000);
    let cases = [
        (HorizonLine { height: 0.2, slope: 0.3 }, Facet { height: -0.1, slope: DVec2::new(0.5, 0.2) }),
        (HorizonLine { height: -0.3, slope: -4.0 }, Facet { height: 0.05, slope: DVec2::new(0.0, -0.9) }),
        (HorizonLine { height: 0.1, slope: 0.0 }, Facet { height: 0.3, slope: DVec2::new(0.9, 0.0) }),
        (HorizonLine { height: -0.6, slope: 0.1 }, Facet { height: 0.6, slope: DVec2::new(0.1, -0.9) }),
        (HorizonLine { height: 0.6, slope: 0.1 }, Facet { height: -0.6, slope: DVec2::new(0.1, -0.9) }),
    ];
    for (horizon, facet) in cases {
        let (mut seen, mut moment, mut all) = (0.0, DVec2::ZERO, 0.0);
        for i in 0..points {
            let square = (f64::from(i) + 0.5) / f64::from(points);
            let q = square.sqrt() * DVec2::from_angle(f64::from(i) * PI * (3.0 - 5f64.sqrt()));
            let light = (1.0 - square).powf(ALPHA_550 / 2.0);
            all += light;
            if q.y >= horizon.height + horizon.slope * q.x && facet.height + facet.slope.dot(q) >= 0.0 {
                seen += light;
                moment += light * q;
            }
        }
        let light = disk.light(horizon, facet);
        assert!((light.fraction - seen / all).abs() < 2e-5, "{horizon:?} {light:?} {}", seen / all);
        assert!((light.moment - moment / all).length() < 2e-5, "{horizon:?} {light:?} {}", moment / all);
    }
}

/// A bare level surface is its own horizon: 1361 W/m² at r = 0.00465048, by the elevation in radii.
#[test]
fn a_bare_level_surface_is_lit_while_the_sun_sets() {
    let radius_rad = 0.004_650_48;
    let table = [(-0.5, 0.25369, 0.20765), (0.0, 1.34312, 1.25653), (0.5, 3.41834, 3.37230), (1.0, 6.32930, 6.32930)];
    for (elevation_radii, uniform_w_m2, darkened_w_m2) in table {
        for (alpha, expected_w_m2) in [(0.0, uniform_w_m2), (ALPHA_550, darkened_w_m2)] {
            let facet = Facet { height: elevation_radii, slope: DVec2::Y };
            let light = disk(alpha).light(HorizonLine::NONE, facet);
            let irradiance_w_m2 = 1361.0 * light.irradiance_factor(facet, radius_rad);
            assert!((irradiance_w_m2 - expected_w_m2).abs() < 2e-5, "{elevation_radii} {irradiance_w_m2}");
        }
    }
}

/// Irradiance of level ground over `V sin e` with part of the Sun behind a level horizon; three decimals.
#[test]
fn irradiance_in_the_penumbra_is_more_than_share_times_sine() {
    let radius_rad: f64 = 0.26645f64.to_radians();
    let table = [
        (1.0f64, [1.039, 1.106, 1.183, 1.250]),
        (1.5, [1.026, 1.071, 1.122, 1.166]),
        (3.0, [1.013, 1.035, 1.061, 1.083]),
        (10.0, [1.004, 1.011, 1.018, 1.025]),
    ];
    for (elevation_deg, ratios) in table {
        let (sin, cos) = elevation_deg.to_radians().sin_cos();
        let facet = Facet { height: sin / radius_rad, slope: DVec2::new(0.0, cos) };
        for (height, ratio) in [-0.5, 0.0, 0.5, 0.9].into_iter().zip(ratios) {
            let light = disk(ALPHA_550).light(HorizonLine { height, slope: 0.0 }, facet);
            let got = light.irradiance_factor(facet, radius_rad) / (light.fraction * sin);
            assert!((got - ratio).abs() < 6e-4, "{elevation_deg} {height}: {got}");
        }
    }
}
