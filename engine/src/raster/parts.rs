//! In which parts a raster is read: whole blocks of its file, none of them twice where it can be helped, and never more in
//! memory than a stated bound.

use std::path::Path;

use gdal::raster::RasterBand;

use super::Error;
use super::coverage::Rectangle;
use super::window::Window;

/// Values of a part: 64 MiB as `f64`.
const MOST_VALUES: usize = 1 << 23;

/// Bytes of a block, which GDAL holds as a whole.
const MOST_BLOCK_BYTES: usize = 512 << 20;

/// Values that are kept of a file: 1 GiB as `f32`. With a part, a block and GDAL's cache reading takes 1.8 GiB at most.
pub const MOST_KEPT: usize = 1 << 28;

/// Pixels that are looked at: SLDEM2015 of the whole Moon has six times fewer.
const MOST_READ: usize = 1 << 36;

/// Pixels along a side that are averaged to one.
const MOST_AVERAGED: usize = 4096;

/// Reckons before anything is allocated: refuses blocks, windows and results that are too large.
pub fn check_memory(path: &Path, band: &RasterBand, window: Window, n: usize) -> Result<(), Error> {
    let (block_columns, block_rows) = band.block_size();
    let bytes = block_columns.saturating_mul(block_rows).saturating_mul(band.band_type().bytes().max(1).into());
    if bytes > MOST_BLOCK_BYTES {
        return Err(Error::Block {
            path: path.into(),
            columns: block_columns,
            rows: block_rows,
            bytes,
            most: MOST_BLOCK_BYTES,
        });
    }
    let (columns, rows) = (window.columns, window.rows);
    if n > MOST_AVERAGED {
        return Err(Error::Averaged { path: path.into(), n, most: MOST_AVERAGED });
    }
    let most = MOST_READ.min(MOST_KEPT.saturating_mul(n * n));
    if columns.saturating_mul(rows) > most {
        return Err(Error::TooMany { path: path.into(), columns, rows, most, n });
    }
    Ok(())
}

/// A part of a window: in whole `reduction × reduction` pixels, and in one piece of the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// From the window's first pixel.
    pub column: usize,
    pub row: usize,
    /// Where it lies in the file.
    pub inside: Rectangle,
}

/// The parts of a window that hold its whole `n × n` pixels, for a file of `width` columns in blocks of `block`.
pub fn parts(window: Window, n: usize, width: usize, block: (usize, usize)) -> Vec<Part> {
    let [columns, rows] = [window.columns, window.rows].map(|count| count / n * n);
    let (block_columns, block_rows) = (block.0.clamp(1, width.max(1)), block.1.max(1));
    // Rows of blocks as wide as they may be, then as many rows as fit. A block larger than a part stays in GDAL's cache.
    let high = block_rows.min(MOST_VALUES / block_columns.min(columns).max(1)).max(n);
    let widest = if columns * high <= MOST_VALUES { columns } else { (MOST_VALUES / high).max(block_columns) };
    let widest = whole(widest, n);
    let highest = whole((MOST_VALUES / widest).max(high.min(rows)), n).max(n);
    let seam = width - window.column.min(width);
    let across = cuts(columns, widest, n, block_columns, window.column, Some(seam));
    let down = cuts(rows, highest, n, block_rows, window.row, None);
    let mut parts = Vec::with_capacity(across.len() * down.len());
    for &(row, rows) in &down {
        for &(column, columns) in &across {
            let inside = Rectangle { column: (window.column + column) % width, row: window.row + row, columns, rows };
            parts.push(Part { column, row, inside });
        }
    }
    parts
}

/// The next smaller multiple of `n`, at least one.
fn whole(count: usize, n: usize) -> usize {
    (count / n * n).max(n)
}

/// Starts and lengths of pieces of at most `most`, that end between blocks as nearly as whole steps of `n` allow; one ends
/// at the seam.
fn cuts(length: usize, most: usize, n: usize, block: usize, start: usize, seam: Option<usize>) -> Vec<(usize, usize)> {
    let mut cuts = Vec::new();
    let mut at = 0;
    while at < length {
        let mut end = (at + most).min(length);
        if end < length {
            let edge = ((start + end) / block * block).saturating_sub(start) / n * n;
            if edge > at {
                end = edge;
            }
        }
        if let Some(seam) = seam.filter(|seam| at < *seam && *seam < end) {
            end = seam;
        }
        cuts.push((at, end - at));
        at = end;
    }
    cuts
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    /// Blocks loaded over blocks there are, when each part loads all that it touches.
    fn loads(window: Window, n: usize, width: usize, block: (usize, usize)) -> f64 {
        let (mut loaded, mut all) = (0, HashSet::new());
        for Part { inside, .. } in parts(window, n, width, block) {
            let across = inside.column / block.0..=(inside.column + inside.columns - 1) / block.0;
            for column in across {
                for row in inside.row / block.1..=(inside.row + inside.rows - 1) / block.1 {
                    loaded += 1;
                    all.insert((column, row));
                }
            }
        }
        loaded as f64 / all.len() as f64
    }

    #[test]
    fn a_tiled_file_is_read_like_one_in_strips() {
        let whole = |columns, rows| Window { column: 0, row: 0, columns, rows };
        // Wider than GDAL's cache holds a row of blocks.
        assert_eq!(loads(whole(12_288, 1536), 1, 12_288, (512, 512)), 1.0);
        assert_eq!(loads(whole(12_288, 1536), 4, 12_288, (512, 512)), 1.0);
        assert_eq!(loads(whole(30_400, 30_400), 1, 30_400, (30_400, 1)), 1.0);
        assert_eq!(loads(whole(46_080, 23_040), 2, 46_080, (256, 256)), 1.0);
        // Steps that divide no block read those on the cuts twice: 2.534 at most here, by a count of its own. GDAL's cache
        // keeps a row of blocks, so that the file is read less often than this.
        for n in [3, 5, 11, 13, 100, 700] {
            for block in [(256, 256), (512, 512), (30_400, 1), (128, 128), (1024, 64)] {
                let loads = loads(Window { column: 77, row: 33, columns: 30_000, rows: 30_000 }, n, 30_400, block);
                assert!(loads < 2.55, "{n} {block:?}: {loads}");
            }
        }
    }

    #[test]
    fn parts_hold_each_pixel_once_and_stay_within_bounds() {
        let seam = Window { column: 900, row: 7, columns: 640, rows: 100 };
        let odd = Window { column: 3, row: 5, columns: 517, rows: 311 };
        for (window, n, block) in [(seam, 4, (64, 64)), (odd, 3, (17, 9)), (odd, 1, (1280, 1)), (odd, 100, (64, 64))] {
            let mut seen = vec![0; window.columns * window.rows];
            for Part { column, row, inside } in parts(window, n, 1280, block) {
                assert!(inside.column + inside.columns <= 1280 && column % n == 0 && row % n == 0, "{inside:?}");
                assert!(inside.columns % n == 0 && inside.rows % n == 0 && inside.columns * inside.rows <= MOST_VALUES);
                assert_eq!((window.column + column) % 1280, inside.column);
                for r in row..row + inside.rows {
                    seen[r * window.columns + column..][..inside.columns].iter_mut().for_each(|count| *count += 1);
                }
            }
            let [columns, rows] = [window.columns / n * n, window.rows / n * n];
            let inside = |index: usize| index % window.columns < columns && index / window.columns < rows;
            assert!(seen.iter().enumerate().all(|(index, count)| *count == usize::from(inside(index))));
        }
    }
}
