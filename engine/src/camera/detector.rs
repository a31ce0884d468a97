//! Electrons and digital numbers: the linear model of EMVA 1288.
//!
//! ```text
//! μ_p = E A t λ / (h c)                         photons on a pixel of area A in the exposure t
//! μ_e = η μ_p,   μ_d = i_d t                    electrons of light and of dark current
//! n   = Poisson(μ_e (1 + PRNU)) + Poisson(μ_d) + DSNU, at most the full well
//! DN  = round(K (n + read noise) + offset), within 0 … 2^bits − 1
//! ```
//!
//! so that the variance grows with the mean by the gain `K`: `σ² = K² σ_read² + 1/12 + K (μ − μ_dark)`.
//!
//! Every random number belongs to a seed, an exposure, a pixel and a stage, and to nothing else: the ChaCha stream
//! of the seed is cut into one block of 16 words a pixel. The pattern (PRNU, DSNU) is that of the seed and the same
//! in all exposures.
//!
//! # Assumptions
//! - One wavelength and one quantum efficiency stand for the band.
//! - Poisson numbers are exact below 50 electrons, and rounded Gaussian ones above (skewness 0.14 there).
//! - No lag, no cosmic rays. Blooming is off unless asked for: then what a well cannot hold goes to its neighbours in the
//!   column, half up and half down, and on from there; what reaches the column's ends is lost.
//!
//! # References
//! EMVA Standard 1288, release 4.0 linear.

use std::f64::consts::TAU;

use rand::RngCore;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::{CameraError, check};
use crate::quantity::{PLANCK_CONSTANT_J_S, SPEED_OF_LIGHT_M_S};

/// A detector and its exposure.
#[derive(Debug, Clone, PartialEq)]
pub struct Detector {
    pub exposure_s: f64,
    pub pixel_pitch_m: f64,
    pub wavelength_m: f64,
    /// Electrons per photon.
    pub quantum_efficiency: f64,
    pub dark_current_e_s: f64,
    pub read_noise_e: f64,
    pub full_well_e: f64,
    /// DN per electron.
    pub gain_dn_e: f64,
    pub offset_dn: f64,
    pub bits: u32,
    /// Standard deviation of the pixels' gains, relative.
    pub prnu: f64,
    /// Standard deviation of the pixels' dark offsets, in electrons.
    pub dsnu_e: f64,
    /// Whether full wells spill into their column.
    pub blooming: bool,
    pub seed: u64,
}

/// Words of the ChaCha stream that one pixel owns: a block, four words for each stage.
const WORDS: u128 = 16;
/// The stream of the fixed pattern; exposures count from 0 and never get here.
const PATTERN_STREAM: u64 = u64::MAX;
/// Pixels to one task.
const CHUNK: usize = 4096;
/// From this mean on a Poisson number is a rounded Gaussian one.
const GAUSSIAN_FROM: f64 = 50.0;

impl Detector {
    /// Checks every parameter.
    pub fn check(&self) -> Result<(), CameraError> {
        check("detector exposure", self.exposure_s, 0.0..=1e6, "[0, 1e6] s")?;
        check("detector pixel pitch", self.pixel_pitch_m, 1e-7..=1e-2, "[1e-7, 1e-2] m")?;
        check("detector wavelength", self.wavelength_m, 1e-7..=1e-4, "[1e-7, 1e-4] m")?;
        check("detector quantum efficiency", self.quantum_efficiency, 0.0..=1.0, "[0, 1]")?;
        check("detector dark current", self.dark_current_e_s, 0.0..=1e9, "[0, 1e9] e-/s")?;
        check("detector read noise", self.read_noise_e, 0.0..=1e6, "[0, 1e6] e-")?;
        check("detector full well", self.full_well_e, 1.0..=1e9, "[1, 1e9] e-")?;
        check("detector gain", self.gain_dn_e, 1e-9..=1e6, "[1e-9, 1e6] DN/e-")?;
        check("detector offset", self.offset_dn, 0.0..=65535.0, "[0, 65535] DN")?;
        check("detector bits", f64::from(self.bits), 1.0..=16.0, "[1, 16]")?;
        check("detector PRNU", self.prnu, 0.0..=1.0, "[0, 1]")?;
        check("detector DSNU", self.dsnu_e, 0.0..=1e6, "[0, 1e6] e-")
    }

    /// Mean photons on a pixel under an irradiance of the focal plane.
    pub fn photons(&self, irradiance_w_m2: f64) -> f64 {
        let energy_j = irradiance_w_m2 * self.pixel_pitch_m * self.pixel_pitch_m * self.exposure_s;
        energy_j * self.wavelength_m / (PLANCK_CONSTANT_J_S * SPEED_OF_LIGHT_M_S)
    }

    /// Electrons up to which digital numbers tell more from less.
    pub fn capacity_e(&self) -> f64 {
        let largest = f64::from((1u32 << self.bits) - 1);
        self.full_well_e.min((largest - self.offset_dn) / self.gain_dn_e)
    }

    /// Mean electrons of light. Where the irradiance has no value there is no light.
    fn electrons(&self, irradiance_w_m2: f32) -> f64 {
        self.quantum_efficiency * self.photons(f64::from(irradiance_w_m2.max(0.0)))
    }

    /// The image in digital numbers without any noise or pattern.
    pub fn expose_without_noise(&self, irradiance_w_m2: &[f32], columns: usize) -> Vec<u16> {
        let dark_e = self.dark_current_e_s * self.exposure_s;
        let mut charge_e: Vec<f64> = irradiance_w_m2.iter().map(|&light| self.electrons(light) + dark_e).collect();
        self.fill(&mut charge_e, columns);
        charge_e.into_iter().map(|electrons| self.digitise(electrons)).collect()
    }

    /// The image in digital numbers; `exposure` counts the exposures of a sequence.
    pub fn expose(&self, irradiance_w_m2: &[f32], columns: usize, exposure: u64) -> Vec<u16> {
        let mut charge_e = vec![0.0; irradiance_w_m2.len()];
        let chunks = charge_e.par_chunks_mut(CHUNK).zip(irradiance_w_m2.par_chunks(CHUNK)).enumerate();
        chunks.for_each(|(chunk, (charge_e, light))| {
            let [mut pattern, mut noise] = [PATTERN_STREAM, exposure].map(|stream| self.stream(stream, chunk * CHUNK));
            for (charge_e, &light) in charge_e.iter_mut().zip(light) {
                *charge_e = self.gathered(light, draws(&mut pattern), draws(&mut noise));
            }
        });
        self.fill(&mut charge_e, columns);
        let mut dn = vec![0; charge_e.len()];
        dn.par_chunks_mut(CHUNK).zip(charge_e.par_chunks(CHUNK)).enumerate().for_each(|(chunk, (dn, charge_e))| {
            let mut noise = self.stream(exposure, chunk * CHUNK);
            for (dn, charge_e) in dn.iter_mut().zip(charge_e) {
                *dn = self.digitise(charge_e + self.read_noise_e * gaussian(draws(&mut noise)[2]));
            }
        });
        dn
    }

    /// Wells hold what they can; the rest is lost, or spills.
    fn fill(&self, charge_e: &mut [f64], columns: usize) {
        if self.blooming {
            (0..columns).for_each(|column| spill(charge_e, column, columns, self.full_well_e));
        }
        charge_e.iter_mut().for_each(|electrons| *electrons = electrons.min(self.full_well_e));
    }

    /// The stream's random numbers from a pixel on.
    fn stream(&self, stream: u64, pixel: usize) -> ChaCha8Rng {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(stream);
        rng.set_word_pos(WORDS * pixel as u128);
        rng
    }

    /// Electrons of a pixel before its well is full.
    fn gathered(&self, irradiance_w_m2: f32, pattern: Draws, noise: Draws) -> f64 {
        let gain = (1.0 + self.prnu * gaussian(pattern[0])).max(0.0);
        let light_e = poisson(gain * self.electrons(irradiance_w_m2), noise[0]);
        let dark_e = poisson(self.dark_current_e_s * self.exposure_s, noise[1]);
        light_e + dark_e + self.dsnu_e * gaussian(pattern[1])
    }

    fn digitise(&self, electrons: f64) -> u16 {
        let largest = f64::from((1u32 << self.bits) - 1);
        (self.gain_dn_e * electrons + self.offset_dn).round().clamp(0.0, largest) as u16
    }
}

/// Half of what each well of a column cannot hold goes down, half up, as far as it must.
fn spill(charge_e: &mut [f64], column: usize, columns: usize, full_e: f64) {
    let cells: Vec<usize> = (column..charge_e.len()).step_by(columns).collect();
    let halves: Vec<f64> = cells.iter().map(|&cell| 0.5 * (charge_e[cell] - full_e).max(0.0)).collect();
    cells.iter().for_each(|&cell| charge_e[cell] = charge_e[cell].min(full_e));
    let mut sweep = |order: &mut dyn Iterator<Item = usize>| {
        let mut carried_e = 0.0;
        for index in order {
            let sum_e = charge_e[cells[index]] + carried_e;
            charge_e[cells[index]] = sum_e.min(full_e);
            carried_e = sum_e - charge_e[cells[index]] + halves[index];
        }
    };
    sweep(&mut (0..cells.len()));
    sweep(&mut (0..cells.len()).rev());
}

/// Two uniform numbers in (0, 1) for each of four stages.
type Draws = [[f64; 2]; 4];

/// The next pixel's block.
fn draws(rng: &mut ChaCha8Rng) -> Draws {
    std::array::from_fn(|_| std::array::from_fn(|_| ((rng.next_u64() >> 12) as f64 + 0.5) / (1u64 << 52) as f64))
}

/// Box & Muller (1958).
fn gaussian([radius, turn]: [f64; 2]) -> f64 {
    (-2.0 * radius.ln()).sqrt() * (TAU * turn).cos()
}

/// Below [`GAUSSIAN_FROM`] by inversion of the distribution.
fn poisson(mean: f64, draw: [f64; 2]) -> f64 {
    if mean >= GAUSSIAN_FROM {
        return (mean + mean.sqrt() * gaussian(draw)).round().max(0.0);
    }
    let (mut count, mut share) = (0.0, (-mean).exp());
    let mut sum = share;
    while draw[0] > sum && share > 0.0 {
        count += 1.0;
        share *= mean / count;
        sum += share;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detector() -> Detector {
        Detector {
            exposure_s: 0.01,
            pixel_pitch_m: 5e-6,
            wavelength_m: 600e-9,
            quantum_efficiency: 0.5,
            dark_current_e_s: 500.0,
            read_noise_e: 8.0,
            full_well_e: 20_000.0,
            gain_dn_e: 0.2,
            offset_dn: 100.0,
            bits: 12,
            prnu: 0.0,
            dsnu_e: 0.0,
            blooming: false,
            seed: 7,
        }
    }

    /// The irradiance that gives so many electrons of light.
    fn irradiance(detector: &Detector, electrons: f64) -> f32 {
        (electrons / (detector.quantum_efficiency * detector.photons(1.0))) as f32
    }

    fn mean_and_variance(values: &[u16]) -> (f64, f64) {
        let mean = values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len() as f64;
        (mean, values.iter().map(|&v| (f64::from(v) - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64)
    }

    /// LROC NAC over ground of I/F 0.05: 0.475 W/m², 7 µm, 0.3376 ms, mean wavelength 580 nm: 23 000 photons.
    #[test]
    fn a_lunar_pixel_gets_its_23000_photons() {
        let nac = Detector { exposure_s: 0.3376e-3, pixel_pitch_m: 7e-6, wavelength_m: 580e-9, ..detector() };
        assert!((nac.photons(0.475) / 23_000.0 - 1.0).abs() < 0.01, "{}", nac.photons(0.475));
    }

    /// The photon transfer curve: variance against mean has the gain as its slope and starts at
    /// K² (σ² + dark) + 1/12. With 2e5 pixels a variance scatters by 0.3 %; 1.5 % is five times that.
    #[test]
    fn variance_grows_with_the_mean_by_the_gain() {
        let detector = detector();
        for electrons in [0.0, 20.0, 45.0, 60.0, 1000.0, 10_000.0] {
            let (mean, variance) =
                mean_and_variance(&detector.expose(&vec![irradiance(&detector, electrons); 200_000], 500, 0));
            let k = detector.gain_dn_e;
            let expected_mean = k * (electrons + 5.0) + 100.0;
            let expected_variance = k * k * (64.0 + 5.0 + electrons) + 1.0 / 12.0;
            assert!((mean - expected_mean).abs() < 5.0 * (expected_variance / 2e5).sqrt(), "{electrons}: {mean}");
            assert!((variance / expected_variance - 1.0).abs() < 0.015, "{electrons}: {variance} {expected_variance}");
        }
    }

    #[test]
    fn without_noise_the_mean_remains() {
        let detector = detector();
        let light = [0.0, 1000.0, 1e9].map(|electrons| irradiance(&detector, electrons));
        assert_eq!(detector.expose_without_noise(&light, 1), [101, 301, 4095]);
        let deep = Detector { bits: 16, ..detector };
        assert_eq!(deep.expose_without_noise(&[light[2], f32::NAN], 1), [4100, 101], "full well; no value is no light");
    }

    #[test]
    fn a_pixels_noise_belongs_to_seed_exposure_and_pixel_alone() {
        let detector = detector();
        let light = vec![irradiance(&detector, 500.0); 3 * CHUNK + 17];
        let whole = detector.expose(&light, 1, 3);
        assert_eq!(whole, detector.expose(&light, 1, 3));
        assert_eq!(whole[..100], detector.expose(&light[..100], 1, 3), "does not depend on the image's size");
        let mut other = light.clone();
        other[5] = 0.0;
        assert_eq!(whole[6..], detector.expose(&other, 1, 3)[6..], "does not depend on the neighbours");
        assert_ne!(whole, detector.expose(&light, 1, 4));
        assert_ne!(whole, Detector { seed: 8, ..detector }.expose(&light, 1, 3));
        let one_pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let alone = one_pool.install(|| super::tests::detector().expose(&light, 1, 3));
        assert_eq!(whole, alone, "does not depend on threads");
    }

    /// 9 wells of light on one pixel of the middle column fill 4 above and 4 below; at an edge half of it is lost.
    #[test]
    fn a_full_well_spills_along_its_column_and_nothing_else() {
        let quiet = Detector { dark_current_e_s: 0.0, blooming: true, gain_dn_e: 0.1, offset_dn: 0.0, ..detector() };
        let seen = |row: usize| {
            let mut light = vec![0.0; 3 * 21];
            light[3 * row + 1] = irradiance(&quiet, 9.0 * quiet.full_well_e);
            quiet.expose_without_noise(&light, 3)
        };
        let full = |dn: &[u16], column: usize| (0..21).filter(|row| dn[3 * row + column] == 2000).collect::<Vec<_>>();
        assert_eq!(full(&seen(10), 1), (6..=14).collect::<Vec<_>>());
        assert_eq!(full(&seen(0), 1), (0..=4).collect::<Vec<_>>());
        assert!(full(&seen(10), 0).is_empty() && seen(10).iter().filter(|dn| **dn > 0).count() == 9);
        let dry = Detector { blooming: false, ..quiet.clone() };
        let mut light = vec![0.0; 63];
        light[31] = irradiance(&quiet, 9.0 * quiet.full_well_e);
        assert_eq!(dry.expose_without_noise(&light, 3).iter().filter(|dn| **dn > 0).count(), 1);
    }

    /// PRNU and DSNU stay when exposures are averaged: 1 % of 10 000 e-, and 30 e-, at 0.2 DN/e-.
    #[test]
    fn the_pattern_is_the_same_in_every_exposure() {
        let patterned = Detector { prnu: 0.01, dsnu_e: 30.0, dark_current_e_s: 0.0, ..detector() };
        for (electrons, expected_dn) in [(0.0, 6.0), (10_000.0, 0.2 * (100f64.powi(2) + 30f64.powi(2)).sqrt())] {
            let light = vec![irradiance(&patterned, electrons); 20_000];
            let [first, second] = [0, 1].map(|exposure| patterned.expose(&light, 1, exposure));
            let (a, b) = (mean_and_variance(&first).0, mean_and_variance(&second).0);
            let shared = first.iter().zip(&second).map(|(&x, &y)| (f64::from(x) - a) * (f64::from(y) - b)).sum::<f64>();
            let pattern_dn = (shared / 20_000.0).sqrt();
            assert!((pattern_dn / expected_dn - 1.0).abs() < 0.05, "{electrons}: {pattern_dn} {expected_dn}");
        }
    }

    /// Mean 2: shares of 0, 1, 2, 3 counts are e⁻² (1, 2, 2, 4/3); 4e5 draws scatter by 7e-4.
    #[test]
    fn small_poisson_numbers_have_their_distribution() {
        let mut rng = detector().stream(0, 0);
        let counts: Vec<f64> = (0..100_000).flat_map(|_| draws(&mut rng).map(|draw| poisson(2.0, draw))).collect();
        for (count, factor) in [(0.0, 1.0), (1.0, 2.0), (2.0, 2.0), (3.0, 4.0 / 3.0)] {
            let share = counts.iter().filter(|&&c| c == count).count() as f64 / counts.len() as f64;
            assert!((share - factor * (-2.0f64).exp()).abs() < 3.5e-3, "{count}: {share}");
        }
    }

    #[test]
    fn impossible_detectors_are_named() {
        let error = Detector { bits: 20, ..detector() }.check().unwrap_err();
        assert_eq!(error.to_string(), "detector bits = 20 is outside [1, 16]");
        assert!(Detector { exposure_s: f64::NAN, ..detector() }.check().is_err());
        assert!(detector().check().is_ok());
    }
}
