//! What a file or a dataset holds, as JSON.

use std::path::Path;

use std::collections::BTreeSet;

use serde_json::{Value as Json, json};

use super::disk;
use super::error::DatasetError;
use super::exr_file::read_exr;
use super::folder::Folder;
use super::plane_statistics::Statistics;
use super::tiff_file::{self, Page};
use super::{npz_file, png_file};
use crate::horizon::header::FORMAT;
use crate::raster;

/// Describes an OpenEXR, PNG, TIFF, NPZ or COCO file, an elevation model, a tile, a record, a manifest, or a dataset's
/// directory.
pub fn inspect(path: &Path) -> Result<Json, DatasetError> {
    if path.is_dir() {
        return directory(path);
    }
    let bytes = disk::read(path)?;
    match bytes.as_slice() {
        [0x76, 0x2f, 0x31, 0x01, ..] => exr(path),
        [0x89, b'P', b'N', b'G', ..] => png(path, &bytes),
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => tiff(path, &bytes),
        [b'P', b'K', 3, 4, ..] => npz(path, &bytes),
        [b'{', ..] => json_file(path, &bytes),
        _ => Err(DatasetError::UnknownFile { path: path.to_path_buf() }),
    }
}

fn exr(path: &Path) -> Result<Json, DatasetError> {
    let file = read_exr(path)?;
    let unit = |channel: &str| {
        let planes = file.metadata.get("planes").and_then(Json::as_array);
        planes
            .and_then(|planes| planes.iter().find(|plane| plane["channel"] == channel))
            .map(|plane| plane["unit"].clone())
    };
    let channels: Vec<Json> = file
        .channels
        .iter()
        .map(|(name, values)| json!({ "channel": name, "unit": unit(name), "statistics": Statistics::of(values) }))
        .collect();
    Ok(json!({
        "kind": "OpenEXR",
        "columns": file.columns,
        "rows": file.rows,
        "channels": channels,
        "metadata": file.metadata,
    }))
}

fn png(path: &Path, bytes: &[u8]) -> Result<Json, DatasetError> {
    let decoded = image::load_from_memory_with_format(bytes, image::ImageFormat::Png);
    let image = decoded.map_err(|source| DatasetError::DecodeImage { path: path.to_path_buf(), source })?;
    let grey: Vec<f32> = image.to_luma16().into_raw().into_iter().map(f32::from).collect();
    Ok(json!({
        "kind": "PNG",
        "columns": image.width(),
        "rows": image.height(),
        "color": format!("{:?}", image.color()),
        "comment": png_file::comment(bytes),
        "statistics_16_bit": Statistics::of(&grey),
    }))
}

fn tiff(path: &Path, bytes: &[u8]) -> Result<Json, DatasetError> {
    let pages: Vec<Json> = tiff_file::pages_of(path, bytes)?.into_iter().map(page).collect();
    let header = &pages[0]["description"];
    if header["format"] == FORMAT {
        return Ok(tile(header, pages.len()));
    }
    match raster::summary(path) {
        Some(raster) => Ok(json!({ "kind": "raster", "raster": raster, "pages": pages })),
        None => Ok(json!({ "kind": "TIFF", "pages": pages })),
    }
}

/// Of a tile's header, what people ask for; how its pages are coded stands in the file.
fn tile(header: &Json, pages: usize) -> Json {
    let errors_deg = |error: &Json| {
        let degrees = |key: &str| error[key].as_f64().map(f64::to_degrees);
        json!({ "rms": degrees("rms_rad"), "p99": degrees("p99_rad"), "maximum": degrees("max_rad") })
    };
    let levels: Vec<String> = header["inputs"]
        .as_array()
        .into_iter()
        .flatten()
        .map(|level| format!("{} x {} nodes at {} m", level["columns"], level["rows"], level["posting_m"]))
        .collect();
    json!({
        "kind": "horizon tile",
        "generator": header["generator"],
        "key": header["key"],
        "encoding": header["encoding"],
        "body": header["body"]["name"],
        "columns": header["columns"],
        "rows": header["rows"],
        "posting_m": header["map"]["posting_m"],
        "centre_deg": header["map"]["centre_deg"],
        "crs": header["map"]["proj4"],
        "azimuths": header["settings"]["azimuths"],
        "decoded_error_deg": errors_deg(&header["errors"]["decoded"]),
        "heights": levels,
        "pages": pages,
    })
}

/// Planes with their statistics, other arrays with their shapes.
fn npz(path: &Path, bytes: &[u8]) -> Result<Json, DatasetError> {
    let arrays = npz_file::read(path, bytes)?;
    let (planes, others): (Vec<_>, Vec<_>) = arrays.into_iter().partition(|array| !array.single.is_empty());
    let channel = |array: &npz_file::Array| json!({ "channel": array.name, "unit": Json::Null, "statistics": Statistics::of(&array.single) });
    let size = planes.first().map(|plane| plane.shape.clone()).unwrap_or_default();
    let others: Vec<String> =
        others.iter().map(|array| format!("{} {} {:?}", array.name, array.kind, array.shape)).collect();
    Ok(json!({
        "kind": "NPZ",
        "columns": size.get(1),
        "rows": size.first(),
        "channels": planes.iter().map(channel).collect::<Vec<_>>(),
        "arrays": others,
    }))
}

/// Descriptions that are JSON, as those of horizon tiles, are shown as JSON.
fn page(page: Page) -> Json {
    let description = page.description.map(|text| serde_json::from_str(&text).unwrap_or(Json::String(text)));
    json!({
        "columns": page.columns,
        "rows": page.rows,
        "samples": page.samples,
        "color": page.color,
        "name": page.name,
        "description": description,
    })
}

fn json_file(path: &Path, bytes: &[u8]) -> Result<Json, DatasetError> {
    let content: Json =
        serde_json::from_slice(bytes).map_err(|source| DatasetError::Json { path: path.to_path_buf(), source })?;
    if let (Some(images), Some(annotations)) = (content["images"].as_array(), content["annotations"].as_array()) {
        return Ok(coco(&content, images, annotations));
    }
    let kind = match &content {
        content if content.get("exposures_planned").is_some() => "manifest",
        content if content.get("landmarks").is_some() => "landmarks",
        content if content.get("frame_id").is_some() => "record",
        _ => return Err(DatasetError::UnknownFile { path: path.to_path_buf() }),
    };
    Ok(json!({ "kind": kind, "content": content }))
}

/// What labels a COCO file holds.
fn coco(content: &Json, images: &[Json], annotations: &[Json]) -> Json {
    let flagged = |flag: &str| annotations.iter().filter(|label| label[flag] == true).count();
    let labelled: BTreeSet<_> = annotations.iter().filter_map(|label| label["image_id"].as_u64()).collect();
    let names = content["categories"].as_array().into_iter().flatten();
    json!({
        "kind": "COCO",
        "description": content["info"]["description"],
        "categories": names.map(|category| &category["name"]).collect::<Vec<_>>(),
        "images": images.len(),
        "images_with_labels": labelled.len(),
        "annotations": annotations.len(),
        "occluded": flagged("occluded"),
        "in_shadow": flagged("in_shadow"),
        "truncated": flagged("truncated"),
    })
}

/// A dataset: its manifest in short, how much of it is finished, and whether each file is what the manifest says.
fn directory(path: &Path) -> Result<Json, DatasetError> {
    let manifest_path = path.join("manifest.json");
    if !manifest_path.is_file() {
        return Err(DatasetError::NoDataset { path: path.to_path_buf() });
    }
    let bytes = disk::read(&manifest_path)?;
    let manifest = super::Manifest::parse(&String::from_utf8_lossy(&bytes))
        .map_err(|why| DatasetError::DamagedManifest { path: manifest_path, why })?;
    let folder = Folder::read(path)?;
    let finished = folder.finished.iter().filter(|(_, finished)| finished.run_key == manifest.run_key);
    let indices: BTreeSet<usize> = finished.map(|(index, _)| *index).collect();
    // A run that goes on, or was stopped, lists its exposures at its end.
    let unlisted = indices.iter().filter(|index| manifest.exposures.iter().all(|entry| entry.index != **index)).count();
    let listed = manifest.exposures.iter().flat_map(|entry| &entry.files).chain(&manifest.files);
    let is_changed = |file: &&super::FileRecord| {
        !disk::read(&path.join(&file.name)).is_ok_and(|bytes| crate::digest::sha256_hex(&bytes) == file.sha256)
    };
    let changed: Vec<&str> = listed.clone().filter(is_changed).map(|file| file.name.as_str()).collect();
    Ok(json!({
        "kind": if manifest.run.draft { "dataset (draft)" } else { "dataset" },
        "title": manifest.run.title,
        "software": manifest.run.software,
        "body": manifest.run.body,
        "inputs": manifest.run.inputs,
        "exposures": indices.len(),
        "exposures_planned": manifest.exposures_planned,
        "not_yet_listed": unlisted,
        "first_utc": manifest.exposures.first().map(|entry| &entry.epoch_utc),
        "last_utc": manifest.exposures.last().map(|entry| &entry.epoch_utc),
        "preview": manifest.preview,
        "files": listed.count(),
        "missing_or_changed": changed,
    }))
}
