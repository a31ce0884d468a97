//! The truth at one elevation of the Sun, and by how much a method's image differs from it.
//!
//! # Assumptions
//! A shadow's displacement is along the Sun's direction in the image, in metres of a pixel's width at the median range.

use glam::DVec2;

use super::methods::MethodFactory;
use super::{Comparison, Trial, compare, level_of, trial};
use crate::{Error, Value};
use perilune_engine::image_metrics::{ScalarImage, edges, flip, ssim};
use perilune_engine::render::planes::Radiometry;
use perilune_engine::render::{Quantity, Renderer, Scene, View};
use perilune_engine::scenario::Scenario;
use perilune_engine::shadow::registry;
use perilune_engine::statistics::{Errors, median};

/// Columns of what [`Truth::errors`] gives.
pub(super) const ERRORS: [(&str, &str); 8] = [
    ("agreement", "%"),
    ("RMS", ""),
    ("p99", ""),
    ("penumbra RMS", ""),
    ("horizon RMS", "deg"),
    ("SSIM", ""),
    ("FLIP", ""),
    ("edge displaced", "m"),
];

/// Truth of one elevation.
pub(super) struct Truth {
    pub(super) trial: Trial,
    pub(super) ground: Vec<bool>,
    /// Radiance that is shown white.
    white: f64,
    /// Along which the ground of the image comes nearer to the Sun, and a pixel's width on it.
    towards_sun: Option<DVec2>,
    pixel_m: f64,
}

impl Truth {
    /// Renders it.
    pub(super) fn of(scene: &Scene, view: &View, factory: &MethodFactory) -> Result<Self, Error> {
        let scene = scene.clone().with_shadows(registry::reference(factory.settings));
        let asked = view.clone().with_quantities([Quantity::DemGap]);
        let trial = trial("traced, reference".into(), &mut Renderer::Reference.session(&scene)?, &asked)?;
        let centres = &trial.samples.centres;
        let ground: Vec<bool> = centres.iter().map(|hit| level_of(hit).is_some()).collect();
        if !ground.contains(&true) {
            return Err(Error::NoGround { exposure: 0 });
        }
        let radiances = trial.samples.pixels.iter().map(|pixel| f64::from(pixel.radiance_w_m2_sr));
        let white = Errors::of(radiances.filter(|radiance| radiance.is_finite())).p99.max(f64::MIN_POSITIVE);
        let range_m = median(centres.iter().flatten().map(|hit| hit.distance_m).collect()).unwrap_or(f64::NAN);
        let pixel_m = range_m / view.optics.focal_px.x;
        Ok(Self { towards_sun: towards_sun(view, &trial), trial, ground, white, pixel_m })
    }

    /// The irradiance of a trial against it.
    pub(super) fn compared(&self, view: &View, trial: &Trial) -> Comparison {
        let full_w_m2 = view.lights[0].irradiance_w_m2;
        compare(&self.trial.samples.pixels, &trial.samples.pixels, &self.ground, full_w_m2)
    }

    /// [`ERRORS`] of a method's image: those of its light as [`Self::compared`], of its horizons, and how it looks.
    pub(super) fn errors(
        &self,
        scenario: &Scenario,
        light: &Comparison,
        tried: &Trial,
        horizon_rms_deg: Option<f64>,
    ) -> [Value; ERRORS.len()] {
        let (columns, rows) = (scenario.camera.columns as usize, scenario.camera.rows as usize);
        let grid = |trial: &Trial, value: &dyn Fn(&Radiometry) -> f64| {
            let pixels = trial.samples.pixels.iter().zip(&self.ground);
            let values = pixels.map(|(pixel, ground)| if *ground { value(pixel) } else { f64::NAN }).collect();
            ScalarImage::new(columns, rows, values)
        };
        let shown = |trial: &Trial| {
            grid(trial, &|pixel| (f64::from(pixel.radiance_w_m2_sr) / self.white).clamp(0.0, 1.0).powf(1.0 / 2.2))
        };
        let fraction = |trial: &Trial| grid(trial, &|pixel| f64::from(pixel.sun_fraction));
        let displaced_m = self.towards_sun.and_then(|towards| {
            let [tried, truth] = [fraction(tried), fraction(&self.trial)];
            let found = edges::displacement(&tried, &truth, 0.5, towards, self.pixel_m);
            (!found.displacements_px.is_empty()).then(|| {
                let squares = found.displacements_px.iter().map(|offset| offset * offset).sum::<f64>();
                (squares / found.displacements_px.len() as f64).sqrt() * self.pixel_m
            })
        });
        let [shown_tried, shown_truth] = [shown(tried), shown(&self.trial)];
        [
            (100.0 * light.agreement).into(),
            light.irradiance.rms.into(),
            light.irradiance.p99.into(),
            light.penumbra.rms.into(),
            horizon_rms_deg.into(),
            ssim::mean(&shown_truth, &shown_tried, 1.0).into(),
            flip::mean(&shown_truth, &shown_tried).into(),
            displaced_m.into(),
        ]
    }
}

/// The direction of the image in which the ground in its middle comes nearer to the Sun.
fn towards_sun(view: &View, trial: &Trial) -> Option<DVec2> {
    let centres = &trial.samples.centres;
    let middle = centres.len() / 2 + view.optics.columns as usize / 2;
    let hit = centres.get(middle).copied().flatten().or_else(|| centres.iter().flatten().next().copied())?;
    let camera_m = view.camera_position.vector_m();
    let here = hit.position.vector_m();
    let ahead = (view.lights[0].position.vector_m() - here).reject_from(here.normalize()).try_normalize()?;
    let pixel = |point: glam::DVec3| {
        let seen = perilune_engine::geometry::Direction::new(point - camera_m)?;
        view.optics.pixel(view.camera_from_body * seen)
    };
    (pixel(here + 1e-3 * hit.distance_m * ahead)? - pixel(here)?).try_normalize()
}
