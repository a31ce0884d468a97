//! The surface of one level along one line, exact at its crossings of the grid.

use super::grid::{ABSENT_M, HeightGrid};
use super::ray::Ray;

/// A line `y = intercept + minor · x` in metres from a common centre: `x` grows along the azimuth's major
/// axis, `y` along the minor axis.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    pub intercept_m: f64,
    pub minor: f64,
}

/// A level's grid in the coordinates of an azimuth.
#[derive(Debug, Clone, Copy)]
pub struct PlacedGrid<'a> {
    pub grid: &'a HeightGrid,
    sign: isize,
    minor: f64,
    /// x of the grid's near side, y of its node row 0.
    near_x_m: f64,
    low_y_m: f64,
}

impl<'a> PlacedGrid<'a> {
    /// `centre_m`: map (major, minor) coordinates of the origin of x and y.
    pub fn new(grid: &'a HeightGrid, ray: &Ray, centre_m: glam::DVec2) -> Self {
        let first = if ray.sign > 0 { 0.0 } else { (grid.majors - 1) as f64 * grid.posting_m };
        Self {
            grid,
            sign: ray.sign,
            minor: ray.minor,
            near_x_m: ray.sign as f64 * (grid.origin_m.x + first - centre_m.x),
            low_y_m: grid.origin_m.y - centre_m.y,
        }
    }

    /// Major index of the node row `along` steps from the near side.
    fn major(&self, along: usize) -> usize {
        if self.sign > 0 { along } else { self.grid.majors - 1 - along }
    }

    /// x at which a line leaves the grid widened by `slack_m` on both sides of the minor axis.
    pub fn exit_x_m(&self, line: Line, slack_m: f64) -> f64 {
        self.x_range_m(line, slack_m).1
    }

    fn x_range_m(&self, line: Line, slack_m: f64) -> (f64, f64) {
        let far_x_m = self.near_x_m + (self.grid.majors - 1) as f64 * self.grid.posting_m;
        let low = self.low_y_m - slack_m - line.intercept_m;
        let high = self.low_y_m + (self.grid.minors - 1) as f64 * self.grid.posting_m + slack_m - line.intercept_m;
        if line.minor == 0.0 {
            let inside = low <= 0.0 && 0.0 <= high;
            return if inside { (self.near_x_m, far_x_m) } else { (far_x_m, self.near_x_m) };
        }
        let (a, b) = (low / line.minor, high / line.minor);
        (self.near_x_m.max(a.min(b)), far_x_m.min(a.max(b)))
    }

    /// Points `(x, height)` of the surface along a line, from far to near, for `from_m < x ≤ to_m`: all crossings,
    /// and the middle of a cell where it bulges above its crossings.
    pub fn descend(&self, line: Line, from_m: f64, to_m: f64, mut push: impl FnMut(f64, f32)) {
        let (enter_m, exit_m) = self.x_range_m(line, 0.0);
        let (from_m, to_m) = (from_m.max(enter_m), to_m.min(exit_m));
        if from_m >= to_m {
            return;
        }
        let posting_m = self.grid.posting_m;
        let across = |x: f64| (line.intercept_m + line.minor * x - self.low_y_m) / posting_m;
        let x_of_row = |along: f64| self.near_x_m + along * posting_m;
        let x_of_column = |v: f64| (self.low_y_m + v * posting_m - line.intercept_m) / line.minor;
        let mut along = ((to_m - self.near_x_m) / posting_m + 1e-9).floor();
        let step = line.minor.signum();
        let mut column = if step > 0.0 { (across(to_m) + 1e-9).floor() } else { (across(to_m) - 1e-9).ceil() };
        let mut farther: Option<(f64, f32)> = None;
        loop {
            let row_x = x_of_row(along);
            let column_x = if line.minor == 0.0 { f64::NEG_INFINITY } else { x_of_column(column) };
            let x = row_x.max(column_x);
            if x <= from_m {
                return;
            }
            let height_m = if row_x >= column_x {
                along -= 1.0;
                self.on_row((x - self.near_x_m) / posting_m, across(x))
            } else {
                column -= step;
                self.on_column((x - self.near_x_m) / posting_m, column + step)
            };
            if let Some((far_x, far_m)) = farther {
                let middle_x = 0.5 * (x + far_x);
                let bulge_m = self.bulge_m((middle_x - self.near_x_m) / posting_m, across(middle_x), far_x - x);
                if bulge_m > 0.0 {
                    push(middle_x, 0.5 * (height_m + far_m) + bulge_m);
                }
            }
            if height_m > ABSENT_M {
                push(x, height_m);
            }
            farther = Some((x, height_m));
        }
    }

    fn node_m(&self, along: usize, v: usize) -> f32 {
        let along = along.min(self.grid.majors - 1);
        self.grid.heights_m[self.grid.at(self.major(along), v.min(self.grid.minors - 1))]
    }

    fn on_row(&self, along: f64, v: f64) -> f32 {
        let along = along.round().max(0.0) as usize;
        let low = v.max(0.0).floor();
        mix(self.node_m(along, low as usize), self.node_m(along, low as usize + 1), v - low)
    }

    fn on_column(&self, along: f64, v: f64) -> f32 {
        let v = v.round().max(0.0) as usize;
        let low = along.max(0.0).floor();
        mix(self.node_m(low as usize, v), self.node_m(low as usize + 1, v), along - low)
    }

    /// Height of the middle of a stretch above its chord; 0 beside a gap.
    fn bulge_m(&self, along: f64, v: f64, run_m: f64) -> f32 {
        let (a, b) = (along.max(0.0) as usize, v.max(0.0) as usize);
        let corners = [(a, b), (a + 1, b), (a, b + 1), (a + 1, b + 1)].map(|(a, b)| self.node_m(a, b));
        if corners.iter().any(|height_m| *height_m <= ABSENT_M) {
            return 0.0;
        }
        let twist_m = corners[0] - corners[1] - corners[2] + corners[3];
        let steps = run_m / self.grid.posting_m;
        -twist_m * (0.25 * self.minor * steps * steps) as f32
    }
}

/// Linear interpolation in which a gap of weight 0 is nothing.
fn mix(a: f32, b: f32, fraction: f64) -> f32 {
    let fraction = if fraction < 1e-6 { 0.0 } else { fraction as f32 };
    (1.0 - fraction) * a + fraction * b
}
