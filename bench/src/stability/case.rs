//! A scene, what is asked of it, and how an answer is judged.

use std::fmt;

use perilune_engine::render::planes::Radiometry;
use perilune_engine::render::{Samples, Scene, View};
use perilune_engine::terrain::Ground;

/// The error that a method makes in a case, from its images of all views.
pub type Judge = Box<dyn Fn(&[Samples]) -> f64>;

/// One hard case.
pub struct Case {
    /// In the list of hard cases.
    pub number: u8,
    pub name: &'static str,
    /// What the error is an error of, with its unit.
    pub error_of: &'static str,
    pub limit: f64,
    pub scene: Scene,
    pub views: Vec<View>,
    /// How far away stands what casts the shadow.
    pub reach_m: f64,
    /// The answer lies in a penumbra.
    pub soft: bool,
    pub error: Judge,
}

impl fmt::Debug for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "case {} {}", self.number, self.name)
    }
}

/// What became of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// With its error.
    Pass(f64),
    /// Infinite where the feature that is measured is not there at all.
    Fail(f64),
    /// Some share of the disc is no number between 0 and 1.
    NotANumber,
    Outside,
}

impl Case {
    /// What images of all views are worth.
    pub fn outcome(&self, images: &[Samples]) -> Outcome {
        if images.iter().any(|image| !sound(image)) {
            return Outcome::NotANumber;
        }
        match (self.error)(images) {
            error if error.is_nan() => Outcome::NotANumber,
            error if error <= self.limit => Outcome::Pass(error),
            error => Outcome::Fail(error),
        }
    }
}

/// Every pixel on the ground has a share of the disc in [0, 1] and a radiance.
fn sound(image: &Samples) -> bool {
    let right = |pixel: &Radiometry| {
        (0.0..=1.0).contains(&pixel.sun_fraction) && pixel.radiance_w_m2_sr >= 0.0 && pixel.irradiance_w_m2 >= 0.0
    };
    let ground = |index: usize| image.centres[index].is_some_and(|hit| hit.ground != Ground::Gap);
    image.pixels.iter().enumerate().all(|(index, pixel)| !ground(index) || right(pixel))
}

impl Outcome {
    pub fn word(&self) -> &'static str {
        match self {
            Self::Pass(_) => "pass",
            Self::Fail(_) => "FAIL",
            Self::NotANumber => "NaN",
            Self::Outside => "outside its domain",
        }
    }

    pub fn error(&self) -> Option<f64> {
        match self {
            Self::Pass(error) | Self::Fail(error) => Some(*error),
            Self::NotANumber | Self::Outside => None,
        }
    }

    /// For the matrix.
    pub fn text(&self, limit: f64) -> String {
        match self {
            Self::Pass(error) => format!("{:.2}", error / limit),
            Self::Fail(error) if error.is_infinite() => "FAIL none".into(),
            Self::Fail(error) => format!("FAIL {:.2}", error / limit),
            Self::NotANumber => "NaN".into(),
            Self::Outside => "outside".into(),
        }
    }
}
