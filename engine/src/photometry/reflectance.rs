//! Radiance of the ground per irradiance of the ground: the bidirectional reflectance distribution function.
//!
//! With `μ0 = cos i`, `μ = cos e`, `g` the phase angle and `A` the normal albedo, `BRDF = L/E = RADF/(π μ0)`:
//!
//! ```text
//! Lambert           A/π
//! Lommel–Seeliger   A/π · 2/(μ0 + μ)
//! lunar-Lambert     A/π · [2 L(g)/(μ0 + μ) + 1 − L(g)]     L = 1 − 0.019 g + 0.242e-3 g² − 1.46e-6 g³, g in deg, L ≥ 0
//! Minnaert          A/π · (μ0 μ)^(k−1)
//! Akimov            A/π · cos(g/2) cos(π d/(π − g)) (cos b)^(1 + η g/(π − g)) / (μ0 μ)
//! Hapke             see `Hapke`
//! ```
//!
//! with the photometric latitude `b` and the longitude `d` from the middle between the points below the Sun and below
//! the camera:
//!
//! ```text
//! cos b cos d = (μ0 + μ)/(2 cos(g/2))        cos b sin d = (μ0 − μ)/(2 sin(g/2))
//! ```
//!
//! Akimov's `η` is 1 in his parameterless law; smaller ones fade less towards the poles of the photometric system.
//! Every law is symmetric in `i` and `e`. Cosines below 1e-6 count as 1e-6, so that every value is finite. At the
//! terminator take `μ0` over the visible part of the disc, `E/(E_n V)`, which is positive where `E` is.
//!
//! # Assumptions
//! - The phase angle comes as a cosine. In `f32` it resolves 3.5e-4 rad, 0.3 % of the lunar opposition surge.
//! - The Sun is a point for the phase angle; the surge inside `g < r` is not flattened.
//!
//! `reflectance.wgsl` does the same; `tests/conformance/photometry.rs` holds the two together.
//!
//! # References
//! McEwen (1996), LPSC XXVII, 841, for the lunar-Lambert weight (as in ISIS `LunarLambertMcEwen`);
//! Minnaert (1941), ApJ 93, 403; Shkuratov et al. (2011), PSS 59, 1326, doi:10.1016/j.pss.2011.06.011, for Akimov's law
//! with and without its parameter.
#![warn(missing_docs)]

use std::f64::consts::{FRAC_PI_2, PI};

use super::quadrature::{gauss_legendre, integrate};
use super::{Hapke, MultipleScattering, PhotometryError};

/// A law of reflection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reflectance {
    /// The same radiance towards all sides.
    Lambert {
        /// `π f_r` at `i = e = g = 0`.
        normal_albedo: f64,
    },
    /// Single scattering by a dark, rough layer.
    LommelSeeliger {
        /// `π f_r` at `i = e = g = 0`.
        normal_albedo: f64,
    },
    /// Lommel-Seeliger and Lambert, mixed by the phase angle.
    LunarLambert {
        /// `π f_r` at `i = e = g = 0`.
        normal_albedo: f64,
    },
    /// Minnaert's law.
    Minnaert {
        /// `π f_r` at `i = e = g = 0`.
        normal_albedo: f64,
        /// Minnaert's `k`.
        exponent: f64,
    },
    /// `smoothness` is Akimov's η: 1 is his parameterless law.
    Akimov {
        /// `π f_r` at `i = e = g = 0`.
        normal_albedo: f64,
        /// Akimov's `η`.
        smoothness: f64,
    },
    /// Hapke's model.
    Hapke(Hapke),
}

/// The parameters of all laws, as `reflectance.wgsl` reads them. Those of other laws are 0.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ReflectanceParameters {
    /// For Hapke's law what multiplies it.
    pub normal_albedo: f32,
    /// Minnaert's `k`, or Akimov's `η`.
    pub exponent: f32,
    /// Hapke's `w`.
    pub single_scattering_albedo: f32,
    /// Hapke's `b`.
    pub asymmetry: f32,
    /// Hapke's `c`.
    pub backscatter: f32,
    /// Hapke's `B_S0`.
    pub shadow_hiding_amplitude: f32,
    /// Hapke's `h_S`.
    pub shadow_hiding_width: f32,
    /// Hapke's `B_C0`.
    pub coherent_amplitude: f32,
    /// Hapke's `h_C`.
    pub coherent_width: f32,
    /// `tan θ̄`.
    pub mean_slope_tan: f32,
    /// Hapke's `K`.
    pub porosity_factor: f32,
    /// The year of the function `H`: 1981 or 2002.
    pub multiple_scattering: f32,
}

/// Cosines of incidence and emission count as no less.
const LEAST_COSINE: f64 = 1e-6;

/// Akimov's phase angle stays as far from 180°, where his law has no value.
const LEAST_SUPPLEMENT_RAD: f64 = 1e-3;

impl Reflectance {
    /// Checks every parameter against the law's domain.
    pub fn check(&self) -> Result<(), PhotometryError> {
        let outside = |parameter, got, allowed| PhotometryError::OutOfRange { parameter, got, allowed };
        match *self {
            Self::Hapke(hapke) => hapke.check(),
            // At grazing incidence this law returns four times its normal albedo.
            Self::LommelSeeliger { normal_albedo } if !(0.0..=0.25).contains(&normal_albedo) => {
                Err(outside("normal_albedo", normal_albedo, "[0, 0.25]"))
            }
            Self::Lambert { normal_albedo }
            | Self::LunarLambert { normal_albedo }
            | Self::Minnaert { normal_albedo, .. }
            | Self::Akimov { normal_albedo, .. }
                if !(0.0..=1.0).contains(&normal_albedo) =>
            {
                Err(outside("normal_albedo", normal_albedo, "[0, 1]"))
            }
            Self::Minnaert { exponent, .. } if !(0.5..=1.5).contains(&exponent) => {
                Err(outside("exponent", exponent, "[0.5, 1.5]"))
            }
            // So does this one: 2.7 times for a smoothness of 0.
            Self::Akimov { normal_albedo, .. } if normal_albedo > 0.37 => {
                Err(outside("normal_albedo", normal_albedo, "[0, 0.37]"))
            }
            Self::Akimov { smoothness, .. } if !(0.0..=2.0).contains(&smoothness) => {
                Err(outside("smoothness", smoothness, "[0, 2]"))
            }
            _ => Ok(()),
        }
    }

    /// Radiance over irradiance of the ground, from the cosines of incidence, emission and phase angle.
    pub fn brdf_sr(&self, incidence_cosine: f64, emission_cosine: f64, phase_cosine: f64) -> f64 {
        let mu0 = incidence_cosine.clamp(LEAST_COSINE, 1.0);
        let mu = emission_cosine.clamp(LEAST_COSINE, 1.0);
        let phase_cosine = phase_cosine.clamp(-1.0, 1.0);
        match *self {
            Self::Lambert { normal_albedo } => normal_albedo / PI,
            Self::LommelSeeliger { normal_albedo } => normal_albedo / PI * 2.0 / (mu0 + mu),
            Self::LunarLambert { normal_albedo } => {
                let weight = lunar_lambert_weight(phase_cosine.acos().to_degrees());
                normal_albedo / PI * (2.0 * weight / (mu0 + mu) + 1.0 - weight)
            }
            Self::Minnaert { normal_albedo, exponent } => normal_albedo / PI * (mu0 * mu).powf(exponent - 1.0),
            Self::Akimov { normal_albedo, smoothness } => {
                normal_albedo / PI * akimov(smoothness, mu0, mu, phase_cosine)
            }
            Self::Hapke(hapke) => hapke.brdf_sr(mu0, mu, phase_cosine),
        }
    }

    /// `π L` over the irradiance of a plane that faces the Sun: the I/F of spacecraft images.
    pub fn radiance_factor(&self, incidence_cosine: f64, emission_cosine: f64, phase_cosine: f64) -> f64 {
        PI * incidence_cosine.max(0.0) * self.brdf_sr(incidence_cosine, emission_cosine, phase_cosine)
    }

    /// `π L` of a sphere's whole disc over the irradiance of a plane that faces the Sun, `∫ RADF μ dω / π`: in opposition the
    /// geometric albedo, ROLO's `A(g)` elsewhere.
    pub fn disc_reflectance(&self, phase_rad: f64) -> f64 {
        let rule = gauss_legendre(64);
        integrate(&rule, phase_rad - FRAC_PI_2, FRAC_PI_2, |longitude_rad| {
            integrate(&rule, -FRAC_PI_2, FRAC_PI_2, |latitude_rad| {
                let cos_b = latitude_rad.cos();
                let (mu0, mu) = (cos_b * (phase_rad - longitude_rad).cos(), cos_b * longitude_rad.cos());
                self.radiance_factor(mu0, mu, phase_rad.cos()) * mu * cos_b
            })
        }) / PI
    }

    /// The `override` value that picks the law in `reflectance.wgsl`.
    pub fn constant(&self) -> (&'static str, f64) {
        let model = match self {
            Self::Lambert { .. } => 0.0,
            Self::LommelSeeliger { .. } => 1.0,
            Self::LunarLambert { .. } => 2.0,
            Self::Minnaert { .. } => 3.0,
            Self::Hapke(_) => 4.0,
            Self::Akimov { .. } => 5.0,
        };
        ("REFLECTANCE_MODEL", model)
    }

    /// The law's numbers as the shader reads them.
    pub fn parameters(&self) -> ReflectanceParameters {
        let none = ReflectanceParameters::default();
        match *self {
            Self::Lambert { normal_albedo }
            | Self::LommelSeeliger { normal_albedo }
            | Self::LunarLambert { normal_albedo } => {
                ReflectanceParameters { normal_albedo: normal_albedo as f32, ..none }
            }
            Self::Minnaert { normal_albedo, exponent } => {
                ReflectanceParameters { normal_albedo: normal_albedo as f32, exponent: exponent as f32, ..none }
            }
            Self::Akimov { normal_albedo, smoothness } => {
                ReflectanceParameters { normal_albedo: normal_albedo as f32, exponent: smoothness as f32, ..none }
            }
            Self::Hapke(hapke) => ReflectanceParameters {
                normal_albedo: hapke.scale as f32,
                single_scattering_albedo: hapke.single_scattering_albedo as f32,
                asymmetry: hapke.asymmetry as f32,
                backscatter: hapke.backscatter as f32,
                shadow_hiding_amplitude: hapke.shadow_hiding_amplitude as f32,
                shadow_hiding_width: hapke.shadow_hiding_width as f32,
                coherent_amplitude: hapke.coherent_amplitude as f32,
                coherent_width: hapke.coherent_width as f32,
                mean_slope_tan: hapke.mean_slope_rad.tan() as f32,
                porosity_factor: hapke.porosity_factor() as f32,
                multiple_scattering: match hapke.multiple_scattering {
                    MultipleScattering::Hapke1981 => 1981.0,
                    MultipleScattering::Hapke2002 => 2002.0,
                },
                ..none
            },
        }
    }
}

/// Share of the Lommel–Seeliger term for the Moon; the fit turns negative beyond 104°, where 0 is taken.
fn lunar_lambert_weight(phase_deg: f64) -> f64 {
    (1.0 + phase_deg * (-0.019 + phase_deg * (0.242e-3 - 1.46e-6 * phase_deg))).max(0.0)
}

/// Akimov's disc function over the cosine of incidence; 1/μ0 in opposition.
fn akimov(smoothness: f64, mu0: f64, mu: f64, phase_cosine: f64) -> f64 {
    let phase_rad = phase_cosine.acos().min(PI - LEAST_SUPPLEMENT_RAD);
    let (half_sine, half_cosine) = (0.5 * phase_rad).sin_cos();
    let along = ((mu0 + mu) / (2.0 * half_cosine)).min(1.0);
    // In opposition the longitude has no influence, and no value.
    let reach = (1.0 - along * along).sqrt();
    let across = ((mu0 - mu) / (2.0 * half_sine).max(1e-12)).clamp(-reach, reach);
    let supplement_rad = PI - phase_rad;
    let towards_terminator = (PI / supplement_rad * across.atan2(along)).cos().max(0.0);
    let latitude_cosine = along.hypot(across);
    half_cosine * towards_terminator * latitude_cosine.powf(1.0 + smoothness * phase_rad / supplement_rad) / (mu0 * mu)
}

#[cfg(test)]
mod tests;
