//! Bits for coefficients: reverse water-filling over a pyramid.
//!
//! From the coarsest page to the finest, what the coarser pages leave of the coefficients' box means is quantised:
//!
//! ```text
//! r_s = mean over the box of c, sharpened − Σ coarser pages at the box's centre      r_s ≈ offset + step · code
//! ```
//!
//! Sharpened means are those whose bilinear interpolation has the box's mean. A page has `32 w` bits a texel. They go one
//! by one (two or three at once where one alone gains nothing) to the coefficient whose mean square error falls most for a
//! bit, as reverse water-filling does for Gaussian ones, but by errors measured on the texels themselves: for each
//! coefficient and each number of bits the step is the best of a few, so that rare large values are clipped if that pays.
//! An error of a coarse page that the next finer one quantises with `b` bits shrinks by `2^−b` there; the coarse one's
//! errors are weighed by what is left of them, which needs the finer pages' bits: the pyramid is filled five times. How
//! many harmonics have bits is the tile's own choice.
//!
//! The mean square over azimuths weighs `a₀` by 1 and all others by 1/2.
//!
//! What limits it, in shares of `fm16`'s pixel error rate under Suns at 1.5° to 15° (`sim bench encodings` has the seven
//! scenes), patches of 96² nodes, beside exact series at full resolution (numerical experiment):
//!
//! | scene | 31 harmonics | 47 | 63 | `w21` with up to 31 | with up to 47 |
//! |---|---|---|---|---|---|
//! | cratered | 0.24 | 0.12 | 0.07 | 0.36 | 0.30 |
//! | smooth | 0.28 | 0.15 | 0.09 | 0.31 | 0.21 |
//! | blocks | 0.45 | 0.31 | 0.24 | 0.64 | 0.58 |
//! | needles of one node | 0.79 | 0.69 | 0.60 | 0.90 | 0.84 |
//! | connecting ridge | 0.11 | 0.07 | 0.04 | 0.31 | 0.30 |
//!
//! Bits are what is missing but on needles: they are narrower than the waves. In their penumbras all of these series have
//! 0.98 to 0.99 of `fm16`'s error.
//!
//! # References
//! Cover & Thomas (2006), *Elements of Information Theory*, 10.3.3. Burt & Adelson (1983), *The Laplacian pyramid as a
//! compact image code*, doi:10.1109/TCOM.1983.1095851.

use std::borrow::Cow;

use rayon::prelude::*;

use super::Group;
use super::sums::Sums;
use crate::horizon::pack::{Encoding, Field, Page, Texels};
use crate::horizon::sweep::wide::wide;

/// Counts changes of what is chosen here: part of a tile's key.
pub const REVISION: u8 = 4;

/// Most bits of a field.
const MAX_WIDTH: usize = 9;
/// Texels that errors are measured on. Rims and cliffs are one in a hundred, and their residuals ten times the deviation:
/// of fewer texels too few are rims, and the codes of the others end below them.
const MEASURED: usize = 4096;
/// Steps tried: so many, over so many octaves up from the smallest, which is this share of the deviation over the number of
/// codes.
const STEPS: usize = 18;
const SMALLEST_STEP: f32 = 1.2;
const OCTAVES: f32 = 5.4;
/// Where the mean may lie, in steps from the middle of the codes, an even number: between two of them, or on one. Most
/// residuals of ground with a few rims or needles are about 0, and few bits should be able to say so.
const SHIFTS: [f32; 3] = [0.0, 0.5, -0.5];
/// Times that the pyramid is filled.
const ROUNDS: usize = 5;
/// An error is never thought to vanish in finer pages.
const LEAST_WEIGHT: f64 = 1e-3;

/// How a coefficient is quantised with some number of bits, and the mean square error then.
#[derive(Debug, Clone, Copy)]
struct Choice {
    step_rad: f32,
    offset_rad: f32,
    error_rad2: f64,
}

/// Means of all coefficients at one page's resolution, in groups of as many each.
pub(super) type Means = [Group];

/// One coefficient over a row of texels.
fn row_of(means: &Means, row: usize, real: usize) -> Cow<'_, [f32]> {
    let reals = means[0].reals;
    means[real / reals].row(row, real % reals)
}

/// Texels and fields of the pyramid for coefficients at full resolution.
pub fn pyramid(encoding: Encoding, sums: &Means) -> (Vec<Texels>, Vec<Vec<Field>>) {
    let pages = encoding.pages();
    let reals = sums.iter().map(|group| group.reals).sum();
    let coarse = |page: &Page| sums.iter().map(|group| sharpened(&box_means(group, page.scale))).collect();
    let coarse: Vec<Vec<Group>> = pages[1..].iter().map(coarse).collect();
    let means = |page: usize| if page == 0 { sums } else { &coarse[page - 1] };
    let mut weights = vec![base_weights(reals); pages.len()];
    let mut outcome = (Vec::new(), Vec::new());
    for round in 0..ROUNDS {
        let mut coarser: Vec<Group> = Vec::new();
        let mut levels = Vec::new();
        let mut fields: Vec<Vec<Field>> = Vec::new();
        for page in (0..pages.len()).rev() {
            let residual = Residual { reals, means: means(page), coarser: &coarser };
            let table = allocate(&residual, &weights[page], 32 * pages[page].words, pages[page].words);
            // The finest page is the largest: written once, when the fields are final.
            if page > 0 || round + 1 == ROUNDS {
                let (level, decoded) = quantise(&residual, &table, pages[page], 0.0, page > 0);
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
fn weigh(weights: &mut [Vec<f64>], fields: &[Vec<Field>]) {
    let mut weight = base_weights(weights[0].len());
    for (weights, fields) in weights.iter_mut().zip(fields) {
        weights.iter_mut().zip(&weight).for_each(|(before, left)| *before = (*before * left).sqrt());
        for field in fields {
            let left = &mut weight[field.real];
            *left = (*left * 0.25_f64.powi(field.width as i32)).max(LEAST_WEIGHT);
        }
    }
}

/// Means over boxes of `scale²` texels, as far as they lie in the map.
pub(super) fn box_means(sums: &Group, scale: usize) -> Group {
    let (columns, rows) = (sums.columns.div_ceil(scale), sums.rows.div_ceil(scale));
    let mut means = vec![0.0; columns * rows * sums.reals];
    means.par_chunks_mut(columns * sums.reals).enumerate().for_each(|(row, means)| {
        let rows = row * scale..((row + 1) * scale).min(sums.rows);
        for (real, means) in means.chunks_mut(columns).enumerate() {
            for row in rows.clone() {
                for (mean, boxed) in means.iter_mut().zip(sums.row(row, real).chunks(scale)) {
                    *mean += boxed.iter().sum::<f32>() / (boxed.len() * rows.len()) as f32;
                }
            }
        }
    });
    Group { scale, columns, rows, sums: Sums::Memory(means), ..*sums }
}

/// Means whose interpolation has about the means that were given. The mean of a bilinear interpolation over a texel is
/// `B = [⅛, ¾, ⅛]` of the texels along either axis; `2 − B` undoes it to first order.
fn sharpened(means: &Group) -> Group {
    let Group { columns, rows, reals, .. } = *means;
    let blurred = |[before, here, after]: [f32; 3]| 0.125 * before + 0.75 * here + 0.125 * after;
    let about = |index: usize, count: usize| [index.saturating_sub(1), index, (index + 1).min(count - 1)];
    let mut sharp = vec![0.0; columns * rows * reals];
    sharp.par_chunks_mut(columns * reals).enumerate().for_each(|(row, sharp)| {
        for (real, sharp) in sharp.chunks_mut(columns).enumerate() {
            let lines = about(row, rows).map(|row| means.row(row, real));
            for (column, sharp) in sharp.iter_mut().enumerate() {
                let along = about(column, columns);
                let blurred = blurred(lines.each_ref().map(|line| blurred(along.map(|column| line[column]))));
                *sharp = 2.0 * lines[1][column] - blurred;
            }
        }
    });
    Group { sums: Sums::Memory(sharp), ..*means }
}

/// What the coarser pages leave of a page's means.
#[derive(Debug, Clone, Copy)]
pub(super) struct Residual<'a> {
    pub reals: usize,
    pub means: &'a Means,
    /// What the coarser pages decode to.
    pub coarser: &'a [Group],
}

impl Residual<'_> {
    /// One coefficient over a row of texels.
    pub fn row(&self, row: usize, real: usize, residual: &mut [f32]) {
        residual.copy_from_slice(&row_of(self.means, row, real));
        let scale = self.means[0].scale;
        for page in self.coarser {
            let (low, high, share) = corner(row, scale, page.scale, page.rows);
            let (south, north) = (page.row(low, real), page.row(high, real));
            for (column, residual) in residual.iter_mut().enumerate() {
                let (west, east, x) = corner(column, scale, page.scale, page.columns);
                let south = south[west] + x * (south[east] - south[west]);
                let north = north[west] + x * (north[east] - north[west]);
                *residual -= south + share * (north - south);
            }
        }
    }
}

/// The two texels of a coarser page about the centre of texel `index`, and the share of the second.
fn corner(index: usize, scale: usize, coarse: usize, count: usize) -> (usize, usize, f32) {
    let at = ((index as f32 + 0.5) * scale as f32 / coarse as f32 - 0.5).clamp(0.0, (count - 1) as f32);
    let low = at.floor();
    (low as usize, (low as usize + 1).min(count - 1), at - low)
}

/// The fields of a page of so many bits.
fn allocate(residual: &Residual, weights: &[f64], bits: usize, words: usize) -> Vec<Field> {
    let choices = choices(residual);
    let gain = |real: usize, width: usize, more: usize| {
        let [before, after] = [width, width + more].map(|width| choices[real][width].error_rad2);
        weights[real] * (before - after) / more as f64
    };
    let mut widths = vec![0; choices.len()];
    let mut left = bits;
    let mut places = Vec::new();
    loop {
        let all = (0..widths.len()).flat_map(|real| (1..=3).map(move |more| (real, more)));
        let fits = |&(real, more): &(usize, usize)| more <= left && widths[real] + more <= MAX_WIDTH;
        let mut wanted: Vec<_> =
            all.filter(fits).map(|(real, more)| (gain(real, widths[real], more), real, more)).collect();
        wanted.retain(|(gain, ..)| *gain > 0.0);
        wanted.sort_by(|a, b| b.0.total_cmp(&a.0));
        let found = wanted.into_iter().find_map(|(_, real, more)| {
            widths[real] += more;
            let placed = place(&widths, words);
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
        let Choice { step_rad, offset_rad, .. } = choices[real][width];
        (width > 0).then_some(Field { real, word, shift, width: width as u32, step_rad, offset_rad })
    };
    places.iter().enumerate().filter_map(field).collect()
}

/// Word and lowest bit for fields of such widths, none across a word, if they fit: the widest first, each into the first
/// word with room for it.
pub(super) fn place(widths: &[usize], words: usize) -> Option<Vec<(usize, u32)>> {
    let mut order: Vec<usize> = (0..widths.len()).filter(|real| widths[*real] > 0).collect();
    order.sort_by_key(|real| std::cmp::Reverse(widths[*real]));
    let mut used = vec![0; words];
    let mut places = vec![(0, 0); widths.len()];
    for real in order {
        let word = (0..words).find(|word| used[*word] + widths[real] <= 32)?;
        places[real] = (word, used[word] as u32);
        used[word] += widths[real];
    }
    Some(places)
}

/// For each coefficient the best quantiser of each width from 0 on.
fn choices(residual: &Residual) -> Vec<[Choice; MAX_WIDTH + 1]> {
    let Group { rows, columns, .. } = residual.means[0];
    // Every so many rows, and in those every so many texels: an odd number, to meet all places in a coarser texel.
    let every = ((rows * columns) as f64 / MEASURED as f64).sqrt().max(1.0) as usize | 1;
    let chosen = |real: usize| {
        let mut values = Vec::new();
        let mut line = vec![0.0; columns];
        for row in (0..rows).step_by(every) {
            residual.row(row, real, &mut line);
            values.extend(line.iter().copied().step_by(every));
        }
        quantisers(&values)
    };
    (0..residual.reals).into_par_iter().map(chosen).collect()
}

fn quantisers(values_rad: &[f32]) -> [Choice; MAX_WIDTH + 1] {
    let count = values_rad.len() as f64;
    let mean_rad = (values_rad.iter().map(|value| f64::from(*value)).sum::<f64>() / count) as f32;
    let square = |value: f32| f64::from(value) * f64::from(value);
    let variance = values_rad.iter().map(|value| square(value - mean_rad)).sum::<f64>() / count;
    let nothing = Choice { step_rad: 0.0, offset_rad: 0.0, error_rad2: variance + square(mean_rad) };
    let constant = Choice { step_rad: 1.0, offset_rad: mean_rad, error_rad2: 0.0 };
    let smallest_rad = SMALLEST_STEP * variance.sqrt() as f32;
    std::array::from_fn(|width| {
        if width == 0 {
            return nothing;
        }
        if variance == 0.0 {
            return constant;
        }
        let codes = (1 << width) as f32;
        let trial = |step: usize, shift: f32| {
            let step_rad = smallest_rad * (OCTAVES * step as f32 / STEPS as f32).exp2() / codes;
            let middle_rad = mean_rad + shift * step_rad;
            let offset_rad = middle_rad + 0.5 * step_rad;
            let (per_rad, half) = (1.0 / step_rad, 0.5 * codes);
            let quantiser = [middle_rad, per_rad, half, codes - 1.0, offset_rad, step_rad];
            let error_rad2 = wide(
                #[inline(always)]
                || square_error(values_rad, quantiser),
            );
            Choice { step_rad, offset_rad, error_rad2: error_rad2 / count }
        };
        let all = (0..STEPS).flat_map(|step| SHIFTS.map(|shift| trial(step, shift)));
        let best = all.min_by(|a, b| a.error_rad2.total_cmp(&b.error_rad2));
        best.expect("steps are tried")
    })
}

/// Sum of the squares of what a quantiser leaves, in so many sums side by side.
#[inline(always)]
fn square_error(values_rad: &[f32], [middle_rad, per_rad, half, last, offset_rad, step_rad]: [f32; 6]) -> f64 {
    const LANES: usize = 16;
    const NO_FRACTION: f32 = 8_388_608.0;
    let error = |value: f32| {
        // Rounded by adding what leaves no bits for a fraction, counted from the lowest code: vectors have no cheaper `floor`.
        let above = ((value - middle_rad) * per_rad + (half - 0.5)).max(0.0).min(last) + NO_FRACTION - NO_FRACTION;
        let error = offset_rad + step_rad * (above - half) - value;
        error * error
    };
    let mut sums = [0.0_f32; LANES];
    let (whole, rest) = values_rad.as_chunks::<LANES>();
    for values in whole {
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += error(*value);
        }
    }
    sums.into_iter().chain(rest.iter().map(|value| error(*value))).map(f64::from).sum()
}

/// The texels of a page, and what they decode to if finer pages need it. Values are moved towards 0 by a share of a step at most.
pub(super) fn quantise(
    residual: &Residual,
    fields: &[Field],
    page: Page,
    dead: f32,
    decode: bool,
) -> (Texels, Option<Group>) {
    let Group { rows, columns, scale, .. } = residual.means[0];
    let reals = residual.reals;
    let quantised = |row: usize| {
        let mut words = vec![0; columns * page.words];
        let mut decoded = vec![0.0; if decode { columns * reals } else { 0 }];
        let mut line = vec![0.0; columns];
        for field in fields {
            residual.row(row, field.real, &mut line);
            let [lowest, highest] = field.range();
            for (texel, value) in words.chunks_mut(page.words).zip(&mut line) {
                let dead_rad = dead * field.step_rad;
                *value -= value.clamp(-dead_rad, dead_rad);
                let code = (((*value - field.offset_rad) / field.step_rad).round() as i32).clamp(lowest, highest);
                field.put(texel, code);
                *value = field.value_rad(code);
            }
            if decode {
                decoded[field.real * columns..][..columns].copy_from_slice(&line);
            }
        }
        (words, decoded)
    };
    let lines: Vec<_> = (0..rows).into_par_iter().map(quantised).collect();
    let (words, decoded): (Vec<_>, Vec<_>) = lines.into_iter().unzip();
    let level = Texels { columns, rows, words_per_texel: page.words, words: words.concat() };
    let means = decode.then(|| Group { scale, first: 0, reals, rows, columns, sums: Sums::Memory(decoded.concat()) });
    (level, means)
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let page = |((level, page), fields): ((&Texels, &Page), &Vec<Field>)| {
                let Some(field) = fields.iter().find(|field| field.real == real) else { return 0.0 };
                let value = |column: usize, row: usize| field.value_rad(field.code(level.texel(column, row)));
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
