//! Long commands killed, interrupted and starved: what has a final name is whole, and the command given again makes the same
//! bytes as one that nothing disturbed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Instant;

use tempfile::TempDir;

use super::run::SMALL;

/// A command of some seconds, and the folders in which its results lie.
struct Long {
    name: &'static str,
    arguments: &'static [&'static str],
    results: &'static [&'static str],
    /// Names of results that hold no times.
    compared: fn(&str) -> bool,
    again: &'static [&'static str],
}

const DEM: [&str; 10] =
    ["terrain", "-o", "dem.tif", "--columns", "160", "--rows", "160", "--at", "-89,20", "--smallest=200"];

fn is_tile(name: &str) -> bool {
    name.ends_with(".tif")
}

const LONG: [Long; 4] = [
    Long {
        name: "run",
        arguments: &["run", "small.ron", "-o", "out", "--cache", "cache", "--adapter", "cpu"],
        results: &["out", "cache/horizon", "cache/terrain"],
        compared: |_| true,
        again: &["--resume"],
    },
    Long {
        name: "horizon",
        arguments: &["horizon", "dem.tif", "-o", "out", "--azimuths", "180"],
        results: &["out"],
        compared: is_tile,
        again: &[],
    },
    Long {
        name: "globe",
        arguments: &[
            "horizon",
            "globe",
            "globe.tif",
            "-o",
            "out",
            "--cells",
            "16",
            "--margin",
            "40",
            "--azimuths",
            "40",
            "--check",
            "2",
        ],
        results: &["out"],
        compared: is_tile,
        again: &[],
    },
    Long {
        name: "illuminate",
        arguments: &[
            "illuminate",
            "dem.tif",
            "-o",
            "out",
            "--cache",
            "cache",
            "--encoding",
            "fm16",
            "--from",
            "2026-01-01Z",
            "--until",
            "2026-02-01Z",
            "--step",
            "2h",
            "--at",
            "-89,20",
            "--azimuths",
            "90",
            "--check",
            "4",
        ],
        results: &["out", "cache/horizon"],
        compared: |name| is_tile(name) || name.ends_with(".csv"),
        again: &[],
    },
];

/// A height every 12° of latitude and longitude, in degrees.
fn write_globe(path: &Path) {
    let (columns, rows) = (60, 30);
    let height = |index: usize| 2000.0 * (((index * 7919) % 1013) as f32 / 1013.0);
    let values: Vec<f32> = (0..columns * rows).map(height).collect();
    let bands = vec![perilune_engine::raster::GeoTiffBand { name: "height", unit: "m", values: &values }];
    let crs = "+proj=eqc +lat_ts=0 +lon_0=0 +R=1737400 +units=m +no_defs";
    let step_m = std::f64::consts::TAU * 1_737_400.0 / columns as f64;
    let geotransform = [-step_m * 30.0, step_m, 0.0, step_m * 15.0, 0.0, -step_m];
    perilune_engine::raster::GeoTiff { columns, rows, bands, crs, geotransform }.write(path).unwrap();
}

/// What commands start from.
fn inputs() -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("small.ron"), SMALL).unwrap();
    let made = Command::new(env!("CARGO_BIN_EXE_sim")).args(DEM).current_dir(folder.path()).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    write_globe(&folder.path().join("globe.tif"));
    folder
}

fn copied(inputs: &Path) -> TempDir {
    let folder = TempDir::new().unwrap();
    for name in ["small.ron", "dem.tif", "globe.tif"] {
        std::fs::copy(inputs.join(name), folder.path().join(name)).unwrap();
    }
    folder
}

/// All files below a folder, by their paths from another.
fn collect(from: &Path, folder: &Path, found: &mut BTreeMap<PathBuf, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(from, &path, found);
        } else {
            found.insert(path.strip_prefix(from).unwrap().into(), std::fs::read(&path).unwrap());
        }
    }
}

impl Long {
    fn command(&self, folder: &Path, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sim"));
        command.args(self.arguments).args(more).current_dir(folder).stdout(Stdio::null()).stderr(Stdio::piped());
        command
    }

    /// Under limits of the shell, as in `ulimit -f 8`.
    fn limited(&self, folder: &Path, limit: &str) -> Output {
        let mut command = Command::new("sh");
        let script = format!("trap '' XFSZ; {limit}; exec \"$@\"");
        command.args(["-c", &script, "sh", env!("CARGO_BIN_EXE_sim")]).args(self.arguments).current_dir(folder);
        command.output().unwrap()
    }

    fn succeed(&self, folder: &Path, more: &[&str]) {
        let output = self.command(folder, more).output().unwrap();
        assert!(output.status.success(), "{}: {}", self.name, String::from_utf8_lossy(&output.stderr));
    }

    /// Results by name, without temporary files.
    fn results(&self, folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut found = BTreeMap::new();
        for name in self.results {
            collect(folder, &folder.join(name), &mut found);
        }
        found.retain(|path, _| {
            let name = path.file_name().unwrap().to_str().unwrap();
            !name.starts_with('.') && (self.compared)(name)
        });
        found
    }

    /// Whether what a stopped command has left under final names is whole: tiles and planes are those of the whole run.
    fn assert_whole(&self, folder: &Path, whole: &BTreeMap<PathBuf, Vec<u8>>, when: &str) {
        for (path, bytes) in self.results(folder) {
            let changes = ["json", "png", "csv", "gif", "md", "checkpoint"]
                .iter()
                .any(|end| path.to_string_lossy().ends_with(end));
            assert!(
                changes || whole.get(&path) == Some(&bytes),
                "{} {when}: {} is not whole",
                self.name,
                path.display()
            );
        }
    }

    fn assert_same(&self, folder: &Path, whole: &BTreeMap<PathBuf, Vec<u8>>, when: &str) {
        let results = self.results(folder);
        let names = whole.keys().chain(results.keys());
        let differing: Vec<_> = names.filter(|name| whole.get(*name) != results.get(*name)).collect();
        assert!(differing.is_empty(), "{} {when}: {differing:?}", self.name);
    }
}

/// Numbers in [0, 1) that a seed gives.
fn moments(seed: u64, count: usize) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        // Knuth's MMIX.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1_u64 << 31) as f64
    };
    (0..count).map(|_| next()).collect()
}

/// Kills a command at moments of its time, by SIGKILL and SIGINT in turn, and gives it again; how many were stopped before their
/// end.
fn interrupted(long: &Long, inputs: &Path, seed: u64, count: usize) -> usize {
    let reference = copied(inputs);
    let start = Instant::now();
    long.succeed(reference.path(), &[]);
    let (took, whole) = (start.elapsed(), long.results(reference.path()));
    assert!(!whole.is_empty(), "{}", long.name);
    let mut stopped = 0;
    for (index, moment) in moments(seed, count).into_iter().enumerate() {
        let folder = copied(inputs);
        let mut child = long.command(folder.path(), &[]).spawn().unwrap();
        std::thread::sleep(took.mul_f64(moment));
        let by_hand = index % 2 == 1;
        if by_hand {
            Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        } else {
            child.kill().unwrap();
        }
        let output = child.wait_with_output().unwrap();
        let when = format!("stopped at {moment:.3} of its time");
        // By the signal itself where it came before anybody listened.
        if let Some(code) = output.status.code().filter(|code| by_hand && *code != 0) {
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(code, 130, "{} {when}: {said}", long.name);
            assert!(said.contains("interrupted: ") && said.contains("sim "), "{} {when}: {said}", long.name);
        }
        stopped += usize::from(!output.status.success());
        long.assert_whole(folder.path(), &whole, &when);
        long.succeed(folder.path(), long.again);
        long.assert_same(folder.path(), &whole, &when);
    }
    stopped
}

#[test]
#[cfg(unix)]
fn long_commands_stopped_twice_each_make_the_same_bytes_when_given_again() {
    let inputs = inputs();
    let stopped: usize = LONG.iter().map(|long| interrupted(long, inputs.path(), 1, 2)).sum();
    assert!(stopped >= 3, "only {stopped} of 8 were stopped before their end");
}

/// Minutes: `cargo test --release --test perilune -- --ignored stopped_ten_times`.
#[test]
#[ignore = "minutes"]
#[cfg(unix)]
fn long_commands_stopped_ten_times_each_make_the_same_bytes_when_given_again() {
    let inputs = inputs();
    for (seed, long) in (10..).zip(&LONG) {
        let stopped = interrupted(long, inputs.path(), seed, 10);
        println!("{}: 10 of 10 make the same bytes, {stopped} stopped before their end", long.name);
    }
}

/// Files of limited size, few descriptors, little memory: an error or the whole result, nothing between, and afterwards the
/// same bytes.
#[test]
#[cfg(target_os = "linux")]
fn limits_leave_whole_files_or_none() {
    let inputs = inputs();
    for long in &LONG {
        let reference = copied(inputs.path());
        long.succeed(reference.path(), &[]);
        let whole = long.results(reference.path());
        for limit in ["ulimit -f 0", "ulimit -f 40", "ulimit -f 200", "ulimit -n 12", "ulimit -v 300000"] {
            let folder = copied(inputs.path());
            let output = long.limited(folder.path(), limit);
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            if output.status.code() == Some(1) {
                assert!(said.contains("error: "), "{} {limit}: {said}", long.name);
            }
            long.assert_whole(folder.path(), &whole, limit);
            long.succeed(folder.path(), long.again);
            long.assert_same(folder.path(), &whole, limit);
        }
    }
}
