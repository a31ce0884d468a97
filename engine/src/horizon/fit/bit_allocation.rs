//! Bits for coefficients: reverse water-filling over a pyramid.
//!
//! From the coarsest page to the finest, what the coarser pages leave of the coefficients' box means is quantised:
//!
//! ```text
//! r_s = mean over the box of c, sharpened − Σ coarser pages at the box's centre      r_s ≈ offset + gain · step · (code + bias)
//! ```
//!
//! Sharpened means are those whose bilinear interpolation has the box's mean. A page has `32 w` bits a texel, two of which
//! are its [`gain`]. The others go one by one (two or three at once where one alone gains nothing) to the coefficient whose
//! mean square error falls most for a bit, as reverse water-filling does for Gaussian ones, but by errors measured on the
//! texels themselves: for each coefficient and each number of bits the step is the best of a few, so that rare large values
//! are clipped if that pays. An error of a coarse page that the next finer one quantises with `b` bits shrinks by `2^−b`
//! there; the coarse one's errors are weighed by what is left of them, which needs the finer pages' bits: the pyramid is
//! filled five times, and fields and gains take turns. How many harmonics have bits is the tile's own choice. Elevations
//! are compressed before ([`crate::horizon::companding`]).
//!
//! The mean square over azimuths weighs `a₀` by 1 and all others by 1/2.
//!
//! Bits are what is missing, not harmonics, but on needles of one node: `docs/experiments/horizon_bit_allocation.md`.
//!
//! # References
//! Cover & Thomas (2006), *Elements of Information Theory*, 10.3.3.

use rayon::prelude::*;

use super::gain;
use super::group::Group;
use super::quantiser::{MAX_WIDTH, Quantiser, quantisers};
use super::residual::{Means, Residual, box_means, sharpened};
use super::texels::{Choice, quantise};
use crate::horizon::pack::bit_fields::gain as factor;
use crate::horizon::pack::encoding::GAIN_BITS;
use crate::horizon::pack::{BitField, Encoding, PageLayout, Texels};

/// Counts changes of what is chosen here: part of a tile's key.
pub const REVISION: u8 = 5;

/// Texels that errors are measured on. Rims and cliffs are one in a hundred, and their residuals ten times the deviation:
/// of fewer texels too few are rims, and the codes of the others end below them.
const MEASURED: usize = 4096;
/// Times that the pyramid is filled.
const ROUNDS: usize = 5;
/// An error is never thought to vanish in finer pages.
const LEAST_WEIGHT: f64 = 1e-3;

/// Texels and fields of the pyramid for coefficients at full resolution.
pub fn pyramid(encoding: Encoding, sums: &Means) -> (Vec<Texels>, Vec<Vec<BitField>>) {
    let pages = encoding.pages();
    let reals = sums.iter().map(|group| group.reals).sum();
    let coarse = |page: &PageLayout| sums.iter().map(|group| sharpened(&box_means(group, page.scale))).collect();
    let coarse: Vec<Vec<Group>> = pages[1..].iter().map(coarse).collect();
    let means = |page: usize| if page == 0 { sums } else { &coarse[page - 1] };
    let mut weights = vec![base_weights(reals); pages.len()];
    let mut gains: Vec<Option<Vec<f32>>> = vec![None; pages.len()];
    let mut outcome = (Vec::new(), Vec::new());
    for round in 0..ROUNDS {
        let mut coarser: Vec<Group> = Vec::new();
        let mut levels = Vec::new();
        let mut fields: Vec<Vec<BitField>> = Vec::new();
        for page in (0..pages.len()).rev() {
            let residual = Residual { reals, means: means(page), coarser: &coarser };
            let values_rad = measured(&residual);
            let known = gains[page].take().unwrap_or_else(|| gain::by_energy(&values_rad, &weights[page]));
            let table = allocate(&values_rad, &known, &weights[page], pages[page].words);
            gains[page] = Some(regained(&table, &weights[page], &values_rad));
            // The finest page is the largest: written once, when the fields are final.
            if page > 0 || round + 1 == ROUNDS {
                let (level, decoded) = quantise(&residual, &table, pages[page], Choice::Gain(&weights[page]), page > 0);
                levels.insert(0, level);
                coarser.extend(decoded);
            }
            fields.insert(0, table);
        }
        weigh(&mut weights, &fields);
        outcome = (levels, fields);
    }
    outcome
}

fn base_weights(reals: usize) -> Vec<f64> {
    // There is no b₀.
    (0..reals).map(|real| [1.0, 0.0].get(real).copied().unwrap_or(0.5)).collect()
}

/// Weighs each page's errors by what the finer ones leave of them, half way from the weights before: with the new ones
/// alone pages would take turns in leaving a coefficient to each other.
fn weigh(weights: &mut [Vec<f64>], fields: &[Vec<BitField>]) {
    let mut weight = base_weights(weights[0].len());
    for (weights, fields) in weights.iter_mut().zip(fields) {
        weights.iter_mut().zip(&weight).for_each(|(before, left)| *before = (*before * left).sqrt());
        for field in fields {
            let left = &mut weight[field.real];
            *left = (*left * 0.25_f64.powi(field.width as i32)).max(LEAST_WEIGHT);
        }
    }
}

/// Residuals of the texels that errors are measured on, `[coefficient][texel]`.
fn measured(residual: &Residual) -> Vec<Vec<f32>> {
    let Group { rows, columns, .. } = residual.means[0];
    // Every so many rows, and in those every so many texels: an odd number, to meet all places in a coarser texel.
    let every = ((rows * columns) as f64 / MEASURED as f64).sqrt().max(1.0) as usize | 1;
    let of = |real: usize| {
        let mut values_rad = Vec::new();
        let mut line = vec![0.0; columns];
        for row in (0..rows).step_by(every) {
            residual.row(row, real, &mut line);
            values_rad.extend(line.iter().copied().step_by(every));
        }
        values_rad
    };
    (0..residual.reals).into_par_iter().map(of).collect()
}

/// The gains that fields ask for in measured texels.
fn regained(fields: &[BitField], weights: &[f64], values_rad: &[Vec<f32>]) -> Vec<f32> {
    let of_fields: Vec<&[f32]> = fields.iter().map(|field| values_rad[field.real].as_slice()).collect();
    gain::best(fields, weights, &of_fields, values_rad[0].len()).into_iter().map(factor).collect()
}

/// The fields of a page of so many words, for residuals and gains of measured texels.
fn allocate(values_rad: &[Vec<f32>], gains: &[f32], weights: &[f64], words: usize) -> Vec<BitField> {
    let choices: Vec<_> = values_rad.par_iter().map(|values_rad| quantisers(values_rad, gains)).collect();
    let worth = |real: usize, width: usize, more: usize| {
        let [before, after] = [width, width + more].map(|width| choices[real][width].error_rad2);
        weights[real] * (before - after) / more as f64
    };
    let mut widths = vec![0; choices.len()];
    let mut left = 32 * words - GAIN_BITS as usize;
    let mut places = Vec::new();
    loop {
        let all = (0..widths.len()).flat_map(|real| (1..=3).map(move |more| (real, more)));
        let fits = |&(real, more): &(usize, usize)| more <= left && widths[real] + more <= MAX_WIDTH;
        let mut wanted: Vec<_> =
            all.filter(fits).map(|(real, more)| (worth(real, widths[real], more), real, more)).collect();
        wanted.retain(|(worth, ..)| *worth > 0.0);
        wanted.sort_by(|a, b| b.0.total_cmp(&a.0));
        let found = wanted.into_iter().find_map(|(_, real, more)| {
            widths[real] += more;
            let placed = place(&widths, words, GAIN_BITS);
            if placed.is_none() {
                widths[real] -= more;
            }
            placed.map(|placed| (placed, more))
        });
        let Some((placed, more)) = found else { break };
        places = placed;
        left -= more;
    }
    let field = |(real, &(word, shift)): (usize, &(usize, u32))| {
        let width = widths[real];
        let Quantiser { step_rad, offset_rad, bias, .. } = choices[real][width];
        (width > 0).then_some(BitField { real, word, shift, width: width as u32, step_rad, offset_rad, bias })
    };
    places.iter().enumerate().filter_map(field).collect()
}

/// Word and lowest bit for fields of such widths, none across a word, if they fit: the widest first, each into the first
/// word with room for it. So many bits of the first word are taken.
pub(super) fn place(widths: &[usize], words: usize, taken: u32) -> Option<Vec<(usize, u32)>> {
    let mut order: Vec<usize> = (0..widths.len()).filter(|real| widths[*real] > 0).collect();
    order.sort_by_key(|real| std::cmp::Reverse(widths[*real]));
    let mut used = vec![0; words];
    used[0] = taken as usize;
    let mut places = vec![(0, 0); widths.len()];
    for real in order {
        let word = (0..words).find(|word| used[*word] + widths[real] <= 32)?;
        places[real] = (word, used[word] as u32);
        used[word] += widths[real];
    }
    Some(places)
}

#[cfg(test)]
mod tests {
    use super::super::residual::corner;
    use super::super::sums::Sums;
    use super::*;
    use crate::horizon::pack::bit_fields::gain_of;

    /// Ground of little relief with a rim of a hundredfold residual at one node in 200: the finest page's codes reach it.
    #[test]
    fn rims_do_not_end_beyond_their_fields() {
        let (columns, rows, reals) = (128, 96, 8);
        let is_rim = |node: usize| (node * 2_654_435_761) % 200 == 7;
        let value = |index: usize| {
            let (column, rest) = (index % columns, index / columns);
            let (real, row) = (rest % reals, rest / reals);
            let noise = ((index * 1_103_515_245) % 65_536) as f32 / 65_536.0 - 0.5;
            let rim = if is_rim(row * columns + column) { 0.1 } else { 0.0 };
            if real == 1 { 0.0 } else { 1e-3 * noise + rim }
        };
        let sums = Sums::Memory((0..columns * rows * reals).map(value).collect());
        let group = Group { scale: 1, first: 0, reals, rows, columns, sums };
        let (levels, fields) = pyramid(Encoding::W21, std::slice::from_ref(&group));
        let pages = Encoding::W21.pages();
        let decoded = |real: usize, column: usize, row: usize| {
            let page = |((level, page), fields): ((&Texels, &PageLayout), &Vec<BitField>)| {
                let Some(field) = fields.iter().find(|field| field.real == real) else { return 0.0 };
                let value = |column: usize, row: usize| {
                    let texel = level.texel(column, row);
                    field.value_rad(field.code(texel), gain_of(texel, GAIN_BITS))
                };
                let (west, east, x) = corner(column, 1, page.scale, level.columns);
                let (south, north, y) = corner(row, 1, page.scale, level.rows);
                let along = |row: usize| value(west, row) + x * (value(east, row) - value(west, row));
                along(south) + y * (along(north) - along(south))
            };
            levels.iter().zip(&pages).zip(&fields).map(page).sum::<f32>()
        };
        let mut worst_rad = 0.0_f32;
        for row in 0..rows {
            for column in 0..columns {
                let expected = value(row * reals * columns + column);
                worst_rad = worst_rad.max((decoded(0, column, row) - expected).abs());
            }
        }
        // Nine bits over ±0.1 rad are steps of 4e-4.
        assert!(worst_rad < 2e-3, "{worst_rad}");
    }
}
