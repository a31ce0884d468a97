//! `sim inspect`.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

use perilune_engine::dataset;
use serde_json::Value as Json;

use super::Outcome;

/// Say what a file or a dataset holds: an image (OpenEXR, PNG, TIFF, NPZ), an elevation model, a horizon tile, labels (COCO), a
/// record, a manifest.
///
/// Of a dataset it also says how many exposures are finished, and which files are missing or not those that its manifest names.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// A file, or the directory of a dataset
    file: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  sim inspect output/lunar_descent
  sim inspect output/lunar_descent/exposure_0000.exr";

pub fn run(args: Args) -> Outcome {
    let found = dataset::inspect(&args.file)?;
    let text = if args.json { format!("{found:#}\n") } else { outline(&for_people(found)) };
    std::io::stdout().write_all(text.as_bytes())?;
    Ok(())
}

/// What reads better in words.
fn for_people(mut found: Json) -> Json {
    if let (Some(exposures), Some(planned)) = (found["exposures"].as_u64(), found["exposures_planned"].as_u64()) {
        found["exposures"] = match exposures == planned {
            true => exposures.into(),
            false => format!("{exposures} of {planned}, go on with sim run … --resume").into(),
        };
    }
    if found["missing_or_changed"].as_array().is_some_and(Vec::is_empty) {
        found["missing_or_changed"] = "none".into();
    }
    found
}

/// JSON as an indented outline: `key: value`, lists of plain values on one line.
fn outline(value: &Json) -> String {
    let mut text = String::new();
    write_outline(&mut text, value, 0);
    text
}

fn write_outline(text: &mut String, value: &Json, depth: usize) {
    let indent = "  ".repeat(depth);
    let entries: Vec<(String, &Json)> = match value {
        Json::Object(map) => map.iter().map(|(key, value)| (key.clone(), value)).collect(),
        Json::Array(items) => items.iter().enumerate().map(|(index, item)| (index.to_string(), item)).collect(),
        _ => return,
    };
    for (key, value) in entries {
        match plain(value) {
            Some(plain) => {
                let _ = writeln!(text, "{indent}{key}: {plain}");
            }
            None => {
                let _ = writeln!(text, "{indent}{key}:");
                write_outline(text, value, depth + 1);
            }
        }
    }
}

/// A value that fits on a line: a scalar, a list of scalars, a channel with its statistics.
fn plain(value: &Json) -> Option<String> {
    match value {
        Json::Null => Some("none".into()),
        Json::String(text) if text.contains('\n') => Some(format!("{} lines", text.lines().count())),
        Json::String(text) => Some(text.clone()),
        Json::Array(items) if items.iter().all(|item| !item.is_array() && !item.is_object()) => {
            Some(items.iter().filter_map(plain).collect::<Vec<_>>().join(", "))
        }
        Json::Array(_) => None,
        Json::Object(_) => channel(value),
        scalar => Some(scalar.to_string()),
    }
}

/// `RADIANCE [W m-2 sr-1]  min 0  median 1.5  max 3  (1024 values)`
fn channel(value: &Json) -> Option<String> {
    let (name, statistics) = (value.get("channel")?.as_str()?, value.get("statistics")?);
    let unit = value["unit"].as_str().unwrap_or("?");
    // Values are single precision; more digits would only show its grid.
    let at = |key: &str| statistics[key].as_f64().map_or("none".into(), |number| (number as f32).to_string());
    let [minimum, median, maximum] = ["minimum", "median", "maximum"].map(at);
    let count = &statistics["count"];
    Some(format!("{name} [{unit}]  min {minimum}  median {median}  max {maximum}  ({count} values)"))
}
