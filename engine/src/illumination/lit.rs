//! What counts as lit, and how much of the disc is seen.

use crate::photometry::SolarDisk;

/// When a place counts as lit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lit {
    /// Any part of the disc is seen.
    AnyLimb,
    /// The disc's centre is seen.
    Centre,
    /// At least this share of the disc's light is seen.
    Share(f64),
}

impl Lit {
    /// How many solar radii the disc's centre must stand above the skyline, when so much of the Sun's light is left by
    /// the Earth; infinite where no height is enough. The centre counts as hidden by the Earth with half of the light.
    pub fn threshold(self, disk: &SolarDisk, sunlight: f64) -> f64 {
        match self {
            _ if sunlight <= 0.0 => f64::INFINITY,
            Self::Centre if sunlight < 0.5 => f64::INFINITY,
            Self::Share(share) if share > sunlight => f64::INFINITY,
            Self::AnyLimb => -1.0,
            Self::Centre => 0.0,
            Self::Share(share) => {
                let share = share / sunlight;
                let (mut low, mut high) = (-1.0, 1.0);
                for _ in 0..50 {
                    let middle = 0.5 * (low + high);
                    if disk.visible_above(-middle) < share { low = middle } else { high = middle }
                }
                high
            }
        }
    }
}

/// Odd powers of the polynomial.
const TERMS: usize = 8;

/// The share of the disc seen above a level line, as a polynomial that many nodes share in registers.
///
/// `V − ½` is odd in the height of the disc's centre above the line: a Chebyshev sum of eight odd terms is within
/// 1.3e-3 of it for a uniform disc and within 6e-4 for a limb-darkened one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiscShare {
    powers: [f32; TERMS],
}

impl DiscShare {
    pub fn new(disk: &SolarDisk) -> Self {
        const NODES: usize = 512;
        let mut powers = [0.0; TERMS];
        for order in (0..TERMS).map(|term| 2 * term + 1) {
            let node = |i: usize| (i as f64 + 0.5) * std::f64::consts::PI / NODES as f64;
            let sample = |i: usize| (disk.visible_above(-node(i).cos()) - 0.5) * (order as f64 * node(i)).cos();
            let coefficient = 2.0 / NODES as f64 * (0..NODES).map(sample).sum::<f64>();
            for (power, of_order) in powers.iter_mut().zip(chebyshev(order)) {
                *power += coefficient * of_order;
            }
        }
        Self { powers: powers.map(|power| power as f32) }
    }

    /// The share for a centre `above` solar radii above the line.
    #[inline(always)]
    pub fn at(&self, above: f32) -> f32 {
        let x = above.clamp(-1.0, 1.0);
        let square = x * x;
        let mut sum = self.powers[TERMS - 1];
        for power in self.powers[..TERMS - 1].iter().rev() {
            sum = sum * square + power;
        }
        (0.5 + x * sum).clamp(0.0, 1.0)
    }
}

/// Coefficients of `x, x³, x⁵, …` in the Chebyshev polynomial of an odd order.
fn chebyshev(order: usize) -> [f64; TERMS] {
    let (mut last, mut this) = (vec![1.0], vec![0.0, 1.0]);
    for _ in 1..order {
        let mut next = vec![0.0; this.len() + 1];
        this.iter().enumerate().for_each(|(i, c)| next[i + 1] += 2.0 * c);
        last.iter().enumerate().for_each(|(i, c)| next[i] -= c);
        (last, this) = (this, next);
    }
    std::array::from_fn(|term| this.get(2 * term + 1).copied().unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photometry::LimbDarkening;

    #[test]
    fn the_polynomial_is_the_share_of_the_disc() {
        for (law, allowed) in [(LimbDarkening::Uniform, 1.3e-3), (LimbDarkening::Power { alpha: 0.5 }, 6e-4)] {
            let disk = SolarDisk::new(law).unwrap();
            let share = DiscShare::new(&disk);
            let error = |i: i32| {
                let above = f64::from(i) / 500.0;
                (f64::from(share.at(above as f32)) - disk.visible_above(-above)).abs()
            };
            let worst = (-1000..=1000).map(error).fold(0.0, f64::max);
            assert!(worst < allowed, "{law:?}: {worst}");
        }
    }

    #[test]
    fn a_share_of_one_half_is_the_centre() {
        let disk = SolarDisk::new(LimbDarkening::Power { alpha: 0.5 }).unwrap();
        assert!(Lit::Share(0.5).threshold(&disk, 1.0).abs() < 1e-9);
        assert!(Lit::Share(0.01).threshold(&disk, 1.0) > Lit::AnyLimb.threshold(&disk, 1.0));
        // Half of the light left: half of it is all that is left, and of none nothing is lit.
        assert!((Lit::Share(0.5).threshold(&disk, 0.5) - 1.0).abs() < 1e-3);
        assert_eq!(Lit::Share(0.6).threshold(&disk, 0.5), f64::INFINITY);
        assert_eq!(Lit::AnyLimb.threshold(&disk, 0.0), f64::INFINITY);
        // Half a radius above the line the uniform disc shows 1 − (acos ½ − ½ √¾)/π of itself.
        let uniform = SolarDisk::new(LimbDarkening::Uniform).unwrap();
        let share = 1.0 - (0.5_f64.acos() - 0.5 * 0.75_f64.sqrt()) / std::f64::consts::PI;
        assert!((Lit::Share(share).threshold(&uniform, 1.0) - 0.5).abs() < 1e-6);
    }
}
