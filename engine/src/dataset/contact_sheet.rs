//! All previews of a sequence in one image, each with its index.

use super::preview::Thumbnail;

const MARGIN_PIXELS: usize = 4;
const LABEL_PIXELS: usize = 14;
const BACKGROUND: u8 = 24;
const INK: u8 = 220;
/// Each dot of a digit is a square of this many pixels.
const DOT_PIXELS: usize = 2;

/// Digits of 3 × 5 dots, row by row from the top, the leftmost dot the highest bit.
const DIGITS: [[u8; 5]; 10] = [
    [0b111, 0b101, 0b101, 0b101, 0b111],
    [0b010, 0b110, 0b010, 0b010, 0b111],
    [0b111, 0b001, 0b111, 0b100, 0b111],
    [0b111, 0b001, 0b111, 0b001, 0b111],
    [0b101, 0b101, 0b111, 0b001, 0b001],
    [0b111, 0b100, 0b111, 0b001, 0b111],
    [0b111, 0b100, 0b111, 0b101, 0b111],
    [0b111, 0b001, 0b010, 0b010, 0b010],
    [0b111, 0b101, 0b111, 0b101, 0b111],
    [0b111, 0b101, 0b111, 0b001, 0b111],
];

/// A grid about as wide as high, row by row; the index of each exposure stands above it.
pub fn sheet(thumbnails: &[(usize, Thumbnail)]) -> Thumbnail {
    let width = thumbnails.iter().map(|(_, thumbnail)| thumbnail.columns).max().unwrap_or(0);
    let height = thumbnails.iter().map(|(_, thumbnail)| thumbnail.rows).max().unwrap_or(0);
    let across = (1..).find(|across| across * across >= thumbnails.len()).unwrap_or(1);
    let down = thumbnails.len().div_ceil(across);
    let (step_x, step_y) = (width + MARGIN_PIXELS, height + LABEL_PIXELS + MARGIN_PIXELS);
    let (columns, rows) = (across * step_x + MARGIN_PIXELS, down * step_y + MARGIN_PIXELS);
    let mut sheet = Thumbnail { columns, rows, grey: vec![BACKGROUND; columns * rows] };
    for (place, (index, thumbnail)) in thumbnails.iter().enumerate() {
        let left = MARGIN_PIXELS + place % across * step_x;
        let top = MARGIN_PIXELS + place / across * step_y;
        write_number(&mut sheet, left, top, *index);
        paste(&mut sheet, left, top + LABEL_PIXELS, thumbnail);
    }
    sheet
}

fn paste(sheet: &mut Thumbnail, left: usize, top: usize, thumbnail: &Thumbnail) {
    for (row, line) in thumbnail.grey.chunks(thumbnail.columns).enumerate() {
        let start = (top + row) * sheet.columns + left;
        sheet.grey[start..start + line.len()].copy_from_slice(line);
    }
}

fn write_number(sheet: &mut Thumbnail, left: usize, top: usize, number: usize) {
    for (place, digit) in number.to_string().bytes().enumerate() {
        let left = left + place * 4 * DOT_PIXELS;
        for (row, dots) in DIGITS[usize::from(digit - b'0')].iter().enumerate() {
            for column in (0..3).filter(|column| dots >> (2 - column) & 1 == 1) {
                let dot = Thumbnail { columns: DOT_PIXELS, rows: DOT_PIXELS, grey: vec![INK; DOT_PIXELS * DOT_PIXELS] };
                paste(sheet, left + column * DOT_PIXELS, top + row * DOT_PIXELS, &dot);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_exposures_stand_in_two_rows_of_three() {
        let thumbnail = Thumbnail { columns: 40, rows: 20, grey: vec![99; 800] };
        let thumbnails: Vec<_> = (0..5).map(|index| (index * 31, thumbnail.clone())).collect();
        let sheet = sheet(&thumbnails);
        assert_eq!((sheet.columns, sheet.rows), (3 * 44 + 4, 2 * 38 + 4));
        assert_eq!(sheet.grey.iter().filter(|grey| **grey == 99).count(), 5 * 800);
        // The index 0 has 12 dots, 31 has 11 + 8, 62 has 12 + 11, 93 has 12 + 11, 124 has 8 + 11 + 9.
        let ink = sheet.grey.iter().filter(|grey| **grey == INK).count();
        assert_eq!(ink, 4 * (12 + 19 + 23 + 23 + 28));
    }
}
