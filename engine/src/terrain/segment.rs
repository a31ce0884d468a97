//! The straight piece of a ray over a map, in lifted coordinates.

use glam::DVec3;

use super::{Gnomonic, Level};

/// The lifted part of a ray above the seen part of a map's outermost level: `start + s · step`, `0 ≤ s ≤ 1`.
#[derive(Debug, Clone, Copy)]
pub struct Segment {
    pub start: DVec3,
    pub step: DVec3,
    pub enters_by_the_edge: bool,
    pub leaves_by_the_edge: bool,
}

/// No ground lies nearer to the centre of projection, in radii.
const LOWEST: f64 = 1e-3;

impl Segment {
    /// Clips a ray (in map axes, from the centre of projection) to the pyramid over the level's seen part.
    pub fn clip(map: &Gnomonic, level: &Level, origin: DVec3, towards: DVec3) -> Option<Self> {
        let (low, high) = level.seen_m();
        let r = map.radius_m;
        let sides = [
            DVec3::new(r, 0.0, -low.x),
            DVec3::new(-r, 0.0, high.x),
            DVec3::new(0.0, r, -low.y),
            DVec3::new(0.0, -r, high.y),
            DVec3::new(0.0, 0.0, r),
        ];
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for side in sides {
            let (value, rate) = (side.dot(origin), side.dot(towards));
            match rate {
                rate if rate > 0.0 => near = near.max(-value / rate),
                rate if rate < 0.0 => far = far.min(-value / rate),
                _ if value < 0.0 => return None,
                _ => {}
            }
        }
        if towards.z < 0.0 {
            // Straight down all sides meet in the centre of projection, which has no place on the map.
            far = far.min((origin.z - LOWEST * r) / -towards.z);
        }
        if near >= far {
            return None;
        }
        let lift = |t: f64| {
            // A ray that rises for ever tends to the lifted point of its direction.
            let p = if t.is_finite() { origin + t * towards } else { towards };
            let height = if t.is_finite() { r * (p.z - r) / p.z } else { r };
            DVec3::new(r * p.x / p.z, r * p.y / p.z, height)
        };
        let start = lift(near);
        let step = lift(far) - start;
        step.is_finite().then_some(Self {
            start,
            step,
            enters_by_the_edge: near > 0.0,
            leaves_by_the_edge: far.is_finite(),
        })
    }

    pub fn at(&self, s: f64) -> DVec3 {
        self.start + s * self.step
    }

    /// Where the segment lies over a level's seen part: an interval of `s`, empty where it does not.
    fn over(&self, level: &Level) -> Option<(f64, f64)> {
        let (low, high) = level.seen_m();
        let (mut near, mut far) = (0.0_f64, 1.0_f64);
        for (start, step, low, high) in
            [(self.start.x, self.step.x, low.x, high.x), (self.start.y, self.step.y, low.y, high.y)]
        {
            if step == 0.0 {
                if start < low || start > high {
                    return None;
                }
                continue;
            }
            let (a, b) = ((low - start) / step, (high - start) / step);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        (near < far).then_some((near, far))
    }

    /// The levels in the order of the ray: `(level, from, until)`, each where it is the finest.
    pub fn visits(&self, levels: &[Level]) -> Vec<(usize, f64, f64)> {
        let outermost = levels.len() - 1;
        let mut visits = vec![(outermost, 0.0, 1.0)];
        for level in (0..outermost).rev() {
            let middle = visits.len() / 2;
            let (outer, from, until) = visits[middle];
            let Some((near, far)) = self.over(&levels[level]) else { break };
            visits.splice(middle..=middle, [(outer, from, near), (level, near, far), (outer, far, until)]);
        }
        visits
    }
}
