//! A ray's walk over one level: blocks whose maximum it may not clear, down to the cell that it hits.

use glam::DVec2;

use super::segment::Segment;
use super::{Level, Pyramid};

/// A walk over a level's blocks, from large ones down to cells.
pub struct March<'a> {
    pub level: &'a Level,
    pub pyramid: &'a Pyramid,
    pub segment: &'a Segment,
}

/// Mips between one size of blocks and the next smaller one of the walk.
const MIPS_AT_ONCE: usize = 4;

impl March<'_> {
    /// The first hit for `from ≤ s ≤ until` among the blocks of a mip, with its cell.
    pub fn first_hit(&self, mip: usize, from: f64, until: f64) -> Option<(f64, (usize, usize))> {
        let size = (1usize << mip) as f64;
        let blocks = &self.pyramid.mips[mip];
        let start = self.level.grid_from_map(self.segment.start.truncate()) / size;
        let step = self.segment.step.truncate() / (self.level.posting_m * size);
        let at = start + from * step;
        let mut column = (at.x.floor().max(0.0) as usize).min(blocks.columns - 1);
        let mut row = (at.y.floor().max(0.0) as usize).min(blocks.rows - 1);
        let mut s = from;
        loop {
            let exit_x = exit(start.x, step.x, column);
            let exit_y = exit(start.y, step.y, row);
            let next = exit_x.min(exit_y).clamp(s, until);
            let lowest_m = self.segment.at(s).z.min(self.segment.at(next).z);
            if lowest_m <= f64::from(blocks.maxima_m[row * blocks.columns + column]) {
                let hit = if mip == 0 {
                    self.hit_in_cell(column, row, s, next).map(|s| (s, (column, row)))
                } else {
                    self.first_hit(mip.saturating_sub(MIPS_AT_ONCE), s, next)
                };
                if hit.is_some() {
                    return hit;
                }
            }
            if next >= until {
                return None;
            }
            let (index, count, rate) =
                if exit_x <= exit_y { (&mut column, blocks.columns, step.x) } else { (&mut row, blocks.rows, step.y) };
            *index = index.checked_add_signed(if rate > 0.0 { 1 } else { -1 }).filter(|i| *i < count)?;
            s = next;
        }
    }

    /// The first `s` in `[from, until]` at which the ray is not above the cell's bilinear patch.
    fn hit_in_cell(&self, column: usize, row: usize, from: f64, until: f64) -> Option<f64> {
        let grid =
            |s: f64| self.level.grid_from_map(self.segment.at(s).truncate()) - DVec2::new(column as f64, row as f64);
        let (p, q) = (grid(from), grid(until));
        let [h00, h10, h01, h11] = self.level.corners_m(column, row);
        let patch = |g: DVec2| h00 + (h10 - h00) * g.x + (h01 - h00) * g.y + (h00 - h10 - h01 + h11) * g.x * g.y;
        // The ray's height above the patch at w in [0, 1] is c + b w + a w².
        let c = self.segment.at(from).z - patch(p);
        let end = self.segment.at(until).z - patch(q);
        let a = -(h00 - h10 - h01 + h11) * (q.x - p.x) * (q.y - p.y);
        let b = end - c - a;
        first_root(a, b, c).map(|w| from + w * (until - from))
    }
}

/// The parameter at which a ray leaves block `index` of a row of unit blocks.
fn exit(start: f64, step: f64, index: usize) -> f64 {
    match step {
        step if step > 0.0 => (index as f64 + 1.0 - start) / step,
        step if step < 0.0 => (index as f64 - start) / step,
        _ => f64::INFINITY,
    }
}

/// The smallest `w` in [0, 1] with `c + b w + a w² ≤ 0`.
fn first_root(a: f64, b: f64, c: f64) -> Option<f64> {
    if c <= 0.0 {
        return Some(0.0);
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    // With c > 0 the smaller positive root is 2c/(−b + √…), free of cancellation where b < 0.
    let denominator = discriminant.sqrt() - b;
    let w = 2.0 * c / denominator;
    (denominator > 0.0 && w <= 1.0).then_some(w)
}
