//! The nodes of largest value that lie apart.

use super::blocks::Blocks;
use crate::terrain::{Gnomonic, Level};

/// Nodes by falling value, each at least `apart_m` from those before it; at most `count`. NaN is no value.
pub fn best_places(values: &[f32], map: &Gnomonic, level: &Level, count: usize, apart_m: f64) -> Vec<usize> {
    let blocks = Blocks::of(level);
    let mut order: Vec<usize> = (0..values.len()).filter(|node| values[*node].is_finite()).collect();
    // Of equals the first.
    order.sort_by(|a, b| values[*b].total_cmp(&values[*a]).then(a.cmp(b)));
    let up =
        |node: usize| map.up(level.node_m(node % blocks.columns + level.margin, node / blocks.columns + level.margin));
    let mut chosen: Vec<usize> = Vec::new();
    for node in order {
        if chosen.len() == count {
            break;
        }
        let here = up(node).unit();
        let is_apart = |other: &usize| up(*other).unit().distance(here) * map.radius_m >= apart_m;
        if chosen.iter().all(is_apart) {
            chosen.push(node);
        }
    }
    chosen
}
