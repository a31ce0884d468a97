//! The formats in which a dataset can be had besides OpenEXR, PNG and JSON.

use serde::{Deserialize, Serialize};

/// Files for the readers of other fields. Each is written where it is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema)]
pub enum Format {
    /// `exposure_0007.fits`: planes as image extensions, with `DATE-OBS`, `EXPTIME`, `BUNIT`, camera, pose, Sun and kernels.
    Fits,
    /// `exposure_0007.npz`: planes, camera matrix and pose as arrays for `numpy.load`.
    Npz,
    /// `exposure_0007.ortho.tif`: planes on a map, as a GeoTIFF with its reference system.
    GeoTiff,
    /// `sequence_0000.kitti.txt`, `.times.txt`, `.calib.txt`: poses relative to the first camera, as in KITTI's odometry.
    Kitti,
    /// `sequence_0000.tum.txt`: poses from camera to body, as in TUM's benchmark.
    Tum,
    /// `sequence_0000.oem`: a CCSDS orbit ephemeris message.
    Oem,
    /// `sequence_0000.aem`: a CCSDS attitude ephemeris message.
    Aem,
}
