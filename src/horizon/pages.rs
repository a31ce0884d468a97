//! A map's texels as pages of whole numbers.
//!
//! A page is one real coefficient of all texels of a level, an image of 8- or 16-bit unsigned numbers: neighbouring nodes see
//! nearly the same skyline, so that the differences that TIFF's horizontal predictor leaves are small and deflate packs them.
//! A half float becomes a whole number that keeps its order:
//!
//! ```text
//! i = bits as a two's complement number;  x = i where i ≥ 0, i xor 0x7fff where i < 0      (its own inverse)
//! page value = x − least x of the page
//! ```
//!
//! The last page holds the codes of [`super::bound`].
//!
//! Measured on 512² nodes of cratered highland, the south polar cap and the connecting ridge, in bytes a node: half floats by fours
//! and deflated 18.7, 18.7, 18.5; these pages 15.7, 15.8, 15.8. Predicting from three neighbours (MED) and splitting
//! bytes would give 13.3, 13.7, 13.7, in a file that no reader of TIFF makes sense of.

use std::io::{Read, Seek, Write};

use serde::{Deserialize, Serialize};
use tiff::TiffResult;
use tiff::decoder::{Decoder, DecodingResult};
use tiff::encoder::colortype::{ColorType, Gray8, Gray16};
use tiff::encoder::{TiffEncoder, TiffValue};
use tiff::tags::Tag;

use super::bound::Bounds;
use super::pack::{Encoding, HorizonMap, TEXEL_COEFFICIENTS, Texels};

/// Rows of a page that a reader unpacks at once.
const ROWS_PER_STRIP: u32 = 128;
/// Name of the last page.
const BOUND: &str = "bound";

/// What a page holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PageHeader {
    /// `re k`, `im k` or `bound`.
    pub name: String,
    /// Nodes per texel side.
    pub scale: usize,
    pub columns: usize,
    pub rows: usize,
    /// To be added to the values in the file.
    pub least: i32,
}

/// One plane of whole numbers, rows up the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    pub header: PageHeader,
    /// Above `header.least`.
    pub values: Vec<u16>,
}

impl Page {
    fn of(name: String, scale: usize, columns: usize, numbers: &[i32]) -> Self {
        let least = numbers.iter().copied().min().unwrap_or(0);
        let header = PageHeader { name, scale, columns, rows: numbers.len() / columns, least };
        Self { header, values: numbers.iter().map(|number| (number - least) as u16).collect() }
    }

    fn numbers(&self) -> impl Iterator<Item = i32> {
        self.values.iter().map(|value| i32::from(*value) + self.header.least)
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

/// Values of the page that a reader stands at, rows up the map; `None` where it holds no numbers of 8 or 16 bits.
pub fn read_values<R: Read + Seek>(file: &mut Decoder<R>, columns: usize) -> TiffResult<Option<Vec<u16>>> {
    let down: Vec<u16> = match file.read_image()? {
        DecodingResult::U8(values) => values.into_iter().map(u16::from).collect(),
        DecodingResult::U16(values) => values,
        _ => return Ok(None),
    };
    Ok(Some(down.chunks(columns).rev().flatten().copied().collect()))
}

/// The pages of a map in their order.
pub fn pages(map: &HorizonMap) -> Vec<Page> {
    let mut pages = Vec::new();
    for (group, (level, scale)) in map.levels.iter().zip(map.encoding.scales()).enumerate() {
        for field in 0..2 * TEXEL_COEFFICIENTS {
            let numbers: Vec<i32> = level.texels.iter().map(|texel| number(texel, field)).collect();
            pages.push(Page::of(name(group, field), scale, level.columns, &numbers));
        }
    }
    let codes: Vec<i32> = map.bounds.codes.iter().map(|code| i32::from(*code)).collect();
    pages.push(Page::of(BOUND.into(), 1, map.columns, &codes));
    pages
}

/// The texels and bounds of pages; `None` where they are not those of a map of so many nodes.
pub fn unpages(pages: &[Page], encoding: Encoding, columns: usize, rows: usize) -> Option<(Vec<Texels>, Bounds)> {
    let fields = 2 * TEXEL_COEFFICIENTS;
    let (bound, coefficients) = pages.split_last()?;
    let mut levels = Vec::new();
    for (group, scale) in encoding.scales().into_iter().enumerate() {
        let mut level = Texels::empty(columns, rows, scale);
        for field in 0..fields {
            let page = coefficients.get(group * fields + field)?;
            if page.header.name != name(group, field) || page.values.len() != level.texels.len() {
                return None;
            }
            level.texels.iter_mut().zip(page.numbers()).for_each(|(texel, number)| set(texel, field, number));
        }
        levels.push(level);
    }
    let codes: Option<Vec<u8>> = bound.numbers().map(|code| u8::try_from(code).ok()).collect();
    let codes = codes.filter(|codes| codes.len() == columns * rows && bound.header.name == BOUND)?;
    Some((levels, Bounds { columns, codes }))
}

fn name(group: usize, field: usize) -> String {
    format!("{} {}", ["re", "im"][field % 2], group * TEXEL_COEFFICIENTS + field / 2)
}

/// A half float of a texel as a number that keeps its order.
fn number(texel: &[u32; 4], field: usize) -> i32 {
    ordered((texel[field / 2] >> (16 * (field % 2))) as u16 as i16)
}

fn set(texel: &mut [u32; 4], field: usize, number: i32) {
    texel[field / 2] |= u32::from(ordered(number as i16) as i16 as u16) << (16 * (field % 2));
}

/// Sign and magnitude to two's complement, and back.
fn ordered(bits: i16) -> i32 {
    i32::from(if bits < 0 { bits ^ i16::MAX } else { bits })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::horizon::pack::tests::noise;
    use half::f16;

    #[test]
    fn numbers_keep_the_order_of_half_floats_and_give_them_back() {
        let finite = |bits: &u16| f16::from_bits(*bits).is_finite();
        for bits in (0..=u16::MAX).filter(finite) {
            assert_eq!(ordered(ordered(bits as i16) as i16) as i16 as u16, bits);
        }
        let mut halves: Vec<u16> = (0..=u16::MAX).filter(finite).collect();
        halves.sort_by_key(|bits| ordered(*bits as i16));
        assert!(halves.is_sorted_by_key(|bits| f16::from_bits(*bits).to_f32()));
    }

    #[test]
    fn pages_give_back_the_texels_they_were_made_of() {
        for encoding in [Encoding::Fm16, Encoding::F16] {
            let map = noise(encoding, 19, 10);
            let (levels, bounds) = unpages(&pages(&map), encoding, 19, 10).unwrap();
            assert!(levels == map.levels && bounds == map.bounds);
            assert_eq!(unpages(&pages(&map)[1..], encoding, 19, 10), None);
            assert_eq!(unpages(&pages(&map), encoding, 20, 10), None);
        }
    }
}
