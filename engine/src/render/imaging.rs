//! How a camera takes an image: a lens that blurs, a shutter that takes its time, an exposure during which it moves.
//!
//! ```text
//! radiance of a pixel = Σ rays W(pixel − ray) · mean over moments L(ray, pose at that moment)
//! ```
//!
//! Every band of rows ([`Shutter`]) has a pose in the middle of its own exposure, and further ones, evenly spread over
//! the exposure, where motion blur is asked for. Radiance is averaged over the moments, linearly, then spread
//! ([`Psf`]); the detector comes after both. Irradiance, Sun's share, coverage and all geometric planes belong to the
//! middle moment, unblurred: they are the ground truth of the image.
//!
//! # Assumptions
//! - The lights are those of each moment's view: whoever takes the image says how they move.
//! - Light that is spread from one band into another counts as if it came from that band's own pose; light from above the
//!   first and below the last row is rendered from their poses. Framelets of a push-frame camera share no light.
//! - Where motion sweeps an edge over many pixels, `m` moments leave steps of `1/m` of it.

use std::ops::Range;
use std::time::Duration;

use super::planes::{self, Part, Radiometry, Samples};
use super::{Image, Rays, RenderError, Scene, Session, View};
use crate::camera::{Camera as Optics, Detector, ExposedRows as Band, Psf, Shutter};

/// What a camera does beyond a pinhole that stands still for an instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Imaging {
    pub timing: Timing,
    pub psf: Option<Psf>,
}

/// When the poses of an image are asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Rows of the image.
    pub rows: u32,
    pub shutter: Shutter,
    /// Moments of each exposure that are averaged; odd, so that one is its middle.
    pub moments: usize,
}

/// An image's light before the detector: its parts, the upper one first.
#[derive(Debug)]
pub struct Capture {
    parts: Vec<OwnedPart>,
    /// What the device spent, where it can tell.
    pub device: Duration,
}

#[derive(Debug)]
struct OwnedPart {
    optics: Optics,
    view: View,
    samples: Samples,
}

impl OwnedPart {
    fn part(&self) -> Part<'_> {
        Part { optics: &self.optics, view: &self.view, samples: &self.samples }
    }
}

impl Imaging {
    /// Takes an image from the views of each band's moments, which differ in pose and lights alone.
    pub fn take(&self, session: &mut Session, views: Vec<Vec<View>>) -> Result<Capture, RenderError> {
        let mut taken = Capture { parts: Vec::new(), device: Duration::ZERO };
        let mut views = views.into_iter();
        for piece in self.timing.shutter.pieces(self.timing.rows) {
            let bands: Vec<(Band, Vec<View>)> = piece.into_iter().zip(&mut views).collect();
            match &self.psf {
                None => bands.iter().try_for_each(|band| taken.sharp(session, band))?,
                Some(psf) => taken.spread(session, psf, &bands)?,
            }
        }
        Ok(taken)
    }
}

impl Timing {
    /// Times of all poses from the image's middle: of each band, of each moment of an exposure.
    pub fn times_s(&self, exposure_s: f64) -> Vec<Vec<f64>> {
        let moment = |index: usize| ((index as f64 + 0.5) / self.moments as f64 - 0.5) * exposure_s;
        let of_band = |band: Band| (0..self.moments).map(|index| band.time_s + moment(index)).collect();
        self.shutter.pieces(self.rows).into_iter().flatten().map(of_band).collect()
    }

    /// Whole seconds from the image's middle about which bands are exposed, in order; none where all are at once.
    pub fn seconds(&self) -> Vec<f64> {
        let bands = self.shutter.pieces(self.rows).into_iter().flatten();
        let mut seconds: Vec<f64> = bands.map(|band| band.time_s.round()).collect();
        seconds.sort_by(f64::total_cmp);
        seconds.dedup();
        if seconds.len() > 1 { seconds } else { Vec::new() }
    }

    /// The farthest of them from the image's middle.
    pub fn reach_s(&self, exposure_s: f64) -> f64 {
        self.times_s(exposure_s).into_iter().flatten().map(f64::abs).fold(0.0, f64::max)
    }
}

impl Capture {
    /// The image of the light, as the detector sees it.
    pub fn image(&self, scene: &Scene, detector: Option<&Detector>) -> Image {
        planes::image_of(scene, detector, &self.parts())
    }

    /// Irradiance of the focal plane, row by row.
    pub fn focal_plane_irradiance(&self) -> Vec<f32> {
        planes::focal_plane_irradiance(&self.parts())
    }

    /// What was sampled, where all rows are exposed together.
    pub fn samples(&self) -> Option<&Samples> {
        match &self.parts[..] {
            [whole] => Some(&whole.samples),
            _ => None,
        }
    }

    fn parts(&self) -> Vec<Part<'_>> {
        self.parts.iter().map(OwnedPart::part).collect()
    }

    /// What some rays see from each moment's view: all of the middle one, and the mean radiance.
    fn moments(&mut self, session: &mut Session, rays: &Rays, views: &[View]) -> Result<Samples, RenderError> {
        let middle = views.len() / 2;
        let mut samples = self.follow(session, rays, &views[middle])?;
        if views.len() == 1 {
            return Ok(samples);
        }
        let mut sums: Vec<f64> = samples.pixels.iter().map(|pixel| f64::from(pixel.radiance_w_m2_sr)).collect();
        // Refinement asks for the centres at every moment, planes only at the middle one.
        let others = Rays { centres: session.scene().refine.is_some(), ..rays.clone() };
        for (_, view) in views.iter().enumerate().filter(|(index, _)| *index != middle) {
            let seen = self.follow(session, &others, view)?;
            sums.iter_mut().zip(&seen.pixels).for_each(|(sum, pixel)| *sum += f64::from(pixel.radiance_w_m2_sr));
        }
        for (pixel, sum) in samples.pixels.iter_mut().zip(sums) {
            pixel.radiance_w_m2_sr = (sum / views.len() as f64) as f32;
        }
        Ok(samples)
    }

    fn follow(&mut self, session: &mut Session, rays: &Rays, view: &View) -> Result<Samples, RenderError> {
        let samples = session.follow(rays, view)?;
        self.device += session.device_time().unwrap_or_default();
        Ok(samples)
    }

    fn sharp(&mut self, session: &mut Session, (band, views): &(Band, Vec<View>)) -> Result<(), RenderError> {
        let view = &views[views.len() / 2];
        let rays = Rays { optics: rows(view, band), ..session.scene().rays(view) };
        let samples = self.moments(session, &rays, views)?;
        self.push(band, views, samples);
        Ok(())
    }

    /// Bands whose light is spread together. Each ray is rendered as a pixel of its own, with a margin all round.
    fn spread(&mut self, session: &mut Session, psf: &Psf, bands: &[(Band, Vec<View>)]) -> Result<(), RenderError> {
        let Some((_, [first, ..])) = bands.first().map(|(band, views)| (band, views.as_slice())) else { return Ok(()) };
        let (side, reach) = (first.samples_per_side as u32, psf.reach as u32);
        let columns = first.optics.columns;
        let mut rays = Vec::new();
        let mut means = Vec::new();
        for (index, (band, views)) in bands.iter().enumerate() {
            let above = if index == 0 { reach } else { 0 };
            let below = if index + 1 == bands.len() { reach } else { 0 };
            let (width, height) = (columns + 2 * reach, above + band.rows + below);
            let corner = [-i64::from(reach), band.first_row - i64::from(above)];
            let optics = views[0].optics.part(corner, width, height).resized(width * side, height * side);
            let each = Rays { optics, samples_per_side: 1, centres: session.scene().refine.is_some() };
            let fine = self.moments(session, &each, views)?;
            rays.extend(fine.pixels.iter().map(|pixel| pixel.radiance_w_m2_sr));
            let within = Within { stride: (width * side) as usize, side: side as usize };
            let rows = above as usize..(above + band.rows) as usize;
            let centres = self.centres(session, band, &views[views.len() / 2])?;
            let inside = reach as usize..(reach + columns) as usize;
            means.push(Samples { pixels: within.means(&fine.pixels, inside, rows), centres });
        }
        let rows: u32 = bands.iter().map(|(band, _)| band.rows).sum();
        let mut light = psf.spread(&rays, [columns as usize, rows as usize]).into_iter();
        for ((band, views), mut samples) in bands.iter().zip(means) {
            samples.pixels.iter_mut().zip(&mut light).for_each(|(pixel, light)| pixel.radiance_w_m2_sr = light);
            self.push(band, views, samples);
        }
        Ok(())
    }

    /// Hits of the pixels' centres, where planes need them.
    fn centres(
        &mut self,
        session: &mut Session,
        band: &Band,
        view: &View,
    ) -> Result<Vec<Option<crate::terrain::Hit>>, RenderError> {
        if !session.scene().needs_centres(view) {
            return Ok(Vec::new());
        }
        let rays = Rays { optics: rows(view, band), samples_per_side: 1, centres: true };
        Ok(self.follow(session, &rays, view)?.centres)
    }

    fn push(&mut self, band: &Band, views: &[View], samples: Samples) {
        let view = views[views.len() / 2].clone();
        self.parts.push(OwnedPart { optics: rows(&view, band), view, samples });
    }
}

/// The part of a view's optics that sees a band's rows.
fn rows(view: &View, band: &Band) -> Optics {
    view.optics.part([0, band.first_row], view.optics.columns, band.rows)
}

/// Rays of a frame, each as a pixel of its own, row by row.
struct Within {
    stride: usize,
    /// Rays along a pixel's side.
    side: usize,
}

impl Within {
    /// Means over pixels, as a renderer makes them; one ray without a value leaves its pixel without.
    fn means(&self, rays: &[Radiometry], columns: Range<usize>, rows: Range<usize>) -> Vec<Radiometry> {
        rows.flat_map(|row| columns.clone().map(move |column| (column, row)))
            .map(|(column, row)| {
                let lines = row * self.side..(row + 1) * self.side;
                let own = column * self.side..(column + 1) * self.side;
                mean(lines.flat_map(|line| &rays[line * self.stride..][own.clone()]))
            })
            .collect()
    }
}

fn mean<'a>(rays: impl Iterator<Item = &'a Radiometry>) -> Radiometry {
    let (mut count, mut hits, mut sums) = (0.0, 0.0, [0.0; 3]);
    for ray in rays {
        count += 1.0;
        sums[0] += f64::from(ray.radiance_w_m2_sr);
        if ray.hit > 0.0 {
            hits += 1.0;
            sums[1] += f64::from(ray.irradiance_w_m2);
            sums[2] += f64::from(ray.sun_fraction);
        }
    }
    Radiometry {
        radiance_w_m2_sr: (sums[0] / count) as f32,
        irradiance_w_m2: (sums[1] / hits) as f32,
        sun_fraction: (sums[2] / hits) as f32,
        hit: (hits / count) as f32,
    }
}
