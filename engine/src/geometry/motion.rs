//! Whether velocities are those of the positions beside them.

use glam::DVec3;

/// How far a velocity may be from the mean of a step: this share of it, besides all that it changes by within the step.
const SHARE: f64 = 0.1;
/// To what share of their length positions are rounded, at the coarsest.
const ROUNDED: f64 = 1e-6;

/// The first step, from one row to the next, over which positions move otherwise than their velocities say.
///
/// The mean velocity `Δr/Δt` must lie about `(v₁ + v₂)/2` within `|v₂ - v₁|` and a tenth of the speed: units, signs, exchanged
/// columns and zeros are found at any sampling that resolves the motion, and no honest table is refused.
pub fn contradicted_step(times_s: &[f64], positions: &[DVec3], velocities: &[DVec3]) -> Option<usize> {
    (1..times_s.len().min(positions.len()).min(velocities.len())).find(|&next| {
        let (a, b) = (next - 1, next);
        let step_s = times_s[b] - times_s[a];
        let mean = (positions[b] - positions[a]) / step_s;
        let (change, middle) = (velocities[b] - velocities[a], (velocities[a] + velocities[b]) / 2.0);
        let rounded = ROUNDED * positions[a].length().max(positions[b].length()) / step_s;
        let allowed = change.length() + SHARE * mean.length().max(middle.length()) + rounded;
        (mean - middle).length() > allowed
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circular orbit, sampled so that the angle between rows is `step_rad`.
    fn orbit(step_rad: f64) -> ([Vec<f64>; 1], Vec<DVec3>, Vec<DVec3>) {
        let (radius_m, rate) = (1.8e6, 9e-4);
        let angles: Vec<f64> = (0..9).map(|k| f64::from(k) * step_rad).collect();
        let at = |angle: &f64| DVec3::new(angle.cos(), angle.sin(), 0.0) * radius_m;
        let moving = |angle: &f64| DVec3::new(-angle.sin(), angle.cos(), 0.0) * radius_m * rate;
        let times = angles.iter().map(|angle| angle / rate).collect();
        ([times], angles.iter().map(at).collect(), angles.iter().map(moving).collect())
    }

    #[test]
    fn an_orbit_agrees_with_itself_however_it_is_sampled() {
        for step_rad in [1e-6, 1e-3, 0.1, 0.5, 1.0, 2.0, 3.0] {
            let ([times], positions, velocities) = orbit(step_rad);
            assert_eq!(contradicted_step(&times, &positions, &velocities), None, "{step_rad}");
        }
    }

    #[test]
    fn other_units_signs_columns_and_zeros_do_not() {
        let ([times], positions, velocities) = orbit(0.05);
        let changes: [fn(DVec3) -> DVec3; 5] =
            [|v| v * 1e3, |v| v * 1e-3, |v| -v, |v| DVec3::new(v.y, v.x, v.z), |_| DVec3::ZERO];
        for (which, change) in changes.into_iter().enumerate() {
            let wrong: Vec<DVec3> = velocities.iter().copied().map(change).collect();
            assert!(contradicted_step(&times, &positions, &wrong).is_some(), "{which}");
        }
        let mut one = positions.clone();
        one[4].x += 1e5;
        assert_eq!(contradicted_step(&times, &one, &velocities), Some(4));
    }
}
