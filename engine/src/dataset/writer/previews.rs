//! What previews show, and the scale that is known while a run goes on.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::dataset::manifest::PreviewScale;
use crate::dataset::preview::{self, White};
use crate::dataset::record::{PlaneRecord, Record};
use crate::render::{Image, Quantity};

/// Planes of 1024² pixels for a sequence of 32.
const PREVIEW_BYTES: usize = 256 << 20;

/// What a preview is made from.
#[derive(Debug, Clone)]
pub struct Shown {
    pub size: [usize; 2],
    pub values: Vec<f32>,
    pub gaps: Option<Vec<f32>>,
}

impl Shown {
    /// 16 bits, linear.
    pub fn numbers(&self, white: f64) -> Vec<u16> {
        preview::digital_numbers(&self.values, self.gaps.as_deref(), self.size[0], white)
    }

    /// 8 bits, for eyes.
    pub fn grey(&self, white: f64) -> Vec<u8> {
        preview::grey(&self.values, self.gaps.as_deref(), self.size[0], white)
    }
}

/// Planes that previews show, so that they need not be read again once their scale is known (as many as fit), and the
/// brightest value so far. Shared by the threads that write.
#[derive(Debug, Clone)]
pub struct Previews {
    white: White,
    state: Arc<Mutex<State>>,
}

#[derive(Debug, Default)]
struct State {
    brightest: f32,
    kept: BTreeMap<usize, Shown>,
}

impl Previews {
    pub fn new(white: White) -> Self {
        Self { white, state: Arc::default() }
    }

    fn state(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Hears of exposures that were finished before.
    pub fn know(&self, records: &[(usize, Record)]) {
        let brightest = records.iter().filter_map(|(_, record)| preview::brightest(&record.planes));
        let mut state = self.state();
        state.brightest = brightest.fold(state.brightest, f32::max);
    }

    /// Keeps what the preview of an exposure shows, and says on which scale it is shown for now.
    pub fn keep(&self, index: usize, image: &Image, records: &[PlaneRecord]) -> Option<PreviewScale> {
        let plane = |channel: &str| image.planes.iter().find(|plane| plane.name == channel);
        let record = preview::shown(records)?;
        let values = plane(&record.channel)?;
        let gaps = plane(Quantity::DemGap.channels()[0]).map(|plane| plane.values.clone());
        let shown = Shown { size: [image.columns, image.rows], values: values.values.clone(), gaps };
        let mut state = self.state();
        state.brightest = state.brightest.max(preview::brightest(records).unwrap_or_default());
        let scale = preview::scale_of(record, state.brightest, self.white);
        let bytes = (2 * size_of::<f32>()) * shown.values.len();
        // The last one is always there: its first look is made from it.
        while !state.kept.is_empty() && (state.kept.len() + 1) * bytes > PREVIEW_BYTES {
            state.kept.pop_first();
        }
        state.kept.insert(index, shown);
        Some(scale)
    }

    /// What the preview of an exposure shows, where it is kept.
    pub fn shown(&self, index: usize) -> Option<Shown> {
        self.state().kept.get(&index).cloned()
    }
}
