//! `sim cache`.

use std::collections::BTreeMap;
use std::time::SystemTime;

use clap::Subcommand;
use perilune_engine::dataset::folder::plural;
use perilune_engine::files::cache::{self, Entry, Kind, Removed};
use serde_json::{Value as Json, json};

use super::common::{CacheArgs, limit_bytes};
use super::{Outcome, print_line};

/// List and clean the folder in which made terrain and horizons are kept.
///
/// It is `--cache`, else `SIM_CACHE`, else `perilune` in the user's folder of caches (XDG_CACHE_HOME, ~/.cache). After each
/// run what was used longest ago is removed until 10 GB are left, or as many as `SIM_CACHE_GB` says. All of it can be made again.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

const EXAMPLES: &str = "\
Examples:
  sim cache ls                what is kept, what was used longest ago first
  sim cache clean             all of it but what a process at work uses
  sim cache clean --keep 2    what was used longest ago, until 2 GB are left
  du -sh $(sim cache path)    the folder";

#[derive(Debug, Subcommand)]
enum Action {
    /// List what is kept
    Ls(Place),
    /// Remove what is kept, but nothing that a process at work uses
    Clean {
        #[command(flatten)]
        place: Place,
        /// Remove what was used longest ago only, until so many GB are left
        #[arg(long, value_name = "GB", default_value_t = 0.0, value_parser = gigabytes)]
        keep: f64,
    },
    /// Print the folder
    Path(Place),
}

#[derive(Debug, clap::Args)]
struct Place {
    #[command(flatten)]
    cache: CacheArgs,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

fn gigabytes(text: &str) -> Result<f64, String> {
    let size = text.parse::<f64>().ok().filter(|size| size.is_finite() && *size >= 0.0);
    size.ok_or_else(|| format!("want a size in GB, as in 2.5, got {text}"))
}

pub fn run(args: Args) -> Outcome {
    match args.action {
        Action::Ls(place) => list(&place),
        Action::Clean { place, keep } => clean(&place, keep),
        Action::Path(place) => {
            let folder = place.cache.place();
            match place.json {
                true => print_line(format_args!("{:#}", json!({ "folder": folder })))?,
                false => print_line(folder.display())?,
            }
            Ok(())
        }
    }
}

fn list(place: &Place) -> Outcome {
    let (folder, limit) = (place.cache.place(), limit_bytes()?);
    let entries = cache::entries(&folder);
    let bytes: u64 = entries.iter().map(|entry| entry.bytes).sum();
    let name = |entry: &Entry| entry.path.strip_prefix(&folder).unwrap_or(&entry.path).display().to_string();
    if place.json {
        let described = |entry: &Entry| json!({ "name": name(entry), "kind": entry.kind.name(), "bytes": entry.bytes, "unused_s": unused_s(entry) });
        let entries: Vec<Json> = entries.iter().map(described).collect();
        let all = json!({ "folder": folder, "bytes": bytes, "limit_bytes": limit, "entries": entries });
        return Ok(print_line(format_args!("{all:#}"))?);
    }
    let mut kinds: BTreeMap<Kind, (usize, u64)> = BTreeMap::new();
    for entry in &entries {
        let (files, bytes) = kinds.entry(entry.kind).or_default();
        *files += 1;
        *bytes += entry.bytes;
        print_line(format_args!("{:>10}  {:>12}  {}", size(entry.bytes), ago(unused_s(entry)), name(entry)))?;
    }
    for (kind, (files, bytes)) in kinds {
        print_line(format_args!("{:>10}  {:>12}  {}", size(bytes), plural(files, "file"), kind.name()))?;
    }
    print_line(format_args!("{} of at most {} in {}", size(bytes), size(limit), folder.display()))?;
    Ok(())
}

fn clean(place: &Place, keep_gb: f64) -> Outcome {
    let folder = place.cache.place();
    let Removed { files, bytes } = cache::trim(&folder, (keep_gb * 1e9) as u64);
    let left: u64 = cache::entries(&folder).iter().map(|entry| entry.bytes).sum();
    if place.json {
        let all = json!({ "folder": folder, "removed_files": files, "removed_bytes": bytes, "bytes": left });
        return Ok(print_line(format_args!("{all:#}"))?);
    }
    let removed = format_args!("{} removed, {}", plural(files, "file"), size(bytes)).to_string();
    print_line(format_args!("{removed}; {} left in {}", size(left), folder.display()))?;
    Ok(())
}

fn unused_s(entry: &Entry) -> u64 {
    SystemTime::now().duration_since(entry.used).unwrap_or_default().as_secs()
}

fn size(bytes: u64) -> String {
    match bytes as f64 {
        bytes if bytes < 1e6 => format!("{:.1} kB", bytes / 1e3),
        bytes if bytes < 1e9 => format!("{:.1} MB", bytes / 1e6),
        bytes => format!("{:.2} GB", bytes / 1e9),
    }
}

fn ago(seconds: u64) -> String {
    match seconds {
        0..120 => format!("{seconds} s ago"),
        120..7200 => format!("{} min ago", seconds / 60),
        7200..172_800 => format!("{} h ago", seconds / 3600),
        _ => format!("{} days ago", seconds / 86_400),
    }
}
