//! Gradient noise whose gradients come from one stream of random numbers.
//!
//! # References
//! Perlin (2002), ACM Trans. Graphics 21, 681, doi:10.1145/566654.566636: the quintic blend.

use glam::DVec2;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// RMS slope of the noise along a fixed direction, per unit of its wavelength: measured, see the test.
pub(super) const RMS_SLOPE: f64 = 0.63;

const TABLE: usize = 1024;

/// Smooth noise of wavelength about 1, mean 0, values mostly within ±0.7.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Noise {
    gradients: Vec<DVec2>,
    permutation: Vec<u16>,
    offset: DVec2,
}

/// The random numbers of one purpose.
pub(super) fn stream(seed: u64, stream: u64) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(stream);
    random
}

impl Noise {
    pub fn new(seed: u64, purpose: u64) -> Self {
        let mut random = stream(seed, purpose);
        let gradients =
            (0..TABLE).map(|_| DVec2::from_angle(random.random_range(0.0..std::f64::consts::TAU))).collect();
        let mut permutation: Vec<u16> = (0..TABLE as u16).collect();
        for last in (1..TABLE).rev() {
            permutation.swap(last, random.random_range(0..=last));
        }
        Self { gradients, permutation, offset: DVec2::new(random.random(), random.random()) }
    }

    /// A random place in the unit square.
    pub fn offset(&self) -> DVec2 {
        self.offset
    }

    pub fn value(&self, at: DVec2) -> f64 {
        let at = at + self.offset * TABLE as f64;
        let cell = at.floor();
        let (t, column, row) = (at - cell, cell.x as i64, cell.y as i64);
        let corner = |c: i64, r: i64| self.gradient(column + c, row + r).dot(t - DVec2::new(c as f64, r as f64));
        let blend = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
        let low = corner(0, 0) + blend.x * (corner(1, 0) - corner(0, 0));
        let high = corner(0, 1) + blend.x * (corner(1, 1) - corner(0, 1));
        low + blend.y * (high - low)
    }

    fn gradient(&self, column: i64, row: i64) -> DVec2 {
        let wrap = |index: i64| index.rem_euclid(TABLE as i64) as usize;
        let along = usize::from(self.permutation[wrap(column)]);
        self.gradients[usize::from(self.permutation[wrap(along as i64 + row)])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The constant that scales the fractal's slope, by finite differences over many places.
    #[test]
    fn the_rms_slope_is_the_one_stated() {
        let noise = Noise::new(3, 7);
        let step = 1e-4;
        let places = (0..200_000).map(|k| DVec2::new(f64::from(k) * 0.618_034, f64::from(k) * 0.414_214 / 7.0));
        let square = |at: DVec2| ((noise.value(at + DVec2::X * step) - noise.value(at)) / step).powi(2);
        let rms = (places.map(square).sum::<f64>() / 200_000.0).sqrt();
        assert!((rms - RMS_SLOPE).abs() < 0.02, "{rms}");
    }

    #[test]
    fn noise_has_no_step_at_its_lattice() {
        let noise = Noise::new(1, 1);
        for k in 0..1000 {
            let at = DVec2::new(f64::from(k % 37), f64::from(k) * 0.37) - noise.offset() * TABLE as f64;
            let step = noise.value(at + DVec2::X * 1e-7) - noise.value(at - DVec2::X * 1e-7);
            assert!(step.abs() < 1e-6, "{step}");
        }
    }
}
