//! Where an albedo map comes from, and whether it holds the photograph that it shall be compared with.
//!
//! A map made from the compared image puts the image's own shading into the render: any renderer would then agree. The
//! map is taken to hold the photograph where it is the same file, or where its name or anything that it says of
//! itself names the photograph or its frame. A map that hides its sources cannot be found out.

use std::path::Path;

use super::Error;
use crate::raster;

/// An identifier shorter than this says nothing.
const LEAST_LETTERS: usize = 6;

/// Why an albedo map is thought to hold a photograph; `None`: nothing says so.
pub fn holds(albedo: &Path, photo: &Path) -> Result<Option<String>, Error> {
    if raster::digest(albedo)? == raster::digest(photo)? {
        return Ok(Some("it is the same file".into()));
    }
    let mut said = raster::notes(albedo)?;
    said.push(albedo.file_name().unwrap_or_default().to_string_lossy().into_owned());
    let name = identifiers(photo).into_iter().find_map(|name| {
        let note = said.iter().find(|note| note.to_lowercase().contains(&name))?;
        Some(format!("{:?} names {name}", note.trim()))
    });
    Ok(name)
}

/// What an albedo map says of its sources, on one line.
pub fn source(albedo: &Path) -> Result<String, Error> {
    let file = albedo.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let notes: Vec<String> = raster::notes(albedo)?
        .into_iter()
        .filter(|note| ["SOURCE=", "IMAGEDESCRIPTION=", "TITLE="].iter().any(|key| note.to_uppercase().contains(key)))
        .collect();
    let said = if notes.is_empty() { "it says nothing of its sources".into() } else { notes.join("; ") };
    Ok(format!("{file}: {said}; SHA-256 {}", raster::digest(albedo)?))
}

/// The photograph's name, and the part of it before an underscore: `AS15-M-0297` of `AS15-M-0297_SML.png`.
fn identifiers(photo: &Path) -> Vec<String> {
    let stem = photo.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
    let product = stem.split('_').next().unwrap_or_default().to_owned();
    let speaks = |name: &String| name.len() >= LEAST_LETTERS && name.chars().any(|letter| letter.is_ascii_digit());
    [stem, product].into_iter().filter(speaks).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_photograph_is_known_by_its_stem_and_its_product() {
        assert_eq!(identifiers(Path::new("x/AS15-M-0297_SML.png")), ["as15-m-0297_sml", "as15-m-0297"]);
        assert!(identifiers(Path::new("photo.png")).is_empty(), "a word names no product");
    }
}
