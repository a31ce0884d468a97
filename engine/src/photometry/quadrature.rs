//! Gauss–Legendre quadrature.

/// Nodes and weights of the `points`-point rule on [0, 1]; exact for polynomials up to degree `2 points − 1`.
///
/// Newton's iteration on the Legendre polynomial from `cos(π (i + 3/4) / (n + 1/2))`.
///
/// # References
/// Davis & Rabinowitz (1984), Methods of Numerical Integration, section 2.7.
pub fn gauss_legendre(points: usize) -> Vec<(f64, f64)> {
    let n = points as f64;
    let rule = (0..points).map(|i| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        for _ in 0..5 {
            let (value, slope) = legendre(points, x);
            x -= value / slope;
        }
        let (_, slope) = legendre(points, x);
        ((1.0 - x) / 2.0, 1.0 / ((1.0 - x * x) * slope * slope))
    });
    rule.collect()
}

/// The Legendre polynomial of a degree, and its derivative, inside (−1, 1).
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (0.0, 1.0);
    for k in 1..=degree {
        let k = k as f64;
        (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
    }
    (value, degree as f64 * (x * value - before) / (x * x - 1.0))
}

/// `∫ f` from `from` to `to` by a rule on [0, 1].
pub fn integrate(rule: &[(f64, f64)], from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    let width = to - from;
    rule.iter().map(|&(node, weight)| weight * width * f(from + width * node)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_exact_for_polynomials_of_degree_2n_minus_1_and_no_further() {
        for points in [1, 2, 5, 16, 64] {
            let rule = gauss_legendre(points);
            for degree in 0..2 * points as i32 {
                let integral = integrate(&rule, -1.0, 2.0, |x| x.powi(degree));
                let expected = (2f64.powi(degree + 1) - (-1f64).powi(degree + 1)) / f64::from(degree + 1);
                assert!((integral / expected - 1.0).abs() < 1e-12, "{points} points, degree {degree}");
            }
        }
        let beyond = integrate(&gauss_legendre(2), -1.0, 1.0, |x| x.powi(4));
        assert!((beyond - 0.4).abs() > 0.1, "{beyond}");
    }
}
