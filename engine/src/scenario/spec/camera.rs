//! The camera, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The camera: a pinhole with a lens. Axes: +x right, +y down, +z along the boresight (OpenCV).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Camera {
    /// A known camera, whose figures take the place of the defaults below and of `detector`; keys that are given go before
    /// them. `columns` and `rows` are then a window in the middle of its image.
    pub preset: Option<Preset>,
    /// A camera from a CSM ISD (JSON, as ALE writes it): image size, focal length, distortion, lines or framelets, and
    /// the times between them. `trajectory: Isd` takes its poses too.
    pub isd: Option<String>,
    /// Width of the image in pixels. It must be given but for presets and ISDs.
    #[schemars(range(min = 1, max = 16384))]
    pub columns: Option<u32>,
    /// Height of the image in pixels: of a scanner, its lines. It must be given but for frame presets and ISDs.
    #[schemars(range(min = 1, max = 65536))]
    pub rows: Option<u32>,
    /// Horizontal field of view between the outer edges of the image. Give this or `focal_length_mm`.
    #[schemars(range(min = 1e-4, max = 170.0))]
    pub field_of_view_deg: Option<f64>,
    /// Focal length. It needs `pixel_pitch_um`.
    #[schemars(range(min = 1.0, max = 10_000.0))]
    pub focal_length_mm: Option<f64>,
    /// Distance of neighbouring pixels' centres on the detector.
    #[schemars(range(min = 0.1, max = 1000.0))]
    pub pixel_pitch_um: Option<f64>,
    /// Where the boresight meets the image; 0, 0 is the outer corner of the top left pixel. Of scanners, the rows are
    /// those of one line or framelet. Default: the middle.
    pub principal_point: Option<PrincipalPoint>,
    /// Lens distortion from undistorted to distorted (OpenCV). Default: none.
    pub distortion: Option<Distortion>,
    /// Lens distortion the other way: from measured to ideal (ISIS, CSM). Give this or `distortion`. Default: none.
    pub correction: Option<Correction>,
    /// How the focal plane darkens towards the image's edge. Default: Cos4.
    pub vignetting: Option<Vignetting>,
    /// What spreads the light of a point over pixels, one after the other. Default: nothing.
    #[schemars(length(max = 8))]
    pub psf: Option<Vec<PsfComponent>>,
    /// When rows are exposed. Default: all at once.
    pub shutter: Option<Shutter>,
    /// Rays a pixel is averaged over: a square number.
    #[serde(default = "four")]
    #[schemars(range(min = 1, max = 1024))]
    pub samples_per_pixel: u32,
    /// Wavelengths between which the camera is sensitive, within 100 to 20 000 nm. Default: the whole spectrum.
    pub band_nm: Option<(f64, f64)>,
    /// Instead of `band_nm` a file of two columns: wavelength in nm, and the share of the light that counts, 0 to 1, of
    /// filters and detector together. `detector.quantum_efficiency` is then that where the share is 1.
    pub response: Option<String>,
    /// Focal length over the diameter of the aperture. Default: 4.
    #[schemars(range(min = 0.5, max = 128.0))]
    pub f_number: Option<f64>,
    /// Share of the light that the lens lets through. Default: 1.
    #[schemars(range(min = 1e-6, max = 1.0))]
    pub transmission: Option<f64>,
    /// Exposure time, of a scanner that of a line. Its middle is the exposure's epoch. Default: 1 ms.
    #[schemars(range(min = 1e-9, max = 3600.0))]
    pub exposure_s: Option<f64>,
    /// Chooses the exposure time of each image by its light. It needs a detector. Default: `exposure_s` holds.
    pub auto_exposure: Option<AutoExposure>,
    /// Motion blur: moments of the exposure at which the scene is rendered and averaged, each from its own pose. An odd
    /// number: the middle one is the ground truth's. An image takes as many times as long. 1 is a scene that stands still.
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 255))]
    pub moments: u32,
}

fn four() -> u32 {
    4
}

fn one() -> u32 {
    1
}

/// A known camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Preset {
    /// Narrow angle camera (left) of the Lunar Reconnaissance Orbiter: a line scanner.
    LroNac,
    /// Wide angle camera of the same, 643 nm: a push-frame camera.
    LroWac,
    /// Terrain Camera 1 of Kaguya: a line scanner.
    KaguyaTc,
    /// Metric (mapping) camera of Apollo 15, as scanned at 200 pixels a millimetre and reduced tenfold.
    ApolloMetric,
    /// Navigation camera 1 of OSIRIS-REx.
    OsirisRexNavCam,
    /// A landing camera like those that flew: 1024 pixels square, 45° wide, 12 bits. No camera in particular.
    Descent,
}

/// Where the boresight meets the image.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PrincipalPoint {
    /// Columns from the left edge of the image.
    #[schemars(range(min = -65536.0, max = 65536.0))]
    pub column: f64,
    /// Rows from the top edge of the image.
    #[schemars(range(min = -65536.0, max = 65536.0))]
    pub row: f64,
}

/// Lens distortion: OpenCV's polynomial, from undistorted to distorted.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Distortion {
    /// Radial, r².
    #[schemars(range(min = -100.0, max = 100.0))]
    pub k1: f64,
    /// Radial, r⁴.
    #[schemars(range(min = -100.0, max = 100.0))]
    pub k2: f64,
    /// Tangential.
    #[schemars(range(min = -10.0, max = 10.0))]
    pub p1: f64,
    /// Tangential.
    #[schemars(range(min = -10.0, max = 10.0))]
    pub p2: f64,
    /// Radial, r⁶.
    #[schemars(range(min = -100.0, max = 100.0))]
    pub k3: f64,
}

/// Lens distortion as missions publish it, on the focal plane in millimetres from the principal point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Correction {
    /// ideal = measured (1 + k0 + k1 r² + k2 r⁴ + k3 r⁶), r the measured distance.
    Radial {
        /// Radial, constant.
        #[serde(default)]
        #[schemars(range(min = -0.5, max = 0.5))]
        k0: f64,
        /// Radial, per mm².
        #[serde(default)]
        #[schemars(range(min = -1.0, max = 1.0))]
        k1: f64,
        /// Radial, per mm⁴.
        #[serde(default)]
        #[schemars(range(min = -1.0, max = 1.0))]
        k2: f64,
        /// Radial, per mm⁶.
        #[serde(default)]
        #[schemars(range(min = -1.0, max = 1.0))]
        k3: f64,
    },
    /// x_ideal = x / (1 + k x²) along the rows; columns stay (LROC NAC).
    AcrossTrack {
        /// Per mm².
        #[schemars(range(min = -1.0, max = 1.0))]
        k: f64,
    },
}

/// How the focal plane darkens towards the image's edge.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Vignetting {
    /// By the fourth power of the cosine of the angle with the boresight.
    Cos4,
    /// Not at all.
    Off,
    /// 1 + a2 r² + a4 r⁴ + a6 r⁶ in place of it, r from the principal point in halves of the image's diagonal.
    Polynomial {
        /// Of r².
        #[schemars(range(min = -10.0, max = 10.0))]
        a2: f64,
        /// Of r⁴.
        #[serde(default)]
        #[schemars(range(min = -10.0, max = 10.0))]
        a4: f64,
        /// Of r⁶.
        #[serde(default)]
        #[schemars(range(min = -10.0, max = 10.0))]
        a6: f64,
    },
}

/// What spreads the light of a point. Energy is kept; light from beyond the image's edges is rendered and falls into it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum PsfComponent {
    /// A bell.
    Gaussian {
        /// Its standard deviation along an axis, in pixels.
        #[schemars(range(min = 0.05, max = 12.0))]
        sigma_px: f64,
    },
    /// Diffraction at the round aperture of `f_number`. It needs `pixel_pitch_um`.
    Airy {
        /// The wavelength. Default: the middle of `band_nm`.
        #[serde(default)]
        #[schemars(range(min = 100.0, max = 20_000.0))]
        wavelength_nm: Option<f64>,
    },
    /// A point out of focus: an even disc.
    Defocus {
        /// Of the disc, in pixels.
        #[schemars(range(min = 0.05, max = 64.0))]
        diameter_px: f64,
    },
    /// A measured kernel: the share of a pixel's light in each pixel around it, as the image lies, of any scale. Sides are odd,
    /// 97 at most. It comes after the others, wherever it stands.
    Kernel {
        /// A grey image (PNG, TIFF, …) or numbers in lines (.csv), looked for as all files are.
        path: String,
    },
}

/// When rows are exposed. Times count from the exposure's epoch, which is the middle of the image's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Shutter {
    /// All at once.
    Global,
    /// Row after row of a frame.
    Rolling {
        /// From one row to the next.
        #[schemars(range(min = 0.0, max = 10.0))]
        line_time_s: f64,
        /// Neighbouring rows that share a pose, to render faster; the record says what that moves at most, in pixels.
        #[serde(default = "one")]
        #[schemars(range(min = 1, max = 16384))]
        rows_per_pose: u32,
        /// The row that is exposed first.
        #[serde(default)]
        first: First,
    },
    /// One line of pixels again and again while the camera moves: each row of the image is a line.
    LineScan {
        /// From one line to the next.
        #[schemars(range(min = 0.0, max = 10.0))]
        line_time_s: f64,
        /// The line that is exposed first.
        #[serde(default)]
        first: First,
    },
    /// A few rows again and again while the camera moves.
    PushFrame {
        /// From one framelet to the next.
        #[schemars(range(min = 0.0, max = 10_000.0))]
        interval_s: f64,
        /// Rows of a framelet; `rows` is a whole number of them.
        #[schemars(range(min = 1, max = 16384))]
        framelet_rows: u32,
        /// The framelet that is exposed first.
        #[serde(default)]
        first: First,
    },
}

/// Where an image begins in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum First {
    /// At its first row.
    #[default]
    Top,
    /// At its last row.
    Bottom,
}

/// Exposes each image so that its bright pixels fill the detector as far as asked.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AutoExposure {
    /// How far: electrons over the full well, or over what the largest digital number stands for where that is less.
    #[schemars(range(min = 0.01, max = 1.0))]
    pub level: f64,
    /// Share of the lit pixels that are no brighter than that.
    #[schemars(range(min = 0.01, max = 1.0))]
    pub quantile: f64,
    /// No exposure is shorter.
    #[schemars(range(min = 1e-9, max = 3600.0))]
    pub shortest_s: f64,
    /// No exposure is longer.
    #[schemars(range(min = 1e-9, max = 3600.0))]
    pub longest_s: f64,
}

impl Default for AutoExposure {
    fn default() -> Self {
        Self { level: 0.7, quantile: 0.995, shortest_s: 1e-6, longest_s: 1.0 }
    }
}
