//! Every encoding on the same horizons: error of the skyline, of hard shadows and of penumbras, and what it costs.
//!
//! The truth is the sweep over all nodes of a patch in 360 azimuths, whose own error is a hundredth of what compression
//! does ([`crate::horizon::sweep`]). Shadows are those of Fritsch et al. (2025): at a fixed elevation of the Sun, over 180
//! azimuths, a node is lit where its horizon is below the Sun's centre; the *pixel error rate* is the share of wrong ones.
//! The structural similarity is that of the binary images, with uniform windows of 8² nodes each 4 nodes in place of Gaussian ones.
//!
//! With a *band* horizons are clamped about the Sun's elevation before the fit ([`crate::horizon::band`]), as for a
//! scenario whose Sun stays there.
//!
//! # References
//! Fritsch et al. (2025), doi:10.2312/hpg.20251171, section 4.2. Wang et al. (2004), *Image quality assessment*,
//! doi:10.1109/TIP.2003.819861.

use glam::DVec2;
use rayon::prelude::*;

use super::shadows::{SUN_ELEVATIONS_DEG, shadows, sun_radius_rad};
use super::tiles::Scratch;
use crate::evaluate::plot::{Axis, Curve, Plot};
use crate::evaluate::scenes::Scene;
use crate::evaluate::statistics::Errors;
use crate::evaluate::{Error, Table, Value};
use crate::horizon::band::MARGIN_RADII;
use crate::horizon::decode::Decoder;
use crate::horizon::fit::{Accumulator, Plane};
use crate::horizon::store::{self, Header};
use crate::horizon::sweep::Sweep;
use crate::horizon::sweep::grid::Major;
use crate::horizon::{Encoding, HorizonMap, Request, Settings};
use crate::pipeline::Progress;

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
/// Elevation and every how many azimuths of the images whose similarity is measured.
const SIMILARITY: (f64, usize) = (6.0, 15);

/// The tables that [`measure`] fills, and their summary.
#[derive(Debug)]
pub struct Tables {
    pub shadows: Table,
    pub horizons: Table,
    pub ratios: Table,
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
        let ratios = [
            ("encoding", ""),
            ("in memory", "B/pixel"),
            ("pixel error rate, mean", "of fm16"),
            ("worst scene", "of fm16"),
            ("penumbra RMS, mean", "of fm16"),
            ("worst scene ", "of fm16"),
        ];
        Self {
            shadows: Table::new("encodings_shadows", "Encodings: shadows against uncompressed horizons", &shadows),
            horizons: Table::new("encodings", "Encodings: bytes and horizons", &horizons),
            ratios: Table::new("encodings_ratios", "Encodings: mean over the Sun's elevations and all scenes", &ratios),
        }
    }
}

/// Measures all encodings on one scene.
pub fn measure(scene: &Scene, tables: &mut Tables, progress: &dyn Progress) -> Result<(), Error> {
    let settings = Settings { azimuths: AZIMUTHS, ..Settings::default() };
    let trials = Encoding::ALL.len() + SUN_ELEVATIONS_DEG.len() * BANDED.len();
    progress.begin(&format!("encodings of {}", scene.name), trials, "encodings");
    let patch = Patch::of(scene, &settings);
    let truth = patch.suns();
    let mut rows = Vec::new();
    for family in FITS {
        let sums = patch.fitted(family[0], |elevation_rad| elevation_rad);
        for encoding in family.iter() {
            let map = sums.narrowed(*encoding).map();
            let tried = decoded(&map, &settings);
            let sizes = [map.bytes() as f64, stored_bytes(scene, settings, &map)?];
            tables.horizons.rows.push(patch.horizon_row(scene, *encoding, sizes, &truth, &tried));
            for sun_deg in SUN_ELEVATIONS_DEG {
                rows.push(shadow_row(scene, encoding.name(), sun_deg, &truth, &tried)?);
            }
            progress.at(rows.len() / SUN_ELEVATIONS_DEG.len(), trials);
        }
    }
    for (done, sun_deg) in SUN_ELEVATIONS_DEG.into_iter().enumerate() {
        let reach_rad = (1.0 + MARGIN_RADII) * sun_radius_rad();
        let [low, high] = [-reach_rad, reach_rad].map(|reach_rad| (sun_deg.to_radians() + reach_rad) as f32);
        for family in FITS {
            let banded: Vec<_> = family.iter().filter(|encoding| BANDED.contains(encoding)).collect();
            let Some(widest) = banded.first() else { continue };
            let sums = patch.fitted(**widest, |elevation_rad| elevation_rad.clamp(low, high));
            for encoding in banded {
                let tried = decoded(&sums.narrowed(*encoding).map(), &settings);
                rows.push(shadow_row(scene, &format!("{encoding}, band"), sun_deg, &truth, &tried)?);
            }
        }
        progress.at(Encoding::ALL.len() + (done + 1) * BANDED.len(), trials);
    }
    compare(&mut rows);
    tables.shadows.rows.extend(rows);
    Ok(())
}

fn shadow_row(scene: &Scene, label: &str, sun_deg: f64, truth: &Suns, tried: &Suns) -> Result<Vec<Value>, Error> {
    let found = shadows(truth, tried, sun_deg.to_radians())?;
    let mut row = vec![scene.name.as_str().into(), label.into(), sun_deg.into()];
    row.extend([(100.0 * found.wrong).into(), Value::Missing, found.penumbra.rms.into(), Value::Missing]);
    Ok(row)
}

/// Fills in the ratios to the baseline at the same elevation of the Sun.
fn compare(rows: &mut [Vec<Value>]) {
    let baseline: Vec<_> = rows.iter().filter(|row| row[1].text() == BASELINE).cloned().collect();
    for row in rows {
        let Some(base) = baseline.iter().find(|base| base[2] == row[2]) else { continue };
        for column in [3, 5] {
            row[column + 1] = (number(&row[column]) / number(&base[column])).into();
        }
    }
}

fn number(value: &Value) -> f64 {
    match value {
        Value::Number(number) => *number,
        Value::Text(_) | Value::Missing => f64::NAN,
    }
}

/// The summary: ratios averaged over the elevations, then over the scenes.
pub fn summarise(tables: &mut Tables) {
    let mut labels: Vec<String> = Vec::new();
    for row in &tables.shadows.rows {
        if !labels.contains(&row[1].text()) {
            labels.push(row[1].text());
        }
    }
    for label in labels {
        let name = label.split(',').next().unwrap_or_default();
        let bytes = name.parse::<Encoding>().map_or(f64::NAN, Encoding::bytes_per_pixel);
        let mut row = vec![label.as_str().into(), bytes.into()];
        for column in [4, 6] {
            let scenes = by_scene(&tables.shadows.rows, &label, column);
            let mean = scenes.iter().sum::<f64>() / scenes.len() as f64;
            row.extend([mean, scenes.into_iter().fold(0.0, f64::max)].map(Value::from));
        }
        tables.ratios.rows.push(row);
    }
}

/// Means over the Sun's elevations of a column, by scene.
fn by_scene(rows: &[Vec<Value>], label: &str, column: usize) -> Vec<f64> {
    let mut scenes: Vec<(String, Vec<f64>)> = Vec::new();
    for row in rows.iter().filter(|row| row[1].text() == label) {
        let (scene, value) = (row[0].text(), number(&row[column]));
        match scenes.last_mut() {
            Some((last, values)) if *last == scene => values.push(value),
            _ => scenes.push((scene, vec![value])),
        }
    }
    scenes.into_iter().map(|(_, values)| values.iter().sum::<f64>() / values.len() as f64).collect()
}

/// Ratio of the pixel error rates over bytes in memory.
pub fn plot(tables: &Tables) -> Plot {
    let mut curves: Vec<Curve> = Vec::new();
    for row in &tables.ratios.rows {
        let name: String = row[0].text().chars().filter(|c| !c.is_ascii_digit()).collect();
        if curves.last().is_none_or(|curve| curve.name != name) {
            curves.push(Curve { name, points: Vec::new(), joined: true });
        }
        let point = [number(&row[1]), number(&row[2])];
        curves.last_mut().expect("pushed above").points.push(point);
    }
    Plot {
        title: "Pixel error rate of encodings, mean over scenes and Sun elevations".into(),
        x: Axis::linear("bytes per pixel"),
        y: Axis::logarithmic("ratio to fm16"),
        curves,
    }
}

/// Elevations of all nodes towards the Suns, `[Sun][node]`.
pub type Suns = Vec<Vec<f32>>;

/// Uncompressed horizons of all nodes of a patch.
#[derive(Debug)]
pub struct Patch {
    pub columns: usize,
    pub rows: usize,
    /// In the order of their azimuths.
    pub planes: Vec<Plane>,
}

impl Patch {
    pub fn of(scene: &Scene, settings: &Settings) -> Self {
        let level = &scene.face.levels[0];
        let (columns, rows) = (level.columns - 2 * level.margin, level.rows - 2 * level.margin);
        let mut planes = Vec::new();
        for major in [Major::Row, Major::Column] {
            let sweep = Sweep::new(&scene.face, 0, major, settings);
            let stride = sweep.receivers.stride;
            let along = (0..settings.azimuths).filter(|azimuth| Major::of(settings.direction(*azimuth)) == major);
            let plane = |azimuth: usize| {
                let swept_rad = sweep.elevations_rad(settings.direction(azimuth));
                let at = |node: usize| match major {
                    Major::Row => node / columns * stride + node % columns,
                    Major::Column => node % columns * stride + node / columns,
                };
                let elevations_rad = (0..columns * rows).map(|node| swept_rad[at(node)]).collect();
                Plane { azimuth, stride: columns, elevations_rad }
            };
            planes.extend(along.collect::<Vec<_>>().into_par_iter().map(plane).collect::<Vec<_>>());
        }
        planes.sort_by_key(|plane| plane.azimuth);
        Self { columns, rows, planes }
    }

    pub fn nodes(&self) -> usize {
        self.columns * self.rows
    }

    /// At the azimuths of the Suns.
    pub fn suns(&self) -> Suns {
        self.planes.iter().step_by(AZIMUTHS / SUNS).map(|plane| plane.elevations_rad.clone()).collect()
    }

    /// Sums of what matters of the horizons.
    pub fn fitted(&self, encoding: Encoding, relevant: impl Fn(f32) -> f32 + Sync) -> Accumulator {
        let mut sums = Accumulator::new(encoding, self.columns, self.rows, self.planes.len());
        for planes in self.planes.chunks(16) {
            let clamped = |plane: &Plane| Plane {
                elevations_rad: plane.elevations_rad.iter().map(|elevation_rad| relevant(*elevation_rad)).collect(),
                ..*plane
            };
            sums.add(&planes.par_iter().map(clamped).collect::<Vec<_>>(), Major::Row);
        }
        sums
    }

    fn horizon_row(
        &self,
        scene: &Scene,
        encoding: Encoding,
        sizes: [f64; 2],
        truth: &Suns,
        tried: &Suns,
    ) -> Vec<Value> {
        let pairs = truth.iter().flatten().zip(tried.iter().flatten());
        let errors = Errors::of(pairs.map(|(truth, tried)| f64::from(tried - truth)));
        let mut row = vec![scene.name.as_str().into(), encoding.name().into()];
        row.extend(sizes.map(|bytes| Value::from(bytes / self.nodes() as f64)));
        row.extend([errors.rms, errors.p95, errors.p99, errors.max].map(|rad| Value::from(rad.to_degrees())));
        row.push(self.similarity(truth, tried).into());
        row
    }

    /// Mean structural similarity of hard shadows.
    fn similarity(&self, truth: &Suns, tried: &Suns) -> f64 {
        let (sun_deg, every) = SIMILARITY;
        let sun_rad = sun_deg.to_radians() as f32;
        let image = |suns: &Suns, sun: usize| -> Vec<bool> { suns[sun].iter().map(|h| *h < sun_rad).collect() };
        let suns: Vec<usize> = (0..SUNS).step_by(every).collect();
        let all = suns.par_iter().map(|sun| similarity(self.columns, &image(truth, *sun), &image(tried, *sun)));
        all.sum::<f64>() / suns.len() as f64
    }
}

/// What a map decodes to at its nodes, towards the Suns.
pub fn decoded(map: &HorizonMap, settings: &Settings) -> Suns {
    let directions: Vec<DVec2> = (0..AZIMUTHS).step_by(AZIMUTHS / SUNS).map(|i| settings.direction(i)).collect();
    let decoder = Decoder::new(map, &directions);
    let rows: Vec<Vec<f32>> = (0..map.rows).into_par_iter().map(|row| decoder.row(row)).collect();
    let towards = |sun: usize| rows.iter().flat_map(|row| &row[sun * map.columns..][..map.columns]).copied().collect();
    (0..SUNS).into_par_iter().map(towards).collect()
}

/// Size of the tile's file.
fn stored_bytes(scene: &Scene, settings: Settings, map: &HorizonMap) -> Result<f64, Error> {
    let folder = Scratch::new()?;
    let request = Request { body: &scene.body, face: &scene.face, level: 0, settings, encoding: map.encoding };
    store::write(&folder.path.join("tile.tif"), &Header::new(&request, map), map)?;
    Ok(folder.bytes() as f64)
}

/// Structural similarity of two binary images, averaged over windows.
fn similarity(columns: usize, a: &[bool], b: &[bool]) -> f64 {
    const WINDOW: usize = 8;
    const APART: usize = 4;
    /// (0.01)² and (0.03)² for values from 0 to 1.
    const C: [f64; 2] = [1e-4, 9e-4];
    let rows = a.len() / columns;
    let (mut sum, mut windows) = (0.0, 0.0);
    for top in (0..=rows.saturating_sub(WINDOW)).step_by(APART) {
        for left in (0..=columns.saturating_sub(WINDOW)).step_by(APART) {
            let nodes =
                (top..top + WINDOW).flat_map(|row| (left..left + WINDOW).map(move |column| row * columns + column));
            let mut counts = [0.0; 3];
            for node in nodes {
                let lit = [a[node], b[node], a[node] && b[node]];
                counts.iter_mut().zip(lit).for_each(|(count, lit)| *count += f64::from(u8::from(lit)));
            }
            let [a, b, both] = counts.map(|count| count / (WINDOW * WINDOW) as f64);
            let (variances, covariance) = (a - a * a + b - b * b, both - a * b);
            let means = (2.0 * a * b + C[0]) / (a * a + b * b + C[0]);
            sum += means * (2.0 * covariance + C[1]) / (variances + C[1]);
            windows += 1.0;
        }
    }
    sum / windows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_images_are_similar_by_one_and_opposite_halves_by_less_than_nothing() {
        let left: Vec<bool> = (0..64).map(|node| node % 8 < 4).collect();
        let right: Vec<bool> = left.iter().map(|lit| !lit).collect();
        assert!((similarity(8, &left, &left) - 1.0).abs() < 1e-12);
        // Equal means, and a covariance of −1/4 beside variances of 1/4 each.
        assert!((similarity(8, &left, &right) + 0.4991 / 0.5009).abs() < 1e-9);
    }

    #[test]
    fn ratios_are_to_the_baseline_at_the_same_elevation() {
        let row = |label: &str, sun: f64, wrong: f64| {
            vec!["a".into(), label.into(), sun.into(), wrong.into(), Value::Missing, wrong.into(), Value::Missing]
        };
        let mut tables = Tables::new();
        tables.shadows.rows =
            vec![row("fm16", 3.0, 2.0), row("fm16", 6.0, 4.0), row("w21", 3.0, 1.0), row("w21", 6.0, 1.0)];
        compare(&mut tables.shadows.rows);
        summarise(&mut tables);
        assert_eq!(tables.ratios.rows[0][2], Value::Number(1.0));
        assert_eq!(
            tables.ratios.rows[1],
            vec!["w21".into(), 21.25.into(), 0.375.into(), 0.375.into(), 0.375.into(), 0.375.into()]
        );
    }
}
