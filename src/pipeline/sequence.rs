//! Labels that need an exposure's neighbours.

use super::{Error, Exposure};
use crate::labels::{self, Limits, Sequence, moved};
use crate::render::planes::Radiometry;
use crate::render::{Plane, Quantity, Renderer, Samples, Scene, View};
use crate::scenario::Scenario;

/// Refuses the change of shadows for a camera that moves.
pub fn check(scenario: &Scenario, exposures: &[Exposure]) -> Result<(), Error> {
    if !scenario.outputs.planes.contains(&Quantity::ShadowChange) {
        return Ok(());
    }
    let moves = |index: usize| Some((index, moved(&exposures[index - 1].view, &exposures[index].view)?));
    match (1..exposures.len()).find_map(moves) {
        Some((exposure, (moved_m, turned_rad))) => {
            Err(Error::CameraMoves { exposure, moved_m, turned_deg: turned_rad.to_degrees() })
        }
        None => Ok(()),
    }
}

/// Makes the labels of exposures, one after the other.
#[derive(Debug)]
pub struct Labels<'a> {
    limits: &'a Limits,
    /// What the last exposure sampled, and which it was.
    last: Option<(usize, Vec<Radiometry>)>,
}

impl<'a> Labels<'a> {
    pub fn new(scenario: &'a Scenario) -> Self {
        Self { limits: &scenario.hazards, last: None }
    }

    /// The planes of exposure `index`, which sampled `samples`.
    pub fn planes(
        &mut self,
        scene: &Scene,
        renderer: &mut dyn Renderer,
        exposures: &[Exposure],
        index: usize,
        samples: Samples,
    ) -> Result<Vec<Plane>, Error> {
        let view = |index: Option<usize>| index.and_then(|index| exposures.get(index)).map(|exposure| &exposure.view);
        let previous: Option<&View> = view(index.checked_sub(1));
        let before = match previous {
            Some(view) if scene.quantities.contains(&Quantity::ShadowChange) => match self.last.take() {
                Some((last, pixels)) if last + 1 == index => Some(pixels),
                // The first of a part of a sequence: what is before it is not rendered otherwise.
                _ => Some(renderer.samples(scene, view)?.pixels),
            },
            _ => None,
        };
        let next = view(Some(index + 1));
        let sequence = Sequence { previous, next, before: before.as_deref(), limits: self.limits };
        let planes = labels::planes(scene, &exposures[index].view, &samples, &sequence);
        self.last = Some((index, samples.pixels));
        Ok(planes)
    }
}
