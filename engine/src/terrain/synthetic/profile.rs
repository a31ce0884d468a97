//! The shape of a simple crater from its formation to its disappearance.
//!
//! A fresh crater of diameter `D = 2R`, `x = r/R`, is a flat-floored bowl of depth `0.196 D` from rim
//! crest to floor inside a rim of height `0.036 D`, which falls outwards as ejecta do:
//!
//! ```text
//! h/D = 0.036 − 0.196 (b(1) − b(x))/(b(1) − b(0.2))     0.2 < x ≤ 1,   b = 0.228 x + 0.083 x² − 0.039 x³
//!       0.036 x⁻³, faded to 0 at x = 4                   x > 1
//! ```
//!
//! with the wall of Fassett & Thomson (2014). It then decays by topographic diffusion,
//! `∂h/∂t = κ ∇²h`, whose only parameter is `K = κt/R²`: the *degradation*. Profiles are computed once
//! for a table of `K` by implicit steps on a radial grid.
//!
//! # References
//! Pike (1977), in Impact and Explosion Cratering, 489: depth and rim height of craters under 15 km;
//! McGetchin et al. (1973), EPSL 20, 226, doi:10.1016/0012-821X(73)90162-3: ejecta as r⁻³;
//! Fassett & Thomson (2014), JGR Planets 119, 2255, doi:10.1002/2014JE004698: diffusion, and the wall.

/// Rim crest to floor over diameter. Pike (1977).
pub const DEPTH_TO_DIAMETER: f64 = 0.196;

/// Rim crest above the surroundings over diameter. Pike (1977).
pub const RIM_TO_DIAMETER: f64 = 0.036;

/// Radius of the flat floor over the crater's. Fassett & Thomson (2014).
const FLOOR: f64 = 0.2;

/// Distance from the centre, in radii, to which a crater changes the ground.
pub const REACH: f64 = 4.0;

const STEPS_PER_RADIUS: usize = 50;
const NODES: usize = REACH as usize * STEPS_PER_RADIUS + 1;

/// Degradations in the table, quadratically spaced: the rim decays fast at first.
const STATES: usize = 41;

/// The largest degradation in the table: less than a tenth of the depth is left.
pub const MOST_DEGRADED: f64 = 0.6;

/// Height over diameter of a fresh crater at `x` radii.
fn fresh(x: f64) -> f64 {
    let bowl = |x: f64| x * (0.228 + x * (0.083 - 0.039 * x));
    if x <= 1.0 {
        let below_rim = (bowl(1.0) - bowl(x.max(FLOOR))) / (bowl(1.0) - bowl(FLOOR));
        RIM_TO_DIAMETER - DEPTH_TO_DIAMETER * below_rim
    } else {
        let fade = ((REACH - x) / (REACH - 2.5)).clamp(0.0, 1.0);
        RIM_TO_DIAMETER * x.powi(-3) * fade * fade * (3.0 - 2.0 * fade)
    }
}

/// Profiles for a range of degradations.
#[derive(Debug, Clone)]
pub(super) struct Profiles {
    /// Heights over diameter at `r/R = node/STEPS_PER_RADIUS`, for each state.
    states: Vec<Vec<f64>>,
}

impl Profiles {
    pub fn new() -> Self {
        let mut profile: Vec<f64> = (0..NODES).map(|node| fresh(node as f64 / STEPS_PER_RADIUS as f64)).collect();
        let mut states = vec![profile.clone()];
        for state in 1..STATES {
            let interval = degradation(state) - degradation(state - 1);
            for _ in 0..8 {
                diffuse(&mut profile, interval / 8.0);
            }
            states.push(profile.clone());
        }
        Self { states }
    }

    /// The profile of one crater, in between those of the table.
    pub fn at(&self, degradation: f64) -> Vec<f64> {
        let state = (degradation / MOST_DEGRADED).clamp(0.0, 1.0).sqrt() * (STATES - 1) as f64;
        let low = (state as usize).min(STATES - 2);
        let share = (degradation - self::degradation(low)) / (self::degradation(low + 1) - self::degradation(low));
        let pairs = self.states[low].iter().zip(&self.states[low + 1]);
        pairs.map(|(low, high)| low + share.clamp(0.0, 1.0) * (high - low)).collect()
    }
}

fn degradation(state: usize) -> f64 {
    MOST_DEGRADED * (state as f64 / (STATES - 1) as f64).powi(2)
}

/// Height over diameter at `x` radii of a profile.
pub(super) fn height(profile: &[f64], x: f64) -> f64 {
    let node = x * STEPS_PER_RADIUS as f64;
    let low = node as usize;
    if low + 1 >= profile.len() {
        return 0.0;
    }
    profile[low] + (node - low as f64) * (profile[low + 1] - profile[low])
}

/// Rim crest to floor over diameter.
pub(super) fn depth(profile: &[f64]) -> f64 {
    profile.iter().fold(f64::MIN, |most, &height| most.max(height)) - profile[0]
}

/// One implicit step of `∂h/∂K = h″ + h′/x`, the height at the far end held at 0.
fn diffuse(profile: &mut [f64], step: f64) {
    let dx = 1.0 / STEPS_PER_RADIUS as f64;
    let n = profile.len();
    let weight = step / (dx * dx);
    // Fluxes through the rings at x ± dx/2; by symmetry 4 (h₁ − h₀) at the centre.
    let rate = |node: usize| match node {
        0 => (0.0, 4.0 * weight),
        node => (weight * (1.0 - 0.5 / node as f64), weight * (1.0 + 0.5 / node as f64)),
    };
    // Thomas' algorithm: −inner h₋ + (1 + inner + outer) h − outer h₊ = old h.
    let (mut upper, mut value) = (vec![0.0; n], vec![0.0; n]);
    for node in 0..n - 1 {
        let (inner, outer) = rate(node);
        let (before_upper, before_value) = if node == 0 { (0.0, 0.0) } else { (upper[node - 1], value[node - 1]) };
        let pivot = 1.0 + inner + outer - inner * before_upper;
        upper[node] = outer / pivot;
        value[node] = (profile[node] + inner * before_value) / pivot;
    }
    profile[n - 1] = 0.0;
    for node in (0..n - 1).rev() {
        profile[node] = value[node] + upper[node] * profile[node + 1];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fassett & Thomson (2014), abstract: after 3 Ga at 5.5 m²/Myr a crater of 1 km keeps about 52 %
    /// of its depth, one of 300 m about 7 %.
    #[test]
    fn craters_decay_as_published() {
        let profiles = Profiles::new();
        let kept = |diameter_m: f64| {
            let degradation = 5.5 * 3000.0 / (diameter_m / 2.0).powi(2);
            depth(&profiles.at(degradation)) / depth(&profiles.at(0.0))
        };
        // The fresh shapes differ in the rim (theirs is 0.218 D deep), the table ends at K = 0.6.
        assert!((kept(1000.0) - 0.52).abs() < 0.06, "{}", kept(1000.0));
        assert!((kept(332.0) - 0.08).abs() < 0.03, "{}", kept(332.0));
    }

    #[test]
    fn a_fresh_crater_has_the_depth_and_the_rim_of_pike() {
        let fresh = Profiles::new().at(0.0);
        assert!((depth(&fresh) - 0.196).abs() < 1e-9);
        assert!((height(&fresh, 1.0) - 0.036).abs() < 1e-9);
        // r⁻³: an eighth at two radii.
        assert!((height(&fresh, 2.0) - 0.0045).abs() < 1e-6);
        // Walls of fresh simple craters stand near the angle of repose.
        let steepest = fresh.windows(2).map(|w| (w[1] - w[0]) * STEPS_PER_RADIUS as f64 * 2.0).fold(0.0, f64::max);
        assert!((25.0..35.0).contains(&steepest.atan().to_degrees()), "{}", steepest.atan().to_degrees());
    }

    /// A Gaussian stays one: `exp(−x²/4s)/s` with `s` growing by the step.
    #[test]
    fn diffusion_spreads_a_gaussian_as_the_heat_kernel_does() {
        let gaussian =
            |s: f64| move |node: usize| (-(node as f64 / STEPS_PER_RADIUS as f64).powi(2) / (4.0 * s)).exp() / s;
        let mut profile: Vec<f64> = (0..NODES).map(gaussian(0.05)).collect();
        (0..400).for_each(|_| diffuse(&mut profile, 0.05 / 400.0));
        for (node, value) in profile.iter().enumerate().take(2 * STEPS_PER_RADIUS) {
            // Second order in dx = 1/50, first in 400 steps.
            assert!((value - gaussian(0.1)(node)).abs() < 0.02, "{node}");
        }
    }
}
