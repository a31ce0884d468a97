//! A map's texels as pages of whole numbers.
//!
//! A page is one of the [`super::coefficients`] of all texels of a level, less the least of them, as an image of 8- or 16-bit
//! unsigned numbers: neighbouring nodes see nearly the same skyline, so that the differences that TIFF's horizontal
//! predictor leaves of half floats are small and deflate packs them. Fields are what coarser pages leave and are stored as
//! they are.
//!
//! The last page holds the codes of [`super::bound`].
//!
//! Bytes a node, and what else was tried: `docs/experiments/horizon_files.md`.

use std::io::{Read, Seek, Write};

use serde::{Deserialize, Serialize};
use tiff::TiffResult;
use tiff::decoder::{Decoder, DecodingResult};
use tiff::encoder::colortype::{ColorType, Gray8, Gray16};
use tiff::encoder::{TiffEncoder, TiffValue};
use tiff::tags::Tag;

use super::bound::Bounds;
use super::coefficients::{Coefficient, coefficients};
use super::pack::{BitField, Encoding, Family, HorizonMap, PageLayout, Texels};
use super::statistics::TileErrors;

/// Rows of a page that a reader unpacks at once.
const ROWS_PER_STRIP: u32 = 128;
/// Name of the last page.
const BOUND: &str = "bound";

/// What a page holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PageHeader {
    /// Text of a [`super::coefficients::CoefficientName`], or `bound`.
    pub name: String,
    /// Nodes per texel side.
    pub scale: usize,
    pub columns: usize,
    pub rows: usize,
    /// To be added to the values in the file.
    pub least: i32,
    /// What the numbers stand for, where they are fields.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field: Option<BitField>,
}

/// One plane of whole numbers, rows up the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    pub header: PageHeader,
    /// Above `header.least`.
    pub values: Vec<u16>,
}

impl Page {
    fn of(
        name: String,
        scale: usize,
        columns: usize,
        field: Option<BitField>,
        numbers: impl Iterator<Item = i32> + Clone,
    ) -> Self {
        let least = numbers.clone().min().unwrap_or(0);
        let values: Vec<u16> = numbers.map(|number| (number - least) as u16).collect();
        Self { header: PageHeader { name, scale, columns, rows: values.len() / columns, least, field }, values }
    }

    fn numbers(&self) -> impl Iterator<Item = i32> {
        self.values.iter().map(|value| i32::from(*value).saturating_add(self.header.least))
    }

    /// GDAL's scale and offset of a page of fields.
    pub fn gdal_metadata(&self) -> Option<String> {
        let BitField { step_rad, offset_rad, bias, .. } = self.header.field?;
        let scale = f64::from(step_rad);
        let offset = f64::from(offset_rad) + scale * (f64::from(bias) + f64::from(self.header.least));
        Some(format!(
            "<GDALMetadata><Item name=\"SCALE\" sample=\"0\" role=\"scale\">{scale}</Item>\
             <Item name=\"OFFSET\" sample=\"0\" role=\"offset\">{offset}</Item></GDALMetadata>"
        ))
    }

    /// Writes the page's rows down the map, after the tags that `describe` adds.
    pub fn write<W: Write + Seek>(
        &self,
        file: &mut TiffEncoder<W>,
        describe: impl FnOnce(&mut tiff::encoder::DirectoryEncoder<W, tiff::encoder::TiffKindStandard>) -> TiffResult<()>,
    ) -> TiffResult<()> {
        let down = || self.values.chunks(self.header.columns).rev().flatten();
        if self.values.iter().all(|value| *value <= u16::from(u8::MAX)) {
            self.write_as::<Gray8, W>(file, &down().map(|value| *value as u8).collect::<Vec<_>>(), describe)
        } else {
            self.write_as::<Gray16, W>(file, &down().copied().collect::<Vec<_>>(), describe)
        }
    }

    fn write_as<C: ColorType, W: Write + Seek>(
        &self,
        file: &mut TiffEncoder<W>,
        values: &[C::Inner],
        describe: impl FnOnce(&mut tiff::encoder::DirectoryEncoder<W, tiff::encoder::TiffKindStandard>) -> TiffResult<()>,
    ) -> TiffResult<()>
    where
        [C::Inner]: TiffValue,
    {
        let mut page = file.new_image::<C>(self.header.columns as u32, self.header.rows as u32)?;
        page.rows_per_strip(ROWS_PER_STRIP)?;
        page.encoder().write_tag(Tag::Unknown(PAGE_NAME), self.header.name.as_str())?;
        describe(page.encoder())?;
        page.write_data(values)
    }
}

/// TIFF 6.0, section 12.
const PAGE_NAME: u16 = 285;
/// GDAL's own tag, which makes radians of a page's numbers.
pub const GDAL_METADATA: u16 = 42112;

/// Values of the page that a reader stands at, rows of so many columns up the map; `None` where it holds no numbers of 8 or
/// 16 bits.
pub fn read_values<R: Read + Seek>(file: &mut Decoder<R>, columns: usize) -> TiffResult<Option<Vec<u16>>> {
    let down: Vec<u16> = match file.read_image()? {
        DecodingResult::U8(values) => values.into_iter().map(u16::from).collect(),
        DecodingResult::U16(values) => values,
        _ => return Ok(None),
    };
    Ok(Some(down.chunks(columns.max(1)).rev().flatten().copied().collect()))
}

/// The pages of a map in their order, made one by one: all of them take as much memory as the map.
pub fn pages(map: &HorizonMap) -> impl Iterator<Item = Page> {
    let page = |number: Coefficient| {
        let level = &map.levels[number.level];
        let whole = level.words.chunks(level.words_per_texel).map(move |texel| number.get(texel));
        Page::of(number.name.to_string(), number.scale, level.columns, number.field(), whole)
    };
    let codes = map.bounds.codes.iter().map(|code| i32::from(*code));
    let bound = || std::iter::once_with(move || Page::of(BOUND.into(), 1, map.columns, None, codes));
    coefficients(map.encoding, &map.fields).into_iter().map(page).chain(bound())
}

/// What the fields of an encoding's pages mean; `None` where the headers are not those of its pages and of so many nodes.
pub fn fields(pages: &[PageHeader], encoding: Encoding, columns: usize, rows: usize) -> Option<Vec<Vec<BitField>>> {
    let (bound, stored) = pages.split_last()?;
    let layouts = encoding.pages();
    let fields_of = |layout: &PageLayout| {
        let of_scale = stored.iter().filter(|page| page.scale == layout.scale);
        of_scale.filter_map(|page| page.field).collect::<Vec<BitField>>()
    };
    let fields = match encoding.family() {
        Family::Quantised => layouts.iter().map(fields_of).collect(),
        Family::Fourier | Family::Sampled => Vec::new(),
    };
    if !encoding.describes(&fields) {
        return None;
    }
    let is = |page: &PageHeader, name: &str, scale: usize| {
        let size = [columns.div_ceil(scale), rows.div_ceil(scale)];
        page.name == name && page.scale == scale && [page.columns, page.rows] == size
    };
    let numbers = coefficients(encoding, &fields);
    let fits = |(number, page): (&Coefficient, &PageHeader)| is(page, &number.name.to_string(), number.scale);
    let are_all = numbers.len() == stored.len() && numbers.iter().zip(stored).all(fits);
    (are_all && is(bound, BOUND, 1)).then_some(fields)
}

/// The map of pages; `None` where they are not those of an encoding and of so many nodes.
pub fn map(pages: &[Page], encoding: Encoding, columns: usize, rows: usize, errors: TileErrors) -> Option<HorizonMap> {
    let headers: Vec<PageHeader> = pages.iter().map(|page| page.header.clone()).collect();
    let fields = fields(&headers, encoding, columns, rows)?;
    let is_full = |page: &Page| page.header.columns.checked_mul(page.header.rows) == Some(page.values.len());
    let (bound, stored) = pages.split_last().filter(|_| pages.iter().all(is_full))?;
    let codes = bound.numbers().map(|code| u8::try_from(code).ok()).collect::<Option<Vec<u8>>>()?;
    let mut levels: Vec<Texels> = encoding.pages().iter().map(|layout| Texels::empty(columns, rows, *layout)).collect();
    for (number, page) in coefficients(encoding, &fields).iter().zip(stored) {
        let level = &mut levels[number.level];
        let texels = level.words.chunks_mut(level.words_per_texel);
        texels.zip(page.numbers()).for_each(|(texel, whole)| number.put(texel, whole));
    }
    Some(HorizonMap { encoding, columns, rows, levels, fields, errors, bounds: Bounds { columns, codes } })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::horizon::pack::tests::noise;

    #[test]
    fn pages_give_back_the_map_they_were_made_of() {
        for encoding in Encoding::ALL {
            let noise = noise(encoding, 19, 10);
            let pages: Vec<_> = pages(&noise).collect();
            assert!(map(&pages, encoding, 19, 10, noise.errors).unwrap() == noise, "{encoding}");
            // Which fields a pyramid has, its pages alone say.
            let missing = map(&pages[1..], encoding, 19, 10, noise.errors);
            assert!(missing.is_none() || encoding.family() == Family::Quantised, "{encoding}");
            assert!(map(&pages, encoding, 20, 10, noise.errors).is_none(), "{encoding}");
        }
        let noise = noise(Encoding::F16, 19, 10);
        let pages: Vec<_> = pages(&noise).collect();
        assert!(map(&pages, Encoding::Fm16, 19, 10, TileErrors::default()).is_none());
    }
}
