//! Every encoding on the same horizons: error of the skyline, of hard shadows and of penumbras, and what it costs.
//!
//! The truth is the sweep over all nodes of a patch in 360 azimuths, whose own error is a hundredth of what compression
//! does ([`perilune_engine::horizon::sweep`]). Shadows are those of Fritsch et al. (2025): at a fixed elevation of the Sun, over 180
//! azimuths, a node is lit where its horizon is below the Sun's centre; the *pixel error rate* is the share of wrong ones.
//! The structural similarity is that of the binary images, with uniform windows of 8² nodes each 4 nodes in place of
//! Gaussian ones.
//!
//! With a *band* horizons are clamped about the Sun's elevation before the fit ([`perilune_engine::horizon::band`]), as for a
//! scenario whose Sun stays there.
//!
//! # References
//! Fritsch et al. (2025), doi:10.2312/hpg.20251171, section 4.2. Wang et al. (2004), *Image quality assessment*,
//! doi:10.1109/TIP.2003.819861.

mod patch;
mod summary;

use super::shadows::{SUN_ELEVATIONS_DEG, shadows, sun_radius_rad};
use crate::scenes::Scene;
use crate::{Error, Table, Value};
use perilune_engine::horizon::band::MARGIN_RADII;
use perilune_engine::horizon::{Encoding, Settings};
use perilune_engine::pipeline::Progress;

pub use patch::{Patch, Suns, decoded};
use patch::{bounds, stored_bytes};
pub use summary::{plot, summarise};

/// What all others are compared with.
const BASELINE: &str = "fm16";
/// Every second of the swept azimuths has a Sun.
pub const SUNS: usize = 180;
pub const AZIMUTHS: usize = 2 * SUNS;
/// Encodings whose sums are those of the first one, or the first of them.
const FITS: [&[Encoding]; 7] = [
    &[Encoding::Fm16, Encoding::Fm12, Encoding::Fm8, Encoding::Fm4],
    &[Encoding::F16, Encoding::F12, Encoding::F8, Encoding::F4],
    &[Encoding::Raw8],
    &[Encoding::Raw12],
    &[Encoding::Raw16],
    &[Encoding::W21, Encoding::W16, Encoding::W11],
    &[Encoding::Q],
];
/// Those that are measured with a band as well.
const BANDED: [Encoding; 3] = [Encoding::Fm16, Encoding::W16, Encoding::W21];
/// Those whose files are measured on larger patches.
const FILES: [&[Encoding]; 3] = [&[Encoding::Fm16], &[Encoding::W11], &[Encoding::Q]];

/// The tables that [`measure`] fills, and those that [`summarise`] makes of them.
#[derive(Debug)]
pub struct Tables {
    pub figures: Table,
    pub ratios: Table,
    pub scenes: Table,
    pub files: Table,
    pub shadows: Table,
    pub horizons: Table,
}

impl Default for Tables {
    fn default() -> Self {
        Self::new()
    }
}

impl Tables {
    pub fn new() -> Self {
        let shadows = [
            ("scene", ""),
            ("encoding", ""),
            ("Sun elevation", "deg"),
            ("pixel error rate", "%"),
            ("ratio to fm16", ""),
            ("penumbra RMS", "share of the disc"),
            ("ratio to fm16 ", ""),
            ("RMS everywhere", "share of the disc"),
            ("ratio to fm16  ", ""),
        ];
        let horizons = [
            ("scene", ""),
            ("encoding", ""),
            ("in memory", "B/pixel"),
            ("on disk", "B/pixel"),
            ("RMS", "deg"),
            ("p95", "deg"),
            ("p99", "deg"),
            ("max", "deg"),
            ("structural similarity at 6 deg", ""),
        ];
        Self {
            figures: summary::figures(),
            ratios: summary::ratios(),
            scenes: summary::scenes(),
            files: summary::files(),
            shadows: Table::new("encodings_shadows", "Encodings: shadows against uncompressed horizons", &shadows),
            horizons: Table::new("encodings", "Encodings: bytes and horizons", &horizons),
        }
    }

    pub fn in_order(&self) -> Vec<Table> {
        [&self.figures, &self.ratios, &self.scenes, &self.files, &self.shadows, &self.horizons].map(Table::clone).into()
    }
}

/// Measures all encodings on one scene.
pub fn measure(scene: &Scene, tables: &mut Tables, progress: &dyn Progress) -> Result<(), Error> {
    let trials = Encoding::ALL.len() + SUN_ELEVATIONS_DEG.len() * BANDED.len();
    progress.begin(&format!("encodings of {}", scene.name), trials, "encodings");
    let patch = Patch::of(scene, &settings());
    let truth = patch.suns();
    let mut rows = Vec::new();
    for family in FITS {
        let [shadows, horizons] = tried(scene, &patch, &truth, family)?;
        rows.extend(shadows);
        tables.horizons.rows.extend(horizons);
        progress.at(rows.len() / SUN_ELEVATIONS_DEG.len(), trials);
    }
    for (done, sun_deg) in SUN_ELEVATIONS_DEG.into_iter().enumerate() {
        let reach_rad = (1.0 + MARGIN_RADII) * sun_radius_rad();
        let [low, high] = [-reach_rad, reach_rad].map(|reach_rad| (sun_deg.to_radians() + reach_rad) as f32);
        for family in FITS {
            let banded: Vec<_> = family.iter().filter(|encoding| BANDED.contains(encoding)).collect();
            let Some(widest) = banded.first() else { continue };
            let sums = patch.fitted(**widest, |elevation_rad| elevation_rad.clamp(low, high));
            for encoding in banded {
                let tried = decoded(&sums.narrowed(*encoding).map(), &settings());
                rows.push(shadow_row(scene, &format!("{encoding}, band"), sun_deg, &truth, &tried)?);
            }
        }
        progress.at(Encoding::ALL.len() + (done + 1) * BANDED.len(), trials);
    }
    summary::compare(&mut rows);
    tables.shadows.rows.extend(rows);
    Ok(())
}

/// Measures those encodings of which a file is asked for.
pub fn measure_files(scene: &Scene, tables: &mut Tables, progress: &dyn Progress) -> Result<(), Error> {
    progress.begin(&format!("files of {}", scene.name), 1, "scene");
    let patch = Patch::of(scene, &settings());
    let truth = patch.suns();
    let mut rows = Vec::new();
    for family in FILES {
        let [shadows, horizons] = tried(scene, &patch, &truth, family)?;
        rows.extend(shadows);
        tables.files.rows.extend(horizons.into_iter().map(|row| row[..4].to_vec()));
    }
    summary::compare(&mut rows);
    tables.files.rows.iter_mut().filter(|row| row.len() == 4).for_each(|row| {
        let ratios = summary::scene_row(&rows, &row[0].text(), &row[1].text());
        row.extend(summary::MEANS.map(|column| ratios[column].clone()));
    });
    Ok(())
}

/// Rows of shadows and of horizons for encodings whose sums are those of the first one.
fn tried(scene: &Scene, patch: &Patch, truth: &Suns, family: &[Encoding]) -> Result<[Vec<Vec<Value>>; 2], Error> {
    let sums = patch.fitted(family[0], |elevation_rad| elevation_rad);
    let (mut rows, mut horizons) = (Vec::new(), Vec::new());
    for encoding in family {
        let mut map = sums.narrowed(*encoding).map();
        let tried = decoded(&map, &settings());
        map.bounds = bounds(&map, truth, &tried);
        let sizes = [map.bytes() as f64, stored_bytes(scene, settings(), &map)?];
        horizons.push(patch.horizon_row(scene, *encoding, sizes, truth, &tried));
        for sun_deg in SUN_ELEVATIONS_DEG {
            rows.push(shadow_row(scene, encoding.name(), sun_deg, truth, &tried)?);
        }
    }
    Ok([rows, horizons])
}

fn settings() -> Settings {
    Settings { azimuths: AZIMUTHS, ..Settings::default() }
}

fn shadow_row(scene: &Scene, label: &str, sun_deg: f64, truth: &Suns, tried: &Suns) -> Result<Vec<Value>, Error> {
    let found = shadows(truth, tried, sun_deg.to_radians())?;
    let mut row = vec![scene.name.as_str().into(), label.into(), sun_deg.into()];
    for error in [100.0 * found.wrong, found.true_penumbra_rms, found.rms] {
        row.extend([error.into(), Value::Missing]);
    }
    Ok(row)
}
