//! Hapke's bidirectional reflectance (2012): porosity, anisotropic single scattering, both opposition surges,
//! macroscopic roughness.
//!
//! With `g` the phase angle, `ψ` the azimuth between the planes of incidence and emission:
//!
//! ```text
//! RADF = K (w/4) μ0e/(μ0e + μe) [ p(g) (1 + Bs0 Bs(g)) + H(μ0e/K) H(μe/K) − 1 ] [1 + Bc0 Bc(g)] S(i, e, ψ)
//!
//! p  = (1+c)/2 (1−b²)/(1 − 2b cos g + b²)^1.5 + (1−c)/2 (1−b²)/(1 + 2b cos g + b²)^1.5    c = 1: all back
//! Bs = 1/(1 + tan(g/2)/hs)        Bc = [1 + (1 − e^−y)/y] / [2 (1 + y)²],  y = tan(g/2)/hc
//! K  = −ln(1 − 1.209 φ^⅔)/(1.209 φ^⅔)
//! H  = 1/{1 − w x [r0 + (1 − 2 r0 x)/2 ln((1 + x)/x)]}          r0 = (1 − √(1−w))/(1 + √(1−w))
//! ```
//!
//! The roughness `S` and the effective cosines `μ0e`, `μe` are those of 1984. What is returned is
//! `BRDF = RADF/(π μ0)`, with the quotient `μ0e S/μ0` taken analytically so that it stays finite at the terminator.
//!
//! # Assumptions
//! - The mean slope `θ̄` stands for relief below the facet. Sets fitted to kilometre pixels count again the shadows
//!   that a metre-scale DEM casts itself: pass a smaller one there.
//!
//! # References
//! Hapke (2012), Theory of Reflectance and Emittance Spectroscopy, 2nd ed.; Hapke (1984), Icarus 59, 41, for the
//! roughness; Sato et al. (2014), JGR Planets 119, 1775, doi:10.1002/2013JE004580, for the Moon.

use std::f64::consts::PI;

use super::PhotometryError;

/// The function `H` of multiple scattering.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MultipleScattering {
    /// `(1 + 2x)/(1 + 2x √(1−w))`: what parameter sets before 2002 were fitted with.
    Hapke1981,
    /// Within 1 % of Chandrasekhar's.
    Hapke2002,
}

/// Parameters of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hapke {
    /// `w`
    pub single_scattering_albedo: f64,
    /// `b`, width of both lobes of the phase function.
    pub asymmetry: f64,
    /// `c`: 1 scatters all back, −1 all forward; fits find up to 1.2.
    pub backscatter: f64,
    /// `Bs0`; 0 switches the shadow-hiding surge off.
    pub shadow_hiding_amplitude: f64,
    /// `hs`
    pub shadow_hiding_width: f64,
    /// `Bc0`; 0 switches the coherent surge off.
    pub coherent_amplitude: f64,
    /// `hc`
    pub coherent_width: f64,
    /// `θ̄`
    pub mean_slope_rad: f64,
    /// `φ`, share of the volume that is grains; 0 makes `K = 1`.
    pub filling_factor: f64,
    pub multiple_scattering: MultipleScattering,
    /// What multiplies the reflectance: ground brighter or darker than that of the set. 1 is the set's.
    pub scale: f64,
}

impl Hapke {
    /// Checks every parameter against the model's domain.
    pub fn check(&self) -> Result<(), PhotometryError> {
        let domains = [
            ("single_scattering_albedo", self.single_scattering_albedo, 0.0, 1.0, "[0, 1]"),
            ("asymmetry", self.asymmetry, 0.0, 0.95, "[0, 0.95]"),
            ("backscatter", self.backscatter, -1.3, 1.3, "[-1.3, 1.3]"),
            ("shadow_hiding_amplitude", self.shadow_hiding_amplitude, 0.0, 10.0, "[0, 10]"),
            ("shadow_hiding_width", self.shadow_hiding_width, 0.0, 10.0, "[0, 10]"),
            ("coherent_amplitude", self.coherent_amplitude, 0.0, 10.0, "[0, 10]"),
            ("coherent_width", self.coherent_width, 0.0, 10.0, "[0, 10]"),
            ("mean_slope", self.mean_slope_rad.to_degrees(), 0.0, 60.0, "[0, 60] deg"),
            ("filling_factor", self.filling_factor, 0.0, 0.75, "[0, 0.75]"),
            ("scale", self.scale, 0.0, 10.0, "[0, 10]"),
        ];
        if let Some((parameter, got, _, _, allowed)) =
            domains.into_iter().find(|&(_, got, least, most, ..)| !(least..=most).contains(&got))
        {
            return Err(PhotometryError::OutOfRange { parameter, got, allowed });
        }
        // Published fits go beyond a share of 1, as long as their phase function stays positive.
        if self.phase_function(-1.0).min(self.phase_function(1.0)) < 0.0 {
            let allowed = "what leaves the phase function positive";
            return Err(PhotometryError::OutOfRange { parameter: "backscatter", got: self.backscatter, allowed });
        }
        Ok(())
    }

    /// `K`
    pub fn porosity_factor(&self) -> f64 {
        match 1.209 * self.filling_factor.powf(2.0 / 3.0) {
            x if x < 1e-9 => 1.0,
            x => -(-x).ln_1p() / x,
        }
    }

    /// Radiance over irradiance of the ground; `incidence_cosine` and `emission_cosine` in (0, 1].
    pub(super) fn brdf_sr(&self, incidence_cosine: f64, emission_cosine: f64, phase_cosine: f64) -> f64 {
        let half_phase_tan = ((1.0 - phase_cosine) / (1.0 + phase_cosine).max(f64::MIN_POSITIVE)).sqrt();
        let rough = self.rough(incidence_cosine, emission_cosine, phase_cosine);
        let porosity = self.porosity_factor();
        let single = self.phase_function(phase_cosine) * (1.0 + self.shadow_hiding(half_phase_tan));
        let multiple = self.h(rough.incidence_cosine / porosity) * self.h(rough.emission_cosine / porosity) - 1.0;
        let both = rough.incidence_cosine + rough.emission_cosine;
        self.scale * porosity * self.single_scattering_albedo / (4.0 * PI) * rough.share_per_cosine / both
            * (single + multiple)
            * (1.0 + self.coherent(half_phase_tan))
    }

    fn phase_function(&self, phase_cosine: f64) -> f64 {
        let (b, c) = (self.asymmetry, self.backscatter);
        let lobe = |towards: f64| (1.0 - b * b) / (1.0 - 2.0 * b * towards + b * b).powf(1.5);
        (1.0 + c) / 2.0 * lobe(phase_cosine) + (1.0 - c) / 2.0 * lobe(-phase_cosine)
    }

    fn shadow_hiding(&self, half_phase_tan: f64) -> f64 {
        let width = self.shadow_hiding_width;
        if width == 0.0 { 0.0 } else { self.shadow_hiding_amplitude / (1.0 + half_phase_tan / width) }
    }

    fn coherent(&self, half_phase_tan: f64) -> f64 {
        if self.coherent_width == 0.0 {
            return 0.0;
        }
        let y = half_phase_tan / self.coherent_width;
        let fading = if y == 0.0 { 1.0 } else { -(-y).exp_m1() / y };
        self.coherent_amplitude * (1.0 + fading) / (2.0 * (1.0 + y) * (1.0 + y))
    }

    fn h(&self, x: f64) -> f64 {
        let w = self.single_scattering_albedo;
        let gamma = (1.0 - w).sqrt();
        match self.multiple_scattering {
            MultipleScattering::Hapke1981 => (1.0 + 2.0 * x) / (1.0 + 2.0 * x * gamma),
            MultipleScattering::Hapke2002 => {
                let r0 = (1.0 - gamma) / (1.0 + gamma);
                1.0 / (1.0 - w * x * (r0 + (0.5 - r0 * x) * (1.0 / x).ln_1p()))
            }
        }
    }

    /// Effective cosines of a rough surface, and `μ0e S/μ0`.
    fn rough(&self, incidence_cosine: f64, emission_cosine: f64, phase_cosine: f64) -> Rough {
        let slope_tan = self.mean_slope_rad.tan();
        if slope_tan == 0.0 {
            return Rough { incidence_cosine, emission_cosine, share_per_cosine: 1.0 };
        }
        let [incidence, emission] = [incidence_cosine, emission_cosine].map(|cosine| Tilt::new(cosine, slope_tan));
        let chi = 1.0 / (1.0 + PI * slope_tan * slope_tan).sqrt();

        // sin²(ψ/2) from the sides of the spherical triangle; where i or e is 0 it does not matter.
        let sines = incidence.sine * emission.sine;
        let half_azimuth_sin2 = if sines > 0.0 {
            ((sines + incidence_cosine * emission_cosine - phase_cosine) / (2.0 * sines)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let azimuth_cos = 1.0 - 2.0 * half_azimuth_sin2;
        let azimuth_rad = 2.0 * half_azimuth_sin2.sqrt().asin();
        let f = (-2.0 * (half_azimuth_sin2 / (1.0 - half_azimuth_sin2)).sqrt()).exp();

        // The ray further from the vertical is shadowed by itself, the other one relative to it.
        let (near, far) =
            if incidence_cosine >= emission_cosine { (incidence, emission) } else { (emission, incidence) };
        let d = 2.0 - far.e1 - azimuth_rad / PI * near.e1;
        let near_cosine =
            chi * (near.cosine + near.sine * slope_tan * (azimuth_cos * far.e2 + half_azimuth_sin2 * near.e2) / d);
        let far_cosine = chi * (far.cosine + far.sine * slope_tan * (far.e2 - half_azimuth_sin2 * near.e2) / d);
        let (incidence_effective, emission_effective) =
            if incidence_cosine >= emission_cosine { (near_cosine, far_cosine) } else { (far_cosine, near_cosine) };

        let [incidence_eta, emission_eta, near_eta] = [incidence, emission, near]
            .map(|tilt| chi * (tilt.cosine + tilt.sine * slope_tan * tilt.e2 / (2.0 - tilt.e1)));
        let visible = chi / (1.0 - f + f * chi * near.cosine / near_eta);
        Rough {
            incidence_cosine: incidence_effective,
            emission_cosine: emission_effective,
            share_per_cosine: incidence_effective * emission_effective / (incidence_eta * emission_eta) * visible,
        }
    }
}

/// One ray against the mean slope: `E1 = exp(−(2/π) cot θ̄ cot x)`, `E2 = exp(−(1/π) cot²θ̄ cot²x)`.
#[derive(Debug, Clone, Copy)]
struct Tilt {
    cosine: f64,
    sine: f64,
    e1: f64,
    e2: f64,
}

impl Tilt {
    fn new(cosine: f64, slope_tan: f64) -> Self {
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let cotangents = cosine / (slope_tan * sine.max(1e-10));
        Self { cosine, sine, e1: (-2.0 / PI * cotangents).exp(), e2: (-cotangents * cotangents / PI).exp() }
    }
}

struct Rough {
    incidence_cosine: f64,
    emission_cosine: f64,
    share_per_cosine: f64,
}
