//! Contacts of lunar eclipses, from the light that the Earth leaves to points of the Moon.
//!
//! The point of the lunar sphere nearest the axis of the shadow meets umbra and penumbra first and leaves them last; the
//! farthest one meets the umbra last. Where the Sun's share at them becomes 0, or falls below 1, is a contact, found by halving
//! an hour.
//!
//! # References
//! Contacts: F. Espenak, NASA/GSFC, eclipse pages of 2018-07-27 and 2019-01-21, whole seconds of UT1, with Danjon's enlarged
//! shadow.

use std::path::{Path, PathBuf};

use hifitime::{Epoch, Unit};

use super::Row;
use crate::Error;
use perilune_engine::ephemeris::{Almanac, BodyFrame, earth, parse_epoch, sun};
use perilune_engine::geometry::{BodyFixed, Position};
use perilune_engine::photometry::LimbDarkening;
use perilune_engine::pipeline::lights::sun_left_by_earth;

/// An eclipse with its published contacts, hours, minutes and seconds of UT1.
#[derive(Debug, Clone, Copy)]
pub struct Eclipse {
    pub date: &'static str,
    /// P1, U1, U2, U3, U4, P4.
    pub contacts: [&'static str; 6],
}

pub const ECLIPSES: [Eclipse; 2] = [
    Eclipse { date: "2018-07-27", contacts: ["17:14:49", "18:24:27", "19:30:15", "21:13:12", "22:19:00", "23:28:37"] },
    Eclipse { date: "2019-01-21", contacts: ["02:36:30", "03:33:54", "04:41:17", "05:43:16", "06:50:39", "07:48:00"] },
];

const NAMES: [&str; 6] = ["P1", "U1", "U2", "U3", "U4", "P4"];

const KERNELS: [&str; 5] = [
    "de440s_sun_emb_earth_moon_2000_2030.bsp",
    "moon_pa_de440_2000_2030.bpc",
    "moon_fk_de440.epa",
    "pck00011.tpc",
    "gm_de440.tpc",
];

/// The canon's own ephemeris and lunar radius, UT1 − UTC and the published second: 2.5 s is met. Another rule for the size of
/// the Earth's shadow is half a minute off.
const ALLOWED_S: f64 = 5.0;

/// Computed less published contacts; none where no folder holds the kernels.
pub fn rows(data: &[PathBuf]) -> Result<Vec<Row>, Error> {
    let folder = data.iter().map(|folder| folder.join("kernels")).find(|f| KERNELS.iter().all(|k| f.join(k).is_file()));
    let Some(folder) = folder else { return Ok(Vec::new()) };
    let moon = Moon::load(&folder)?;
    let mut rows = Vec::new();
    for eclipse in &ECLIPSES {
        for (index, (name, time)) in NAMES.into_iter().zip(eclipse.contacts).enumerate() {
            let published =
                parse_epoch(&format!("{}T{time} UTC", eclipse.date)).map_err(perilune_engine::pipeline::Error::from)?;
            let late_s = (moon.contact(index, published)? - published).to_unit(Unit::Second);
            rows.push(Row {
                quantity: format!("contact {name} of the lunar eclipse of {} after the published one", eclipse.date),
                unit: "s",
                ours: late_s,
                reference: 0.0,
                allowed: ALLOWED_S,
                source: "Espenak, NASA/GSFC",
            });
        }
    }
    Ok(rows)
}

struct Moon {
    almanac: Almanac,
    frame: BodyFrame,
}

impl Moon {
    fn load(folder: &Path) -> Result<Self, Error> {
        let paths: Vec<PathBuf> = KERNELS.iter().map(|name| folder.join(name)).collect();
        let almanac = Almanac::load(&paths).map_err(perilune_engine::pipeline::Error::from)?;
        let frame = almanac.body_frame("moon", None).map_err(perilune_engine::pipeline::Error::from)?;
        Ok(Self { almanac, frame })
    }

    /// The contact of a number within half an hour of an epoch.
    fn contact(&self, index: usize, near: Epoch) -> Result<Epoch, Error> {
        // Points farthest from the axis meet the umbra at U2 and leave it at U3.
        let side = if matches!(index, 2 | 3) { 1.0 } else { -1.0 };
        let before = |share: f64| match index {
            0 => share >= 1.0,
            1 | 2 => share > 0.0,
            3 | 4 => share <= 0.0,
            _ => share < 1.0,
        };
        let (mut from, mut until) = (near - 30.0 * Unit::Minute, near + 30.0 * Unit::Minute);
        for _ in 0..16 {
            let middle = from + 0.5 * (until - from);
            if before(self.share(side, middle)?) { from = middle } else { until = middle }
        }
        Ok(from + 0.5 * (until - from))
    }

    /// Share of the Sun's light at the point of the sphere farthest (1) from the shadow's axis, or nearest (−1).
    fn share(&self, side: f64, epoch: Epoch) -> Result<f64, Error> {
        let seen = |point: Position<BodyFixed>| {
            let sun = sun(&self.almanac, &self.frame, point, epoch).map_err(perilune_engine::pipeline::Error::from)?;
            let earth =
                earth(&self.almanac, &self.frame, point, epoch).map_err(perilune_engine::pipeline::Error::from)?;
            Ok::<_, Error>((sun, earth))
        };
        let (sun, earth) = seen(Position::from_m(glam::DVec3::ZERO))?;
        let to_earth_m = earth.distance_m * earth.direction.unit();
        let axis = (to_earth_m - sun.distance_m * sun.direction.unit()).normalize();
        let aside = (-to_earth_m + to_earth_m.dot(axis) * axis).normalize();
        let point = Position::from_m(side * self.frame.body.equatorial_radius_m * aside);
        let (sun, earth) = seen(point)?;
        Ok(sun_left_by_earth(LimbDarkening::Uniform, &sun, &earth))
    }
}
