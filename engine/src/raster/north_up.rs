//! Grids with north up, in the reference system of another raster and on its pixels.

use glam::DVec2;

use super::{Error, Georeference};

impl Georeference {
    /// Columns from west to east and rows from north to south on the corners of this raster's pixels, of which each cell holds
    /// `times` along a side; a raster that is turned gives its reference system, its corner and its pixel size. `columns` is
    /// this raster's number of columns.
    pub fn north_up(&self, columns: usize, times: f64) -> Result<Self, Error> {
        let [x, a, b, y, c, d] = self.geotransform;
        let is_turned = b.abs().max(c.abs()) > 1e-9 * self.pixel_size();
        let [width, height] = if is_turned { [self.pixel_size(); 2] } else { [a.abs(), d.abs()] };
        Self::new(&self.wkt, [x, times * width, 0.0, y, 0.0, -times * height], (columns as f64 / times).ceil() as usize)
    }

    /// The part that begins at a column and a row, which may lie outside, with `columns` columns.
    pub fn from_cell(&self, [column, row]: [i64; 2], columns: usize) -> Result<Self, Error> {
        let [x, a, b, y, c, d] = self.geotransform;
        let (column, row) = (column as f64, row as f64);
        let corner = DVec2::new(x + column * a + row * b, y + column * c + row * d);
        Self::new(&self.wkt, [corner.x, a, b, corner.y, c, d], columns)
    }
}

/// First cell and numbers of cells of the least part of a grid that holds some of its pixel coordinates; `None` of nothing.
pub fn cells_around(pixels: impl IntoIterator<Item = DVec2>) -> Option<([i64; 2], [usize; 2])> {
    let bounds = pixels.into_iter().filter(|pixel| pixel.is_finite()).fold(None, |bounds, pixel| {
        let (low, high) = bounds.unwrap_or((pixel, pixel));
        Some((low.min(pixel), high.max(pixel)))
    });
    let (low, high) = bounds?;
    // Centres are whole: a cell reaches half a pixel to each side.
    let (first, last) = ((low + 0.5).floor(), (high + 0.5).floor());
    let size = last - first + 1.0;
    Some(([first.x as i64, first.y as i64], [size.x as usize, size.y as usize]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const POLE: &str = "+proj=stere +lat_0=-90 +R=1737400 +units=m +no_defs";

    #[test]
    fn cells_lie_on_the_pixels_whichever_way_the_raster_runs() {
        for height in [-10.0, 10.0] {
            let raster = Georeference::new(POLE, [1000.0, 10.0, 0.0, 500.0, 0.0, height], 64).unwrap();
            let grid = raster.north_up(64, 2.0).unwrap();
            assert_eq!(grid.geotransform, [1000.0, 20.0, 0.0, 500.0, 0.0, -20.0]);
            let part = grid.from_cell([3, -2], 5).unwrap();
            assert_eq!(part.geotransform, [1060.0, 20.0, 0.0, 540.0, 0.0, -20.0]);
        }
        let turned = Georeference::new(POLE, [0.0, 6.0, 8.0, 0.0, 8.0, -6.0], 64).unwrap();
        assert_eq!(turned.north_up(64, 1.0).unwrap().geotransform, [0.0, 10.0, 0.0, 0.0, 0.0, -10.0]);
    }

    #[test]
    fn the_least_part_holds_all_cells_of_the_coordinates() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        assert_eq!(cells_around([at(2.0, 3.0), at(4.4, 3.6), DVec2::NAN]), Some(([2, 3], [3, 2])));
        assert_eq!(cells_around([at(-0.6, 0.0)]), Some(([-1, 0], [1, 1])));
        assert_eq!(cells_around([DVec2::NAN]), None);
    }
}
