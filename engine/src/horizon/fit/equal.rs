//! Every coefficient in equal steps over a pyramid: most codes of the fine page are 0, and deflate packs those.
//!
//! From the coarsest page to the finest, what the coarser pages leave of the coefficients' box means is rounded:
//!
//! ```text
//! r_s = mean over the box of c − Σ coarser pages at the box's centre      r_s ≈ step_s · code
//! step of the finest page = step, of a₀ step/√2; of all coarser pages half of that
//! ```
//!
//! A uniform quantiser with equal steps before an entropy coder is, but for a quarter of a bit a number, the best that
//! there is for a mean square error (reverse water-filling: every coefficient errs by the same `step²/12`, and those that
//! are below it cost nothing); the mean square over azimuths weighs `a₀` by 1 and all others by 1/2. Where ground is smooth
//! the finest codes vanish and the coarser pages' errors remain: three quarters of their numbers are those of the next
//! page, so that half steps cost little there. Other ways of storing them were tried: `docs/experiments/horizon_files.md`.
//!
//! Fields have as many bits as their largest code needs, so that nothing is clipped. Where all of them do not fit into a
//! texel, the page's steps grow by octaves' eighths until they do.
//!
//! # References
//! Gish & Pierce (1968), *Asymptotically efficient quantizing*, doi:10.1109/TIT.1968.1054193. Burt & Adelson (1983), *The
//! Laplacian pyramid as a compact image code*, doi:10.1109/TCOM.1983.1095851.

use std::f32::consts::SQRT_2;

use rayon::prelude::*;

use super::bit_allocation::place;
use super::group::Group;
use super::residual::{Means, Residual, box_means};
use super::texels::{Choice, quantise};
use crate::horizon::pack::{BitField, Encoding, Texels};

/// Step of all coefficients but the mean on the finest page: 0.11°. Skylines err about as those of `fm16`.
const STEP_RAD: f32 = 1.9e-3;
/// Values are moved towards 0 by up to this fraction of a step before they are rounded: fewer bytes at little more error.
const DEAD: f32 = 0.1;
/// Steps of coarser pages, in steps of the finest.
const COARSE_STEP: f32 = 0.5;

/// Texels and fields of the pyramid for coefficients at full resolution.
pub fn pyramid(encoding: Encoding, sums: &Means) -> (Vec<Texels>, Vec<Vec<BitField>>) {
    let reals: usize = sums.iter().map(|group| group.reals).sum();
    let (mut levels, mut all_fields, mut coarser) = (Vec::new(), Vec::new(), Vec::<Group>::new());
    for (index, page) in encoding.pages().into_iter().enumerate().rev() {
        let boxed: Vec<Group>;
        let (means, step_rad) = if index == 0 {
            (sums, STEP_RAD)
        } else {
            boxed = sums.iter().map(|group| box_means(group, page.scale)).collect();
            (boxed.as_slice(), COARSE_STEP * STEP_RAD)
        };
        let residual = Residual { reals, means, coarser: &coarser };
        let ranges: Vec<[f32; 2]> = (0..reals).into_par_iter().map(|real| range(&residual, real)).collect();
        let steps = (0..).map(|eighths: i32| step_rad * (eighths as f32 / 8.0).exp2());
        let fields = steps.into_iter().find_map(|step_rad| fields(&ranges, step_rad, page.words));
        let fields = fields.expect("steps grow until no coefficient needs a code");
        let (level, decoded) = quantise(&residual, &fields, page, Choice::Dead(DEAD), index > 0);
        levels.insert(0, level);
        all_fields.insert(0, fields);
        coarser.extend(decoded);
    }
    (levels, all_fields)
}

/// Least and largest value of a coefficient.
fn range(residual: &Residual, real: usize) -> [f32; 2] {
    let mut line = vec![0.0; residual.means[0].columns];
    let mut range = [f32::MAX, f32::MIN];
    for row in 0..residual.means[0].rows {
        residual.row(row, real, &mut line);
        range = line.iter().fold(range, |[low, high], value| [low.min(*value), high.max(*value)]);
    }
    range
}

/// Fields of as many bits as codes about the middle of the range need, if they fit into a texel.
fn fields(ranges: &[[f32; 2]], step_rad: f32, words: usize) -> Option<Vec<BitField>> {
    let step_of = |real: usize| if real == 0 { step_rad / SQRT_2 } else { step_rad };
    let codes = |real: usize| ranges[real].map(|value| (value / step_of(real)).round());
    let middle = |real: usize| (codes(real).iter().sum::<f32>() / 2.0).ceil();
    // Signed codes of `width` bits go from −2^(width − 1) to 2^(width − 1) − 1.
    let width = |real: usize| {
        let [low, high] = codes(real).map(|code| code - middle(real));
        (0..=16)
            .find(|width| low == high || (-low).max(high + 1.0) <= 2.0_f32.powi(width - 1))
            .map(|width| width as usize)
    };
    let widths = (0..ranges.len()).map(width).collect::<Option<Vec<_>>>()?;
    // A coefficient that is 0 everywhere has no field; one that is another constant needs one for its offset.
    let widths: Vec<_> =
        widths.iter().zip(0..).map(|(w, real)| if middle(real) == 0.0 { *w } else { (*w).max(1) }).collect();
    let places = place(&widths, words, 0)?;
    let field = |(real, &(word, shift)): (usize, &(usize, u32))| {
        let (width, step_rad) = (widths[real] as u32, step_of(real));
        let offset_rad = step_rad * middle(real);
        (width > 0).then_some(BitField { real, word, shift, width, step_rad, offset_rad, bias: 0.0 })
    };
    Some(places.iter().enumerate().filter_map(field).collect())
}

#[cfg(test)]
mod tests {
    use super::super::sums::Sums;
    use super::*;
    use crate::horizon::HorizonMap;
    use crate::horizon::bound::Bounds;
    use crate::horizon::pack::Horizon;
    use crate::horizon::statistics::TileErrors;
    use glam::DVec2;

    /// Coefficients of falling size, one of them constant, one 0.
    fn group(size_rad: f32) -> Group {
        let (columns, rows, reals) = (40, 24, 40);
        let value = |index: usize| {
            let real = index / columns % reals;
            let wave = ((index * 7 % 101) as f32 / 50.0 - 1.0) * size_rad / (1 + real) as f32;
            match real {
                1 => 0.0,
                5 => 0.0123,
                _ => wave,
            }
        };
        let sums = Sums::Memory((0..columns * rows * reals).map(value).collect());
        Group { scale: 1, first: 0, reals, rows, columns, sums }
    }

    #[test]
    fn coefficients_err_by_half_a_step_and_the_dead_zone_at_most() {
        for (size_rad, largest_step_rad) in [(0.3, STEP_RAD), (30.0, 64.0 * STEP_RAD)] {
            let group = group(size_rad);
            let (levels, fields) = pyramid(Encoding::Q, std::slice::from_ref(&group));
            assert!(fields.iter().flatten().all(|field| field.real != 1));
            let step_rad = fields[0].iter().fold(0.0, |step_rad: f32, field| step_rad.max(field.step_rad));
            // Steps are those asked for where they fit, and larger where they do not.
            assert_eq!(step_rad == STEP_RAD, size_rad < 1.0, "{step_rad}");
            assert!(step_rad <= largest_step_rad);
            let (columns, rows) = (group.columns, group.rows);
            let (errors, bounds) = (TileErrors::default(), Bounds::unknown(columns, rows));
            let map = HorizonMap { encoding: Encoding::Q, columns, rows, levels, fields, errors, bounds };
            for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
                let Horizon::Series(series) = map.horizon(DVec2::new(column as f64, row as f64)) else { panic!() };
                for (k, [a, b]) in (1..).zip(&series.harmonics_rad) {
                    for (real, got) in [(2 * k, a), (2 * k + 1, b)] {
                        let expected = f64::from(group.row(row, real)[column]);
                        // Half a step, the dead zone, and rounding of a hundred times as much in f32.
                        assert!((got - expected).abs() <= 0.601 * f64::from(step_rad), "{real} {got} {expected}");
                    }
                }
            }
        }
    }
}
