//! What is fuzzed: each reader as a function of bytes that may be anything. `tests/fuzz.rs` feeds it the corpora.
//!
//! A reader may refuse what it gets, in words; it may not end the process, run without end or take memory without bound. What it
//! accepts is used once, since much is only looked at then.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use perilune_engine::camera::Isd;
use perilune_engine::dataset::inspect;
use perilune_engine::ephemeris::aem::Aem;
use perilune_engine::ephemeris::trajectory::{Oem, SpkObject, Trajectory};
use perilune_engine::ephemeris::{Almanac, parse_epoch};
use perilune_engine::horizon::store;
use perilune_engine::labels::Origin;
use perilune_engine::labels::catalogue;
use perilune_engine::photometry::Curve;
use perilune_engine::scenario::{SearchPath, resolve};

/// A reader's name, which is that of its corpus, and the reader.
pub type Target = (&'static str, fn(&[u8]));

/// All readers.
pub const TARGETS: [Target; 10] = [
    ("scenario", scenario),
    ("tile", tile),
    ("daf", daf),
    ("text_kernel", text_kernel),
    ("oem", oem),
    ("aem", aem),
    ("isd", isd),
    ("craters", craters),
    ("curve", curve),
    ("inspect", described),
];

fn text(bytes: &[u8]) -> std::borrow::Cow<'_, str> {
    String::from_utf8_lossy(bytes)
}

/// A file with these bytes, in memory where the system has such a place; one for each thread.
fn file(bytes: &[u8], name: &str) -> PathBuf {
    thread_local!(static FOLDER: RefCell<Option<tempfile::TempDir>> = const { RefCell::new(None) });
    let path = FOLDER.with_borrow_mut(|folder| {
        let memory = Path::new("/dev/shm");
        let make = || if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
        folder.get_or_insert_with(|| make().expect("a folder for files")).path().join(name)
    });
    std::fs::write(&path, bytes).expect("a file of its own");
    path
}

/// A scenario, without any file that it may name.
pub fn scenario(bytes: &[u8]) {
    let nowhere = SearchPath { beside: PathBuf::from("/nowhere"), data: Vec::new() };
    if let Err(error) = resolve(Path::new("a.ron"), &text(bytes), &nowhere, &|_| None) {
        error.to_string();
    }
}

/// A horizon tile, with what is decoded at some of its nodes.
pub fn tile(bytes: &[u8]) {
    let Ok((_, map)) = store::read(&file(bytes, "a.tif")) else { return };
    for node in [glam::DVec2::ZERO, glam::DVec2::new(map.columns as f64, map.rows as f64) * 0.49] {
        map.horizon(node);
        map.bound_rad(node);
    }
}

/// A binary kernel, with a spacecraft's state.
pub fn daf(bytes: &[u8]) {
    kernel(bytes, "a.bsp");
}

/// A text kernel, with the Moon's orientation.
pub fn text_kernel(bytes: &[u8]) {
    kernel(bytes, "a.tpc");
}

const MOON: &str = "KPL/PCK\n\\begindata\nBODY301_RADII = ( 1737.4 1737.4 1737.4 )\nBODY301_POLE_RA = ( 270 0 0 )\n\
                    BODY301_POLE_DEC = ( 66.5 0 0 )\nBODY301_PM = ( 38.3 13.17 0 )\n\\begintext\n";

fn kernel(bytes: &[u8], name: &str) {
    let moon = file(MOON.as_bytes(), "moon.tpc");
    let Ok(almanac) = Almanac::load(&[moon, file(bytes, name)]) else { return };
    let Ok(epoch) = parse_epoch("2009-09-15T07:30:00 TDB") else { return };
    let Ok(frame) = almanac.body_frame("moon", None) else { return };
    let spacecraft = Trajectory::Spk(SpkObject { naif_id: -85 });
    spacecraft.state(&almanac, &frame, epoch).map_err(|error| error.to_string()).ok();
}

/// An orbit ephemeris message.
pub fn oem(bytes: &[u8]) {
    if let Ok(oem) = Oem::parse(Path::new("a.oem"), &text(bytes)) {
        oem.span();
    }
}

/// An attitude ephemeris message.
pub fn aem(bytes: &[u8]) {
    Aem::parse(Path::new("a.aem"), &text(bytes)).map_err(|error| error.to_string()).ok();
}

/// A camera as image support data.
pub fn isd(bytes: &[u8]) {
    let Ok(isd) = Isd::parse(Path::new("a.json"), &text(bytes)) else { return };
    let poses = &isd.camera.poses;
    assert!(poses.iter().all(|pose| pose.position.vector_m().is_finite()), "a pose that is no number");
}

/// A list of craters.
pub fn craters(bytes: &[u8]) {
    catalogue::parse(Path::new("a.csv"), &text(bytes), "", Origin::Catalogue).map_err(|error| error.to_string()).ok();
}

/// A response or spectrum.
pub fn curve(bytes: &[u8]) {
    if let Ok(curve) = Curve::parse(&text(bytes)) {
        assert!(Curve::integral(&[&curve], 0).is_finite(), "an integral that is no number");
    }
}

/// OpenEXR, NPZ, PNG, TIFF, manifests, records.
pub fn described(bytes: &[u8]) {
    inspect(&file(bytes, "a.bin")).map_err(|error| error.to_string()).ok();
}
