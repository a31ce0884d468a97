//! The Sun and the Earth in the sky of the connecting ridge, one line a day for a year.
//!
//! `cargo run --release --example sun_over_a_year`

use perilune::{Ephemeris, Error, Geodetic, parse_epoch};

const DAY_S: f64 = 86_400.0;

fn main() -> Result<(), Error> {
    let moon = Ephemeris::of("moon")?;
    let ridge = Geodetic::from_degrees(-89.45, 222.7, 0.0);
    let start = parse_epoch("2027-01-01T00:00:00 UTC")?;
    println!("epoch,sun_azimuth_deg,sun_elevation_deg,earth_elevation_deg");
    for day in 0..365 {
        let epoch = start + f64::from(day) * DAY_S * perilune::Unit::Second;
        let (sun, earth) = (moon.sun(ridge, epoch)?, moon.earth(ridge, epoch)?);
        let [azimuth, elevation, of_earth] =
            [sun.azimuth_rad, sun.elevation_rad, earth.elevation_rad].map(f64::to_degrees);
        println!("{epoch},{azimuth:.3},{elevation:.3},{of_earth:.3}");
    }
    Ok(())
}
