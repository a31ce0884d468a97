//! How the Sun's disc darkens towards its limb, by wavelength.
//!
//! With `μ` the cosine of the angle with the Sun's own vertical, radiance over that of the centre is
//!
//! ```text
//! Hestroffer & Magnan 1998    μ^α          α = −0.023 + 0.292/λ (416 to 1099 nm), −0.507 + 0.441/λ (303 to 357 nm), λ in µm
//! Neckel & Labs 1994          Σ Aₖ μᵏ      k = 0 … 5, of 29 wavelengths from 303 to 1099 nm, linear between
//! ```
//!
//! One number makes the first; the second follows the measurement to the limb, where the first is 18 % too dark at 580 nm and
//! `μ` = 0.1. What is seen above a horizon differs by at most 1.4e-3 of the whole Sun.
//!
//! # Assumptions
//! - A camera's band has the law of its mean wavelength. For 420 to 1000 nm that is 1.3e-3 of the whole Sun from the mean of
//!   the laws (a test).
//! - The row of 365.875 nm is left out: as printed its terms sum to 0.998 where all others sum to 1.
//!
//! # References
//! Hestroffer & Magnan (1998), A&A 333, 338; Neckel & Labs (1994), Solar Physics 153, 91, doi:10.1007/BF00712494.

use super::PhotometryError;

/// Radiance across the disc against the cosine `μ` of the angle with the Sun's own vertical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LimbDarkening {
    /// The same everywhere.
    Uniform,
    /// `μ^alpha`.
    Power { alpha: f64 },
    /// `Σ Aₖ μᵏ`, 1 in the centre.
    Polynomial { coefficients: [f64; 6] },
}

impl LimbDarkening {
    /// The power law at a wavelength: 303 to 357 nm or 416 to 1099 nm; there is no published fit between.
    ///
    /// # References
    /// Hestroffer & Magnan (1998), A&A 333, 338.
    pub fn hestroffer_magnan(wavelength_nm: f64) -> Result<Self, PhotometryError> {
        let wavelength_um = wavelength_nm * 1e-3;
        match wavelength_nm {
            303.0..=357.0 => Ok(Self::Power { alpha: -0.507 + 0.441 / wavelength_um }),
            416.0..=1099.0 => Ok(Self::Power { alpha: -0.023 + 0.292 / wavelength_um }),
            got => Err(PhotometryError::OutOfRange {
                parameter: "wavelength of the limb darkening",
                got,
                allowed: "[303, 357] and [416, 1099] nm",
            }),
        }
    }

    /// The polynomial law at a wavelength between 303.327 and 1098.95 nm.
    ///
    /// # References
    /// Neckel & Labs (1994), Solar Physics 153, 91, table 1.
    pub fn neckel_labs(wavelength_nm: f64) -> Result<Self, PhotometryError> {
        let after = NECKEL_LABS.partition_point(|&(nm, ..)| nm < wavelength_nm);
        let rows = NECKEL_LABS.get(after.saturating_sub(1).min(NECKEL_LABS.len() - 2)..).unwrap_or_default();
        let [(low_nm, low, _), (high_nm, high, _), ..] = rows else { unreachable!("the table has two rows") };
        if !(*low_nm..=*high_nm).contains(&wavelength_nm) {
            let (parameter, allowed) = ("wavelength of the limb darkening", "[303.327, 1098.95] nm");
            return Err(PhotometryError::OutOfRange { parameter, got: wavelength_nm, allowed });
        }
        let share = (wavelength_nm - low_nm) / (high_nm - low_nm);
        let mixed: [f64; 6] = std::array::from_fn(|k| low[k] + share * (high[k] - low[k]));
        let centre: f64 = mixed.iter().sum();
        Ok(Self::Polynomial { coefficients: mixed.map(|coefficient| coefficient / centre) })
    }

    /// Radiance over that of the disc's centre.
    pub fn at(self, mu: f64) -> f64 {
        match self {
            Self::Uniform => 1.0,
            Self::Power { alpha } => mu.powf(alpha),
            Self::Polynomial { coefficients } => coefficients.iter().rev().fold(0.0, |sum, a| sum * mu + a),
        }
    }

    /// Mean of the disc over its centre.
    pub fn mean(self) -> f64 {
        self.powers().iter().map(|(alpha, factor)| 2.0 * factor / (alpha + 2.0)).sum()
    }

    /// The law as a sum of powers of `μ`: exponent and factor.
    pub(super) fn powers(self) -> Vec<(f64, f64)> {
        match self {
            Self::Uniform => vec![(0.0, 1.0)],
            Self::Power { alpha } => vec![(alpha, 1.0)],
            Self::Polynomial { coefficients } => {
                (0..6).zip(coefficients).map(|(k, factor)| (f64::from(k), factor)).filter(|p| p.1 != 0.0).collect()
            }
        }
    }

    /// Checks that radiance is nowhere negative and nowhere more than twice that of the centre.
    pub(super) fn check(self) -> Result<(), PhotometryError> {
        let outside = |parameter, got, allowed| Err(PhotometryError::OutOfRange { parameter, got, allowed });
        match self {
            Self::Power { alpha } if !(0.0..=2.0).contains(&alpha) => {
                outside("exponent of the limb darkening", alpha, "[0, 2]")
            }
            Self::Polynomial { coefficients } => {
                let values = (0..=100).map(|i| self.at(f64::from(i) * 0.01));
                match values.into_iter().find(|value| !(0.0..=2.0).contains(value)) {
                    Some(got) => outside("radiance of the limb darkening over the centre's", got, "[0, 2]"),
                    None if (coefficients.iter().sum::<f64>() - 1.0).abs() > 1e-9 => {
                        outside("limb darkening at the centre", coefficients.iter().sum(), "1")
                    }
                    None => Ok(()),
                }
            }
            _ => Ok(()),
        }
    }
}

/// Wavelength in nm, `A₀` to `A₅`, mean over centre: table 1 of Neckel & Labs (1994).
const NECKEL_LABS: [(f64, [f64; 6], f64); 29] = [
    (303.327, [0.08011, 0.70695, 0.49910, -0.31080, -0.02177, 0.04642], 0.6826),
    (310.843, [0.08160, 0.71609, 0.69685, -0.87703, 0.47008, -0.08760], 0.6883),
    (320.468, [0.08833, 0.77285, 0.65382, -1.04647, 0.72921, -0.19775], 0.6985),
    (329.897, [0.09188, 0.92459, 0.19604, -0.39546, 0.23599, -0.05303], 0.7116),
    (349.947, [0.11012, 1.02168, -0.10924, -0.00055, -0.08688, 0.06487], 0.7260),
    (374.086, [0.12579, 0.85402, 0.54601, -1.15048, 0.88928, -0.26462], 0.7288),
    (390.915, [0.12995, 0.91836, -0.07566, 0.19149, -0.28712, 0.12298], 0.7204),
    (401.97, [0.12323, 1.08648, -0.43974, 0.45912, -0.32759, 0.09850], 0.7303),
    (416.319, [0.12814, 1.19947, -0.84407, 1.07201, -0.79537, 0.23982], 0.7380),
    (427.93, [0.14249, 1.28796, -1.19564, 1.68603, -1.36658, 0.44572], 0.7495),
    (443.885, [0.16220, 1.24893, -0.92165, 0.89978, -0.50148, 0.11220], 0.7588),
    (445.125, [0.15248, 1.38517, -1.49615, 1.99886, -1.48155, 0.44119], 0.7596),
    (457.345, [0.16604, 1.38544, -1.52275, 2.00232, -1.45969, 0.42864], 0.7651),
    (477.427, [0.19571, 1.30551, -1.25845, 1.50626, -1.05472, 0.30570], 0.7751),
    (492.905, [0.20924, 1.30798, -1.20411, 1.21505, -0.67196, 0.14381], 0.7823),
    (519.93, [0.23695, 1.29927, -1.28034, 1.37760, -0.85054, 0.21706], 0.7925),
    (541.76, [0.26073, 1.27428, -1.30352, 1.47085, -0.96618, 0.26384], 0.8002),
    (559.95, [0.26892, 1.34319, -1.58427, 1.91271, -1.31350, 0.37295], 0.8061),
    (579.88, [0.28392, 1.36896, -1.75998, 2.22154, -1.56074, 0.44630], 0.8125),
    (610.975, [0.30854, 1.36620, -1.83572, 2.33221, -1.63082, 0.45959], 0.8221),
    (640.97, [0.33644, 1.30590, -1.79238, 2.45040, -1.89979, 0.59943], 0.8290),
    (669.4, [0.34685, 1.37539, -2.04425, 2.70493, -1.94290, 0.55999], 0.8360),
    (700.875, [0.37885, 1.25553, -1.70908, 2.19647, -1.59554, 0.47378], 0.8434),
    (748.71, [0.40627, 1.22842, -1.67877, 2.05535, -1.39972, 0.38845], 0.8524),
    (811.76, [0.42977, 1.25182, -1.85164, 2.31949, -1.59101, 0.44155], 0.8621),
    (869.6, [0.45396, 1.25101, -2.02958, 2.75410, -2.02287, 0.59338], 0.8701),
    (948.85, [0.47855, 1.19813, -1.86296, 2.36939, -1.64367, 0.46056], 0.8773),
    (1046.6, [0.49870, 1.21429, -2.06976, 2.80703, -2.05247, 0.60221], 0.8841),
    (1098.95, [0.51149, 1.19354, -2.00174, 2.66936, -1.94981, 0.57715], 0.8890),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photometry::{Curve, SolarDisk, SolarSpectrum};

    #[test]
    fn the_exponent_follows_hestroffer_and_magnan_and_ends_where_their_fit_ends() {
        let table = [(321.0, 0.8668), (450.0, 0.6259), (550.0, 0.5079), (689.0, 0.4008), (1000.0, 0.2690)];
        for (wavelength_nm, expected) in table {
            let LimbDarkening::Power { alpha } = LimbDarkening::hestroffer_magnan(wavelength_nm).unwrap() else {
                unreachable!("it is a power law")
            };
            assert!((alpha - expected).abs() < 6e-5, "{wavelength_nm} nm: {alpha}");
        }
        for outside_nm in [302.0, 360.0, 415.0, 1100.0, f64::NAN] {
            assert!(LimbDarkening::hestroffer_magnan(outside_nm).is_err(), "{outside_nm} nm");
        }
        assert!(LimbDarkening::Power { alpha: -0.1 }.check().is_err());
    }

    /// The table prints the mean over the centre beside the terms: 29 times two columns that must agree, to their four digits.
    #[test]
    fn every_row_of_neckel_and_labs_sums_to_one_and_has_its_printed_mean() {
        for (wavelength_nm, coefficients, mean) in NECKEL_LABS {
            assert!((coefficients.iter().sum::<f64>() - 1.0).abs() < 2.5e-5, "{wavelength_nm}");
            let law = LimbDarkening::neckel_labs(wavelength_nm).unwrap();
            assert!((law.mean() - mean).abs() < 7e-5, "{wavelength_nm}: {} {mean}", law.mean());
            assert!(law.check().is_ok());
        }
    }

    /// At 580 nm, four digits.
    #[test]
    fn the_polynomial_has_its_values_between_rows_and_ends_with_the_table() {
        let law = LimbDarkening::neckel_labs(579.88).unwrap();
        for (mu, expected) in [(0.9, 0.9494), (0.7, 0.8421), (0.5, 0.7225), (0.3, 0.5846), (0.2, 0.5027), (0.1, 0.4053)]
        {
            assert!((law.at(mu) - expected).abs() < 6e-5, "{mu}: {}", law.at(mu));
        }
        assert!((LimbDarkening::neckel_labs(570.0).unwrap().at(1.0) - 1.0).abs() < 1e-12);
        for outside_nm in [303.0, 1099.0, f64::NAN] {
            assert!(LimbDarkening::neckel_labs(outside_nm).is_err(), "{outside_nm} nm");
        }
    }

    /// The share above a line of a polynomial disc, six digits, from the incomplete beta function.
    #[test]
    fn the_polynomial_disc_has_its_closed_shares() {
        let disk = SolarDisk::new(LimbDarkening::neckel_labs(579.88).unwrap()).unwrap();
        let table =
            [(-0.9, 0.987443), (-0.5, 0.823556), (0.0, 0.5), (0.25, 0.330073), (0.5, 0.176444), (0.9, 0.012557)];
        for (height, expected) in table {
            assert!((disk.visible_above(height) - expected).abs() < 1.5e-6, "{height}: {}", disk.visible_above(height));
        }
    }

    /// What the whole band shows above a line against the law of its mean wavelength.
    #[test]
    fn a_wide_band_looks_like_its_mean_wavelength() {
        let (tsis, response) = (SolarSpectrum::tsis1_hsrs(), Curve::top_hat([420.0, 1000.0]).unwrap());
        let mean_nm = tsis.through(&response).unwrap().wavelength_nm;
        let one = SolarDisk::new(LimbDarkening::neckel_labs(mean_nm).unwrap()).unwrap();
        let (mut worst, heights) = (0.0f64, [-0.9, -0.6, -0.3, 0.3, 0.6, 0.9]);
        let steps = (0..58).map(|i| 425.0 + 10.0 * f64::from(i));
        let weights: Vec<_> = steps.map(|nm| (nm, tsis.curve.at(nm))).collect();
        let sum: f64 = weights.iter().map(|w| w.1).sum();
        for height in heights {
            let of_band: f64 = weights
                .iter()
                .map(|&(nm, weight)| {
                    let disk = SolarDisk::new(LimbDarkening::neckel_labs(nm).unwrap()).unwrap();
                    weight / sum * disk.visible_above(height)
                })
                .sum();
            worst = worst.max((of_band - one.visible_above(height)).abs());
        }
        println!("{mean_nm:.1} nm: {worst:.1e}");
        assert!(worst < 1.3e-3, "{worst}");
    }
}
