//! The record of an exposure: all that is needed to use its planes without the program.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::plane_statistics::Statistics;
use super::seal;
use crate::render::{Image, Quantity};

/// Grows with every change that a reader must know about.
pub const SCHEMA_VERSION: &str = "1.0";

/// `exposure_0007.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    pub schema_version: String,
    /// Hash of all that shapes the pixels of the run; two exposures with one key belong together.
    pub run_key: String,
    /// Hash of the run's key and `made_from`; an exposure with the same key has the same pixels.
    #[serde(default)]
    pub exposure_key: String,
    /// What shapes the pixels of this exposure besides what it shares with the run's others.
    #[serde(default)]
    pub made_from: serde_json::Value,
    #[serde(flatten)]
    pub facts: ExposureMetadata,
    pub planes: Vec<PlaneRecord>,
    /// The preview's scale follows from the whole sequence, so it is filled in last.
    pub preview: Option<PreviewRecord>,
    pub files: Vec<FileRecord>,
    /// Of all that stands before it in the file.
    #[serde(default)]
    pub sha256: String,
}

impl Record {
    /// The file, which ends with the hash of what comes before.
    pub fn text(&self) -> String {
        seal::sealed(&Self { sha256: String::new(), ..self.clone() })
    }

    /// Reads a file; an error says what is wrong with it.
    pub fn parse(text: &str) -> Result<Self, String> {
        let record: Self = serde_json::from_str(text).map_err(|error| error.to_string())?;
        seal::check(text, &record.sha256).map(|()| record)
    }
}

/// What is known of an exposure before it is written.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ExposureMetadata {
    /// `lunar_descent/0007`.
    pub frame_id: String,
    /// Absent: the run has no sweep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<SweepRecord>,
    /// For a first look only: a quarter of the size, one ray a pixel. Absent: the image is what the scenario asks for.
    #[serde(default, skip_serializing_if = "is_false")]
    pub draft: bool,
    /// Absent: the dataset is not split.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub split: Option<SplitRecord>,
    pub epoch: EpochRecord,
    pub body: BodyRecord,
    pub camera: CameraRecord,
    pub pose: PoseRecord,
    pub sun: SunRecord,
    pub radiometry: RadiometryRecord,
    pub sensor: SensorRecord,
    pub inputs: InputRecords,
    pub software: SoftwareRecord,
    pub quality: QualityRecord,
}

/// The point of a sweep that an exposure belongs to.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SweepRecord {
    pub point: usize,
    /// What varies, by its key of the scenario.
    pub values: BTreeMap<String, f64>,
}

/// The part of a dataset that an exposure belongs to.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SplitRecord {
    /// `train`, `validation` or `test`.
    pub part: String,
    /// Row (from the south pole) and column (eastwards from longitude 0) of the ground cell under the boresight.
    pub cell: [u64; 2],
    /// Diameter of what the image shows, at the boresight's ground.
    pub shown_m: f64,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct EpochRecord {
    pub tdb_s_past_j2000: f64,
    /// ISO 8601 with `Z`.
    pub utc: String,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct BodyRecord {
    pub name: String,
    /// Body-fixed frame by its SPICE name.
    pub frame: String,
    /// Of the reference spheroid, along x, y, z.
    pub radii_m: [f64; 3],
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CameraRecord {
    pub model: String,
    pub width: usize,
    pub height: usize,
    /// Row by row, in pixels, for `pixel_origin`.
    #[serde(rename = "K")]
    pub k: [[f64; 3]; 3],
    pub dist_model: String,
    /// k1, k2, p1, p2, k3.
    pub dist_coeffs: Vec<f64>,
    pub pixel_origin: String,
    pub axes: String,
    pub shutter: String,
    /// Effects beyond a pinhole with distortion that stands still; absent where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub effects: Option<CameraEffects>,
}

/// What lens and motion do to the image.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CameraEffects {
    /// One after the other, in pixels; and the share of their light beyond their ends, given back in proportion.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub psf: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub psf_cut_off: Option<f64>,
    /// How the focal plane darkens, where not by the fourth power of the cosine.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vignetting: Option<String>,
    /// Motion blur: moments of the exposure whose light is averaged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moments: Option<u32>,
    /// What rows that share a pose are off by, at most, in pixels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shared_pose_error_px: Option<f64>,
    /// Planes that carry these effects; all others belong to the middle of the exposure, unblurred.
    pub planes: String,
}

impl CameraRecord {
    /// A pinhole in OpenCV's convention. The principal point is given from the outer corner of the top left pixel,
    /// half a pixel from where OpenCV counts.
    pub fn opencv(size: [usize; 2], focal_length_px: f64, principal_point_px: [f64; 2], distortion: [f64; 5]) -> Self {
        let [column, row] = principal_point_px.map(|from_corner| from_corner - 0.5);
        Self {
            model: "pinhole".into(),
            width: size[0],
            height: size[1],
            k: [[focal_length_px, 0.0, column], [0.0, focal_length_px, row], [0.0, 0.0, 1.0]],
            dist_model: "opencv k1 k2 p1 p2 k3".into(),
            dist_coeffs: distortion.to_vec(),
            pixel_origin: "the centre of the top left pixel is (0, 0)".into(),
            axes: "+x right, +y down, +z along the boresight".into(),
            shutter: "global, instantaneous".into(),
            effects: None,
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PoseRecord {
    /// Camera from the body's centre, body-fixed.
    pub r_body_fixed_m: [f64; 3],
    /// Velocity against the turning body.
    pub v_body_fixed_m_s: [f64; 3],
    /// Scalar first, Hamilton's; turns body-fixed components into camera components.
    pub q_wxyz: [f64; 4],
    pub q_direction: String,
    pub latitude_deg: f64,
    pub longitude_east_deg: f64,
    /// Above the reference spheroid.
    pub height_m: f64,
    /// Of the image's rows in the middle of their exposures, the top first, where they are not exposed together.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rows: Vec<RowPose>,
}

/// From where some rows of an image are seen, up to the next entry's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RowPose {
    pub first_row: usize,
    /// From the image's epoch.
    pub t_s: f64,
    pub r_body_fixed_m: [f64; 3],
    pub q_wxyz: [f64; 4],
}

impl Default for PoseRecord {
    fn default() -> Self {
        Self {
            r_body_fixed_m: [0.0; 3],
            v_body_fixed_m_s: [0.0; 3],
            q_wxyz: [1.0, 0.0, 0.0, 0.0],
            q_direction: "camera_from_body".into(),
            latitude_deg: 0.0,
            longitude_east_deg: 0.0,
            height_m: 0.0,
            rows: Vec::new(),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SunRecord {
    /// Apparent, from the body's centre or the terrain's, as `seen_from` says.
    pub direction_body_fixed: [f64; 3],
    pub seen_from: String,
    pub distance_m: f64,
    pub angular_radius_rad: f64,
    /// In the sky of the terrain's centre, clockwise from north; absent without terrain.
    pub azimuth_deg: Option<f64>,
    pub elevation_deg: Option<f64>,
    /// `uniform`, or the law and its wavelength.
    pub limb_darkening: String,
    /// Share of the Sun's light that the Earth leaves; absent where that was not asked.
    pub eclipse_share: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RadiometryRecord {
    /// Of the plane `radiance`.
    pub unit: String,
    /// The table that the irradiance comes from.
    pub spectrum: String,
    pub irradiance_1au_w_m2: f64,
    /// At the Sun's distance; what an eclipse leaves of it.
    pub irradiance_w_m2: f64,
    /// Absent: the whole spectrum.
    pub band_nm: Option<[f64; 2]>,
    /// Absent: the same between the ends of the band, or the whole spectrum.
    pub response: Option<String>,
    /// The response's integral: radiance over it is radiance per nanometre.
    pub band_width_nm: Option<f64>,
    /// Mean of the sunlight in the band, weighted by energy; photons are counted at it.
    pub mean_wavelength_nm: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SensorRecord {
    pub seed: u64,
    pub exposure_s: f64,
    pub f_number: f64,
    pub transmission: f64,
    pub samples_per_pixel: u32,
    /// Absent: an ideal sensor.
    pub gain_e_per_dn: Option<f64>,
    /// Absent: no digital numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detector: Option<DetectorRecord>,
    /// How the exposure time was chosen; absent: by the scenario.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub auto_exposure: Option<String>,
}

/// EMVA 1288: what made digital numbers of light.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DetectorRecord {
    pub quantum_efficiency: f64,
    pub wavelength_nm: f64,
    pub pixel_pitch_um: f64,
    pub dark_current_e_per_s: f64,
    pub read_noise_e: f64,
    pub prnu: f64,
    pub dsnu_e: f64,
    pub full_well_e: f64,
    pub blooming: bool,
    pub gain_e_per_dn: f64,
    pub offset_dn: f64,
    pub bits: u32,
    /// To what the random numbers belong.
    pub noise: String,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct InputRecords {
    pub dem_sha256: Vec<String>,
    pub horizon_sha256: Vec<String>,
    /// File names.
    pub kernels: Vec<String>,
    /// `constant 0.12`, or the hash of the map.
    pub albedo: String,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SoftwareRecord {
    pub version: String,
    /// Absent: built outside a repository.
    pub commit: Option<String>,
    pub adapter: String,
    pub backend: String,
}

/// What the program knows of its own error; absent where nothing was measured.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct QualityRecord {
    /// Of the compressed horizons.
    pub max_horizon_error_deg: Option<f64>,
    /// Share of ground pixels whose share of the Sun has a standard deviation above 0.01; where that plane is written.
    pub share_uncertain: Option<f64>,
    /// Share of ground pixels without DEM heights.
    pub share_interpolated_dem: Option<f64>,
    /// Share of the detector's pixels that hold no more light; absent: there is no detector.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share_saturated: Option<f64>,
    /// What is odd about the image, with what can be done; absent: nothing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<WarningRecord>,
}

/// What is odd about an image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WarningRecord {
    /// `no_ground`, `no_terrain`, `no_albedo`, `sun_down`, `saturated`, `black`, `no_value`.
    pub kind: String,
    pub text: String,
}

/// One channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlaneRecord {
    pub channel: String,
    pub quantity: Quantity,
    pub unit: String,
    pub statistics: Statistics,
}

/// How a preview shows its plane.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PreviewRecord {
    pub file: FileRecord,
    pub channel: String,
    /// The value of the greatest number, in `unit`.
    pub white: f64,
    pub unit: String,
    pub encoding: String,
    /// The same plane, linear in 16 bits, where it is asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub linear: Option<FileRecord>,
}

impl PreviewRecord {
    pub fn files(&self) -> impl Iterator<Item = &FileRecord> {
        [&self.file].into_iter().chain(&self.linear)
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FileRecord {
    pub name: String,
    pub sha256: String,
    pub bytes: usize,
}

pub fn is_false(value: &bool) -> bool {
    !value
}

pub fn planes(image: &Image) -> Vec<PlaneRecord> {
    let record = |plane: &crate::render::Plane| PlaneRecord {
        channel: plane.name.into(),
        quantity: plane.quantity,
        unit: plane.quantity.unit().into(),
        statistics: Statistics::of(&plane.values),
    };
    image.planes.iter().map(record).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// OpenCV's documentation of `initUndistortRectifyMap`: the centre of an image of n pixels is at (n − 1)/2.
    #[test]
    fn the_principal_point_is_half_a_pixel_from_the_corner_count() {
        let camera = CameraRecord::opencv([1024, 512], 1000.0, [512.0, 256.0], [0.0; 5]);
        assert_eq!((camera.k[0][2], camera.k[1][2]), (511.5, 255.5));
    }
}
