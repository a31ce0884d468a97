//! Sums over pairs of values.

/// Pearson's correlation; NaN where one of the two is the same everywhere.
pub fn correlation(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let (count, [a_mean, b_mean]) = means(pairs.clone());
    if count < 2.0 {
        return f64::NAN;
    }
    let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
    for (a, b) in pairs {
        let (a, b) = (a - a_mean, b - b_mean);
        aa += a * a;
        ab += a * b;
        bb += b * b;
    }
    ab / (aa.sqrt() * bb.sqrt())
}

fn means(pairs: impl Iterator<Item = (f64, f64)>) -> (f64, [f64; 2]) {
    let (count, a, b) = pairs.fold((0.0, 0.0, 0.0), |(n, a, b), (x, y)| (n + 1.0, a + x, b + y));
    (count, [a / count, b / count])
}

/// Slope and intercept of `b` over `a` by least squares; slope 0 where `a` is the same everywhere.
pub fn line(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> [f64; 2] {
    let (_, [a_mean, b_mean]) = means(pairs.clone());
    let (mut aa, mut ab) = (0.0, 0.0);
    for (a, b) in pairs {
        aa += (a - a_mean).powi(2);
        ab += (a - a_mean) * (b - b_mean);
    }
    let slope = if aa > 0.0 { ab / aa } else { 0.0 };
    [slope, b_mean - slope * a_mean]
}

/// Standard deviation about the mean, and that mean.
pub fn spread(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let (count, sum) = values.clone().fold((0.0, 0.0), |(n, s), v| (n + 1.0, s + v));
    let mean = sum / count;
    ((values.map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt(), mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_and_correlates() {
        let pairs = || (0..10).map(|i| (f64::from(i), 3.0 - 2.0 * f64::from(i)));
        let [slope, intercept] = line(pairs());
        assert!((slope + 2.0).abs() < 1e-12 && (intercept - 3.0).abs() < 1e-12);
        assert!((correlation(pairs()) + 1.0).abs() < 1e-12);
        assert!(correlation((0..10).map(|i| (1.0, f64::from(i)))).is_nan());
    }
}
