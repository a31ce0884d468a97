//! Relief without craters: the massif, and the fractal over everything.

use std::f64::consts::PI;

use glam::DVec2;

use super::noise::{self, Noise};

/// Median Hurst exponent of the lunar highlands. Rosenburg et al. (2011).
const HURST: f64 = 0.95;

/// Wavelength above which the surface is no longer self-affine. Rosenburg et al. (2011): about 1 km.
const BREAKOVER_M: f64 = 2000.0;

/// Ratio of neighbouring wavelengths. Not 2, so that the lattices of the octaves never coincide.
const LACUNARITY: f64 = 1.87;

/// A grid holds wavelengths from this many postings on.
const POSTINGS_PER_WAVELENGTH: f64 = 4.0;

/// Posting at which the fractal has the slope asked for.
const REFERENCE_POSTING_M: f64 = 20.0;

/// A massif goes over into other hills beyond this.
const LARGEST_MASSIF_M: f64 = 100_000.0;

/// A bent, notched ridge and hills beside it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Massif {
    bend: Noise,
    notch: Noise,
    hills: Noise,
    towards: DVec2,
    side_m: f64,
    relief_m: f64,
}

impl Massif {
    pub fn new(seed: u64, side_m: f64, relief_m: f64) -> Self {
        let [bend, notch, hills] = [100, 101, 102].map(|stream| Noise::new(seed, stream));
        let angle_rad = PI * bend.offset().x;
        Self {
            bend,
            notch,
            hills,
            towards: DVec2::from_angle(angle_rad),
            side_m: side_m.min(LARGEST_MASSIF_M),
            relief_m,
        }
    }

    pub fn height_m(&self, at_m: DVec2) -> f64 {
        let at = at_m / self.side_m;
        let sum = |noise: &Noise, first: f64, octaves: i32| -> f64 {
            (0..octaves).map(|k| noise.value(at * first * 2f64.powi(k)) * 0.5f64.powi(k)).sum()
        };
        // Distance from a line that wanders by a fifth of the map.
        let across = at.dot(self.towards) + 0.22 * sum(&self.bend, 1.7, 4);
        let crest = 0.75 + 0.6 * sum(&self.notch, 2.3, 4);
        let ridge = crest * (-(across / 0.17).powi(2)).exp();
        self.relief_m * (ridge + 0.45 * sum(&self.hills, 2.6, 5))
    }
}

/// Self-affine noise: octave `k` has the wavelength `BREAKOVER_M / LACUNARITY^k` on any grid that holds it.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Fractal {
    octaves: Vec<Octave>,
}

/// Noise on a lattice that is turned at random, so that no direction stands out.
#[derive(Debug, Clone, PartialEq)]
struct Octave {
    noise: Noise,
    turn: DVec2,
    wavelength_m: f64,
    amplitude_m: f64,
}

impl Fractal {
    /// Goes on from the shortest octave to the shortest that a grid holds, leaving out what is longer than
    /// `longest_m`.
    pub fn continued(mut self, seed: u64, posting_m: f64, longest_m: f64, roughness: f64) -> Self {
        let end_m = self.octaves.last().map_or(f64::INFINITY, |octave| octave.wavelength_m);
        // Squared slopes of the octaves add up.
        let slope = |wavelength_m: f64| noise::RMS_SLOPE * wavelength_m.powf(HURST - 1.0);
        let squared: f64 = wavelengths_m(REFERENCE_POSTING_M).map(|(_, l)| slope(l).powi(2)).sum();
        let scale = roughness / squared.sqrt();
        for (k, wavelength_m) in wavelengths_m(posting_m).filter(|&(_, l)| l < end_m && l <= longest_m) {
            let amplitude_m = scale * wavelength_m.powf(HURST);
            let noise = Noise::new(seed, 200 + k);
            let turn = DVec2::from_angle(2.0 * PI * noise.offset().x);
            self.octaves.push(Octave { noise, turn, wavelength_m, amplitude_m });
        }
        self
    }

    pub fn height_m(&self, at_m: DVec2) -> f64 {
        let height_m =
            |octave: &Octave| octave.amplitude_m * octave.noise.value(octave.turn.rotate(at_m / octave.wavelength_m));
        self.octaves.iter().map(height_m).sum()
    }
}

/// The octaves that a grid holds, longest first.
fn wavelengths_m(posting_m: f64) -> impl Iterator<Item = (u64, f64)> {
    let shortest_m = POSTINGS_PER_WAVELENGTH * posting_m;
    (0..).map(|k| (k as u64, BREAKOVER_M / LACUNARITY.powi(k))).take_while(move |&(_, l)| l >= shortest_m)
}
