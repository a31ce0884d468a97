//! Radiance of the ground per irradiance of the ground: the bidirectional reflectance distribution function.
//!
//! With `μ0 = cos i`, `μ = cos e` and `g` the phase angle, `BRDF = L/E = RADF/(π μ0)`:
//!
//! ```text
//! empirical   RADF = A f(g) D(i, e, g)       A the normal albedo, see `PhaseFunction` and `DiscFunction`
//! LROC 2019   RADF = μ0/(μ0 + μ) exp(−1.479654495 − 8.3528e-5 g² + 0.012964707 g − 0.237774774 √g
//!                                    + 0.556075496 μ + 0.663671460 μ0 − 0.439918609 μ0²)    g in deg
//! Hapke       see `Hapke`
//! ```
//!
//! Every law but LROC's is symmetric in `i` and `e`. Cosines below 1e-6 count as 1e-6, so that every value is finite. At
//! the terminator take `μ0` over the visible part of the disc, `E/(E_n V)`, which is positive where `E` is.
//!
//! # Assumptions
//! - The phase angle comes as a cosine. In `f32` it resolves 3.5e-4 rad, 0.3 % of the lunar opposition surge.
//! - The Sun is a point for the phase angle; the surge inside `g < r` is not flattened.
//! - LROC's law was fitted to phase angles of 15 to 65°; what it says elsewhere is extrapolated.
//!
//! `reflectance.wgsl` does the same; `tests/conformance/photometry.rs` holds the two together.
//!
//! # References
//! USGS ISIS, `lronacpho`, algorithm of 2019, for LROC's law. Those of the disc functions and of the phase function stand
//! there.
#![warn(missing_docs)]

use std::f64::consts::{FRAC_PI_2, PI};

use super::quadrature::{gauss_legendre, integrate};
use super::{DiscFunction, Hapke, MultipleScattering, PhaseFunction, PhotometryError};

/// A law of reflection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reflectance {
    /// What an albedo, a phase function and a disc function give together.
    Empirical {
        /// `π f_r` at `i = e = g = 0`.
        normal_albedo: f64,
        /// How light is spread over the disc.
        disc: DiscFunction,
        /// How it falls with the phase angle.
        phase: PhaseFunction,
    },
    /// The Moon in images of LROC's narrow-angle cameras, fitted in 2019.
    LrocNac2019 {
        /// What multiplies the reflectance: 1 is the fit's.
        scale: f64,
    },
    /// Hapke's model.
    Hapke(Hapke),
}

/// The parameters of all laws, as `reflectance.wgsl` reads them. Those of other laws are 0.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ReflectanceParameters {
    /// For Hapke's law and LROC's what multiplies it.
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
    /// Of the powers of the phase angle in `ln f`.
    pub phase_linear: f32,
    /// See `phase_linear`.
    pub phase_square: f32,
    /// See `phase_linear`.
    pub phase_cube: f32,
    /// See `phase_linear`.
    pub phase_fourth: f32,
    /// Of the surge of 4°.
    pub phase_narrow_surge: f32,
    /// Of the surge of 13°.
    pub phase_wide_surge: f32,
}

/// Cosines of incidence and emission count as no less.
const LEAST_COSINE: f64 = 1e-6;

impl Reflectance {
    /// A law without a phase function: brightness changes with the phase angle only as the disc function says.
    pub fn empirical(normal_albedo: f64, disc: DiscFunction) -> Self {
        Self::Empirical { normal_albedo, disc, phase: PhaseFunction::CONSTANT }
    }

    /// Lambert's law.
    pub fn lambert(normal_albedo: f64) -> Self {
        Self::empirical(normal_albedo, DiscFunction::Lambert)
    }

    /// An empirical law with the Moon's phase function: its sphere is as bright as ROLO saw the Moon, but for the albedo.
    pub fn lunar(normal_albedo: f64, disc: DiscFunction) -> Result<Self, PhotometryError> {
        Ok(Self::Empirical { normal_albedo, disc, phase: Self::lunar_phase(disc)? })
    }

    /// The Moon's phase function for a disc function. It takes some 100 integrals over the disc, 20 ms.
    pub fn lunar_phase(disc: DiscFunction) -> Result<PhaseFunction, PhotometryError> {
        let law = Self::empirical(1.0, disc);
        PhaseFunction::of_the_moon(|phase_rad| law.disc_reflectance(phase_rad))
    }

    /// Checks every parameter against the law's domain.
    pub fn check(&self) -> Result<(), PhotometryError> {
        let within = |parameter, got, range: std::ops::RangeInclusive<f64>, allowed| {
            if range.contains(&got) { Ok(()) } else { Err(PhotometryError::OutOfRange { parameter, got, allowed }) }
        };
        let (normal_albedo, disc) = match *self {
            Self::Hapke(hapke) => return hapke.check(),
            Self::LrocNac2019 { scale } => return within("scale", scale, 0.0..=10.0, "[0, 10]"),
            Self::Empirical { normal_albedo, disc, .. } => (normal_albedo, disc),
        };
        match disc {
            // At grazing incidence this law returns four times its normal albedo.
            DiscFunction::LommelSeeliger => within("normal_albedo", normal_albedo, 0.0..=0.25, "[0, 0.25]"),
            // So does this one: 2.7 times for a smoothness of 0.
            DiscFunction::Akimov { smoothness } => within("normal_albedo", normal_albedo, 0.0..=0.37, "[0, 0.37]")
                .and(within("smoothness", smoothness, 0.0..=2.0, "[0, 2]")),
            DiscFunction::Minnaert { exponent } => within("normal_albedo", normal_albedo, 0.0..=1.0, "[0, 1]")
                .and(within("exponent", exponent, 0.5..=1.5, "[0.5, 1.5]")),
            DiscFunction::Lambert | DiscFunction::LunarLambert => {
                within("normal_albedo", normal_albedo, 0.0..=1.0, "[0, 1]")
            }
        }
    }

    /// Radiance over irradiance of the ground, from the cosines of incidence, emission and phase angle.
    pub fn brdf_sr(&self, incidence_cosine: f64, emission_cosine: f64, phase_cosine: f64) -> f64 {
        let mu0 = incidence_cosine.clamp(LEAST_COSINE, 1.0);
        let mu = emission_cosine.clamp(LEAST_COSINE, 1.0);
        let phase_cosine = phase_cosine.clamp(-1.0, 1.0);
        match *self {
            Self::Empirical { normal_albedo, disc, phase } => {
                normal_albedo / PI * phase.value(phase_cosine.acos()) * disc.over_incidence(mu0, mu, phase_cosine)
            }
            Self::LrocNac2019 { scale } => scale / PI * lroc_nac_2019(mu0, mu, phase_cosine.acos().to_degrees()),
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
            Self::Empirical { disc, .. } => disc.constant().0,
            Self::Hapke(_) => 4.0,
            Self::LrocNac2019 { .. } => 6.0,
        };
        ("REFLECTANCE_MODEL", model)
    }

    /// The law's numbers as the shader reads them.
    pub fn parameters(&self) -> ReflectanceParameters {
        let none = ReflectanceParameters::default();
        match *self {
            Self::Empirical { normal_albedo, disc, phase } => ReflectanceParameters {
                normal_albedo: normal_albedo as f32,
                exponent: disc.constant().1 as f32,
                phase_linear: phase.powers[0] as f32,
                phase_square: phase.powers[1] as f32,
                phase_cube: phase.powers[2] as f32,
                phase_fourth: phase.powers[3] as f32,
                phase_narrow_surge: phase.surges[0] as f32,
                phase_wide_surge: phase.surges[1] as f32,
                ..none
            },
            Self::LrocNac2019 { scale } => ReflectanceParameters { normal_albedo: scale as f32, ..none },
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

/// LROC's reflectance over the cosine of incidence.
fn lroc_nac_2019(mu0: f64, mu: f64, phase_deg: f64) -> f64 {
    let phase = phase_deg * (0.012964707 - 8.3528e-5 * phase_deg) - 0.237774774 * phase_deg.sqrt();
    let angles = 0.556075496 * mu + mu0 * (0.663671460 - 0.439918609 * mu0);
    (-1.479654495 + phase + angles).exp() / (mu0 + mu)
}

#[cfg(test)]
mod tests;
