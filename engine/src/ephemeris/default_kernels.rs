//! The kernels that come with the program: positions from analytic series, and as they are an excerpt of constants and one of the
//! orientation of the Moon of DE440, 2000 to 2030.
//!
//! SOFA's `epv00` (Earth and Sun, from VSOP2000), `moon98` (the Moon, Meeus) and `plan94` (Mars, Simon) are
//! sampled at Chebyshev nodes and written as SPK type 2:
//!
//! ```text
//! Sun = epv00_barycentric - epv00_heliocentric       Earth-Moon barycentre = Earth + m Moon,  m = 1/(1 + M_E/M_M)
//! Earth, Moon against the Earth-Moon barycentre = -m Moon, (1 - m) Moon         Mars = Sun + plan94
//! ```
//!
//! with `Moon` geocentric and the masses' ratio of DE440. The fit errs by less than 10 m. The series err against
//! DE440 by at most (seen from the Moon 2020 to 2029, from Mars 2023 to 2025, by the tests of the reference):
//!
//! ```text
//! Sun from the Moon      0.028″    15 km         (its radius is 959″)
//! Earth from the Moon   10.7″      11 km         (its radius is 3400″)
//! Sun from Mars         10.1″    5020 km         (its radius is 630″)
//! ```
//!
//! # Assumptions
//! `moon98` gets TDB for TT (1.7 ms, 1.7 m), and the axes of `plan94` (J2000) stand for ICRF (0.02″). The bytes
//! repeat on one machine; another mathematics library may change last digits, far below the fit's error.
//!
//! # References
//! SOFA, <https://www.iausofa.org>. Moisson and Bretagnon (2001), Celest. Mech. Dyn. Astron. 80, 205. Simon et al. (1994),
//! Astron. Astrophys. 282, 663. Meeus (1998), Astronomical Algorithms, 2nd ed., chapter 47. Park et al. (2021),
//! doi:10.3847/1538-3881/abd414, for the mass ratio.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use glam::DVec3;
use hifitime::Epoch;
use rayon::prelude::*;

use super::EphemerisError;
use super::daf::{ChebyshevSegment, write_spk};
use super::epoch::utc_text;
use super::shipped::{DEFAULT_KERNELS, SHIPPED};
use crate::files;
use crate::quantity::ASTRONOMICAL_UNIT_M;

/// Mass of the Earth over that of the Moon. DE440.
const EARTH_MOON_MASS_RATIO: f64 = 81.300_568_221_497_22;
const ASTRONOMICAL_UNIT_KM: f64 = ASTRONOMICAL_UNIT_M / 1000.0;
const DAY_S: f64 = 86_400.0;
const J2000_JD: f64 = 2_451_545.0;
/// TDB seconds past J2000 of 1900 and 2100, between which SOFA states the errors of the series.
const SERIES_SPAN_S: [f64; 2] = [-100.0 * 365.25 * DAY_S, 100.0 * 365.25 * DAY_S];
/// Before the first and after the last epoch, so that light may leave before the span begins.
const MARGIN_S: f64 = DAY_S;

/// A body's series and the intervals that carry it.
struct Series {
    name: &'static str,
    target_id: i32,
    center_id: i32,
    interval_days: f64,
    degree: usize,
    position_km: fn(f64) -> DVec3,
}

const SERIES: [Series; 5] = [
    Series {
        name: "SUN / SSB (SOFA epv00)",
        target_id: 10,
        center_id: 0,
        interval_days: 32.0,
        degree: 8,
        position_km: sun_km,
    },
    Series {
        name: "EMB / SSB (SOFA epv00, moon98)",
        target_id: 3,
        center_id: 0,
        interval_days: 16.0,
        degree: 13,
        position_km: barycenter_km,
    },
    Series {
        name: "EARTH / EMB (SOFA moon98)",
        target_id: 399,
        center_id: 3,
        interval_days: 8.0,
        degree: 10,
        position_km: earth_km,
    },
    Series {
        name: "MOON / EMB (SOFA moon98)",
        target_id: 301,
        center_id: 3,
        interval_days: 8.0,
        degree: 12,
        position_km: moon_km,
    },
    Series {
        name: "MARS BARYCENTER / SSB (SOFA plan94)",
        target_id: 4,
        center_id: 0,
        interval_days: 32.0,
        degree: 10,
        position_km: mars_km,
    },
];

/// Writes the default kernels, positions for a span, into a folder and returns their paths.
///
/// The span of the committed files is 2020-01-01 to 2041-01-01; another span keeps their names.
pub fn make_default_kernels(folder: &Path, from: Epoch, until: Epoch) -> Result<Vec<PathBuf>, EphemerisError> {
    let spk = make_spk(from, until)?;
    std::fs::create_dir_all(folder).map_err(|source| EphemerisError::Unwritable { path: folder.to_owned(), source })?;
    let mut paths = Vec::new();
    for kernel in &SHIPPED {
        let path = folder.join(kernel.name);
        let bytes = if kernel.name == DEFAULT_KERNELS[0] { spk.as_slice() } else { kernel.bytes };
        files::write(&path, bytes).map_err(|source| EphemerisError::Unwritable { path: path.clone(), source })?;
        paths.push(path);
    }
    Ok(paths)
}

/// The positions as the bytes of an SPK.
fn make_spk(from: Epoch, until: Epoch) -> Result<Vec<u8>, EphemerisError> {
    let (start_et_s, end_et_s) = (from.to_et_seconds() - MARGIN_S, until.to_et_seconds() + MARGIN_S);
    if from >= until || start_et_s < SERIES_SPAN_S[0] || end_et_s > SERIES_SPAN_S[1] {
        return Err(EphemerisError::Span { from_utc: utc_text(from), until_utc: utc_text(until) });
    }
    let segments: Vec<ChebyshevSegment> = SERIES.iter().map(|series| series.fit(start_et_s, end_et_s)).collect();
    let comment = format!(
        "Sun, Earth-Moon barycenter, Earth, Moon and Mars barycenter from the analytic series of SOFA\n\
         (epv00, moon98, plan94), ICRF, {} to {}.\nMade by `sim kernels make`. Not for navigation.",
        utc_text(from),
        utc_text(until)
    );
    Ok(write_spk("perilune default ephemeris", &comment, &segments))
}

impl Series {
    fn fit(&self, start_et_s: f64, end_et_s: f64) -> ChebyshevSegment {
        let interval_s = self.interval_days * DAY_S;
        let intervals = ((end_et_s - start_et_s) / interval_s).ceil() as usize;
        let coefficients_km = (0..intervals)
            .into_par_iter()
            .map(|i| {
                let middle_s = start_et_s + (i as f64 + 0.5) * interval_s;
                chebyshev_coefficients(self.degree, |x| (self.position_km)(middle_s + 0.5 * interval_s * x))
            })
            .collect();
        let (name, target_id, center_id) = (self.name.to_owned(), self.target_id, self.center_id);
        ChebyshevSegment { name, target_id, center_id, start_et_s, interval_s, coefficients_km }
    }
}

/// Coefficients of the polynomial that meets `f` on [-1, 1] at the Chebyshev nodes:
/// `c_j = (2 - δ_j0)/n Σ_k f(cos θ_k) cos(j θ_k)`, `θ_k = π (k + ½)/n`, `n = degree + 1`.
fn chebyshev_coefficients(degree: usize, f: impl Fn(f64) -> DVec3) -> [Vec<f64>; 3] {
    let nodes = degree + 1;
    let angle_rad = |k: usize| PI * (k as f64 + 0.5) / nodes as f64;
    let samples: Vec<DVec3> = (0..nodes).map(|k| f(angle_rad(k).cos())).collect();
    let coefficients: Vec<DVec3> = (0..nodes)
        .map(|j| {
            let sum: DVec3 = samples.iter().enumerate().map(|(k, y)| *y * (j as f64 * angle_rad(k)).cos()).sum();
            sum * if j == 0 { 1.0 } else { 2.0 } / nodes as f64
        })
        .collect();
    [0, 1, 2].map(|axis| coefficients.iter().map(|c| c[axis]).collect())
}

fn kilometres([position_au, _]: [[f64; 3]; 2]) -> DVec3 {
    DVec3::from_array(position_au) * ASTRONOMICAL_UNIT_KM
}

/// Earth against the Sun and against the solar system barycentre.
fn earth_from_sun_and_barycenter_km(et_s: f64) -> (DVec3, DVec3) {
    let (heliocentric, barycentric) =
        sofars::eph::epv00(J2000_JD, et_s / DAY_S).expect("the span was checked to lie in 1900 to 2100");
    (kilometres(heliocentric), kilometres(barycentric))
}

fn geocentric_moon_km(et_s: f64) -> DVec3 {
    kilometres(sofars::eph::moon98(J2000_JD, et_s / DAY_S))
}

fn sun_km(et_s: f64) -> DVec3 {
    let (from_sun, from_barycenter) = earth_from_sun_and_barycenter_km(et_s);
    from_barycenter - from_sun
}

fn barycenter_km(et_s: f64) -> DVec3 {
    earth_from_sun_and_barycenter_km(et_s).1 - earth_km(et_s)
}

fn earth_km(et_s: f64) -> DVec3 {
    geocentric_moon_km(et_s) * (-1.0 / (1.0 + EARTH_MOON_MASS_RATIO))
}

fn moon_km(et_s: f64) -> DVec3 {
    geocentric_moon_km(et_s) + earth_km(et_s)
}

fn mars_km(et_s: f64) -> DVec3 {
    const MARS: i32 = 4;
    let (from_sun, _) = sofars::eph::plan94(J2000_JD, et_s / DAY_S, MARS).expect("4 is a planet");
    sun_km(et_s) + kilometres(from_sun)
}

/// The span of the default kernels: from, until.
pub fn default_span() -> (Epoch, Epoch) {
    let start = Epoch::from_gregorian_utc_at_midnight(2020, 1, 1);
    (start, Epoch::from_gregorian_utc_at_midnight(2041, 1, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn evaluate_km(segment: &ChebyshevSegment, et_s: f64) -> DVec3 {
        let i = ((et_s - segment.start_et_s) / segment.interval_s) as usize;
        let x = 2.0 * ((et_s - segment.start_et_s) / segment.interval_s - i as f64) - 1.0;
        let axis = |axis: usize| -> f64 {
            let terms = segment.coefficients_km[i][axis].iter().enumerate();
            terms.map(|(j, c)| c * (j as f64 * x.acos()).cos()).sum()
        };
        DVec3::new(axis(0), axis(1), axis(2))
    }

    #[test]
    fn the_fit_stays_below_ten_metres() {
        let start_et_s = 7e8;
        for series in &SERIES {
            let segment = series.fit(start_et_s, start_et_s + 600.0 * DAY_S);
            let error_km = (0..3000)
                .map(|i| start_et_s + (f64::from(i) + 0.3) * 0.2 * DAY_S)
                .map(|et_s| evaluate_km(&segment, et_s).distance((series.position_km)(et_s)))
                .fold(0.0, f64::max);
            println!("{}: {error_km:.2e} km", series.name);
            assert!(error_km < 0.01, "{}: {error_km} km", series.name);
        }
    }
}
