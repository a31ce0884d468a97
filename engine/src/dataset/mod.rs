//! Image sequences on disk.
//!
//! ```text
//! exposure_0007.exr    planes, 32-bit floats, one channel each; units and the record in the header
//! exposure_0007.tif    the same as pages of a TIFF, on request; other formats on request: [`Format`]
//! exposure_0007.png    preview for eyes, 8 bits, sRGB; white is the same for the whole sequence
//! exposure_0007.landmarks.json   craters as ellipses and conics, on request ([`crate::labels`])
//! exposure_0007.landmarks.png    the preview with the ellipses drawn over it, on request
//! exposure_0007.json   record: epoch, poses, Sun, inputs, hashes of the files above
//! dataset_card.md      what the dataset is, how it was made, inputs and licences, conventions, limits
//! manifest.json        versions, inputs, settings, exposures with their hashes
//! poses.csv            camera and Sun, one line an exposure
//! contact_sheet.png    all previews, each with its index
//! preview.gif          the previews in order
//! ```
//!
//! Every file is written whole or not at all ([`crate::files`]): no half-written file carries a final name. The manifest is
//! there before the first exposure: from then on the names of the sequence are the program's. A record is written after the
//! files it names: an exposure is finished when its record is there, carries the keys of the run and of the exposure, and the
//! files have the hashes that it states. Keys are hashes of what shapes the pixels: comments, titles and the number of exposures
//! are no part of them. What belongs to another run, or to nobody, is written over only where the user says so
//! ([`folder::Existing`]).
//!
//! Any number of processes may render exposures of one run into one folder. Each writes its exposures; the last to end lists
//! them all. Previews are written with their exposures, on the scale known by then, and again at the end where the brightest
//! exposure came later.
//!
//! Nothing on disk depends on the time of day, on the number of threads or on the order in which exposures were finished: same
//! scenario, same bytes.

mod animation;
mod card;
mod coco;
mod contact_sheet;
mod differences;
pub mod disk;
mod error;
mod exr_blocks;
mod exr_file;
mod fits_file;
mod fits_planes;
pub mod folder;
mod format;
mod inspect;
mod landmarks;
mod manifest;
mod npz_file;
mod plane_statistics;
mod png_file;
mod poses;
mod preview;
mod record;
mod seal;
mod sequences;
mod stored_planes;
mod tiff_file;
mod writer;

pub use disk::{check_writable, write as write_whole};
pub use error::DatasetError;
pub use exr_file::{ExrFile, read_exr, write_exr};
pub use folder::{Existing, Folder, Plan};
pub use format::Format;
pub use inspect::inspect;
pub use landmarks::LandmarkFile;
pub use manifest::{Input, Manifest, ManifestEntry, PreviewScale, Run, commit, model};
pub use plane_statistics::Statistics;
pub use preview::White;
pub use record::{
    BodyRecord, CameraEffects, CameraRecord, DetectorRecord, EpochRecord, ExposureMetadata, FileRecord, InputRecords,
    PlaneRecord, PoseRecord, PreviewRecord, QualityRecord, RadiometryRecord, Record, RowPose, SensorRecord,
    SoftwareRecord, SplitRecord, SunRecord, SweepRecord, WarningRecord,
};
pub use writer::{Exposure, Orthoimage, Settings, State, Summary, Writer};
