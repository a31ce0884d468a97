//! The formats in which a dataset can be had besides PNG and JSON.

use serde::{Deserialize, Serialize};

/// Files for the readers of other fields. Each is written where it is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema)]
pub enum Format {
    /// `exposure_0007.exr`: planes as 32-bit floats, lossless, compressed. Written too where no other format of all planes
    /// (Fits, Npz) is named.
    Exr,
    /// `exposure_0007.fits`: planes as image extensions, with `DATE-OBS`, `EXPTIME`, `BUNIT`, camera, pose, Sun and kernels.
    Fits,
    /// `exposure_0007.npz`: planes, camera matrix and pose as arrays for `numpy.load`.
    Npz,
    /// `exposure_0007.linear.png`: the plane of the preview in 16 bits, linear, on the preview's scale.
    Png16,
    /// `exposure_0007.ortho.tif`: planes on a map, as a GeoTIFF with its reference system.
    GeoTiff,
    /// `annotations.coco.json`: craters with bounding box, mask, ellipse, conic and flags; needs `landmarks`.
    Coco,
    /// `craters.csv`: ellipses in the columns of NASA's crater detection challenge; needs `landmarks`.
    CraterChallenge,
    /// `sequence_0000.kitti.txt`, `.times.txt`, `.calib.txt`: poses relative to the first camera, as in KITTI's odometry.
    Kitti,
    /// `sequence_0000.tum.txt`: poses from camera to body, as in TUM's benchmark.
    Tum,
    /// `sequence_0000.oem`: a CCSDS orbit ephemeris message.
    Oem,
    /// `sequence_0000.aem`: a CCSDS attitude ephemeris message.
    Aem,
}

impl Format {
    /// Whether OpenEXR is written where these formats are asked for: by name, or because nothing else would hold all planes.
    pub fn writes_exr(formats: &[Self]) -> bool {
        formats.contains(&Self::Exr) || !formats.iter().any(|format| matches!(format, Self::Fits | Self::Npz))
    }

    /// Its files and what they hold, for the dataset's card.
    pub fn about(self) -> &'static str {
        match self {
            Self::Exr => "`exposure_NNNN.exr`: planes, float32, lossless, a channel each",
            Self::Fits => "`exposure_NNNN.fits`: planes as image extensions, row 1 is the top of the image",
            Self::Npz => "`exposure_NNNN.npz`: planes, `K`, pose and Sun as arrays for `numpy.load`",
            Self::Png16 => {
                "`exposure_NNNN.linear.png`: the plane of the preview, 16 bits, linear, DN 65535 is the preview's white"
            }
            Self::GeoTiff => {
                "`exposure_NNNN.ortho.tif`: planes on a stereographic map, a GeoTIFF; where ground is seen"
            }
            Self::Coco => "`annotations.coco.json`: craters with box, mask, ellipse, conic and flags (COCO)",
            Self::CraterChallenge => "`craters.csv`: ellipses in the columns of NASA's crater detection challenge",
            Self::Kitti => {
                "`sequence_NNNN.kitti.txt`, `.times.txt`, `.calib.txt`: poses relative to the first camera (KITTI)"
            }
            Self::Tum => "`sequence_NNNN.tum.txt`: time, place and quaternion, body from camera, scalar last (TUM)",
            Self::Oem => "`sequence_NNNN.oem`: CCSDS orbit ephemeris message, body-fixed frame, TDB",
            Self::Aem => "`sequence_NNNN.aem`: CCSDS attitude ephemeris message, camera from body, scalar last, TDB",
        }
    }
}
