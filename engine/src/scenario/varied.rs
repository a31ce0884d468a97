//! The points of a sweep, as values.

use super::spec;

/// Points and what varies between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    pub written: spec::Sweep,
    pub points: Vec<Point>,
}

/// The values at one point.
#[derive(Debug, Clone, PartialEq)]
pub struct Point(pub Vec<(Varied, f64)>);

/// What a sweep varies, in the unit of its key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Varied {
    EpochS,
    SunAzimuthDeg,
    SunElevationDeg,
    NorthM,
    EastM,
    HeightFactor,
    RollDeg,
    Albedo,
    NoiseSeed,
}

impl Varied {
    /// The key of the scenario.
    pub fn key(self) -> &'static str {
        match self {
            Self::EpochS => "epoch_s",
            Self::SunAzimuthDeg => "sun_azimuth_deg",
            Self::SunElevationDeg => "sun_elevation_deg",
            Self::NorthM => "north_m",
            Self::EastM => "east_m",
            Self::HeightFactor => "height_factor",
            Self::RollDeg => "roll_deg",
            Self::Albedo => "albedo",
            Self::NoiseSeed => "noise_seed",
        }
    }
}
