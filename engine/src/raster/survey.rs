//! What a raster's numbers are like: all of them are looked at while they are read, none is taken on trust.
//!
//! * Numbers that the body cannot have are errors, with the most frequent one, how often it comes, and where first.
//! * The least, the greatest and the number 0 are suspicious where they come in blocks and their edges are cliffs: a fill value
//!   that nobody declared.
//! * Numbers that are all whole multiples of a step (integers, radii as `f32`) make stairs: facets tilt by up to
//!   `atan(step/posting)`.

use std::path::Path;

use super::error::{Error, short};
use super::reading::{Content, Numbers, Values};

/// What is known of an elevation model or a map once it is read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Survey {
    /// What the numbers are; never `Auto`.
    pub values: Values,
    /// Pixels that were looked at, and those of them that hold a value.
    pub pixels: u64,
    pub known: u64,
    /// Least and greatest, in metres or shares.
    pub extremes: [f64; 2],
    /// What all numbers are multiples of, in metres; `None`: nothing that can be told.
    pub step_m: Option<f64>,
    /// By how much steps tilt facets at the posting that is used.
    pub step_slope_rad: f64,
    /// What a user should know, a line each.
    pub findings: Vec<String>,
}

/// Numbers of one kind, as they are met.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Suspect {
    stored: f64,
    count: u64,
    first: [usize; 2],
    /// Neighbours that have the same number, and the sum of differences to those that have another.
    same: u64,
    cliffs: u64,
    cliff_sum: f64,
}

/// A number that the body cannot have.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Wrong {
    stored: f64,
    count: u64,
    first: [usize; 2],
}

/// Grows part by part.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    pixels: u64,
    known: u64,
    least: Suspect,
    greatest: Suspect,
    zero: Suspect,
    wrong: Vec<Wrong>,
    all_wrong: u64,
    differences: u64,
    difference_sum: f64,
    /// Exponent of the lowest binary digit of all numbers.
    lowest_digit: i32,
    tenths: bool,
}

/// Wrong numbers that are told apart.
const KINDS: usize = 16;
/// A fill value's edges are so much steeper than other ground.
const CLIFF: f64 = 25.0;
/// Fewer stairs than these are terraces.
const STAIRS: f64 = 8.0;
/// Facets that tilt by more: the Sun's disc is as wide.
const STEEP_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;
/// Steps below a thousandth of a unit are none.
const FINEST: i32 = -10;

impl Default for Tally {
    fn default() -> Self {
        let at = |stored| Suspect { stored, ..Suspect::default() };
        Self {
            pixels: 0,
            known: 0,
            least: at(f64::INFINITY),
            greatest: at(f64::NEG_INFINITY),
            zero: at(0.0),
            wrong: Vec::new(),
            all_wrong: 0,
            differences: 0,
            difference_sum: 0.0,
            lowest_digit: i32::MAX,
            tenths: true,
        }
    }
}

impl Tally {
    /// Looks at stored numbers, rows of `columns` of them, NaN where there are none; the first stands at `[column, row]` of the
    /// file.
    pub fn look(&mut self, numbers: &Numbers, stored: &[f64], columns: usize, [column, row]: [usize; 2]) {
        let place = |index: usize| [column + index % columns, row + index / columns];
        let (mut low, mut high, mut has_zero) = (f64::INFINITY, f64::NEG_INFINITY, false);
        for (index, &value) in stored.iter().enumerate() {
            if value.is_nan() {
                continue;
            }
            self.known += 1;
            (low, high) = (low.min(value), high.max(value));
            has_zero |= value == 0.0;
            if !numbers.holds(value) {
                self.count_wrong(value, place(index));
            }
            if self.lowest_digit > FINEST || self.tenths {
                self.look_for_steps(value);
            }
        }
        self.pixels += stored.len() as u64;
        let mut suspects = Vec::new();
        let (lower, higher) = (low < self.least.stored, high > self.greatest.stored);
        for (suspect, met, further) in
            [(&mut self.least, low, lower), (&mut self.greatest, high, higher), (&mut self.zero, 0.0, false)]
        {
            if further {
                *suspect = Suspect { stored: met, ..Suspect::default() };
            }
            if met == suspect.stored && (met != 0.0 || has_zero) {
                suspects.push(suspect);
            }
        }
        for suspect in &mut suspects {
            let mut count = stored.iter().enumerate().filter(|(_, value)| **value == suspect.stored);
            if let Some((first, _)) = count.next() {
                if suspect.count == 0 {
                    suspect.first = place(first);
                }
                suspect.count += 1 + count.count() as u64;
            }
        }
        let (differences, sum) = edges(stored, columns, &mut suspects);
        self.differences += differences;
        self.difference_sum += sum;
    }

    /// Looks at pixels that hold nothing.
    pub fn look_at_nothing(&mut self, pixels: usize) {
        self.pixels += pixels as u64;
    }

    fn count_wrong(&mut self, stored: f64, first: [usize; 2]) {
        self.all_wrong += 1;
        if let Some(wrong) = self.wrong.iter_mut().find(|wrong| wrong.stored == stored) {
            wrong.count += 1;
        } else if self.wrong.len() < KINDS {
            self.wrong.push(Wrong { stored, count: 1, first });
        }
    }

    fn look_for_steps(&mut self, value: f64) {
        if value == 0.0 {
            return;
        }
        let bits = value.to_bits();
        let exponent = ((bits >> 52) & 0x7ff) as i32 - 1075;
        let zeros = ((bits & ((1 << 52) - 1)) | (1 << 52)).trailing_zeros() as i32;
        self.lowest_digit = self.lowest_digit.min(exponent + zeros);
        // Half of a last place of `f32`.
        let tolerance = (value.abs() * 10.0 * 6e-8).max(1e-9);
        self.tenths &= tolerance < 0.02 && (10.0 * value - (10.0 * value).round()).abs() <= tolerance;
    }

    /// The error that wrong numbers are, the most frequent first.
    pub fn check(
        &self,
        path: &Path,
        body: &str,
        numbers: &Numbers,
        content: Content,
        counts: bool,
    ) -> Result<(), Error> {
        let Some(worst) = self.wrong.iter().max_by_key(|wrong| wrong.count) else { return Ok(()) };
        let allowed = numbers.plausible.map(|stored| numbers.value(stored));
        let [low, high] = [allowed[0].min(allowed[1]), allowed[0].max(allowed[1])];
        let Wrong { stored, count, first: [column, row] } = *worst;
        let (path, wrong, pixels) = (path.into(), self.all_wrong, self.pixels);
        if content == Content::Albedo {
            let hint = albedo_hint(stored, counts, self.greatest.stored);
            return Err(Error::NoAlbedo { path, stored, count, column, row, wrong, pixels, hint });
        }
        let value_m = numbers.value(stored);
        let [column, row] = [column, row].map(|place| place as u32);
        Err(Error::Implausible {
            path,
            body: body.into(),
            stored,
            value_m,
            count,
            column,
            row,
            wrong,
            pixels,
            low_m: low,
            high_m: high,
        })
    }

    /// What was found, of pixels that become nodes `posting_m` apart, `n × n` of them one.
    pub fn survey(&self, numbers: &Numbers, extremes: [f64; 2], content: Content, posting_m: f64, n: usize) -> Survey {
        let values = numbers.values;
        let mut survey = Survey { values, pixels: self.pixels, known: self.known, extremes, ..Survey::default() };
        survey.findings.extend([&self.least, &self.greatest, &self.zero].iter().enumerate().filter_map(
            |(index, suspect)| {
                let again = index == 2 && [&self.least, &self.greatest].iter().any(|other| other.stored == 0.0);
                if again { None } else { self.suspicion(suspect, numbers, content, posting_m / n as f64) }
            },
        ));
        if content == Content::Elevation {
            survey.step_m = self.step(numbers);
            let step_m = survey.step_m.unwrap_or(0.0);
            // A mean of n × n pixels has steps that are n times finer.
            survey.step_slope_rad = (step_m / (n as f64 * posting_m)).atan();
            if survey.step_slope_rad > STEEP_RAD {
                survey.findings.push(format!(
                    "values come in steps of {step_m} m, which tilts facets {posting_m:.3} m apart by up to {:.1} deg; a coarser posting_m is \
                     smoother",
                    survey.step_slope_rad.to_degrees()
                ));
            }
        }
        survey
    }

    fn step(&self, numbers: &Numbers) -> Option<f64> {
        let binary = if self.lowest_digit > FINEST && self.lowest_digit < i32::MAX {
            2_f64.powi(self.lowest_digit)
        } else {
            0.0
        };
        let step = if self.tenths { binary.max(0.1) } else { binary };
        let stairs = (self.greatest.stored - self.least.stored) / step;
        (step > 0.0 && stairs >= STAIRS).then_some(step * numbers.scale.abs())
    }

    /// A number that comes in blocks with cliffs around.
    fn suspicion(&self, suspect: &Suspect, numbers: &Numbers, content: Content, pixel_m: f64) -> Option<String> {
        let Suspect { stored, count, first: [column, row], same, cliffs, cliff_sum } = *suspect;
        let usual = (self.difference_sum - cliff_sum) / (self.differences - cliffs).max(1) as f64;
        let cliff = cliff_sum / cliffs.max(1) as f64;
        // Ground of more than 45° on average is no ground.
        let is_wall = content == Content::Albedo || cliff * numbers.scale.abs() > pixel_m;
        if count < 2 || same == 0 || usual <= 0.0 || cliff < CLIFF * usual || !is_wall {
            return None;
        }
        let (what, unit) = match content {
            Content::Elevation => ("cliffs", " m"),
            Content::Albedo => ("edges", ""),
        };
        let number = short(stored);
        let size = |difference: f64| difference * numbers.scale.abs();
        Some(format!(
            "the number {number} comes {count} times, first at column {column}, row {row}, with {what} of {:.4}{unit} around it where \
             neighbours elsewhere differ by {:.4}{unit}: if it marks missing data write nodata: {number}",
            size(cliff),
            size(usual)
        ))
    }
}

/// Differences to the neighbours to the right and below: how many and their sum; those at a suspect's edges go to it as well.
fn edges(stored: &[f64], columns: usize, suspects: &mut [&mut Suspect]) -> (u64, f64) {
    let (mut differences, mut sum) = (0_u64, 0.0);
    let mut pair = |a: f64, b: f64| {
        let difference = (a - b).abs();
        if difference.is_nan() {
            return;
        }
        differences += 1;
        sum += difference;
        for suspect in suspects.iter_mut() {
            match (a == suspect.stored, b == suspect.stored) {
                (true, true) => suspect.same += 1,
                (false, false) => {}
                _ => {
                    suspect.cliffs += 1;
                    suspect.cliff_sum += difference;
                }
            }
        }
    };
    for (index, row) in stored.chunks(columns).enumerate() {
        row.windows(2).for_each(|values| pair(values[0], values[1]));
        if let Some(below) = stored.get((index + 1) * columns..(index + 2) * columns) {
            row.iter().zip(below).for_each(|(a, b)| pair(*a, *b));
        }
    }
    (differences, sum)
}

/// What makes shares of numbers that are none.
fn albedo_hint(stored: f64, counts: bool, greatest: f64) -> String {
    let number = short(stored);
    match (stored, counts, greatest) {
        (stored, _, _) if stored < 0.0 => format!("if it marks missing data write nodata: {number}"),
        (_, true, greatest) if greatest <= 255.0 => "if these are counts of 255 write scale: 0.00392".into(),
        (_, true, greatest) if greatest <= 65_535.0 => "if these are counts of 65535 write scale: 1.526e-5".into(),
        (_, false, greatest) if greatest <= 100.0 => "if these are percent write unit: \"%\"".into(),
        _ => format!("write scale, or nodata: {number} if it marks missing data"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const METRES: Numbers = Numbers { values: Values::Height, scale: 1.0, offset: 0.0, plausible: [-9700.0, 11_300.0] };

    fn tally(values: impl Fn(f64, f64) -> f64) -> Tally {
        let stored: Vec<f64> = (0..64 * 64).map(|index| values((index % 64) as f64, (index / 64) as f64)).collect();
        let mut tally = Tally::default();
        // In two parts, as files are read.
        tally.look(&METRES, &stored[..32 * 64], 64, [0, 0]);
        tally.look(&METRES, &stored[32 * 64..], 64, [0, 32]);
        tally
    }

    fn hills(x: f64, y: f64) -> f64 {
        100.0 * (0.1 * x).sin() + 60.0 * (0.13 * y).cos() + 0.37 * x
    }

    fn findings(tally: &Tally, posting_m: f64) -> Vec<String> {
        tally.survey(&METRES, [0.0; 2], Content::Elevation, posting_m, 1).findings
    }

    #[test]
    fn hills_are_not_suspicious_and_fill_values_are() {
        assert_eq!(findings(&tally(hills), 30.0), Vec::<String>::new());
        for fill in [-9000.0, 0.0, 9000.0] {
            let block =
                |x: f64, y: f64| if (20.0..26.0).contains(&x) && y > 40.0 { fill } else { hills(x, y) + 2000.0 };
            let found = findings(&tally(block), 30.0);
            assert!(found.len() == 1 && found[0].contains(&format!("nodata: {fill}")), "{found:?}");
            assert!(found[0].contains("comes 138 times, first at column 20, row 41"), "{found:?}");
            let rows = |x: f64, y: f64| if y > 60.0 { fill } else { hills(x, y) + 2000.0 };
            assert_eq!(findings(&tally(rows), 30.0).len(), 1);
        }
    }

    #[test]
    fn impossible_numbers_are_refused_with_the_most_frequent() {
        let tally = tally(|x, y| match (x, y) {
            (3.0, 1.0) => 1e20,
            (x, _) if x < 2.0 => -32_768.0,
            _ => hills(x, y),
        });
        let error = tally.check(Path::new("a.tif"), "Moon", &METRES, Content::Elevation, false).unwrap_err();
        let Error::Implausible { stored, count, wrong, column, row, .. } = error else { panic!("{error}") };
        assert_eq!((stored, count, wrong, column, row), (-32_768.0, 128, 129, 0, 0));
    }

    /// A slope of 5° has differences of one size, which are no steps.
    #[test]
    fn stairs_are_told_and_slopes_are_not() {
        let slope = |x: f64, _: f64| 100.0 + 5_f64.to_radians().tan() * x;
        assert!(findings(&tally(slope), 1.0).is_empty());
        assert!(findings(&tally(|x, y| f64::from(slope(x, y) as f32)), 1.0).is_empty());
        let stairs = |size: f64| tally(move |x, y| (hills(x, y) / size).round() * size);
        for size in [0.125, 0.5, 1.0] {
            assert_eq!(stairs(size).step(&METRES), Some(size));
        }
        assert_eq!(tally(|x, y| f64::from(((hills(x, y) * 10.0).round() / 10.0) as f32)).step(&METRES), Some(0.1));
        assert!(
            findings(&stairs(0.125), 1.0)[0]
                .contains("steps of 0.125 m, which tilts facets 1.000 m apart by up to 7.1 deg")
        );
        assert!(findings(&stairs(0.125), 30.0).is_empty());
    }
}
