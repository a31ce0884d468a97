//! Maps as pictures, cut to what was mapped, with the chosen places marked.

use std::io::Cursor;

use image::{ImageFormat, Rgb, RgbImage};

use crate::illumination::Maps;
use crate::report::Error;
use crate::report::Figure;

/// What was not mapped.
const MISSING: Rgb<u8> = Rgb([70, 78, 100]);
const MARK: Rgb<u8> = Rgb([213, 94, 0]);
/// Half the side of a mark.
const MARK_PX: i64 = 6;
/// Nodes around what was mapped.
const BORDER: usize = 8;
/// Small maps are enlarged until their longer side has so many pixels.
const LEAST_PX: usize = 400;

/// A picture a map; `marks` are nodes.
pub fn all(maps: &Maps, marks: &[usize]) -> Result<Vec<Figure>, Error> {
    let cut = Cut::of(maps);
    [
        ("lit_share", "Share of the time lit: black never, white always", &maps.lit_share, 1.0),
        ("disc_share", "Mean share of the Sun's light seen: black none, white all of it", &maps.disc_share, 1.0),
        (
            "earth_share",
            "Share of the time with the Earth's centre in sight: black never, white always",
            &maps.earth_share,
            1.0,
        ),
        ("longest_night", "Longest night: black none, white 30 days and more", &maps.longest_night_h, 720.0),
    ]
    .into_iter()
    .map(|(name, caption, plane, white)| {
        let mut png = Cursor::new(Vec::new());
        let image = cut.image(maps, plane, white, marks);
        image.write_to(&mut png, ImageFormat::Png).map_err(|source| Error::Png { name: name.to_owned(), source })?;
        let marked = if marks.is_empty() { "" } else { "; squares: the places" };
        Ok(Figure { name: name.into(), caption: format!("{caption}{marked}"), png: png.into_inner() })
    })
    .collect()
}

/// The columns and rows that a picture shows.
struct Cut {
    columns: std::ops::Range<usize>,
    rows: std::ops::Range<usize>,
}

impl Cut {
    fn of(maps: &Maps) -> Self {
        let mapped = || (0..maps.lit_share.len()).filter(|node| maps.lit_share[*node].is_finite());
        let range = |of: &dyn Fn(usize) -> usize, nodes: usize| {
            let least = mapped().map(of).min().unwrap_or(0);
            let most = mapped().map(of).max().unwrap_or(nodes - 1);
            least.saturating_sub(BORDER)..(most + 1 + BORDER).min(nodes)
        };
        Self {
            columns: range(&|node| node % maps.columns, maps.columns),
            rows: range(&|node| node / maps.columns, maps.rows),
        }
    }

    fn image(&self, maps: &Maps, plane: &[f32], white: f32, marks: &[usize]) -> RgbImage {
        let side = LEAST_PX.div_ceil(self.columns.len().max(self.rows.len()));
        let size = [self.columns.len(), self.rows.len()].map(|nodes| (nodes * side) as u32);
        let mut image = RgbImage::from_fn(size[0], size[1], |x, y| {
            let (column, row) = (self.columns.start + x as usize / side, self.rows.end - 1 - y as usize / side);
            let value = plane[row * maps.columns + column] / white;
            if value.is_nan() { MISSING } else { Rgb([(255.0 * value.clamp(0.0, 1.0)) as u8; 3]) }
        });
        for mark in marks {
            // The middle of the node's pixels.
            let middle = |nodes: i64| nodes * side as i64 + side as i64 / 2;
            let x = middle((mark % maps.columns) as i64 - self.columns.start as i64);
            let y = middle(self.rows.end as i64 - 1 - (mark / maps.columns) as i64);
            for step in -MARK_PX..=MARK_PX {
                for (x, y) in
                    [(x + step, y - MARK_PX), (x + step, y + MARK_PX), (x - MARK_PX, y + step), (x + MARK_PX, y + step)]
                {
                    if let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y))
                        && let Some(pixel) = image.get_pixel_mut_checked(x, y)
                    {
                        *pixel = MARK;
                    }
                }
            }
        }
        image
    }
}
