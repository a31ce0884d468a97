//! Quantiles of a plane, for records.

use serde::{Deserialize, Serialize};

/// Of the pixels that have a value. Absent where none has.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Statistics {
    pub count: usize,
    pub minimum: Option<f32>,
    pub median: Option<f32>,
    pub quantile_995: Option<f32>,
    pub maximum: Option<f32>,
}

impl Statistics {
    pub fn of(values: &[f32]) -> Self {
        let mut finite: Vec<f32> = values.iter().copied().filter(|value| value.is_finite()).collect();
        if finite.is_empty() {
            return Self::default();
        }
        let last = finite.len() - 1;
        let rank = |share: f64| (share * last as f64).round() as usize;
        let minimum = finite.iter().copied().reduce(f32::min);
        let maximum = finite.iter().copied().reduce(f32::max);
        let quantile_995 = *finite.select_nth_unstable_by(rank(0.995), f32::total_cmp).1;
        let median = *finite.select_nth_unstable_by(rank(0.5), f32::total_cmp).1;
        Self { count: last + 1, minimum, median: Some(median), quantile_995: Some(quantile_995), maximum }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_leave_out_pixels_without_a_value() {
        let mut values: Vec<f32> = (0..=200).map(|value| value as f32).collect();
        values.extend([f32::NAN, f32::INFINITY]);
        let statistics = Statistics::of(&values);
        assert_eq!(statistics.count, 201);
        assert_eq!((statistics.minimum, statistics.median), (Some(0.0), Some(100.0)));
        assert_eq!((statistics.quantile_995, statistics.maximum), (Some(199.0), Some(200.0)));
        assert_eq!(Statistics::of(&[f32::NAN]), Statistics::default());
    }
}
