//! Curves over wavelength: spectra and responses.
//!
//! A curve is linear between its points and 0 outside. Products of curves are integrated exactly, segment by segment of
//! all their points, since resampling a solar spectrum first loses its lines: 5 to 10 % at 390 to 430 nm.

use super::PhotometryError;
use super::quadrature::{gauss_legendre, integrate};
use crate::text::{Heading, Row, Table, column_name};

/// A function of wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Wavelength in nm and value; wavelengths rise.
    points: Vec<[f64; 2]>,
}

/// Most points of a curve: 0.01 nm over a whole spectrum.
const MOST_POINTS: usize = 1_000_000;

/// Three curves times the wavelength are a polynomial of degree 4 between their points.
const POINTS_A_SEGMENT: usize = 3;

/// Names of wavelengths with their unit in nm, as [`column_name`] writes them.
const WAVELENGTHS: [(&str, f64); 17] = [
    ("wavelength", 1.0),
    ("wavelength_nm", 1.0),
    ("wavelengths", 1.0),
    ("wavelengths_nm", 1.0),
    ("lambda", 1.0),
    ("lambda_nm", 1.0),
    ("wl", 1.0),
    ("wl_nm", 1.0),
    ("nm", 1.0),
    ("wavelength_um", 1e3),
    ("wavelength_µm", 1e3),
    ("wavelength_micron", 1e3),
    ("wavelength_microns", 1e3),
    ("lambda_um", 1e3),
    ("um", 1e3),
    ("wavelength_angstrom", 0.1),
    ("angstrom", 0.1),
];

/// Names of values without a unit, or in that of a spectrum.
const VALUES: [&str; 19] = [
    "value",
    "response",
    "relative_response",
    "spectral_response",
    "relative_spectral_response",
    "responsivity",
    "sensitivity",
    "transmission",
    "transmittance",
    "throughput",
    "qe",
    "quantum_efficiency",
    "irradiance",
    "irradiance_w_m2_nm",
    "irradiance_w_m_2_nm_1",
    "spectral_irradiance",
    "ssi",
    "ssi_w_m2_nm",
    "ssi_w_m_2_nm_1",
];

/// Which of the two columns holds wavelengths, and their unit in nm.
fn columns(heading: &Row) -> Option<(usize, f64)> {
    let [first, second] = &heading.fields[..] else { return None };
    let names = [first, second].map(|name| column_name(name));
    let unit_nm = |name: &String| WAVELENGTHS.iter().find(|(known, _)| known == name).map(|(_, unit_nm)| *unit_nm);
    let found = |wavelength: usize| {
        let is_value = VALUES.contains(&names[1 - wavelength].as_str());
        unit_nm(&names[wavelength]).filter(|_| is_value).map(|unit_nm| (wavelength, unit_nm))
    };
    found(0).or(found(1))
}

impl Curve {
    pub fn new(points: Vec<[f64; 2]>) -> Result<Self, PhotometryError> {
        let bad = |point: usize, what: &'static str| Err(PhotometryError::CurvePoint { point, what });
        if !(2..=MOST_POINTS).contains(&points.len()) {
            return Err(PhotometryError::CurveLength { got: points.len() });
        }
        for (index, point) in points.iter().enumerate() {
            if !(point[0] > 0.0 && point[0].is_finite()) {
                return bad(index + 1, "has no wavelength above 0 nm");
            }
            if !(point[1] >= 0.0 && point[1].is_finite()) {
                return bad(index + 1, "has no value from 0 on");
            }
            if index > 0 && point[0] <= points[index - 1][0] {
                return bad(index + 1, "has a wavelength that does not rise");
            }
        }
        Ok(Self { points })
    }

    /// 1 from one wavelength to another.
    pub fn top_hat([from_nm, to_nm]: [f64; 2]) -> Result<Self, PhotometryError> {
        Self::new(vec![[from_nm, 1.0], [to_nm, 1.0]])
    }

    /// A [`Table`] of two columns: wavelength, in nm where no heading says otherwise, and value. Lines that begin with `#` are
    /// comments.
    pub fn parse(text: &str) -> Result<Self, PhotometryError> {
        let table = Table::parse(text, Heading::Optional, Some('#'))?;
        let (wavelength, unit_nm) = match &table.heading {
            None => (0, 1.0),
            Some(heading) => columns(heading).ok_or_else(|| {
                let got = heading.fields.join(", ");
                PhotometryError::CurveHeading { line: heading.line, got }
            })?,
        };
        let point = |row: &Row| {
            // Lines may part their numbers otherwise than the first one does.
            let parts = row.fields.iter().flat_map(|field| field.split([',', ';', ' ', '\t']));
            let parts = parts.filter(|part| !part.is_empty());
            let numbers: Option<Vec<f64>> = parts.map(|part| part.parse().ok()).collect();
            match numbers.as_deref() {
                Some(&[first, second]) if wavelength == 0 => Ok([first * unit_nm, second]),
                Some(&[first, second]) => Ok([second * unit_nm, first]),
                _ => Err(PhotometryError::CurveLine { line: row.line }),
            }
        };
        Self::new(table.rows.iter().map(point).collect::<Result<_, _>>()?)
    }

    /// The first and the last wavelength.
    pub fn range_nm(&self) -> [f64; 2] {
        [self.points[0][0], self.points[self.points.len() - 1][0]]
    }

    /// The largest value.
    pub fn peak(&self) -> f64 {
        self.points.iter().map(|point| point[1]).fold(0.0, f64::max)
    }

    pub fn at(&self, wavelength_nm: f64) -> f64 {
        let after = self.points.partition_point(|point| point[0] < wavelength_nm);
        match (after.checked_sub(1).map(|before| self.points[before]), self.points.get(after)) {
            (_, Some(&[at_nm, value])) if at_nm == wavelength_nm => value,
            (Some([low_nm, low]), Some(&[high_nm, high])) => {
                low + (high - low) * (wavelength_nm - low_nm) / (high_nm - low_nm)
            }
            _ => 0.0,
        }
    }

    /// `∫ Πᵢ cᵢ(λ) λ^power dλ` of up to three curves, λ in nm, with a power of 0 or 1.
    pub fn integral(curves: &[&Self], power: i32) -> f64 {
        let from_nm = curves.iter().map(|curve| curve.range_nm()[0]).fold(0.0, f64::max);
        let to_nm = curves.iter().map(|curve| curve.range_nm()[1]).fold(f64::INFINITY, f64::min);
        let inside = curves.iter().flat_map(|curve| &curve.points).map(|point| point[0]);
        let mut ends_nm: Vec<f64> = inside.filter(|nm| (from_nm..=to_nm).contains(nm)).collect();
        ends_nm.sort_by(f64::total_cmp);
        let rule = gauss_legendre(POINTS_A_SEGMENT);
        let product = |nm: f64| curves.iter().map(|curve| curve.at(nm)).product::<f64>() * nm.powi(power);
        ends_nm.windows(2).map(|ends| integrate(&rule, ends[0], ends[1], product)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[[f64; 2]]) -> Curve {
        Curve::new(points.to_vec()).unwrap()
    }

    #[test]
    fn a_curve_is_linear_between_its_points_and_nothing_outside() {
        let ramp = curve(&[[400.0, 0.0], [500.0, 1.0], [600.0, 1.0]]);
        for (nm, value) in [(399.9, 0.0), (400.0, 0.0), (450.0, 0.5), (500.0, 1.0), (600.0, 1.0), (600.1, 0.0)] {
            assert!((ramp.at(nm) - value).abs() < 1e-12, "{nm}");
        }
    }

    /// `∫₀¹ x³ = 1/4` of three ramps, and with the wavelength itself.
    #[test]
    fn products_are_integrated_exactly_over_the_points_of_all() {
        let ramp = curve(&[[100.0, 0.0], [200.0, 1.0]]);
        assert!((Curve::integral(&[&ramp, &ramp, &ramp], 0) / 25.0 - 1.0).abs() < 1e-14);
        // ∫ x (100 + 100 x) 100 dx = 100 (50 + 100/3).
        assert!((Curve::integral(&[&ramp], 1) / (100.0 * (50.0 + 100.0 / 3.0)) - 1.0).abs() < 1e-14);
        // A spike between the other's points is not missed.
        let (spike, flat) = (curve(&[[149.0, 0.0], [150.0, 1.0], [151.0, 0.0]]), curve(&[[100.0, 2.0], [200.0, 2.0]]));
        assert!((Curve::integral(&[&spike, &flat], 0) - 2.0).abs() < 1e-12);
        let elsewhere = curve(&[[300.0, 1.0], [400.0, 1.0]]);
        assert_eq!(Curve::integral(&[&ramp, &elsewhere], 0), 0.0);
    }

    #[test]
    fn text_has_two_numbers_a_line() {
        let text = "wavelength nm, response\n# a filter\n400, 0.0\n500;1\n\n600\t0.5\n";
        assert_eq!(Curve::parse(text).unwrap(), curve(&[[400.0, 0.0], [500.0, 1.0], [600.0, 0.5]]));
        let swapped = "\u{feff}response;wavelength [um]\r0;0.4\r1;0.5\r0.5;0.6";
        assert_eq!(Curve::parse(swapped).unwrap(), Curve::parse(text).unwrap());
        for (text, message) in [
            ("40O,1\n500,1\n600,1\n", "line 1 is not two numbers"),
            ("400;1\n500;0,5\n", "line 2 is not two numbers"),
            ("band,response\n500,1\n600,1\n", "line 1 has the names band, response; allowed are wavelength_nm"),
            ("400,1\n500,x\n", "line 2 is not two numbers"),
            ("400,1\n500,1,2\n", "line 2 is not two numbers"),
            ("400,1\n400,1\n", "point 2 has a wavelength that does not rise"),
            ("400,1\n500,-1\n", "point 2 has no value from 0 on"),
            ("400,1\n", "2 to 1 000 000 points"),
        ] {
            let error = Curve::parse(text).unwrap_err().to_string();
            assert!(error.contains(message), "{text:?}: {error}");
        }
    }
}
