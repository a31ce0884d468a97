//! Barrett's convex hull of a line's skyline: a stack of the points that any nearer receiver can see.
//!
//! Points come from far to near. A vertex keeps its slope to the next one farther away, so that asking
//! whether a point hides a vertex, or whether a receiver sees the next vertex above this one, takes one
//! multiplication and no division.
//!
//! # References
//! Barrett, *Linear-time horizon sweep*; Timonen & Westerholm (2010), doi:10.1111/j.1467-8659.2009.01640.x.

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
