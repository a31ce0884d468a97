//! Parts of a raster for which its file holds nothing: missing blocks of sparse files, gaps between the sources of a VRT.
//! Both read as 0 where no nodata value is declared.

use std::ptr;

use gdal::raster::RasterBand;
use gdal::{Dataset, Metadata};

/// Columns and rows of a file, from its first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    pub column: usize,
    pub row: usize,
    pub columns: usize,
    pub rows: usize,
}

/// `GDAL_DATA_COVERAGE_STATUS_*`.
const UNIMPLEMENTED: i32 = 1;
const DATA: i32 = 2;
const EMPTY: i32 = 4;

/// Who knows what a file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Knows {
    /// GDAL, of whole rectangles.
    Status,
    /// The offsets of a GeoTIFF's blocks. Uncompressed zeros that the file system keeps as a hole are numbers all the same, which
    /// GDAL's status takes for missing.
    Offsets,
}

impl Knows {
    pub fn of(dataset: &Dataset) -> Self {
        let packed = dataset.metadata_item("COMPRESSION", "IMAGE_STRUCTURE").is_some();
        if dataset.driver().short_name() == "GTiff" && !packed { Self::Offsets } else { Self::Status }
    }
}

/// Calls `hole` for all parts of a rectangle that the file holds nothing for; formats that cannot tell have none.
pub fn holes(band: &RasterBand, knows: Knows, rectangle: Rectangle, hole: &mut dyn FnMut(Rectangle)) {
    match knows {
        Knows::Status => by_status(band, rectangle, hole),
        Knows::Offsets => by_offsets(band, rectangle, hole),
    }
}

fn by_offsets(band: &RasterBand, rectangle: Rectangle, hole: &mut dyn FnMut(Rectangle)) {
    let Rectangle { column, row, columns, rows } = rectangle;
    let (width, height) = band.block_size();
    for y in row / height..(row + rows).div_ceil(height) {
        for x in column / width..(column + columns).div_ceil(width) {
            if band.metadata_item(&format!("BLOCK_OFFSET_{x}_{y}"), "TIFF").is_some() {
                continue;
            }
            let (left, top) = (column.max(x * width), row.max(y * height));
            let (right, bottom) = ((column + columns).min((x + 1) * width), (row + rows).min((y + 1) * height));
            hole(Rectangle { column: left, row: top, columns: right - left, rows: bottom - top });
        }
    }
}

fn by_status(band: &RasterBand, rectangle: Rectangle, hole: &mut dyn FnMut(Rectangle)) {
    let Rectangle { column, row, columns, rows } = rectangle;
    let status = status(band, rectangle);
    if status & UNIMPLEMENTED != 0 || status & EMPTY == 0 {
        return;
    }
    if status & DATA == 0 {
        return hole(rectangle);
    }
    let block = band.block_size();
    let [first, second] = if columns * block.1.max(1) >= rows * block.0.max(1) && columns > 1 {
        let left = half(columns, block.0, column);
        [
            Rectangle { columns: left, ..rectangle },
            Rectangle { column: column + left, columns: columns - left, ..rectangle },
        ]
    } else if rows > 1 {
        let above = half(rows, block.1, row);
        [Rectangle { rows: above, ..rectangle }, Rectangle { row: row + above, rows: rows - above, ..rectangle }]
    } else {
        return;
    };
    by_status(band, first, hole);
    by_status(band, second, hole);
}

/// About half of a length, cut between two blocks where it holds several.
fn half(length: usize, block: usize, start: usize) -> usize {
    let middle = start + length / 2;
    let cut = middle / block.max(1) * block;
    if cut > start && cut < start + length { cut - start } else { length / 2 }
}

fn status(band: &RasterBand, Rectangle { column, row, columns, rows }: Rectangle) -> i32 {
    let [column, row, columns, rows] = [column, row, columns, rows].map(|count| count as i32);
    // SAFETY: the band lives as long as its data set, which it borrows; GDAL takes no percentage by a null pointer.
    unsafe { gdal_sys::GDALGetDataCoverageStatus(band.c_rasterband(), column, row, columns, rows, 0, ptr::null_mut()) }
}
