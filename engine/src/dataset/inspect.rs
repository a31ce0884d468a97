//! What a file or a dataset holds, as JSON.

use std::path::Path;

use serde_json::{Value as Json, json};

use super::disk;
use super::error::DatasetError;
use super::exr_file::read_exr;
use super::png_file;
use super::record::Statistics;
use super::tiff_file::{self, Page};

/// Describes an OpenEXR, PNG or TIFF file, a record, a manifest, or a dataset's directory.
pub fn inspect(path: &Path) -> Result<Json, DatasetError> {
    if path.is_dir() {
        return directory(path);
    }
    let bytes = disk::read(path)?;
    match bytes.as_slice() {
        [0x76, 0x2f, 0x31, 0x01, ..] => exr(path),
        [0x89, b'P', b'N', b'G', ..] => png(path, &bytes),
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => tiff(path, &bytes),
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

/// Of a decoded image; its statistics take six times as much for a moment.
const MOST_PNG_BYTES: u64 = 256 << 20;

fn png(path: &Path, bytes: &[u8]) -> Result<Json, DatasetError> {
    let mut reader = image::ImageReader::with_format(std::io::Cursor::new(bytes), image::ImageFormat::Png);
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(MOST_PNG_BYTES);
    reader.limits(limits);
    let image = reader.decode().map_err(|source| DatasetError::DecodeImage { path: path.to_path_buf(), source })?;
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
    Ok(json!({ "kind": "TIFF", "pages": pages }))
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
    let kind = match &content {
        content if content.get("exposures_planned").is_some() => "manifest",
        content if content.get("landmarks").is_some() => "landmarks",
        content if content.get("frame_id").is_some() => "record",
        _ => return Err(DatasetError::UnknownFile { path: path.to_path_buf() }),
    };
    Ok(json!({ "kind": kind, "content": content }))
}

/// A dataset: its manifest in short, and whether each file is what the manifest says.
fn directory(path: &Path) -> Result<Json, DatasetError> {
    let manifest_path = path.join("manifest.json");
    if !manifest_path.is_file() {
        return Err(DatasetError::NoDataset { path: path.to_path_buf() });
    }
    let bytes = disk::read(&manifest_path)?;
    let manifest: super::Manifest =
        serde_json::from_slice(&bytes).map_err(|source| DatasetError::Json { path: manifest_path, source })?;
    let listed = manifest.exposures.iter().flat_map(|entry| &entry.files).chain(&manifest.files);
    let is_changed = |file: &&super::FileRecord| {
        !disk::read(&path.join(&file.name)).is_ok_and(|bytes| crate::digest::sha256_hex(&bytes) == file.sha256)
    };
    let changed: Vec<&str> = listed.clone().filter(is_changed).map(|file| file.name.as_str()).collect();
    Ok(json!({
        "kind": "dataset",
        "title": manifest.run.title,
        "software": manifest.run.software,
        "body": manifest.run.body,
        "inputs": manifest.run.inputs,
        "exposures": manifest.exposures.len(),
        "exposures_planned": manifest.exposures_planned,
        "first_utc": manifest.exposures.first().map(|entry| &entry.epoch_utc),
        "last_utc": manifest.exposures.last().map(|entry| &entry.epoch_utc),
        "preview": manifest.preview,
        "files": listed.count(),
        "missing_or_changed": changed,
    }))
}
