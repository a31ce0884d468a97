//! Planes as a TIFF of 32-bit floats: one page a channel, its name and unit in the page's description.

use std::io::Cursor;
use std::path::Path;

use tiff::encoder::{Compression, DeflateLevel, TiffEncoder, colortype::Gray32Float};
use tiff::tags::Tag;
use tiff::{TiffError, TiffResult};

use super::error::DatasetError;
use crate::render::Image;

/// TIFF 6.0, tag 285.
const PAGE_NAME: Tag = Tag::Unknown(285);

/// The bytes of a file with the planes of `image`; `description` goes with the first page's.
pub fn encode(path: &Path, image: &Image) -> Result<Vec<u8>, DatasetError> {
    pages(image).map_err(|source| DatasetError::EncodeTiff { path: path.to_path_buf(), source })
}

fn pages(image: &Image) -> TiffResult<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    let mut file = TiffEncoder::new(&mut bytes)?.with_compression(Compression::Deflate(DeflateLevel::Fast));
    for plane in &image.planes {
        let mut page = file.new_image::<Gray32Float>(image.columns as u32, image.rows as u32)?;
        let description = format!("{} [{}]", plane.name, plane.quantity.unit());
        page.encoder().write_tag(Tag::ImageDescription, description.as_str())?;
        page.encoder().write_tag(PAGE_NAME, plane.name)?;
        page.write_data(&plane.values)?;
    }
    Ok(bytes.into_inner())
}

/// One page of a TIFF file, for `sim inspect`.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    pub columns: u32,
    pub rows: u32,
    pub samples: usize,
    /// `Gray(32)` and the like.
    pub color: String,
    pub name: Option<String>,
    pub description: Option<String>,
}

/// The pages of any TIFF file.
pub fn pages_of(path: &Path, bytes: &[u8]) -> Result<Vec<Page>, DatasetError> {
    read_pages(bytes).map_err(|source| DatasetError::DecodeTiff { path: path.to_path_buf(), source })
}

fn read_pages(bytes: &[u8]) -> Result<Vec<Page>, TiffError> {
    let mut decoder = tiff::decoder::Decoder::new(Cursor::new(bytes))?;
    let mut pages = Vec::new();
    loop {
        let (columns, rows) = decoder.dimensions()?;
        let samples = decoder.find_tag(Tag::SamplesPerPixel)?.map_or(Ok(1), |value| value.into_u16())?;
        let mut text = |tag| decoder.get_tag_ascii_string(tag).ok();
        let (name, description) = (text(PAGE_NAME), text(Tag::ImageDescription));
        let color = decoder.colortype().map_or_else(|_| "unknown".into(), |color| format!("{color:?}"));
        pages.push(Page { columns, rows, samples: usize::from(samples), color, name, description });
        if !decoder.more_images() {
            return Ok(pages);
        }
        decoder.next_image()?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Plane, Quantity};

    #[test]
    fn each_plane_is_a_page_with_its_name_and_unit() {
        let plane = |quantity, name, value| Plane { quantity, name, values: vec![value; 6] };
        let planes = vec![plane(Quantity::Depth, "DEPTH", 1.5), plane(Quantity::Radiance, "RADIANCE", f32::NAN)];
        let bytes = encode(Path::new("a"), &Image { columns: 3, rows: 2, planes }).unwrap();
        let pages = pages_of(Path::new("a"), &bytes).unwrap();
        assert_eq!(pages.len(), 2);
        assert_eq!((pages[0].columns, pages[0].rows), (3, 2));
        assert_eq!(pages[0].description.as_deref(), Some("DEPTH [m]"));
        assert_eq!(pages[1].name.as_deref(), Some("RADIANCE"));
        let mut decoder = tiff::decoder::Decoder::new(Cursor::new(bytes)).unwrap();
        let tiff::decoder::DecodingResult::F32(values) = decoder.read_image().unwrap() else { panic!("no floats") };
        assert_eq!(values, [1.5; 6]);
    }
}
