//! `sim kernels`.

use std::path::PathBuf;

use perilune_engine::ephemeris::{Kernel, Kind, default_span, make_default_kernels, parse_epoch, utc_text};
use serde_json::json;

use super::{Outcome, print_line};

/// Make the default kernels and list what a kernel covers.
///
/// Kernels are SPICE's: files that say where bodies are (.bsp) and how they are turned and shaped (.bpc, .tpc).
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: sim kernels list kernels/perilune_2020_2040.bsp")]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// Write the default kernels: Sun, Earth, Moon and Mars from analytic series, and their constants.
    Make {
        /// First epoch, with its scale
        #[arg(long, default_value_t = utc_text(default_span().0))]
        from: String,
        /// Last epoch, with its scale
        #[arg(long, default_value_t = utc_text(default_span().1))]
        until: String,
        /// Folder to write into
        #[arg(short, long, default_value = "kernels")]
        output: PathBuf,
    },
    /// Print the segments, bodies, frames and epochs of kernel files.
    List {
        #[arg(required = true)]
        files: Vec<PathBuf>,
        /// One JSON object a file, one line a file
        #[arg(long)]
        json: bool,
    },
}

pub fn run(args: Args) -> Outcome {
    match args.command {
        Command::Make { from, until, output } => {
            for path in make_default_kernels(&output, parse_epoch(&from)?, parse_epoch(&until)?)? {
                let kernel = Kernel::open(&path)?;
                print_line(format_args!(
                    "{}  {} bytes  sha256 {}",
                    path.display(),
                    std::fs::metadata(&path)?.len(),
                    kernel.sha256
                ))?;
            }
        }
        Command::List { files, json } => {
            for path in files {
                let kernel = Kernel::open(&path)?;
                if json {
                    print_line(as_json(&kernel))?;
                } else {
                    print_line(kernel.describe().join("\n"))?;
                }
            }
        }
    }
    Ok(())
}

fn as_json(kernel: &Kernel) -> serde_json::Value {
    let segments: Vec<_> = kernel
        .segments
        .iter()
        .map(|segment| {
            let [from_utc, until_utc] = segment.span_utc();
            json!({
                "kind": if segment.kind == Kind::Spk { "position" } else { "orientation" },
                "name": segment.name,
                "target_id": segment.target_id,
                "center_id": segment.center_id,
                "inertial_frame_id": segment.inertial_frame_id,
                "data_type": segment.data_type,
                "from_utc": from_utc,
                "until_utc": until_utc,
            })
        })
        .collect();
    json!({
        "path": kernel.path.display().to_string(),
        "format": format!("{:?}", kernel.format),
        "sha256": kernel.sha256,
        "segments": segments,
        "constants_of": kernel.constants_of,
        "fixed_frames": kernel.fixed_frames,
    })
}
