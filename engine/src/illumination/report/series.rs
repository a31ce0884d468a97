//! Light step by step, as CSV.

use crate::ephemeris::utc_text;
use crate::illumination::place::Moment;
use crate::illumination::{Series, Track};

/// A place's.
pub fn of_place(track: &Track, moments: &[Moment]) -> String {
    let header = "epoch_utc,sun_azimuth_deg,sun_elevation_deg,skyline_deg,disc_share,lit,earth_azimuth_deg,\
                  earth_elevation_deg,earth_seen,sunlight\n";
    let deg = f64::to_degrees;
    moments.iter().enumerate().fold(header.to_owned(), |text, (index, moment)| {
        text + &format!(
            "{},{:.5},{:.5},{:.5},{:.4},{},{:.5},{:.5},{},{:.5}\n",
            utc_text(track.epoch(index)),
            deg(moment.sun_azimuth_rad),
            deg(moment.sun_elevation_rad),
            deg(moment.skyline_rad),
            moment.share,
            u8::from(moment.lit),
            deg(moment.earth_azimuth_rad),
            deg(moment.earth_elevation_rad),
            u8::from(moment.earth_seen),
            track.sunlight[index],
        )
    })
}

/// An area's.
pub fn of_area(track: &Track, series: &Series) -> String {
    let header = "epoch_utc,lit_share,disc_share,earth_share,sunlight\n";
    (0..track.steps()).fold(header.to_owned(), |text, index| {
        let [lit, disc, earth] =
            [&series.lit_share, &series.disc_share, &series.earth_share].map(|shares| shares[index]);
        let sunlight = track.sunlight[index];
        text + &format!("{},{lit:.5},{disc:.5},{earth:.5},{sunlight:.5}\n", utc_text(track.epoch(index)))
    })
}
