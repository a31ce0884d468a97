//! Sunlight through a camera's band.
//!
//! With the solar spectral irradiance `E(λ)` at 1 au and the response `T(λ)`:
//!
//! ```text
//! E_band = ∫ E T dλ        width = ∫ T dλ        λ_mean = ∫ E T λ dλ / E_band
//! ```
//!
//! `E_band/width` is the irradiance per nanometre. `E_band λ_mean/(hc) = ∫ E T λ/(hc) dλ` is the number of photons, exactly:
//! a detector that knows these two numbers counts the electrons of every wavelength, where `T` is the response of filters
//! and quantum efficiency together.
//!
//! | spectrum | nm | accuracy | against the other |
//! |---|---|---|---|
//! | TSIS-1 HSRS v2 | 350 to 2500, 1 nm | 0.3 % | |
//! | ASTM E490 | 119.5 to 1e6 | | −1.1 % at 400–700, +2.4 % at 870 nm |
//!
//! # Assumptions
//! - The ground is grey within the band. The Sun's own variation, 0.1 %, is left out.
//! - 1 nm resolution: narrower bands see the mean of the lines around them.
//!
//! # References
//! Coddington et al. (2021), GRL 48, e2020GL091709, doi:10.1029/2020GL091709, and (2023), doi:10.1029/2022EA002637; ASTM
//! E490-00a (2014).

use super::{Curve, PhotometryError};

/// A table of the Sun's spectral irradiance at 1 au, W m⁻² nm⁻¹.
#[derive(Debug, Clone, PartialEq)]
pub struct SolarSpectrum {
    pub name: String,
    pub curve: Curve,
}

/// What a band makes of sunlight at 1 au.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandLight {
    pub irradiance_w_m2: f64,
    pub width_nm: f64,
    /// Weighted by energy.
    pub wavelength_nm: f64,
}

impl SolarSpectrum {
    /// The reference of CEOS for calibration.
    pub fn tsis1_hsrs() -> Self {
        Self::shipped("TSIS-1 HSRS v2, 1 nm", include_str!("spectra/tsis1_hsrs.csv"))
    }

    pub fn e490() -> Self {
        Self::shipped("ASTM E490-00a (2014)", include_str!("spectra/e490.csv"))
    }

    fn shipped(name: &str, text: &str) -> Self {
        Self { name: name.into(), curve: Curve::parse(text).expect("a shipped table is well formed") }
    }

    /// Sunlight at 1 au through a response. All of the response must lie where the table has values.
    pub fn through(&self, response: &Curve) -> Result<BandLight, PhotometryError> {
        let ([from_nm, to_nm], [low_nm, high_nm]) = (response.range_nm(), self.curve.range_nm());
        if from_nm < low_nm || to_nm > high_nm {
            let spectrum = self.name.clone();
            return Err(PhotometryError::BeyondSpectrum { spectrum, low_nm, high_nm, from_nm, to_nm });
        }
        let irradiance_w_m2 = Curve::integral(&[&self.curve, response], 0);
        if irradiance_w_m2 <= 0.0 {
            return Err(PhotometryError::Dark { from_nm, to_nm });
        }
        let wavelength_nm = Curve::integral(&[&self.curve, response], 1) / irradiance_w_m2;
        Ok(BandLight { irradiance_w_m2, width_nm: Curve::integral(&[response], 0), wavelength_nm })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::TOTAL_SOLAR_IRRADIANCE_W_M2;

    fn through(spectrum: &SolarSpectrum, from_nm: f64, to_nm: f64) -> BandLight {
        spectrum.through(&Curve::top_hat([from_nm, to_nm]).unwrap()).unwrap()
    }

    /// Integrals of both tables computed by another program from its own copies, five digits; the shipped copies keep four
    /// decimals.
    #[test]
    fn bands_hold_what_other_copies_of_the_tables_hold() {
        let (tsis, e490) = (SolarSpectrum::tsis1_hsrs(), SolarSpectrum::e490());
        let table = [
            (350.0, 2500.0, 1266.48, 1261.55),
            (400.0, 700.0, 530.11, 535.93),
            (400.0, 750.0, 596.89, 602.88),
            (450.0, 850.0, 623.67, 627.65),
            (400.0, 1000.0, 841.26, 843.38),
            (500.0, 600.0, 184.88, 187.10),
            (600.0, 700.0, 159.00, 158.82),
        ];
        for (from_nm, to_nm, of_e490, of_tsis) in table {
            for (spectrum, expected) in [(&e490, of_e490), (&tsis, of_tsis)] {
                let got = through(spectrum, from_nm, to_nm).irradiance_w_m2;
                assert!((got - expected).abs() < 0.012, "{} {from_nm} to {to_nm}: {got}", spectrum.name);
            }
        }
        let means = [
            (440.0, 5.0, 1.8330, 1.8599),
            (500.0, 5.0, 1.9195, 1.9605),
            (566.0, 10.0, 1.8373, 1.8505),
            (643.0, 11.5, 1.6200, 1.6098),
            (689.0, 19.5, 1.4565, 1.4669),
            (870.0, 5.0, 0.9536, 0.9310),
        ];
        for (centre_nm, half_nm, of_e490, of_tsis) in means {
            for (spectrum, expected) in [(&e490, of_e490), (&tsis, of_tsis)] {
                let light = through(spectrum, centre_nm - half_nm, centre_nm + half_nm);
                let got = light.irradiance_w_m2 / light.width_nm;
                assert!((got - expected).abs() < 1.5e-4, "{} {centre_nm} nm: {got}", spectrum.name);
            }
        }
    }

    /// The standard is scaled to 1366.1 W/m²; TSIS-1's range holds 92.7 % of the total irradiance that its instrument
    /// measures.
    #[test]
    fn whole_tables_hold_the_solar_constant() {
        let e490 = through(&SolarSpectrum::e490(), 119.5, 1e6).irradiance_w_m2;
        assert!((e490 - 1366.1).abs() < 0.05, "{e490}");
        let share = through(&SolarSpectrum::tsis1_hsrs(), 350.0, 2500.0).irradiance_w_m2 / TOTAL_SOLAR_IRRADIANCE_W_M2;
        assert!((0.92..0.935).contains(&share), "{share}");
    }

    #[test]
    fn a_flat_response_of_a_half_halves_light_and_width_and_keeps_the_colour() {
        let tsis = SolarSpectrum::tsis1_hsrs();
        let half = tsis.through(&Curve::new(vec![[450.0, 0.5], [850.0, 0.5]]).unwrap()).unwrap();
        let full = through(&tsis, 450.0, 850.0);
        assert!((half.irradiance_w_m2 / full.irradiance_w_m2 - 0.5).abs() < 1e-12);
        assert!((half.width_nm - 200.0).abs() < 1e-9 && (half.wavelength_nm - full.wavelength_nm).abs() < 1e-9);
    }

    /// Photons counted wavelength by wavelength, 0.1 nm at a time, are those of the mean wavelength.
    #[test]
    fn photons_are_those_of_a_sum_over_wavelengths() {
        let tsis = SolarSpectrum::tsis1_hsrs();
        let response = Curve::new(vec![[400.0, 0.0], [500.0, 0.9], [900.0, 0.4]]).unwrap();
        let light = tsis.through(&response).unwrap();
        let by_means = light.irradiance_w_m2 * light.wavelength_nm;
        let step_nm = 0.1;
        let sum: f64 = (0..5000)
            .map(|i| 400.0 + (f64::from(i) + 0.5) * step_nm)
            .map(|nm| tsis.curve.at(nm) * response.at(nm) * nm * step_nm)
            .sum();
        assert!((by_means / sum - 1.0).abs() < 1e-5, "{by_means} {sum}");
    }

    #[test]
    fn a_band_beyond_the_table_is_refused() {
        let error = SolarSpectrum::tsis1_hsrs().through(&Curve::top_hat([300.0, 700.0]).unwrap()).unwrap_err();
        assert!(error.to_string().contains("350 to 2500 nm"), "{error}");
        let dark = Curve::new(vec![[400.0, 0.0], [500.0, 0.0]]).unwrap();
        assert!(SolarSpectrum::e490().through(&dark).is_err());
    }
}
