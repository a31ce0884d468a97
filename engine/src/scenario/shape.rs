//! What of a scenario shapes the pixels of its images, as a tree in the words of its keys: what the exposures share, and what
//! each has of its own. Equal trees with equal files make equal pixels.
//!
//! Left out are title, comments, the number of exposures and of a sweep's points, the scale and the film of previews, the files
//! of whole sequences, and the names of files: their contents count, by their hashes.

use std::path::Path;

use serde_json::{Map, Value as Json, json};

use super::resolved::{Albedo, CraterList, Dem, Scenario, Towards, Trajectory};
use crate::dataset::Format;
use crate::ephemeris::utc_text;
use crate::render::Quantity;

/// Formats that concern exposures one by one.
const OF_EXPOSURES: [&str; 4] = ["Exr", "Fits", "Npz", "GeoTiff"];

impl Scenario {
    /// What all exposures share.
    pub fn shape(&self) -> Json {
        let mut spec = self.spec.clone();
        spec.shadows = spec.shadows.current();
        let mut tree = serde_json::to_value(&spec).expect("plain values become JSON");
        for key in ["title", "exposures", "sweep", "outputs.preview", "outputs.animation", "landmarks.overlay"] {
            remove(&mut tree, key);
        }
        if let Some(formats) = tree["outputs"]["formats"].as_array_mut() {
            if Format::writes_exr(&self.outputs.formats) && !self.outputs.formats.contains(&Format::Exr) {
                formats.push("Exr".into());
            }
            formats.retain(|format| format.as_str().is_some_and(|name| OF_EXPOSURES.contains(&name)));
            formats.sort_by_key(ToString::to_string);
        }
        let files = self.files();
        let names: Vec<&str> = files.iter().filter_map(|path| path.file_name()?.to_str()).collect();
        unnamed(&mut tree, &names);
        tree
    }

    /// What each exposure has of its own, those of one point of the sweep after those of the one before.
    pub fn shapes(&self) -> Vec<Json> {
        let points = (0..self.points()).map(|point| (point, self.at_point(point)));
        points.flat_map(|(point, scenario)| self.shapes_at(point, &scenario)).collect()
    }

    fn shapes_at(&self, point: usize, at_point: &Self) -> Vec<Json> {
        let values = self.sweep.as_ref().map(|sweep| {
            let values = sweep.points[point].0.iter().map(|(varied, value)| (varied.key().to_owned(), json!(value)));
            values.collect::<Map<_, _>>()
        });
        let epochs = &at_point.exposures;
        let counts = |epoch: &hifitime::Epoch| json!({ "utc": utc_text(*epoch), "tdb_s": epoch.to_et_seconds() });
        let from_start = matches!(self.trajectory, Trajectory::Waypoints { .. })
            || matches!(self.pointing.towards, Towards::Table(_));
        let has = |wanted: &[Quantity]| wanted.iter().any(|quantity| self.outputs.planes.contains(quantity));
        let before = has(&[Quantity::FlowBack, Quantity::CovisibleBack, Quantity::ShadowChange]);
        let after = has(&[Quantity::Flow, Quantity::Covisible]);
        let shape = |(index, epoch): (usize, &hifitime::Epoch)| {
            let mut own = Map::new();
            own.insert("index".into(), json!(point * epochs.len() + index));
            own.insert("epoch".into(), counts(epoch));
            if from_start {
                own.insert("first_epoch".into(), counts(&epochs[0]));
            }
            if let Some(values) = &values {
                own.insert("sweep".into(), Json::Object(values.clone()));
            }
            if before {
                let other = index.checked_sub(1).and_then(|other| epochs.get(other));
                own.insert("epoch_before".into(), other.map_or(Json::Null, counts));
            }
            if after {
                own.insert("epoch_after".into(), epochs.get(index + 1).map_or(Json::Null, counts));
            }
            Json::Object(own)
        };
        epochs.iter().enumerate().map(shape).collect()
    }

    /// The files that it names.
    fn files(&self) -> Vec<&Path> {
        let mut files: Vec<&Path> = self.other_files().into_iter().map(|(_, path)| path).collect();
        for dem in self.terrain.iter().flat_map(|terrain| &terrain.dems) {
            match dem {
                Dem::File { path, .. } | Dem::Cube { path, .. } => files.push(path),
                Dem::Globe(globe) => {
                    files.push(&globe.path);
                    files.extend(globe.tiles.as_deref());
                }
                Dem::Synthetic { .. } | Dem::Detail { .. } => {}
            }
        }
        files.extend(self.kernels.iter().flatten().map(|kernel| kernel.path()));
        if let Trajectory::Spk { path: Some(kernel), .. } = &self.trajectory {
            files.push(kernel.path());
        }
        files
    }

    /// Files that shape the images besides elevation models and kernels, with their role.
    pub fn other_files(&self) -> Vec<(&'static str, &Path)> {
        let mut inputs = Vec::new();
        if let Albedo::Map(path) | Albedo::SingleScattering(path) = &self.albedo {
            inputs.push(("albedo", path.as_path()));
        }
        if let Trajectory::Oem { path } = &self.trajectory {
            inputs.push(("trajectory", path.as_path()));
        }
        if let Some(isd) = &self.camera.isd {
            inputs.push(("camera", isd.path.as_path()));
        }
        if let Some(kernel) = &self.camera.kernel {
            inputs.push(("psf", kernel.as_path()));
        }
        let response = self.band.as_ref().and_then(|band| band.path.as_deref());
        inputs.extend(response.map(|path| ("response", path)));
        inputs.extend(self.sun.table.as_deref().map(|path| ("spectrum", path)));
        if let Towards::Aem { path } = &self.pointing.towards {
            inputs.push(("attitude", path.as_path()));
        }
        for list in self.landmarks.iter().flat_map(|landmarks| &landmarks.lists) {
            if let CraterList::File(path) = list {
                inputs.push(("craters", path.as_path()));
            }
        }
        inputs
    }
}

/// Takes `a.b` out of a tree, where it is there.
fn remove(tree: &mut Json, key: &str) {
    match key.split_once('.') {
        Some((first, rest)) => {
            if let Some(below) = tree.get_mut(first) {
                remove(below, rest);
            }
        }
        None => {
            if let Json::Object(map) = tree {
                map.remove(key);
            }
        }
    }
}

/// Puts a placeholder wherever a file of one of these names is named.
fn unnamed(tree: &mut Json, names: &[&str]) {
    match tree {
        Json::String(text) => {
            let last = Path::new(text.as_str()).file_name().and_then(|name| name.to_str());
            if last.is_some_and(|last| names.contains(&last)) {
                *text = "a file".into();
            }
        }
        Json::Array(items) => items.iter_mut().for_each(|item| unnamed(item, names)),
        Json::Object(map) => map.values_mut().for_each(|value| unnamed(value, names)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::super::{SearchPath, resolve};
    use super::*;

    const TEXT: &str = r#"(
        title: "a", surface: (albedo: Constant(0.1)),
        trajectory: Waypoints(points: [(t_s: 0, latitude_deg: 0, longitude_deg: 0, height_m: 1000)]),
        camera: (columns: 8, rows: 8, field_of_view_deg: 40),
        exposures: Series(start: "2026-11-06T00:00:00 UTC", step_s: 10, count: 2),
    )"#;

    fn scenario(text: &str) -> Scenario {
        let path = Path::new("/nowhere/a.ron");
        resolve(path, text, &SearchPath::of(path, &[]), &|_| None).unwrap()
    }

    #[test]
    fn comments_titles_defaults_and_counts_leave_the_shape_as_it_is() {
        let first = scenario(TEXT);
        let same = [
            format!("// a comment\n{TEXT}"),
            TEXT.replace("\"a\"", "\"b\""),
            TEXT.replace("count: 2", "count: 9"),
            TEXT.replace("camera:", "seed: 0, outputs: (animation: false, formats: [Kitti]), camera:"),
        ];
        for text in same {
            let other = scenario(&text);
            assert_eq!(other.shape(), first.shape(), "{text}");
            assert_eq!(other.shapes()[..2], first.shapes());
        }
        for (from, to) in [("0.1", "0.2"), ("rows: 8", "rows: 9"), ("camera:", "seed: 1, camera:")] {
            assert_ne!(scenario(&TEXT.replace(from, to)).shape(), first.shape(), "{to}");
        }
        let later = scenario(&TEXT.replace("step_s: 10", "step_s: 11"));
        assert_eq!((later.shape(), &later.shapes()[0]), (first.shape(), &first.shapes()[0]));
        assert_ne!(later.shapes()[1], first.shapes()[1]);
    }

    #[test]
    fn a_longer_sweep_of_a_sequence_of_points_begins_as_the_shorter() {
        let sweep = |count: usize, design: &str| {
            let sweep = format!(
                "sweep: (design: {design}(count: {count}, seed: 3), roll_deg: Range(from: 0, to: 90)), camera:"
            );
            scenario(&TEXT.replace("camera:", &sweep)).shapes()
        };
        assert_eq!(sweep(5, "Sobol")[..6], sweep(3, "Sobol"));
        assert_ne!(sweep(5, "LatinHypercube")[..6], sweep(3, "LatinHypercube"));
    }

    #[test]
    fn labels_that_ask_about_neighbours_hang_on_them() {
        let flow = TEXT.replace("camera:", "outputs: (planes: [radiance, flow]), camera:");
        let [short, long] = [flow.clone(), flow.replace("count: 2", "count: 3")].map(|text| scenario(&text).shapes());
        assert_eq!(short[0], long[0]);
        assert_ne!(short[1], long[1]);
    }
}
