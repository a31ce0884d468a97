//! The sources' own experiments, repeated.
//!
//! Each table names the figure or table that it repeats, has the printed number beside ours where one is printed, and a
//! ratio to a baseline of the same run, because machines differ: raw12 for encodings, the middle value for soft shadows, no
//! shadows for presets, 100 uniform steps for searches, a sampled horizon map for single azimuths.
//!
//! | source | repeated |
//! |---|---|
//! | Fritsch et al. (2025) | figures 11 to 14, tables 1 and 3 |
//! | Aslandere et al. (2015) | tables 1 and 2 |
//! | Snyder & Nowrouzezahrai (2008) | figures 3, 4, 6 and 10, table 1 |
//! | Jung et al. (2020) | figures 6 and 13, table 2 |

mod aslandere;
mod frames;
mod fritsch;
mod jung;
mod snyder;

use std::time::Instant;

use super::{Error, Machine, Report};
use perilune_engine::gpu::{Adapter, Gpu};
use perilune_engine::pipeline::Progress;
use perilune_engine::statistics::median;

/// How much to measure.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// Smaller patches and images.
    pub quick: bool,
    /// Frames that are timed with each method.
    pub repeat: usize,
}

/// Repeats all experiments.
pub fn run(options: &Options, progress: &dyn Progress) -> Result<Report, Error> {
    let machine = Machine::here();
    let gpu = Gpu::open(Adapter::Auto).map_err(|error| progress.say(&format!("no GPU method: {error}"))).ok();
    let renderer = gpu.as_ref().map_or("the reference renderer".into(), Gpu::describe);
    let mut tables = frames::tables(options, gpu.as_ref(), progress)?;
    let (figures, mut plots) = fritsch::figures(options, progress)?;
    tables.extend(figures);
    tables.extend(aslandere::tables(options, progress)?);
    tables.extend(snyder::tables(options, gpu.as_ref(), progress)?);
    let (edge, plot) = jung::figure_6()?;
    tables.push(edge);
    plots.push(plot);
    tables.sort_by_key(|table| table.name);
    Ok(Report {
        name: "sources",
        title: "The sources' own experiments, repeated".into(),
        machine,
        notes: vec![
            format!("Frames: {renderer}; least of {}, readback included.", options.repeat),
            "Fritsch's three patches of MOLA are replaced by three generated terrains; Blocks and Peaks are like theirs.".into(),
            "FLIP stands in for LPIPS, whose trained weights cannot be shipped.".into(),
            "Ratios are to the first row of a method's kind; papers' numbers are as printed, on their machines.".into(),
        ],
        tables,
        plots,
        figures: Vec::new(),
    })
}

/// Median seconds of some runs, and what the last one made.
fn timed<T>(runs: usize, mut make: impl FnMut() -> T) -> (f64, T) {
    let mut once = || {
        let start = Instant::now();
        let made = make();
        (start.elapsed().as_secs_f64(), made)
    };
    let (first_s, mut made) = once();
    let mut seconds = vec![first_s];
    for _ in 1..runs {
        let (run_s, again) = once();
        seconds.push(run_s);
        made = again;
    }
    (median(seconds).unwrap_or(f64::NAN), made)
}
