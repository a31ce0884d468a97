//! Barrett's convex hull of a line's skyline: a stack of the points that any nearer receiver can see.
//!
//! Points come from far to near. A vertex keeps the line through itself and the next one farther away, `h = c + s x`. A
//! point below that line sees the vertex rise above all farther ones; a hull is convex, so that this holds for every vertex
//! from the bottom of the stack up to the one that the point's tangent touches, and for none above. To find
//! the touched vertex is to count, a window of them at a time from the top down, without a branch; and a new point hides
//! what lies above the vertex that its own tangent touches.
//!
//! # References
//! Barrett, *Linear-time horizon sweep*; Timonen & Westerholm (2010), *Scalable height field self-shadowing*.

use crate::horizon::lanes::larger;
use crate::horizon::wide::{Registers, lines_above};

/// Vertices that are looked at together.
const WINDOW: usize = 16;

/// A point of a line: distance along it, growing away from the receivers, and height.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Point {
    pub x: f32,
    pub height_m: f32,
}

/// Vertices that a hull holds. Few have more than 50; a smooth dome is all hull.
const CAPACITY: usize = 256;

/// Points closer than this to each other are this far apart: two crossings may have one place.
const LEAST_RUN_M: f32 = 1e-3;

impl Point {
    /// Slope and intercept of the line from here to a farther point.
    #[inline(always)]
    pub fn line_to(self, farther: Self) -> [f32; 2] {
        let slope = (farther.height_m - self.height_m) / larger(farther.x - self.x, LEAST_RUN_M);
        [slope, (-slope).mul_add(self.x, self.height_m)]
    }
}

/// The hull of one line. A window of vertices below all others, from which every point sees every other rise, stands
/// for "nothing".
#[derive(Debug)]
pub struct Hull {
    length: usize,
    intercepts_m: [f32; CAPACITY + WINDOW],
    slopes: [f32; CAPACITY + WINDOW],
    points: [Point; CAPACITY + WINDOW],
}

/// Height of a point that no receiver sees, and that goes with the next one. Far above what would make a product of its
/// slope and a distance infinite.
pub const LOWEST_M: f32 = -1e20;
/// What no receiver sees, beyond everything: the slope to it is −10¹¹.
const NOTHING: Point = Point { x: 1e9, height_m: LOWEST_M };

impl Default for Hull {
    fn default() -> Self {
        Self {
            length: WINDOW,
            intercepts_m: [f32::MAX; CAPACITY + WINDOW],
            slopes: [0.0; CAPACITY + WINDOW],
            points: [NOTHING; CAPACITY + WINDOW],
        }
    }
}

impl Hull {
    pub fn clear(&mut self) {
        self.length = WINDOW;
    }

    /// Adds a point nearer than all others.
    #[inline(always)]
    pub fn push(&mut self, registers: Registers, point: Point) {
        let [touched] = self.touched(registers, self.length, [point]);
        self.push_on(touched, point);
    }

    /// Adds a point whose tangent touches the vertex `touched`, and hides those above.
    #[inline(always)]
    fn push_on(&mut self, touched: usize, point: Point) {
        let [slope, intercept_m] = point.line_to(self.points[touched]);
        self.put(touched, point, [slope, intercept_m]);
    }

    /// A push with the line through both points at hand.
    #[inline(always)]
    pub fn put(&mut self, touched: usize, point: Point, [slope, intercept_m]: [f32; 2]) {
        let touched = if touched + 1 < CAPACITY { touched } else { self.thin_out(touched) };
        // Never out of bounds, and the compiler sees it.
        let touched = touched % CAPACITY;
        self.intercepts_m[touched + 1] = intercept_m;
        self.slopes[touched + 1] = slope;
        self.points[touched + 1] = point;
        self.length = touched + 2;
    }

    /// Makes room in a hull that ends with the vertex `last`, and returns where that is now: of every other vertex, drops
    /// the half where the hull turns least.
    #[cold]
    #[inline(never)]
    fn thin_out(&mut self, last: usize) -> usize {
        let (points, slopes) = (self.points, self.slopes);
        let turn = |i: usize| slopes[i + 1] - slopes[i];
        let candidates = || (WINDOW + 1..last).step_by(2);
        let mut turns: Vec<f32> = candidates().map(turn).collect();
        turns.sort_by(f32::total_cmp);
        let least = turns[turns.len() / 2];
        self.length = WINDOW;
        let mut touched = WINDOW - 1;
        for i in WINDOW..=last {
            if i < last && (i - WINDOW) % 2 == 1 && turn(i) <= least {
                continue;
            }
            self.push_on(touched, points[i]);
            touched += 1;
        }
        touched
    }

    /// Where the tangents from three points nearer than all vertices touch; of the first, which vertex it is as well.
    #[inline(always)]
    pub fn tangents(&self, registers: Registers, from: [Point; 3]) -> (usize, [Point; 3]) {
        let [a, b, c] = self.touched(registers, self.length, from);
        (a, [self.points[a % CAPACITY], self.points[b % CAPACITY], self.points[c % CAPACITY]])
    }

    /// The vertices that the tangents from receivers at `x` between two heights touch, some of the nearest points lying behind
    /// them: those do not count.
    #[inline(always)]
    pub fn touched_between(&self, registers: Registers, x: f32, [low_m, high_m]: [f32; 2]) -> &[Point] {
        let points = &self.points[WINDOW..self.length];
        let ahead = match points.last() {
            Some(nearest) if nearest.x <= x => points.partition_point(|point| point.x > x),
            _ => points.len(),
        };
        let from = [low_m, high_m].map(|height_m| Point { x, height_m });
        let [nearest, farthest] = self.touched(registers, WINDOW + ahead, from);
        &self.points[farthest..=nearest]
    }

    /// The vertices among the farthest `length` that tangents touch.
    #[inline(always)]
    fn touched<const N: usize>(&self, registers: Registers, length: usize, from: [Point; N]) -> [usize; N] {
        let start = (length - WINDOW) % CAPACITY;
        let intercepts_m: &[f32; WINDOW] = self.intercepts_m[start..start + WINDOW].first_chunk().expect("WINDOW");
        let slopes: &[f32; WINDOW] = self.slopes[start..start + WINDOW].first_chunk().expect("WINDOW");
        let (mut touched, mut fewest) = ([0; N], WINDOW);
        for i in 0..N {
            let count = lines_above(registers, intercepts_m, slopes, from[i].x, from[i].height_m) as usize;
            touched[i] = (length - WINDOW + count).wrapping_sub(1);
            fewest = fewest.min(count);
        }
        if fewest == 0 {
            for i in 0..N {
                touched[i] = self.touched_deep(registers, length, from[i].x, from[i].height_m);
            }
        }
        touched
    }

    /// [`Self::touched`] where more than a window of vertices lies above one: window by window.
    #[cold]
    #[inline(never)]
    fn touched_deep(&self, registers: Registers, length: usize, x: f32, height_m: f32) -> usize {
        let mut end = length;
        loop {
            let start = end.saturating_sub(WINDOW);
            let intercepts_m = self.intercepts_m[start..start + WINDOW].first_chunk().expect("WINDOW");
            let slopes = self.slopes[start..start + WINDOW].first_chunk().expect("WINDOW");
            // Every point lies below the lines of the first window, but one without a height.
            match lines_above(registers, intercepts_m, slopes, x, height_m) {
                0 if start > 0 => end = start,
                count => return start + (count as usize).saturating_sub(1),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The steepest of all points, looked at one by one.
    fn steepest(points: &[Point], x: f32, height_m: f32) -> f32 {
        points.iter().map(|point| (point.height_m - height_m) / (point.x - x)).fold(f32::NEG_INFINITY, f32::max)
    }

    #[test]
    fn a_tangent_is_the_steepest_of_all_points() {
        for curvature in [0.0, 1e-5] {
            let (mut hull, mut points) = (Hull::default(), Vec::new());
            for step in 0..2000 {
                let x = 10_000.0 - 10.0 * step as f32;
                // Any bumpy profile: no two waves in step. Curved enough, all its points are vertices.
                let phase = step as f32;
                let bumps_m = 200.0 * (0.011 * phase).sin() + 40.0 * (0.173 * phase).cos() + 9.0 * (1.9 * phase).sin();
                let height_m = if curvature == 0.0 { bumps_m } else { -curvature * x * x };
                let receivers = [Point { x: x - 300.0, height_m: -150.0 }, Point { x: x - 45.0, height_m: 260.0 }];
                let from = [receivers[0], receivers[1], receivers[1]];
                let (_, touches) = hull.tangents(Registers::Any, from);
                hull.push(Registers::Any, Point { x, height_m });
                for (touch, from) in touches.into_iter().zip(receivers).filter(|_| step > 0) {
                    let expected = steepest(&points, from.x, from.height_m);
                    // Lines through vertices are rounded to 1e-3 m, and points are 45 m away or more; chords of 40 m in a
                    // hull that was thinned out sag by 0.004 m.
                    let got = (touch.height_m - from.height_m) / (touch.x - from.x);
                    assert!((got - expected).abs() < 1e-4, "{step}: {touch:?} {expected}");
                }
                points.push(Point { x, height_m });
            }
        }
    }

    #[test]
    fn a_point_without_a_height_touches_nothing() {
        let mut hull = Hull::default();
        hull.push(Registers::Any, Point { x: 300.0, height_m: 30.0 });
        let (_, touches) = hull.tangents(Registers::Any, [Point { x: 0.0, height_m: f32::NAN }; 3]);
        assert_eq!(touches, [NOTHING; 3]);
    }

    #[test]
    fn points_behind_a_receiver_do_not_count() {
        let mut hull = Hull::default();
        for (x, height_m) in [(300.0, 30.0), (200.0, 28.0), (100.0, 20.0)] {
            hull.push(Registers::Any, Point { x, height_m });
        }
        let touched = |hull: &Hull, x, heights_m| hull.touched_between(Registers::Any, x, heights_m).to_vec();
        assert_eq!(touched(&hull, 150.0, [0.0, 0.0]), [Point { x: 200.0, height_m: 28.0 }]);
        assert_eq!(touched(&hull, 50.0, [0.0, 0.0]), [Point { x: 100.0, height_m: 20.0 }]);
        let farther = [Point { x: 200.0, height_m: 28.0 }, Point { x: 100.0, height_m: 20.0 }];
        assert_eq!(touched(&hull, 50.0, [0.0, 20.0]), farther);
        assert_eq!(touched(&Hull::default(), 0.0, [0.0, 0.0]), [NOTHING]);
    }
}
