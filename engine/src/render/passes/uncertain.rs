//! Pixels of a device's image whose light the horizon maps leave uncertain, rendered again by the reference renderer.

use glam::DVec2;
use rayon::prelude::*;

use crate::render::planes::Samples;
use crate::render::reference::{self, Lighting};
use crate::render::refine::{UncertainTraced, is_open};
use crate::render::{Diffuse, Rays, Scene, View};
use crate::terrain::Hit;

/// Renders again, with traced shadows, what a device's samples leave uncertain.
pub fn trace_uncertain(scene: &Scene, rays: &Rays, view: &View, diffuse: &Diffuse, samples: &mut Samples) {
    let Some(shadow) = UncertainTraced::of(scene) else { return };
    let (columns, rows) = (rays.optics.columns as usize, rays.optics.rows as usize);
    let is_open = |hit: &Option<Hit>| hit.as_ref().is_some_and(|hit| is_open(scene, view, shadow.maps.as_ref(), hit));
    let open: Vec<bool> = samples.centres.par_iter().map(is_open).collect();
    let reach = usize::from(rays.samples_per_side > 1);
    let concerned = |index: usize| {
        let near = |at: usize, count: usize| at.saturating_sub(reach)..(at + reach + 1).min(count);
        let (column, row) = (index % columns, index / columns);
        near(row, rows).any(|row| near(column, columns).any(|column| open[row * columns + column]))
    };
    let offsets = rays.offsets();
    samples.pixels.par_iter_mut().enumerate().filter(|(index, _)| concerned(*index)).for_each(|(index, pixel)| {
        let at = DVec2::new((index % columns) as f64, (index / columns) as f64);
        let lighting = Lighting { shadow: Some(&shadow), diffuse };
        *pixel = reference::mean(scene, &rays.optics, view, lighting, at, &offsets);
    });
}
