//! At what sizes a photograph and its render are compared.

use super::ScalarImage;

/// Rendered pixels along a compared one, at most.
pub const FINER: f64 = 3.0;
/// Standard deviation of what a slope of the elevation model averages over, in postings: central differences span two
/// of them, `(2²)/12`, and are interpolated over a tent, `1/6`; the root of the sum.
pub const SLOPE_SIGMA: f64 = 0.707;

/// At what the two were compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    pub photo_px: [usize; 2],
    pub photo_pixel_m: f64,
    pub posting_m: f64,
    pub compared_px: [usize; 2],
    pub compared_pixel_m: f64,
    pub high_pass_px: f64,
    /// Distance of the ground in the middle of the image.
    pub range_m: f64,
}

impl Resolution {
    /// A compared pixel over the photograph's.
    pub fn factor(&self) -> f64 {
        self.compared_pixel_m / self.photo_pixel_m
    }

    /// A rendered pixel over the photograph's: its own where that is affordable, so that both are reduced alike.
    pub fn render_factor(&self) -> f64 {
        (self.factor() / FINER).max(1.0)
    }

    pub fn reduced(&self, image: ScalarImage) -> ScalarImage {
        image.reduced(self.compared_px[0], self.compared_px[1])
    }

    /// Reduced and smoothed to what both can show.
    pub fn seen(&self, image: ScalarImage) -> ScalarImage {
        self.reduced(image).blurred(SLOPE_SIGMA * self.posting_m / self.compared_pixel_m)
    }
}
