//! Image sequences on disk.
//!
//! ```text
//! exposure_0007.exr    planes, 32-bit floats, one channel each; units and the record in the header
//! exposure_0007.tif    the same as pages of a TIFF, on request; other formats on request: [`Format`]
//! exposure_0007.png    preview, 16 bits, linear; white is the same for the whole sequence
//! exposure_0007.landmarks.json   craters as ellipses and conics, on request ([`crate::labels`])
//! exposure_0007.landmarks.png    the preview with the ellipses drawn over it, on request
//! exposure_0007.json   record: epoch, poses, Sun, inputs, hashes of the files above
//! dataset_card.md      what the dataset is, how it was made, inputs and licences, conventions, limits
//! manifest.json        versions, inputs, settings, exposures with their hashes
//! poses.csv            camera and Sun, one line an exposure
//! contact_sheet.png    all previews, 8 bits, gamma 2.2, each with its index
//! preview.gif          the previews in order
//! ```
//!
//! Every file is written whole or not at all ([`crate::files`]): no half-written file carries a final name. A record
//! is written after the files it names: an exposure is finished when its record is there, carries the key of the
//! run, and the files have the hashes that it states. Nothing on disk depends on the time of day, on the number of
//! threads or on the order in which exposures were finished: same scenario, same bytes.

mod animation;
mod card;
mod coco;
mod contact_sheet;
pub mod disk;
mod error;
mod exr_blocks;
mod exr_file;
mod fits_file;
mod format;
mod inspect;
mod landmarks;
mod manifest;
mod npz_file;
mod png_file;
mod poses;
mod preview;
mod record;
mod sequences;
mod tiff_file;
mod writer;

pub use disk::{check_writable, write as write_whole};
pub use error::DatasetError;
pub use exr_file::{ExrFile, read_exr, write_exr};
pub use format::Format;
pub use inspect::inspect;
pub use landmarks::LandmarkFile;
pub use manifest::{Input, Manifest, ManifestEntry, PreviewScale, Run, commit};
pub use preview::White;
pub use record::{
    BodyRecord, CameraEffects, CameraRecord, DetectorRecord, EpochRecord, ExposureMetadata, FileRecord, InputRecords,
    PlaneRecord, PoseRecord, PreviewRecord, QualityRecord, RadiometryRecord, Record, RowPose, SensorRecord,
    SoftwareRecord, SplitRecord, Statistics, SunRecord, SweepRecord, WarningRecord,
};
pub use writer::{Exposure, Orthoimage, Settings, Summary, Writer};
