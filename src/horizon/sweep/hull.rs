//! Barrett's convex hull of a line's skyline: a stack of the points that any nearer receiver can see.
//!
//! Points come from far to near. A vertex keeps its slope to the next one farther away, so that asking
//! whether a point hides a vertex, or whether a receiver sees the next vertex above this one, takes one
//! multiplication and no division.
//!
//! # References
//! Barrett, *Linear-time horizon sweep*; Timonen & Westerholm (2010), *Scalable height field self-shadowing*.

use super::grid::NEVER_M;

/// A vertex of the upper hull. Farther vertices lie below it in the stack.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(16))]
pub struct Vertex {
    /// Distance along the line, in metres along the major axis, growing away from the receivers.
    x: f32,
    height_m: f32,
    /// Slope to the next farther vertex; −∞ at the farthest.
    slope: f32,
}

/// The point of a hull that a receiver sees as its skyline, from the receiver.
#[derive(Debug, Clone, Copy)]
pub struct Touch {
    pub rise_m: f32,
    pub run_m: f32,
}

/// The hull of one line.
#[derive(Debug, Default)]
pub struct Hull {
    stack: Vec<Vertex>,
    /// Where the last receiver's tangent touched.
    touched: usize,
}

impl Hull {
    pub fn clear(&mut self) {
        self.stack.clear();
        self.touched = 0;
    }

    /// Adds a point nearer than all others.
    #[inline(always)]
    pub fn push(&mut self, x: f32, height_m: f32) {
        let mut length = self.stack.len();
        let mut slope = f32::NEG_INFINITY;
        while length > 0 {
            let top = self.stack[length - 1];
            let (run, rise) = (top.x - x, top.height_m - height_m);
            if rise > top.slope * run {
                slope = rise / run;
                break;
            }
            length -= 1;
        }
        self.stack.truncate(length);
        self.stack.push(Vertex { x, height_m, slope });
    }

    /// Where the tangent from a receiver nearer than all points touches; a rise of [`NEVER_M`] where the hull
    /// has no points.
    #[inline(always)]
    pub fn tangent(&mut self, x: f32, height_m: f32) -> Touch {
        self.tangent_of(self.stack.len(), x, height_m)
    }

    /// [`Self::tangent`] for a receiver that some of the nearest points may lie behind: those do not count.
    pub fn tangent_beyond(&mut self, x: f32, height_m: f32) -> Touch {
        let ahead = self.stack.partition_point(|vertex| vertex.x > x);
        self.tangent_of(ahead, x, height_m)
    }

    /// The tangent to the farthest `length` vertices, searched from where the last one touched.
    #[inline(always)]
    fn tangent_of(&mut self, length: usize, x: f32, height_m: f32) -> Touch {
        let stack = &self.stack[..length];
        if stack.is_empty() {
            return Touch { rise_m: NEVER_M, run_m: 1.0 };
        }
        let mut touched = self.touched.min(stack.len() - 1);
        let mut vertex = stack[touched];
        // Is the next vertex farther away above the line of sight to this one?
        let below = |vertex: Vertex| vertex.height_m - height_m < vertex.slope * (vertex.x - x);
        if below(vertex) {
            while below(vertex) {
                touched -= 1;
                vertex = stack[touched];
            }
        } else {
            while let Some(nearer) = stack.get(touched + 1) {
                if below(*nearer) {
                    break;
                }
                touched += 1;
                vertex = *nearer;
            }
        }
        self.touched = touched;
        Touch { rise_m: vertex.height_m - height_m, run_m: vertex.x - x }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The steepest of all points, looked at one by one.
    fn steepest(points: &[(f32, f32)], x: f32, height_m: f32) -> f32 {
        points.iter().map(|(px, h)| (h - height_m) / (px - x)).fold(f32::NEG_INFINITY, f32::max)
    }

    #[test]
    fn a_tangent_is_the_steepest_of_all_points() {
        let (mut hull, mut points) = (Hull::default(), Vec::new());
        for step in 0..2000 {
            let x = -10.0 * step as f32;
            // Any bumpy profile: no two waves in step.
            let phase = step as f32;
            let height_m = 200.0 * (0.011 * phase).sin() + 40.0 * (0.173 * phase).cos() + 9.0 * (1.9 * phase).sin();
            hull.push(x, height_m);
            points.push((x, height_m));
            for (nearer_m, receiver_m) in [(10.0, height_m), (300.0, -150.0), (45.0, 260.0)] {
                let touch = hull.tangent(x - nearer_m, receiver_m);
                let expected = steepest(&points, x - nearer_m, receiver_m);
                // Hull slopes are rounded to 1e-7 of some units.
                assert!((touch.rise_m / touch.run_m - expected).abs() < 1e-5, "{step}: {touch:?} {expected}");
            }
        }
    }

    #[test]
    fn points_behind_a_receiver_do_not_count() {
        let mut hull = Hull::default();
        for (x, height_m) in [(300.0, 30.0), (200.0, 28.0), (100.0, 20.0)] {
            hull.push(x, height_m);
        }
        let touch = hull.tangent_beyond(150.0, 0.0);
        assert_eq!((touch.rise_m, touch.run_m), (28.0, 50.0));
        assert!(Hull::default().tangent_beyond(0.0, 0.0).rise_m < -1e29);
    }
}
