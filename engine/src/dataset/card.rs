//! The dataset's card: for people who find the folder and want to know whether they may trust it.
//!
//! All it says stands in the manifest and the records too; the card says it in words. Like them it depends on nothing but the
//! run, not on the day.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use serde_json::Value as Json;

use super::format::Format;
use super::manifest::{PreviewScale, Run};
use super::record::{ExposureMetadata, PlaneRecord, Record};
use crate::ephemeris::known_file;

/// What a card is written from.
#[derive(Debug, Clone, Copy)]
pub struct Card<'a> {
    pub run: &'a Run,
    pub records: &'a [Record],
    pub planned: usize,
    pub preview: Option<&'a PreviewScale>,
    pub formats: &'a [Format],
    pub tiff: bool,
}

impl Card<'_> {
    /// The card as Markdown.
    pub fn text(&self) -> String {
        let sections = [
            self.what(),
            self.planes(),
            self.how(),
            self.parts(),
            self.files(),
            conventions(),
            self.inputs(),
            self.limits(),
        ];
        let scenario = format!("## Scenario\n\n```ron\n{}\n```\n", self.run.scenario.trim_end());
        sections.into_iter().flatten().chain([scenario]).collect::<Vec<_>>().join("\n")
    }

    fn facts(&self) -> impl Iterator<Item = &ExposureMetadata> {
        self.records.iter().map(|record| &record.facts)
    }

    fn what(&self) -> Option<String> {
        let Run { title, name, body, software, .. } = self.run;
        let commit = software.commit.as_ref().map_or(String::new(), |commit| format!(", commit {commit}"));
        let mut text = format!(
            "# {title}\n\n{} of {} images `{name}`, rendered by Perilune {}{commit} on {}.\n",
            self.records.len(),
            self.planned,
            software.version,
            software.adapter
        );
        if self.run.draft {
            text.push_str(
                "\n**A draft**, for a first look: a quarter of the size, one ray a pixel, the quickest shadows.\n",
            );
        }
        let Some(first) = self.facts().next() else { return Some(text) };
        let epochs: Vec<&str> = self.facts().map(|facts| facts.epoch.utc.as_str()).collect();
        let (earliest, latest) = (epochs.iter().min().unwrap_or(&""), epochs.iter().max().unwrap_or(&""));
        let camera = &first.camera;
        text.push_str("\n| | |\n|---|---|\n");
        let mut row = |key: &str, value: String| text.push_str(&format!("| {key} | {value} |\n"));
        row("body, frame", format!("{}, {}", body.name, body.frame));
        row("images", format!("{} × {} pixels, {}", camera.width, camera.height, camera.model));
        row("epochs", if earliest == latest { (*latest).into() } else { format!("{earliest} to {latest}") });
        row("height above the spheroid", range(self.facts().map(|facts| Some(facts.pose.height_m)), "m"));
        row("Sun above the terrain's centre", range(self.facts().map(|facts| facts.sun.elevation_deg), "°"));
        row("Sun's azimuth there", range(self.facts().map(|facts| facts.sun.azimuth_deg), "°"));
        row("run", format!("`{}`", self.run.key()));
        Some(text)
    }

    fn planes(&self) -> Option<String> {
        let planes: &[PlaneRecord] = &self.records.first()?.planes;
        let mut text = String::from("## Planes\n\n| channel | unit | least | greatest |\n|---|---|---|---|\n");
        for PlaneRecord { channel, unit, .. } in planes {
            let of_all = || self.records.iter().flat_map(|r| &r.planes).filter(|plane| plane.channel == *channel);
            let least = of_all().filter_map(|plane| plane.statistics.minimum).reduce(f32::min);
            let greatest = of_all().filter_map(|plane| plane.statistics.maximum).reduce(f32::max);
            let shown = |value: Option<f32>| value.map_or("none".into(), |value| format!("{value:.4e}"));
            let _ = writeln!(text, "| {channel} | {unit} | {} | {} |", shown(least), shown(greatest));
        }
        Some(text)
    }

    fn how(&self) -> Option<String> {
        let mut text = String::from("## How it was made\n\n");
        let settings = self.run.settings.as_object()?;
        let own_words = |key: &String| ["sweep", "split", "camera_preset", "resampling"].contains(&key.as_str());
        for (key, value) in settings.iter().filter(|(key, value)| !own_words(key) && !value.is_null()) {
            let lines = value.as_array().cloned().unwrap_or_else(|| vec![value.clone()]);
            for line in lines {
                let shown = line.as_str().map_or_else(|| line.to_string(), String::from);
                let _ = writeln!(text, "- {}: {shown}", key.replace('_', " "));
            }
        }
        for (model, line) in (1..).zip(settings.get("resampling").and_then(Json::as_array).into_iter().flatten()) {
            let line = line.as_str().unwrap_or_default().trim_start_matches("resampling: ");
            let _ =
                writeln!(text, "- resampling of model {model}{}: {line}", if model == 1 { ", the finest" } else { "" });
        }
        if let Some(preset) = settings.get("camera_preset") {
            let name = preset["name"].as_str().unwrap_or_default();
            let _ = writeln!(text, "- camera preset: {name}, its figures stand in `manifest.json`");
        }
        if let Some(sensor) = self.facts().next().map(|facts| &facts.sensor) {
            let gain = sensor.gain_e_per_dn.map_or("ideal".into(), |gain| format!("{gain} electrons per DN"));
            let _ = writeln!(text, "- sensor: {gain}, exposure {} s, f/{}", sensor.exposure_s, sensor.f_number);
        }
        let _ = writeln!(text, "- seed of the noise: {}; seeds of terrain stand in the scenario below", self.run.seed);
        if let Some(sweep) = settings.get("sweep") {
            let _ = writeln!(text, "- sweep: {}, all points in `manifest.json`", sweep["design"]);
            let varied: BTreeSet<&String> =
                self.facts().flat_map(|facts| &facts.sweep).flat_map(|s| s.values.keys()).collect();
            for key in varied {
                let values = self.facts().map(|facts| facts.sweep.as_ref()?.values.get(key).copied());
                let _ = writeln!(text, "  - {key}: {}", range(values, ""));
            }
        }
        Some(text)
    }

    fn parts(&self) -> Option<String> {
        let split = self.run.settings.get("split")?;
        let mut parts: BTreeMap<&str, (usize, BTreeSet<[u64; 2]>)> = BTreeMap::new();
        let mut shown_m = 0.0;
        for part in self.facts().filter_map(|facts| facts.split.as_ref()) {
            let (images, cells) = parts.entry(&part.part).or_default();
            *images += 1;
            cells.insert(part.cell);
            shown_m = f64::max(shown_m, part.shown_m);
        }
        let mut text = format!(
            "## Parts\n\nBy place: an image belongs to the part of the ground cell under its boresight, and a cell to the part \
             that the hash of its place draws: `{split}`. Each record names both.\n\n| part | images | cells |\n|---|---|---|\n"
        );
        for (part, (images, cells)) in &parts {
            let _ = writeln!(text, "| {part} | {images} | {} |", cells.len());
        }
        let cell_m = split["cell_m"].as_f64().unwrap_or_default();
        let apart = if shown_m < cell_m {
            "Images of neighbouring cells in different parts share at most the ground along their border; of cells that do not \
             touch, none."
        } else {
            "**Images of neighbouring cells in different parts show the same ground**: use larger cells."
        };
        let _ = writeln!(text, "\nCells are {cell_m} m wide, images up to {shown_m:.0} m at their boresight. {apart}");
        Some(text)
    }

    fn files(&self) -> Option<String> {
        let mut text = String::from(
            "## Files\n\n\
             - `exposure_NNNN.json`: record of epoch, pose, Sun, camera, inputs, hashes\n\
             - `poses.csv`: camera and Sun, a line an exposure\n\
             - `manifest.json`: what made the dataset, from what, all files with their SHA-256\n",
        );
        if let Some(PreviewScale { channel, white, unit }) = self.preview {
            let _ =
                writeln!(text, "- `exposure_NNNN.png`: preview of {channel}, 8 bits, sRGB, white is {white:e} {unit}");
        }
        if self.tiff {
            text.push_str("- `exposure_NNNN.tif`: planes as pages of a TIFF\n");
        }
        let exr = Format::writes_exr(self.formats).then_some(Format::Exr);
        for format in exr.iter().chain(self.formats.iter().filter(|format| **format != Format::Exr)) {
            let _ = writeln!(text, "- {}", format.about());
        }
        Some(text)
    }

    fn inputs(&self) -> Option<String> {
        let mut text = String::from(
            "## Inputs, their sources and licences\n\n| role | file | what | source | licence | SHA-256 |\n|---|---|---|---|---|---|\n",
        );
        for input in &self.run.inputs {
            let known = known_file(&input.name);
            let made = input.role == "horizon" || input.name.starts_with("highland-");
            let (what, source, licence) = match known {
                Some(file) => {
                    (file.what.as_str(), file.source.as_str(), file.licence.as_deref().unwrap_or("see the source"))
                }
                None if made => ("made by this program", "this scenario", "as its inputs"),
                None => ("a file of the user's", "not known", "ask whoever made the dataset"),
            };
            let _ = writeln!(
                text,
                "| {} | {} | {what} | {source} | {licence} | `{}` |",
                input.role, input.name, input.sha256
            );
        }
        text.push_str("\nThe images are made from these files, and their terms hold. The program claims no right in what it renders.\n");
        Some(text)
    }

    fn limits(&self) -> Option<String> {
        let mut text = String::from("## Limits\n\n");
        let quality = || self.facts().map(|facts| &facts.quality);
        if let Some(worst) = quality().filter_map(|quality| quality.max_horizon_error_deg).reduce(f64::max) {
            let _ = writeln!(text, "- Largest error of a compressed horizon: {worst:.3}°; it moves shadows' edges.");
        }
        if let Some(share) = quality().filter_map(|quality| quality.share_interpolated_dem).reduce(f64::max) {
            let _ = writeln!(text, "- Up to {:.2} % of an image's ground has no measured height.", 100.0 * share);
        }
        let mut odd: BTreeMap<&str, (usize, &str)> = BTreeMap::new();
        for warning in quality().flat_map(|quality| &quality.warnings) {
            odd.entry(&warning.kind).or_insert((0, &warning.text)).0 += 1;
        }
        for (images, first) in odd.values() {
            let _ = writeln!(text, "- {images} of {} images: {first}.", self.records.len());
        }
        if self.records.len() < self.planned {
            let _ = writeln!(text, "- {} images are not rendered yet.", self.planned - self.records.len());
        }
        text.push_str(
            "- Ground is bilinear between the nodes of the elevation models: no detail is invented below their posting.\n\
             - Rendered, not photographed: what the models leave out is listed in the program's documentation under the version \
             above.\n",
        );
        Some(text)
    }
}

fn conventions() -> Option<String> {
    Some(String::from(
        "## Units and conventions\n\n\
         - SI; angles of planes in degrees. A pixel without a value is NaN.\n\
         - Row 0 is the top of the image; the centre of the top left pixel is (0, 0).\n\
         - Camera axes: +x right, +y down, +z along the boresight (OpenCV). `K` is in pixels.\n\
         - `q_wxyz`: scalar first, Hamilton's, turns body-fixed components into camera components; `r_body_fixed_m` is the camera \
         seen from the body's centre. A point `p` is seen at `K R(q) (p − r)`.\n\
         - Body-fixed axes: z to the north pole, x to longitude 0; longitudes east, latitudes planetographic, heights above the \
         reference spheroid. Azimuths clockwise from north.\n\
         - Depth is along the boresight, range along the ray.\n",
    ))
}

/// Least to greatest of the values that are known.
fn range(values: impl Iterator<Item = Option<f64>>, unit: &str) -> String {
    let values: Vec<f64> = values.flatten().collect();
    let end = |choose: fn(f64, f64) -> f64| values.iter().copied().reduce(choose);
    match (end(f64::min), end(f64::max)) {
        (Some(least), Some(greatest)) if least == greatest => format!("{least:.4} {unit}").trim_end().into(),
        (Some(least), Some(greatest)) => format!("{least:.4} to {greatest:.4} {unit}").trim_end().into(),
        _ => "not known".into(),
    }
}
