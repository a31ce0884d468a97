//! Trajectory, pointing and exposures, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where the camera is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Trajectory {
    /// A smooth path through points, in the body-fixed frame.
    Waypoints {
        /// The points, in order of time. One point is a camera that stands still.
        #[schemars(length(min = 1, max = 100_000))]
        points: Vec<Waypoint>,
        /// What their heights are measured from.
        #[serde(default)]
        height_above: HeightAbove,
    },
    /// A body of an SPK kernel.
    Spk {
        /// The kernel. Default: one of `kernels`.
        #[serde(default)]
        path: Option<String>,
        /// SPICE id of the spacecraft, as in -85 for LRO.
        naif_id: i32,
    },
    /// A CCSDS orbit ephemeris message.
    Oem {
        /// The file, in key-value notation.
        path: String,
    },
    /// A Kepler orbit from its elements. Axes: ICRF, origin: the body's centre.
    Orbit {
        /// When the elements hold, with its scale: `2026-08-01T00:00:00 TDB`.
        epoch: String,
        /// Half the long axis; negative for a hyperbola.
        #[schemars(range(min = -1e12, max = 1e12))]
        semi_major_axis_m: f64,
        /// 0 is a circle.
        #[schemars(range(min = 0.0, max = 100.0))]
        eccentricity: f64,
        /// Tilt of the orbit to the ICRF equator.
        #[schemars(range(min = 0.0, max = 180.0))]
        inclination_deg: f64,
        /// Right ascension of the ascending node.
        #[schemars(range(min = -360.0, max = 360.0))]
        node_deg: f64,
        /// From the node to the periapsis.
        #[schemars(range(min = -360.0, max = 360.0))]
        periapsis_deg: f64,
        /// From the periapsis to the spacecraft at `epoch`.
        #[schemars(range(min = -360.0, max = 360.0))]
        true_anomaly_deg: f64,
        /// Gravitational parameter. Default: from the kernels.
        #[serde(default)]
        #[schemars(range(min = 1.0, max = 1e20))]
        gm_m3_s2: Option<f64>,
    },
    /// A Kepler orbit from position and velocity. Axes: ICRF, origin: the body's centre.
    State {
        /// When the state holds, with its scale: `2026-08-01T00:00:00 TDB`.
        epoch: String,
        /// Position.
        position_m: (f64, f64, f64),
        /// Velocity.
        velocity_m_s: (f64, f64, f64),
        /// Gravitational parameter. Default: from the kernels.
        #[serde(default)]
        #[schemars(range(min = 1.0, max = 1e20))]
        gm_m3_s2: Option<f64>,
    },
    /// The poses of `camera.isd`, body-fixed, whatever the epoch; no pointing beside it.
    Isd,
}

/// A point of a path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// Time after the first exposure.
    #[schemars(range(min = -1e9, max = 1e9))]
    pub t_s: f64,
    /// Geodetic latitude, north positive.
    #[schemars(range(min = -90.0, max = 90.0))]
    pub latitude_deg: f64,
    /// East longitude.
    #[schemars(range(min = -360.0, max = 360.0))]
    pub longitude_deg: f64,
    /// Height.
    #[schemars(range(min = -1e5, max = 1e10))]
    pub height_m: f64,
}

/// What heights are measured from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum HeightAbove {
    /// The reference spheroid.
    #[default]
    Spheroid,
    /// The ground below.
    Terrain,
}

/// Where the camera looks.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Pointing {
    /// What the boresight follows.
    pub towards: Towards,
    /// Whither the top of the image leans. Default: North for Nadir, otherwise Up; fixed attitudes have none.
    pub top: Option<Top>,
    /// Turns the camera about its boresight, from +x (right) towards +y (down).
    #[schemars(range(min = -360.0, max = 360.0))]
    pub roll_deg: f64,
}

/// Whither the top of the image leans.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Top {
    /// To the north pole.
    North,
    /// In the direction of flight: a scanner's first line is then the image's last, `first: Bottom`.
    Velocity,
    /// Away from the ground.
    Up,
}

/// What the boresight follows.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Towards {
    /// Straight down to the reference spheroid.
    #[default]
    Nadir,
    /// A point of the ground.
    At {
        /// Geodetic latitude, north positive.
        #[schemars(range(min = -90.0, max = 90.0))]
        latitude_deg: f64,
        /// East longitude.
        #[schemars(range(min = -360.0, max = 360.0))]
        longitude_deg: f64,
        /// Height of the point.
        #[serde(default)]
        #[schemars(range(min = -1e5, max = 1e10))]
        height_m: f64,
        /// What `height_m` is measured from.
        #[serde(default)]
        height_above: HeightAbove,
    },
    /// The direction of flight over the ground.
    AlongVelocity,
    /// A fixed attitude: the quaternion `camera_from_body`, scalar first, Hamilton's. It is of length 1 within 1e-3.
    Quaternion {
        /// Scalar part.
        #[schemars(range(min = -1.001, max = 1.001))]
        w: f64,
        /// x of the vector part.
        #[schemars(range(min = -1.001, max = 1.001))]
        x: f64,
        /// y of the vector part.
        #[schemars(range(min = -1.001, max = 1.001))]
        y: f64,
        /// z of the vector part.
        #[schemars(range(min = -1.001, max = 1.001))]
        z: f64,
    },
    /// Attitudes over time, interpolated along great circles.
    Table {
        /// The attitudes, in order of time.
        #[schemars(length(min = 1, max = 1_000_000))]
        points: Vec<Pose>,
    },
    /// A CCSDS attitude ephemeris message: quaternions between a frame of space or of the body and the camera's.
    Aem {
        /// The file, in key-value notation.
        path: String,
    },
}

/// An attitude at a time: the quaternion `camera_from_body`, scalar first, Hamilton's. It is of length 1 within 1e-3.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// Time after the first exposure.
    #[schemars(range(min = -1e9, max = 1e9))]
    pub t_s: f64,
    /// Scalar part.
    #[schemars(range(min = -1.001, max = 1.001))]
    pub w: f64,
    /// x of the vector part.
    #[schemars(range(min = -1.001, max = 1.001))]
    pub x: f64,
    /// y of the vector part.
    #[schemars(range(min = -1.001, max = 1.001))]
    pub y: f64,
    /// z of the vector part.
    #[schemars(range(min = -1.001, max = 1.001))]
    pub z: f64,
}

/// When images are taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Exposures {
    /// At equal steps.
    Series {
        /// The first, with its scale: `2026-08-01T00:00:00 UTC`, `… TDB` or `…Z`.
        start: String,
        /// From one to the next.
        #[schemars(range(min = 1e-6, max = 1e9))]
        step_s: f64,
        /// How many.
        #[schemars(range(min = 1, max = 100_000))]
        count: u32,
    },
    /// At given epochs, each with its scale, in order of time.
    List(#[schemars(length(min = 1, max = 100_000))] Vec<String>),
    /// One, at the centre time of `camera.isd`.
    Isd,
}
