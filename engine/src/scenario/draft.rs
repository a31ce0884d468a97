//! A scenario for a first look: a quarter of the size, one ray a pixel, the shadows that are ready soonest.

use super::resolved::{Ambient, Camera, Scenario, Shadows, Sky};
use crate::camera::Shutter;
use crate::render::Quantity;

/// Pixels of the camera along a side of a draft's pixel.
const COARSER: u32 = 4;

impl Scenario {
    /// The same views in a quarter of their columns and rows, through a lens without blur, each exposed at once. What needs
    /// horizons all around (light of a sky behind horizons, bounced light, `refine`) is left out, and said.
    pub fn draft(mut self) -> Self {
        let mut left_out = Vec::new();
        let mut leave_out = |is_there: bool, what: &'static str| left_out.extend(is_there.then_some(what));
        leave_out(self.bounce.is_some(), "bounce");
        leave_out(matches!(self.ambient, Some(Ambient { sky: Sky::Horizons, .. })), "ambient");
        leave_out(self.refine, "refine");
        leave_out(!self.camera.spreads.is_empty() || self.camera.kernel.is_some(), "camera.psf");
        leave_out(self.camera.moments > 1, "motion blur");
        // It rests on the errors of horizon maps.
        let is_sigma = |quantity: &Quantity| *quantity == Quantity::SunFractionSigma;
        leave_out(self.outputs.planes.iter().any(is_sigma), "sun_fraction_sigma");
        self.outputs.planes.retain(|quantity| !is_sigma(quantity));
        if self.outputs.planes.is_empty() {
            self.outputs.planes.push(Quantity::SunFraction);
        }
        self.bounce = None;
        self.ambient = self.ambient.filter(|ambient| ambient.sky != Sky::Horizons);
        self.refine = false;
        // Whatever is ready soonest, of methods whose errors an eye does not see in a small image.
        self.shadows = match self.shadows.are_off() {
            true => self.shadows,
            false => Shadows::Auto { max_irradiance_error: 1.0 },
        };
        let columns = self.camera.columns;
        self.camera = self.camera.draft();
        self.draft = true;
        let size = if self.camera.columns < columns { "a quarter of the size, " } else { "" };
        let without = if left_out.is_empty() { String::new() } else { format!(", without {}", left_out.join(", ")) };
        self.notes.push(format!("a draft: {size}one ray a pixel, the quickest shadows{without}"));
        self
    }
}

impl Camera {
    fn draft(mut self) -> Self {
        (self.samples_per_pixel, self.moments) = (1, 1);
        (self.spreads, self.kernel) = (Vec::new(), None);
        // Scanners and poses of an ISD have lines of their own.
        if self.isd.is_none() && self.shutter.exposed_rows(self.rows) == self.rows {
            let factor = f64::from(COARSER);
            self.columns = self.columns.div_ceil(COARSER);
            self.rows = self.rows.div_ceil(COARSER);
            self.focal_length_px /= factor;
            self.principal_point_px = self.principal_point_px.map(|place| place / factor);
            self.shutter = Shutter::Global;
        }
        self
    }
}
