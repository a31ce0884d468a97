//! Sweep and split, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One scenario under many Suns, over many places: all exposures are made at each point of a design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// How the points lie in the space of what varies.
    pub design: Design,
    /// Added to all epochs; the path and attitudes of this file move along, kernels and messages do not.
    #[serde(default)]
    pub epoch_s: Option<Axis>,
    /// Azimuth of the Sun that `sun.fixed` holds still.
    #[serde(default)]
    pub sun_azimuth_deg: Option<Axis>,
    /// Elevation of the Sun that `sun.fixed` holds still.
    #[serde(default)]
    pub sun_elevation_deg: Option<Axis>,
    /// Carries all waypoints and the point that is looked at along the ground, rigidly.
    #[serde(default)]
    pub north_m: Option<Axis>,
    /// As `north_m`, eastwards.
    #[serde(default)]
    pub east_m: Option<Axis>,
    /// Multiplies the waypoints' heights.
    #[serde(default)]
    pub height_factor: Option<Axis>,
    /// Added to `pointing.roll_deg`.
    #[serde(default)]
    pub roll_deg: Option<Axis>,
    /// In place of `surface.albedo`.
    #[serde(default)]
    pub albedo: Option<Axis>,
    /// In place of `seed`, rounded.
    #[serde(default)]
    pub noise_seed: Option<Axis>,
}

/// How points lie in the space of what varies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Design {
    /// All combinations; the axis named last above runs fastest.
    Grid,
    /// Each point drawn by itself.
    Uniform {
        /// How many points.
        #[schemars(range(min = 1, max = 100_000))]
        count: u32,
        /// Seed of the draws.
        #[serde(default)]
        seed: u64,
    },
    /// Each axis in as many strata as points, each stratum met once (McKay et al. 1979).
    LatinHypercube {
        /// How many points.
        #[schemars(range(min = 1, max = 100_000))]
        count: u32,
        /// Seed of the draws.
        #[serde(default)]
        seed: u64,
    },
    /// A Sobol sequence, shifted by the seed: even in all axes at once. Best with a power of two.
    Sobol {
        /// How many points.
        #[schemars(range(min = 1, max = 100_000))]
        count: u32,
        /// Seed of the shift; 0 shifts by nothing.
        #[serde(default)]
        seed: u64,
    },
}

/// What a quantity takes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Axis {
    /// These values.
    Values(#[schemars(length(min = 1, max = 100_000), inner(range(min = -1e10, max = 1e10)))] Vec<f64>),
    /// Values at equal steps, both ends among them.
    Steps {
        /// The first.
        #[schemars(range(min = -1e10, max = 1e10))]
        from: f64,
        /// The last.
        #[schemars(range(min = -1e10, max = 1e10))]
        to: f64,
        /// How many.
        #[schemars(range(min = 1, max = 100_000))]
        count: u32,
    },
    /// All numbers between two; not for a grid.
    Range {
        /// The lower end.
        #[schemars(range(min = -1e10, max = 1e10))]
        from: f64,
        /// The upper end.
        #[schemars(range(min = -1e10, max = 1e10))]
        to: f64,
    },
}

/// Parts of the dataset for training, validation and test, by place: an image belongs to the part of the ground cell that its
/// boresight meets, whenever it was taken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Split {
    /// Share of the cells for training.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub train: f64,
    /// Share of the cells for validation.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub validation: f64,
    /// Share of the cells for the test. The three add up to 1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub test: f64,
    /// Side of a cell. Larger than what an image shows, or neighbours in different parts see the same ground.
    #[schemars(range(min = 1.0, max = 1e7))]
    pub cell_m: f64,
    /// Seed of the draw.
    #[serde(default)]
    pub seed: u64,
}
