//! Published parameter sets of Hapke's model, in this program's notation.
//!
//! | set | wavelength | from | what its disc gives |
//! |---|---|---|---|
//! | `moon` | 566 nm | Sato et al. 2014 | within 5 % of ROLO's phase curve |
//! | `mars` | red | Kirk & Johnson, as shipped with USGS ISIS | I/F 0.131 at i = 30°, e = 0 |
//! | `mercury` | 554 nm | Warell & Valegård 2006, table 1 | geometric albedo 0.158 |
//!
//! Papers write the two lobes in two ways: with shares `(1 ± c)/2`, as here, and with `c` and `1 − c` (McGuire & Hapke
//! 1995), whose `c` is `2c − 1` here. Mercury's set comes in the second; read in the first it is 3 % darker.
//!
//! There is no set for Ceres: what was found names the asymmetry `ξ = −bc` alone. Read as one lobe it gives a geometric
//! albedo of 0.065, where its authors found 0.094.
//!
//! # References
//! Sato et al. (2014), JGR Planets 119, 1775, doi:10.1002/2013JE004580; Warell & Valegård (2006), A&A 460, 625,
//! doi:10.1051/0004-6361:20065850; Ciarniello et al. (2017), A&A 598, A130, doi:10.1051/0004-6361/201629490, for Ceres.

use super::{Hapke, MultipleScattering};

impl Hapke {
    /// The lunar regolith at 566 nm after Sato et al. (2014), with `K = 1` as they fitted.
    pub fn moon() -> Self {
        Self {
            single_scattering_albedo: 0.32357,
            asymmetry: 0.23955,
            backscatter: 0.30452,
            shadow_hiding_amplitude: 1.80238,
            shadow_hiding_width: 0.07145,
            coherent_amplitude: 0.0,
            coherent_width: 1.0,
            mean_slope_rad: 23.4f64.to_radians(),
            filling_factor: 0.0,
            multiple_scattering: MultipleScattering::Hapke2002,
            scale: 1.0,
        }
    }

    /// Mars in red light, without haze: the set of Kirk & Johnson in the photometric templates of USGS ISIS.
    pub fn mars() -> Self {
        Self {
            single_scattering_albedo: 0.52,
            asymmetry: 0.213,
            backscatter: 1.0,
            shadow_hiding_amplitude: 0.0,
            shadow_hiding_width: 1.0,
            mean_slope_rad: 30f64.to_radians(),
            multiple_scattering: MultipleScattering::Hapke1981,
            ..Self::moon()
        }
    }

    /// Mercury at 554 nm after Warell & Valegård (2006), table 1: w 0.18, b 0.18, c 1.1 of McGuire & Hapke, B0 2.7,
    /// h 0.09, θ̄ 20°.
    pub fn mercury() -> Self {
        Self {
            single_scattering_albedo: 0.18,
            asymmetry: 0.18,
            backscatter: 1.2,
            shadow_hiding_amplitude: 2.7,
            shadow_hiding_width: 0.09,
            mean_slope_rad: 20f64.to_radians(),
            multiple_scattering: MultipleScattering::Hapke1981,
            ..Self::moon()
        }
    }
}
