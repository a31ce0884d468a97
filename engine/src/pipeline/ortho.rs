//! Images on a map: each cell of a grid takes the value of the pixel that sees its ground.
//!
//! ```text
//! cell --PROJ--> place of the body --surface--> ground point --camera--> pixel, where nothing stands before it
//! ```
//!
//! The map is that of the finest measured model, north up, on its pixels: a cell is a model's pixel halved or doubled until it is
//! as large as the median pixel on the ground. Over a globe, whose own map is of no use at its poles, it is stereographic,
//! conformal about the terrain's centre, and a cell is as large as the median pixel, rounded to two digits. All images of a scene
//! share the map, so that they lie on each other. The grid spans the ground that the image shows, and cells grow where it would
//! get more than twice as long as the image. Radiometric planes are interpolated between pixels' centres, those of geometry taken
//! from the nearest pixel. Cells that the camera does not see are NaN, as those whose pixel has no value.
//!
//! # Assumptions
//! A cell hidden by less than its own side counts as seen. Lengths on the map are `1 + ρ²/4R²` times those on the ground,
//! `ρ` from its centre: 1.0003 at 60 km on the Moon.

use glam::DVec2;
use rayon::prelude::*;

use super::Error;
use crate::dataset::Orthoimage;
use crate::geometry::{Body, BodyFixed, Geodetic, Position};
use crate::grid::{Cell, Grid2, mix_known};
use crate::raster::{Georeference, cells_around};
use crate::render::{Image, Plane, Scene, View};
use crate::terrain::Hit;

/// Rays along each side of an image that find the ground it shows.
const PROBES: usize = 33;
/// Cells along the map per pixel along the image, at most.
const MOST_CELLS_PER_PIXEL: f64 = 2.0;
/// A map reaches no further from its centre; beyond, the place below the camera is its centre.
const REACH_RAD: f64 = 0.8;
/// Rows that one thread does with one projector.
const BAND_ROWS: usize = 64;

/// The map of a measured model, and its columns.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelMap {
    pub georeference: Georeference,
    pub columns: usize,
}

/// `image` on the map of `model`, or on one about `centre`; `None` where it shows no ground.
pub fn orthoimage(
    scene: &Scene,
    model: Option<&ModelMap>,
    centre: Geodetic,
    view: &View,
    image: &Image,
) -> Result<Option<Orthoimage>, Error> {
    let Some(grid) = Grid::of(scene, model, centre, view)? else { return Ok(None) };
    let bands = (0..grid.rows).step_by(BAND_ROWS).collect::<Vec<_>>().into_par_iter();
    let pixels = bands.map(|row| seen(scene, view, &grid, row..(row + BAND_ROWS).min(grid.rows)));
    let pixels: Vec<Option<DVec2>> = pixels.collect::<Result<Vec<_>, Error>>()?.concat();
    let on_map = |plane: &Plane| {
        let size = [image.columns, image.rows];
        let sampled = |at: &Option<DVec2>| match at {
            None => f32::NAN,
            Some(at) if plane.quantity.is_geometric() => nearest(&plane.values, size, *at),
            Some(at) => bilinear(&plane.values, size, *at),
        };
        Plane { values: pixels.par_iter().map(sampled).collect(), ..*plane }
    };
    let planes = image.planes.iter().map(on_map).collect();
    let Georeference { wkt, geotransform, .. } = grid.georeference;
    let image = Image { columns: grid.columns, rows: grid.rows, planes };
    Ok(Some(Orthoimage { crs: wkt, geotransform, image }))
}

fn crs(body: &Body, centre: Geodetic) -> String {
    format!(
        "+proj=stere +lat_0={} +lon_0={} +a={} +b={} +units=m +no_defs",
        centre.latitude_rad.to_degrees(),
        centre.longitude_east_rad.to_degrees(),
        body.equatorial_radius_m,
        body.polar_radius_m
    )
}

/// The terrain's centre, or the whole degrees below a camera that is far from it.
fn map_centre(body: &Body, centre: Geodetic, view: &View) -> Geodetic {
    let below = body.geodetic_from_position(view.camera_position);
    if body.up(centre).angle_to(body.up(below)) < REACH_RAD {
        return centre;
    }
    let degrees = |angle_rad: f64| angle_rad.to_degrees().round();
    Geodetic::from_degrees(degrees(below.latitude_rad), degrees(below.longitude_east_rad), 0.0)
}

/// Cells on a map, row 0 in the north.
struct Grid {
    georeference: Georeference,
    cell_m: f64,
    columns: usize,
    rows: usize,
}

impl Grid {
    /// Over the ground that a view shows; `None` where it shows none.
    fn of(scene: &Scene, model: Option<&ModelMap>, centre: Geodetic, view: &View) -> Result<Option<Self>, Error> {
        let body = &scene.surface.terrain.body;
        let (hits, mut sides_m): (Vec<Hit>, Vec<f64>) = probes(scene, view).into_iter().unzip();
        if hits.is_empty() {
            return Ok(None);
        }
        let middle = sides_m.len() / 2;
        let side_m = *sides_m.select_nth_unstable_by(middle, f64::total_cmp).1;
        let places: Vec<Position<BodyFixed>> = hits.iter().map(|hit| hit.position).collect();
        let most_cells = MOST_CELLS_PER_PIXEL * f64::from(view.optics.columns.max(view.optics.rows));
        let on = |whole: Georeference| -> Result<Option<(Self, f64)>, Error> {
            let Some((first, [columns, rows])) = cells_around(whole.projector()?.pixels(&places)) else {
                return Ok(None);
            };
            let cell_m = whole.posting_m();
            let grid = Self { georeference: whole.from_cell(first, columns)?, cell_m, columns, rows };
            Ok(Some((grid, columns.max(rows) as f64 / most_cells)))
        };
        let with_cells = |cell_m: f64| -> Result<Georeference, Error> {
            let Some(ModelMap { georeference, columns }) = model else {
                let crs = crs(body, map_centre(body, centre, view));
                let cell_m = two_digits(cell_m);
                return Ok(Georeference::new(&crs, [0.0, cell_m, 0.0, 0.0, 0.0, -cell_m], 1)?);
            };
            let pixel_m = georeference.posting_m();
            Ok(georeference.north_up(*columns, 2_f64.powf((cell_m / pixel_m).log2().ceil()))?)
        };
        match on(with_cells(side_m)?)? {
            Some((_, excess)) if excess > 1.0 => Ok(on(with_cells(side_m * excess)?)?.map(|(grid, _)| grid)),
            found => Ok(found.map(|(grid, _)| grid)),
        }
    }
}

/// Ground seen along some rays, and the side of a pixel there.
fn probes(scene: &Scene, view: &View) -> Vec<(Hit, f64)> {
    let size = DVec2::new(f64::from(view.optics.columns), f64::from(view.optics.rows));
    let body_from_camera = view.camera_from_body.inverse();
    let probe = |index: usize| {
        let share = DVec2::new((index % PROBES) as f64, (index / PROBES) as f64) / (PROBES - 1) as f64;
        let pixel = share * size - 0.5;
        let direction = view.optics.direction(pixel)?;
        let hit = scene.surface.intersect(view.camera_position, body_from_camera * direction)?;
        let side_rad = view.optics.solid_angle_sr(pixel)?.sqrt();
        Some((hit, hit.distance_m * side_rad))
    };
    (0..PROBES * PROBES).into_par_iter().filter_map(probe).collect()
}

/// The pixels that see the cells of some rows.
fn seen(scene: &Scene, view: &View, grid: &Grid, rows: std::ops::Range<usize>) -> Result<Vec<Option<DVec2>>, Error> {
    let (surface, body) = (&scene.surface, &scene.surface.terrain.body);
    let cells: Vec<DVec2> =
        rows.flat_map(|row| (0..grid.columns).map(move |column| DVec2::new(column as f64, row as f64))).collect();
    let projector = grid.georeference.projector()?;
    let mut heights_m = vec![0.0; cells.len()];
    // Verticals of the map and of the surface part on a spheroid: the second round starts where the first has met the ground.
    for _ in 0..2 {
        let above = projector.positions(body, &cells, &heights_m);
        heights_m = above.iter().map(|&at| body.geodetic_from_position(surface.below(at)).height_m).collect();
    }
    let pixel = |ground: Position<BodyFixed>| {
        let towards = view.camera_position.direction_to(ground)?;
        let pixel = view.optics.pixel(view.camera_from_body * towards).filter(|pixel| view.optics.contains(*pixel))?;
        let hit = surface.intersect(view.camera_position, towards)?;
        (hit.distance_m > view.camera_position.distance_m(ground) - grid.cell_m).then_some(pixel)
    };
    Ok(projector.positions(body, &cells, &heights_m).into_iter().map(pixel).collect())
}

/// The next number upwards with two digits.
fn two_digits(number: f64) -> f64 {
    let unit = 10_f64.powf(number.log10().floor() - 1.0);
    // A tenth of a tenth is no tenth in binary: the text is what has two digits.
    format!("{:.1e}", (number / unit).ceil() * unit).parse().unwrap_or(number)
}

fn nearest(values: &[f32], [columns, rows]: [usize; 2], at: DVec2) -> f32 {
    let index = |along: f64, count: usize| (along.round().max(0.0) as usize).min(count - 1);
    values[index(at.y, rows) * columns + index(at.x, columns)]
}

/// Within half a pixel of the image's edge the outermost centres hold.
fn bilinear(values: &[f32], size: [usize; 2], at: DVec2) -> f32 {
    let pixels = Grid2::new(values, size);
    Cell::clamped(size, at).mix_by(|column, row| pixels.get(column, row), mix_known)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_two_digits() {
        assert_eq!([0.1234, 98.1, 100.0, 1.0].map(two_digits), [0.13, 99.0, 100.0, 1.0]);
    }

    #[test]
    fn values_between_four_centres_are_their_mean_and_beyond_the_edge_the_nearest() {
        let values = [1.0, 2.0, 3.0, 6.0, f32::NAN, 8.0];
        let at = |x: f64, y: f64| bilinear(&values, [2, 3], DVec2::new(x, y));
        assert_eq!((at(0.5, 0.5), at(-0.5, -0.4), at(1.4, 2.4)), (3.0, 1.0, 8.0));
        assert!(at(0.5, 1.5).is_nan());
        assert_eq!(nearest(&values, [2, 3], DVec2::new(0.6, 2.4)), 8.0);
    }
}
