//! Photometry against published values that need more than one module.

use glam::DVec3;
use perilune_engine::geometry::{Direction, Local};
use perilune_engine::photometry::{HorizonLine, LimbDarkening, SolarDisk, SunAxes};
use perilune_engine::quantity::{ASTRONOMICAL_UNIT_M, SOLAR_RADIUS_M, TOTAL_SOLAR_IRRADIANCE_W_M2};

/// Level polar ground at 1.5° Sun elevation, the Sun's centre on a level horizon: half the disc lights it, and its
/// irradiance is 7.1 % above the half of 1361 sin 1.5° W/m². From vectors to watts in one go.
#[test]
fn half_a_sun_at_the_pole_gives_more_than_half_the_irradiance() {
    let sun_rad = 1.5f64.to_radians();
    let radius_rad = (SOLAR_RADIUS_M / ASTRONOMICAL_UNIT_M).asin();
    let disk = SolarDisk::new(LimbDarkening::hestroffer_magnan(550.0).unwrap()).unwrap();
    let local = |vector: DVec3| Direction::<Local>::new(vector).unwrap();
    let axes = SunAxes::new(local(DVec3::new(0.0, sun_rad.cos(), sun_rad.sin())), local(DVec3::Z));
    let facet = axes.facet(local(DVec3::Z), radius_rad);
    let light = disk.light(HorizonLine::new(sun_rad, 0.0, sun_rad, radius_rad), facet);
    let irradiance_w_m2 = TOTAL_SOLAR_IRRADIANCE_W_M2 * light.irradiance_factor(facet, radius_rad);
    let naive_w_m2 = 0.5 * TOTAL_SOLAR_IRRADIANCE_W_M2 * sun_rad.sin();
    assert!((irradiance_w_m2 / naive_w_m2 - 1.071).abs() < 6e-4, "{}", irradiance_w_m2 / naive_w_m2);
}
