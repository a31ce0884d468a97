//! How far each node's decoded skyline may be off, in one byte.
//!
//! A renderer may trust a shadow where the light stands further from the decoded skyline than the node's bound `B`
//! ([`super::calibration`] finds it). It is stored rounded up:
//!
//! ```text
//! B = 2^(c/16 − 15) rad      c = 0 … 254: 0.0017° to 105° in steps of 4.4 %      c = 255: nothing is known
//! ```
//!
//! # Assumptions
//! Between nodes the skyline is interpolated: [`Bounds::bound_rad`] gives the largest bound of the four nodes around, which
//! covers the interpolation of their errors and not what the terrain does between them. Nodes in gaps have no bound.

use glam::DVec2;

/// Codes of one doubling, and the binary logarithm of the bound of code 0, in radians.
const CODES_PER_OCTAVE: f64 = 16.0;
const LEAST_EXPONENT: f64 = -15.0;
/// The code of a node without a bound.
pub const UNKNOWN: u8 = u8::MAX;
/// The code of the smallest stored bound that is not below a given one.
pub fn encode(bound_rad: f64) -> u8 {
    let code = (CODES_PER_OCTAVE * (bound_rad.log2() - LEAST_EXPONENT)).ceil();
    // A NaN is nothing known, not a bound of zero.
    if code < f64::from(UNKNOWN) { code.max(0.0) as u8 } else { UNKNOWN }
}

/// The bound that a code stands for.
pub fn decode_rad(code: u8) -> Option<f64> {
    (code != UNKNOWN).then(|| (f64::from(code) / CODES_PER_OCTAVE + LEAST_EXPONENT).exp2())
}

/// The bound of code 0.
pub fn least_rad() -> f64 {
    LEAST_EXPONENT.exp2()
}

/// The codes of all nodes of a map, rows up the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    pub columns: usize,
    pub codes: Vec<u8>,
}

impl Bounds {
    /// A map of which nothing is known.
    pub fn unknown(columns: usize, rows: usize) -> Self {
        Self { columns, codes: vec![UNKNOWN; columns * rows] }
    }

    /// The largest bound of the nodes around a grid point; `None` where one of them has none.
    pub fn bound_rad(&self, grid: DVec2) -> Option<f64> {
        let last = DVec2::new((self.columns - 1) as f64, (self.codes.len() / self.columns - 1) as f64);
        let at = grid.clamp(DVec2::ZERO, last);
        let corner = |at: DVec2| self.codes[at.y as usize * self.columns + at.x as usize];
        let (low, high) = (at.floor(), at.ceil());
        let corners = [low, DVec2::new(high.x, low.y), DVec2::new(low.x, high.y), high];
        decode_rad(corners.into_iter().map(corner).fold(0, u8::max))
    }

    /// Nodes of which a traced error lies beyond their bound, and how many errors do. Errors are `[node][azimuth]`, nodes
    /// (column, row).
    pub fn exceeded(&self, nodes: &[[usize; 2]], errors_rad: &[Vec<f64>]) -> [usize; 2] {
        let beyond = |([column, row], errors_rad): (&[usize; 2], &Vec<f64>)| {
            let bound_rad = decode_rad(self.codes[row * self.columns + column]);
            errors_rad.iter().filter(|error_rad| bound_rad.is_some_and(|bound_rad| error_rad.abs() > bound_rad)).count()
        };
        let counts: Vec<usize> = nodes.iter().zip(errors_rad).map(beyond).collect();
        [counts.iter().filter(|count| **count > 0).count(), counts.iter().sum()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stored_bound_is_never_below_its_own_nor_far_above() {
        for i in 0..10_000 {
            let bound_rad = least_rad() * (1.0 + f64::from(i) * 3.0).min(5e4);
            let stored_rad = decode_rad(encode(bound_rad)).unwrap();
            // One code is 2^(1/16); the rest is rounding.
            assert!(
                stored_rad >= bound_rad * (1.0 - 1e-12) && stored_rad <= bound_rad * 1.0443,
                "{bound_rad} {stored_rad}"
            );
        }
        assert_eq!((encode(0.0), encode(1e-9)), (0, 0));
        assert_eq!((encode(f64::INFINITY), encode(f64::NAN), encode(3.0)), (UNKNOWN, UNKNOWN, UNKNOWN));
    }

    #[test]
    fn a_place_between_nodes_has_the_largest_bound_around_it() {
        let bounds = Bounds { columns: 3, codes: vec![0, 16, 32, 48, 64, UNKNOWN] };
        let at = |x: f64, y: f64| bounds.bound_rad(DVec2::new(x, y)).map(f64::log2);
        assert_eq!((at(0.0, 0.0), at(0.5, 0.0), at(0.3, 0.2)), (Some(-15.0), Some(-14.0), Some(-11.0)));
        assert_eq!((at(1.5, 0.5), at(-4.0, 9.0)), (None, Some(-12.0)));
    }
}
