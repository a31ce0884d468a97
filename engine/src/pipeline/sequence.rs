//! Labels that need an exposure's neighbours: those at the same point of a sweep.

use super::{Error, Exposure};
use crate::labels::{self, Sequence, moved};
use crate::render::planes::Radiometry;
use crate::render::{Plane, Quantity, Samples, Scene, Session, View};
use crate::scenario::{Dem, Scenario};
use crate::shadow::Shadow;

/// Refuses the change of shadows for a camera that moves.
pub fn check(scenario: &Scenario, exposures: &[Exposure]) -> Result<(), Error> {
    if !scenario.outputs.planes.contains(&Quantity::ShadowChange) {
        return Ok(());
    }
    let moves = |index: usize| Some((index, moved(previous(exposures, index)?, &exposures[index].view)?));
    match (1..exposures.len()).find_map(moves) {
        Some((exposure, (moved_m, turned_rad))) => {
            Err(Error::CameraMoves { exposure, moved_m, turned_deg: turned_rad.to_degrees() })
        }
        None => Ok(()),
    }
}

/// How many of the terrain's models, the finest, are made up below the posting of a measured one.
pub fn synthetic_levels(scenario: &Scenario) -> usize {
    let dems = scenario.terrain.as_ref().map_or(&[][..], |terrain| &terrain.dems);
    dems.iter().take_while(|dem| matches!(dem, Dem::Detail { .. })).count()
}

fn previous(exposures: &[Exposure], index: usize) -> Option<&View> {
    beside(exposures, index, index.checked_sub(1)?)
}

fn beside(exposures: &[Exposure], index: usize, other: usize) -> Option<&View> {
    let other = exposures.get(other).filter(|other| other.point == exposures[index].point);
    other.map(|exposure| &exposure.view)
}

/// What the exposure before each sampled, where a label needs it.
#[derive(Debug, Default)]
pub struct Before {
    /// What the last exposure sampled, and which it was.
    last: Option<(usize, Vec<Radiometry>)>,
}

impl Before {
    /// Of the exposure before `index`.
    pub fn pixels(
        &mut self,
        session: &mut Session,
        exposures: &[Exposure],
        index: usize,
    ) -> Result<Option<Vec<Radiometry>>, Error> {
        match previous(exposures, index) {
            Some(view) if is_needed(&exposures[index].view) => match self.last.take() {
                Some((last, pixels)) if last + 1 == index => Ok(Some(pixels)),
                // The first of a part of a sequence: what is before it is not rendered otherwise.
                _ => Ok(Some(session.samples(view)?.pixels)),
            },
            _ => Ok(None),
        }
    }

    pub fn keep(&mut self, view: &View, index: usize, samples: &Samples) {
        self.last = is_needed(view).then(|| (index, samples.pixels.clone()));
    }
}

fn is_needed(view: &View) -> bool {
    view.quantities.contains(&Quantity::ShadowChange)
}

/// The labels of exposure `index`, before which `before` was sampled.
pub fn planes(
    scenario: &Scenario,
    scene: &Scene,
    exposures: &[Exposure],
    index: usize,
    samples: &Samples,
    before: Option<&[Radiometry]>,
    shadow: Option<&dyn Shadow>,
) -> Vec<Plane> {
    let (previous, next) = (previous(exposures, index), beside(exposures, index, index + 1));
    let (limits, synthetic_levels) = (&scenario.hazards, synthetic_levels(scenario));
    let sequence = Sequence { previous, next, before, shadow, limits, synthetic_levels };
    labels::planes(scene, &exposures[index].view, samples, &sequence)
}
