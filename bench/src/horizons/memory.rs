//! Memory of making a tile, in a process of its own.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::tiles::Scratch;
use crate::{Error, Table, Value};
use perilune_engine::report::machine::peak_memory_mib_of;

/// How often a process is asked for its peak.
const EVERY: Duration = Duration::from_millis(5);

/// The table that [`rows`] fill.
pub fn table() -> Table {
    Table::new(
        "memory",
        "Peak memory of a tile in its own process",
        &[("nodes", ""), ("horizons", ""), ("time", "s"), ("peak memory", "MiB")],
    )
}

/// Peak memory of `program horizon` on a synthetic terrain of `nodes²`, by each method.
pub fn rows(program: &Path, nodes: usize, azimuths: usize) -> Result<Vec<Vec<Value>>, Error> {
    let folder = Scratch::new()?;
    let (terrain, side) = (folder.path.join("terrain.tif"), nodes.to_string());
    let start = |arguments: &[&str], files: &[&Path]| {
        let mut command = Command::new(program);
        command.args(arguments).args(files).stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().map_err(|source| Error::Program { path: program.into(), source })
    };
    let finished =
        |mut child: std::process::Child| child.wait().map_err(|source| Error::Program { path: program.into(), source });
    finished(start(&["terrain", "--columns", &side, "--rows", &side, "-o"], &[&terrain])?)?;
    let mut rows = Vec::new();
    for (label, method) in [("swept", "sweep"), ("exact", "exact")] {
        let begin = Instant::now();
        let azimuths = azimuths.to_string();
        let arguments = ["horizon", "--method", method, "--azimuths", &azimuths, "-o"];
        let mut child = start(&arguments, &[&folder.path, &terrain])?;
        let mut peak_mib = None;
        while let Ok(None) = child.try_wait() {
            peak_mib = peak_memory_mib_of(child.id()).or(peak_mib);
            std::thread::sleep(EVERY);
        }
        let whole = finished(child)?.success();
        let row = [Some(begin.elapsed().as_secs_f64()), peak_mib].map(|figure| Value::from(figure.filter(|_| whole)));
        rows.push([vec![(nodes as f64).into(), label.into()], row.into()].concat());
    }
    Ok(rows)
}
