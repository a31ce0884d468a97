//! Values of a page rounded to the codes of its texels.

use rayon::prelude::*;

use super::gain;
use super::group::Group;
use super::residual::Residual;
use super::sums::Sums;
use crate::horizon::pack::bit_fields::{gain as factor, put_gain};
use crate::horizon::pack::{BitField, PageLayout, Texels};

/// What is chosen texel by texel.
#[derive(Debug, Clone, Copy)]
pub enum Choice<'a> {
    /// The gain that loses the least, errors of the coefficients weighed.
    Gain(&'a [f64]),
    /// Nothing; values are moved towards 0 by a fraction of a step at most.
    Dead(f32),
}

/// The texels of a page, and what they decode to if finer pages need it.
pub fn quantise(
    residual: &Residual,
    fields: &[BitField],
    page: PageLayout,
    choice: Choice,
    decode: bool,
) -> (Texels, Option<Group>) {
    let Group { rows, columns, scale, .. } = residual.means[0];
    let reals = residual.reals;
    let quantised = |row: usize| {
        let mut words = vec![0; columns * page.words];
        let mut decoded = vec![0.0; if decode { columns * reals } else { 0 }];
        let mut lines = residual.lines(row, fields.iter().map(|field| field.real));
        let gains: Vec<f32> = match choice {
            Choice::Gain(weights) => {
                let best = gain::best(fields, weights, &lines, columns);
                words.chunks_mut(page.words).zip(&best).for_each(|(texel, code)| put_gain(texel, *code));
                best.into_iter().map(factor).collect()
            }
            Choice::Dead(fraction) => {
                for (field, line) in fields.iter().zip(&mut lines) {
                    let dead_rad = fraction * field.step_rad;
                    line.iter_mut().for_each(|value| *value -= value.clamp(-dead_rad, dead_rad));
                }
                vec![1.0; columns]
            }
        };
        for (field, line) in fields.iter().zip(&mut lines) {
            let [lowest, highest] = field.range();
            for ((texel, value), gain) in words.chunks_mut(page.words).zip(&mut *line).zip(&gains) {
                let code = (*value - field.offset_rad) / (gain * field.step_rad) - field.bias;
                let code = (code.round() as i32).clamp(lowest, highest);
                field.put(texel, code);
                *value = field.value_rad(code, *gain);
            }
            if decode {
                decoded[field.real * columns..][..columns].copy_from_slice(line);
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
