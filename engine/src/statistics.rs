//! Errors against the truth, summed up; quantiles.

/// Quantiles of absolute errors; the mean keeps the sign.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Errors {
    pub count: usize,
    pub mean: f64,
    pub rms: f64,
    pub p50: f64,
    pub p95: f64,
    pub p99: f64,
    pub max: f64,
}

impl Errors {
    /// Of signed errors; zeros where there are none.
    pub fn of(errors: impl IntoIterator<Item = f64>) -> Self {
        let signed: Vec<f64> = errors.into_iter().collect();
        let count = signed.len();
        if count == 0 {
            return Self::default();
        }
        let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / count as f64;
        let mut sizes: Vec<f64> = signed.iter().map(|error| error.abs()).collect();
        let mut quantile = |fraction: f64| quantile_of(&mut sizes, fraction);
        Self {
            count,
            mean: mean(&mut signed.iter().copied()),
            rms: mean(&mut signed.iter().map(|error| error * error)).sqrt(),
            p50: quantile(0.5),
            p95: quantile(0.95),
            p99: quantile(0.99),
            max: quantile(1.0),
        }
    }
}

/// The value below which a fraction of all lies, the one of nearest rank; NaN of nothing.
pub fn quantile(mut values: Vec<f64>, fraction: f64) -> f64 {
    if values.is_empty() { f64::NAN } else { quantile_of(&mut values, fraction) }
}

/// A quantile of at least one value, whose order it changes.
fn quantile_of(values: &mut [f64], fraction: f64) -> f64 {
    let rank = ((values.len() - 1) as f64 * fraction).round() as usize;
    *values.select_nth_unstable_by(rank, f64::total_cmp).1
}

/// The middle value; of an even number the lower one. `None` where there are none.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len().checked_sub(1)? / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0, −1, 2, −3, … 100: mean of the alternating series, RMS of the first hundred numbers.
    #[test]
    fn quantiles_are_of_sizes_and_the_mean_is_signed() {
        let errors = Errors::of((0..=100).map(|i| f64::from(if i % 2 == 0 { i } else { -i })));
        assert_eq!((errors.p50, errors.p95, errors.p99, errors.max), (50.0, 95.0, 99.0, 100.0));
        assert!((errors.mean - 50.0 / 101.0).abs() < 1e-12);
        assert!((errors.rms - (100.0 * 101.0 * 201.0 / 6.0 / 101.0f64).sqrt()).abs() < 1e-12);
        assert_eq!(Errors::of([]), Errors::default());
    }

    #[test]
    fn quantiles_are_values() {
        assert_eq!(quantile(vec![4.0, 1.0, 3.0, 2.0, 5.0], 0.5), 3.0);
        assert!(quantile(vec![], 0.5).is_nan());
    }

    #[test]
    fn the_median_is_a_value_that_was_measured() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![3.0, 1.0]), Some(1.0));
        assert_eq!(median(vec![]), None);
    }
}
