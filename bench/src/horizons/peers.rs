//! GRASS' `r.horizon` on the same terrain and the same core.
//!
//! It gets the terrain on a transverse Mercator grid of the Moon's sphere, so that its projection of every sample stays cheap,
//! and no limit of distance. Its own time on a core counts, the start of GRASS and the reading of files do not.
//! It bends light about a sphere of Earth's radius and samples the nearest cell: its horizons differ, its work is the same.
//!
//! # References
//! Hofierka, Huld & Šúri, *r.horizon*, GRASS GIS; the radius is a constant of its source.

use std::path::Path;
use std::process::Command;

use super::speed::searched;
use super::tiles::Scratch;
use crate::scenes::Scene;
use crate::{Error, Table, Value};
use perilune_engine::horizon::{Method, Settings};
use perilune_engine::raster::{GeoTiff, GeoTiffBand};
use perilune_engine::statistics::median;

/// The table that [`rows`] fill.
pub fn table() -> Table {
    Table::new(
        "peers",
        "Beside GRASS r.horizon, in turns on one core",
        &[
            ("scene", ""),
            ("program", ""),
            ("runs", ""),
            ("median", "M samples/s/core"),
            ("slowest", "M samples/s/core"),
            ("fastest", "M samples/s/core"),
            ("over GRASS", ""),
        ],
    )
}

/// Whether GRASS is installed.
pub fn grass_version() -> Option<String> {
    let output = Command::new("grass").arg("--version").output().ok()?;
    // It names itself on standard error.
    let text = String::from_utf8([output.stdout, output.stderr].concat()).ok()?;
    Some(text.lines().next()?.trim().to_owned()).filter(|line| !line.is_empty())
}

/// Speeds of `r.horizon`, the sweep and the exact search, run in turns; `None` where GRASS does not do it.
pub fn rows(scene: &Scene, settings: &Settings, runs: usize) -> Result<Option<Vec<Vec<Value>>>, Error> {
    let folder = Scratch::new()?;
    let level = &scene.face.levels[0];
    if !prepare(scene, &folder.path)? {
        return Ok(None);
    }
    let pinned = Pinned::to_first_core();
    let mut speeds = [Vec::new(), Vec::new(), Vec::new()];
    for run in 0..runs {
        // Oblique azimuths, as most are.
        let Some(seconds) = horizon_seconds(&folder.path, 17 + 67 * run) else { return Ok(None) };
        speeds[0].push((level.columns * level.rows) as f64 / seconds * 1e-6);
        for (method, speeds) in [Method::Sweep, Method::Exact].into_iter().zip(&mut speeds[1..]) {
            speeds.push(searched(scene, &Settings { method, ..*settings }, 12, run)?);
        }
    }
    drop(pinned);
    let theirs = median(speeds[0].clone()).unwrap_or(f64::NAN);
    let row = |(label, speeds): (&str, Vec<f64>)| {
        let ends = [f64::min, f64::max].map(|end| speeds.iter().copied().reduce(end));
        let middle = median(speeds);
        let mut row = vec![scene.name.as_str().into(), label.into(), (runs as f64).into()];
        row.extend([middle, ends[0], ends[1], middle.map(|ours| ours / theirs)].map(Value::from));
        row
    };
    Ok(Some(["GRASS r.horizon", "swept", "exact"].into_iter().zip(speeds).map(row).collect()))
}

/// A GRASS location with the terrain in it.
fn prepare(scene: &Scene, folder: &Path) -> Result<bool, Error> {
    let level = &scene.face.levels[0];
    let path = folder.join("terrain.tif");
    let values: Vec<f32> = (0..level.rows)
        .rev()
        .flat_map(|row| &level.heights_m[row * level.columns..][..level.columns])
        .copied()
        .collect();
    let west_m = level.west_m - 0.5 * level.posting_m;
    let north_m = level.south_m + (level.rows as f64 - 0.5) * level.posting_m;
    let radius_m = scene.face.map.radius_m;
    let raster = GeoTiff {
        columns: level.columns,
        rows: level.rows,
        bands: vec![GeoTiffBand { name: "height", unit: "m", values: &values }],
        crs: &format!("+proj=tmerc +lat_0=0 +lon_0=0 +k=1 +x_0=0 +y_0=0 +R={radius_m} +units=m +no_defs"),
        geotransform: [west_m, level.posting_m, 0.0, north_m, 0.0, -level.posting_m],
    };
    raster.write(&path)?;
    let created = Command::new("grass").args(["-e", "-c"]).arg(&path).arg(folder.join("location")).output();
    let import = format!("r.in.gdal --quiet input='{}' output=terrain && g.region raster=terrain", path.display());
    Ok(created.is_ok_and(|output| output.status.success()) && grass(folder, &import).is_some())
}

/// What a shell command says inside the location.
fn grass(folder: &Path, command: &str) -> Option<String> {
    let mut grass = Command::new("grass");
    grass.arg(folder.join("location/PERMANENT")).args(["--exec", "bash", "-c", command]);
    let output = grass.output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout))
}

/// Seconds on a core of one azimuth of all pixels.
fn horizon_seconds(folder: &Path, azimuth_deg: usize) -> Option<f64> {
    let work =
        format!("r.horizon --quiet --overwrite elevation=terrain direction={} output=horizon", azimuth_deg % 360);
    let said = grass(folder, &format!("TIMEFORMAT='spent %U'; time {work}"))?;
    let time = said.lines().find_map(|line| line.trim().strip_prefix("spent "))?;
    time.trim().parse().ok().filter(|seconds| *seconds > 0.0)
}

/// This thread, and what it starts, on the machine's first core until dropped, where `taskset` is installed.
struct Pinned {
    thread: Option<String>,
}

impl Pinned {
    fn to_first_core() -> Self {
        let link = std::fs::read_link("/proc/thread-self").ok();
        let thread = link.and_then(|path| Some(path.file_name()?.to_str()?.to_owned()));
        let pinned = Self { thread };
        pinned.set("0");
        pinned
    }

    fn set(&self, cores: &str) {
        if let Some(thread) = &self.thread {
            // Without it the machine places both programs alike.
            let _ = Command::new("taskset").args(["-c", "-p", cores, thread]).output();
        }
    }
}

impl Drop for Pinned {
    fn drop(&mut self) {
        let last = std::thread::available_parallelism().map_or(0, |cores| cores.get() - 1);
        // The thread itself sees one core now; the file system knows all.
        let all = std::fs::read_to_string("/sys/devices/system/cpu/online");
        self.set(all.as_deref().map_or(last.to_string().as_str(), str::trim));
    }
}
