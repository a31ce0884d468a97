//! From elevation models to levels of lifted heights.
//!
//! A node stands on the ray from the map's centre of projection through its place on the map. Its point
//! of the surface is where that ray meets the elevation model,
//!
//! ```text
//! height above the spheroid of P(r) = DEM(latitude, longitude of P(r)),   H = R − R²/(r cos c)
//! ```
//!
//! in one step on a sphere centred on the centre of projection, by three rounds of fixed point on a
//! spheroid, where ray and normal part by at most 0.34° (Mars).
//!
//! # Nesting
//! All levels of a face share one lattice: each posting is a whole multiple of the next finer one, and
//! the finest lattice has a node on the pixel centre nearest to the map's centre. A model that *is* a
//! gnomonic grid about that centre is taken over sample by sample.
//!
//! A finer level differs from the next coarser one by `d = H_fine − H_coarse`. What is stored is
//! `H_coarse + w d`: `w` is 1 where the finer model has data, falls smoothly to 0 within
//! [`FEATHER_POSTINGS`] coarse postings of the level's border, and within as much outside the data,
//! where `d` is continued smoothly. The outermost nodes lie on the coarse bilinear surface to the
//! rounding of `f32`, so there is no crack.
//!
//! # Gaps
//! A node where no model gives a height is a gap. It carries a height continued smoothly from its
//! surroundings (`∇²h = 0`, approximately), never a sentinel, never a cliff. Rows and columns of a level
//! without a single height are dropped. Beyond the outermost level lies the bare spheroid.
//!
//! # Assumptions
//! Between nodes the surface is bilinear and no longer the model's: [`ResamplingError`] states by how
//! much at the model's own samples. Measured at the model's own posting, root mean square and largest, and
//! root mean square of slopes:
//!
//! ```text
//! Mars, Gale (HiRISE)      1 m     0.003 m    0.08 m   0.22°
//! Moon, Site01 (LOLA)     10 m     0.002 m    0.08 m   0.013°
//! Moon, polar cap        240 m     1.7 m     31 m      0.38°     beside Site01
//! Moon, GLD100 globe       8 km  113 m     1480 m                means of 4 × 4 pixels, as a cube
//! ```

mod drawn;
mod error;
mod fill;
mod grid;
mod resampling;
mod tile;

use glam::DVec2;
use rayon::prelude::*;

pub use drawn::drawn_tile;
pub use error::Error;
use grid::{Grid, Rectangle};
pub use resampling::ResamplingError;
pub use tile::{GlobalDem, build_tile};

use super::{Face, Gnomonic, Level};
use crate::geometry::{Body, BodyFixed, Geodetic, Position};
use crate::raster::Dem;

/// A level's edge length that keeps a horizon tile of it within common limits of buffers.
pub const MAX_NODES_PER_SIDE: usize = 2896;

/// Width of the band over which a finer level turns into the next coarser one, in coarse postings.
pub const FEATHER_POSTINGS: f64 = 2.0;

/// One level to build.
#[derive(Debug, Clone, Copy)]
pub struct NestedDem<'a> {
    pub dem: &'a Dem,
    /// Distance of nodes; by default the model's own at the map's centre.
    pub posting_m: Option<f64>,
    /// Side of the square about the map's centre to cover; by default all that the model covers.
    pub extent_m: Option<f64>,
}

impl<'a> NestedDem<'a> {
    pub fn whole(dem: &'a Dem) -> Self {
        Self { dem, posting_m: None, extent_m: None }
    }
}

/// Levels, finest first, on the gnomonic map about `centre`, and what resampling did to each model.
pub fn build_face(
    body: &Body,
    centre: Geodetic,
    dems: &[NestedDem],
    max_nodes_per_side: usize,
) -> Result<(Face, Vec<ResamplingError>), Error> {
    let map = aligned(body, centre, dems)?;
    let grids = grid::plan(body, &map, dems)?;
    let mut levels: Vec<Level> = Vec::new();
    let mut errors = Vec::new();
    // Coarsest first: a finer level rests on the coarser one.
    for (index, grid) in grids.iter().enumerate().rev() {
        let nested = &dems[index];
        let grid = match levels.first() {
            Some(coarse) => {
                grid.within(&Rectangle::of(coarse)).ok_or_else(|| Error::Apart { path: nested.dem.path.clone() })?
            }
            None => *grid,
        };
        // Before its empty edges are dropped a grid is a little too large.
        grid.check_size(nested.dem, max_nodes_per_side, max_nodes_per_side / 20)?;
        let mut heights_m = vec![f64::NAN; grid.nodes()];
        // Where this model has no data a finer one may have.
        for source in dems[..=index].iter().rev() {
            sample(body, &map, &grid, source.dem, &mut heights_m)?;
        }
        let (grid, heights_m) = grid.trim(heights_m).ok_or_else(|| Error::outside(nested.dem, centre))?;
        grid.check_size(nested.dem, max_nodes_per_side, 0)?;
        let level = match levels.first() {
            Some(coarse) => nest(body, &map, &grid, &heights_m, coarse),
            None => outermost(body, &map, &grid, heights_m),
        };
        errors.push(resampling::measure(body, &map, &level, nested.dem, levels.first())?);
        levels.insert(0, level);
    }
    errors.reverse();
    Ok((Face { map, levels }, errors))
}

/// The map about `centre`, turned so that up on it is up the columns of the finest model: levels then cover the
/// models' pixels without corners to spare.
fn aligned(body: &Body, centre: Geodetic, dems: &[NestedDem]) -> Result<Gnomonic, Error> {
    let map = Gnomonic::about(body, centre);
    let Some(finest) = dems.first() else { return Ok(map) };
    let at = body.position_from_geodetic(centre);
    let pixel = finest.dem.georeference.projector()?.pixels(&[at])[0];
    let points = finest.dem.points(body, &[pixel, pixel - DVec2::Y])?;
    let on_map = |point: &Position<BodyFixed>| map.lifted_from_body(*point).map(|lifted| lifted.truncate());
    let Some((here, above)) = on_map(&points[0]).zip(on_map(&points[1])) else { return Ok(map) };
    let up = (above - here).normalize_or_zero();
    // Rounding is no reason to leave the model's own grid.
    let is_up = up.x.abs() < 1e-9 && up.y > 0.0;
    Ok(if is_up || !up.is_finite() { map } else { map.turned_to(up) })
}

/// Six faces of a cube about the body's centre, the first about `centre`, from one model of the whole
/// body. Each covers `|X|, |Y| ≤ R` and a margin of at least `margin_m` that only casts shadows. The
/// posting is the nearest one that divides `R`, so that neighbours share their edge nodes.
pub fn build_cube(
    body: &Body,
    centre: Geodetic,
    dem: &Dem,
    posting_m: f64,
    margin_m: f64,
    max_nodes_per_side: usize,
) -> Result<(Vec<Face>, ResamplingError), Error> {
    let half = (body.equatorial_radius_m / posting_m).round().max(1.0);
    let posting_m = body.equatorial_radius_m / half;
    let margin = (margin_m / posting_m).ceil() as usize;
    let grid = Grid::centred(posting_m, half as usize + margin);
    grid.check_size(dem, max_nodes_per_side, 0)?;
    // Filled on the model's own pixels: neighbouring faces then meet in the same heights at gaps too.
    let filled = fill::filled(dem);
    let face = |map: Gnomonic| -> Result<Face, Error> {
        let mut heights_m = vec![f64::NAN; grid.nodes()];
        sample(body, &map, &grid, dem, &mut heights_m)?;
        let gap = heights_m.iter().map(|height| height.is_nan()).collect();
        sample(body, &map, &grid, &filled, &mut heights_m)?;
        fill::replace_missing(&mut heights_m, filled.mean_m());
        Ok(Face { levels: vec![Level { gap, margin, ..level(body, &map, &grid, &heights_m) }], map })
    };
    let faces = Gnomonic::cube(body, centre).into_iter().map(face).collect::<Result<Vec<_>, _>>()?;
    let errors = faces.iter().map(|face| resampling::measure(body, &face.map, &face.levels[0], dem, None));
    let errors = errors.collect::<Result<Vec<_>, _>>()?;
    Ok((faces, ResamplingError::of_all(&errors)))
}

/// The level that nothing lies under: missing heights are continued from the others.
fn outermost(body: &Body, map: &Gnomonic, grid: &Grid, mut heights_m: Vec<f64>) -> Level {
    let gap = heights_m.iter().map(|height| height.is_nan()).collect();
    fill::continue_smoothly(&mut heights_m, grid.columns);
    Level { gap, ..level(body, map, grid, &heights_m) }
}

/// The level as coarse heights plus the feathered difference to them.
fn nest(body: &Body, map: &Gnomonic, grid: &Grid, heights_m: &[f64], coarse: &Level) -> Level {
    let mut nested = level(body, map, grid, heights_m);
    let missing: Vec<bool> = heights_m.iter().map(|height| height.is_nan()).collect();
    // Inside up to rounding: the grid was cut to the coarse level.
    let far = DVec2::new((coarse.columns - 1) as f64, (coarse.rows - 1) as f64);
    let at = |index: usize| coarse.grid_from_map(grid.node_m(index)).clamp(DVec2::ZERO, far);
    let base_m: Vec<f64> =
        (0..grid.nodes()).into_par_iter().map(|index| coarse.bilinear_m(at(index)).expect("clamped")).collect();
    let mut difference_m: Vec<f64> =
        nested.heights_m.iter().zip(&base_m).map(|(&height, base)| f64::from(height) - base).collect();
    fill::continue_smoothly(&mut difference_m, grid.columns);

    let side = grid.columns.min(grid.rows);
    let feather = (FEATHER_POSTINGS * coarse.posting_m / grid.posting_m).min(side as f64 / 4.0);
    let outside = fill::distances(&missing, grid.columns);
    nested.heights_m.par_iter_mut().enumerate().for_each(|(index, height_m)| {
        let inwards = grid.nodes_to_border(index) as f64 / feather;
        let outwards = 1.0 - f64::from(outside[index]) / feather;
        let weight = smooth_step(inwards) * smooth_step(outwards);
        *height_m = (base_m[index] + weight * difference_m[index]) as f32;
    });
    let rests_on_gap = |index: usize| coarse.cell(at(index)).is_some_and(|(c, r)| coarse.cell_has_gap(c, r));
    nested.gap = (0..grid.nodes()).map(|index| missing[index] && rests_on_gap(index)).collect();
    nested
}

/// Lifts heights above the spheroid; NaN stays NaN, no node is a gap.
fn level(body: &Body, map: &Gnomonic, grid: &Grid, heights_m: &[f64]) -> Level {
    let lift = |(index, &height_m): (usize, &f64)| {
        let at_m = grid.node_m(index);
        map.lifted_height_m(at_m, radius_m(body, map, at_m, height_m)) as f32
    };
    Level {
        columns: grid.columns,
        rows: grid.rows,
        posting_m: grid.posting_m,
        west_m: grid.west_south_m().x,
        south_m: grid.west_south_m().y,
        heights_m: heights_m.par_iter().enumerate().map(lift).collect(),
        gap: vec![false; grid.nodes()],
        margin: 0,
    }
}

/// 0 below 0, 1 above 1, smooth in between.
fn smooth_step(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Puts the model's heights on the nodes that have none yet.
fn sample(body: &Body, map: &Gnomonic, grid: &Grid, dem: &Dem, heights_m: &mut [f64]) -> Result<(), Error> {
    dem.georeference.projector()?;
    let start_m = dem.mean_m();
    heights_m.par_chunks_mut(grid.columns).enumerate().with_min_len(32).for_each_init(
        || dem.georeference.projector().expect("made once above"),
        |projector, (row, heights_m)| {
            let wanted: Vec<usize> = (0..grid.columns).filter(|&column| heights_m[column].is_nan()).collect();
            let nodes_m: Vec<DVec2> = wanted.iter().map(|&column| grid.at(column, row)).collect();
            let mut found_m = vec![start_m; wanted.len()];
            for _ in 0..if body.is_sphere() { 1 } else { 3 } {
                let points: Vec<_> = nodes_m
                    .iter()
                    .zip(&found_m)
                    .map(|(&at_m, &height_m)| surface_point(body, map, at_m, height_m))
                    .collect();
                for (height_m, pixel) in found_m.iter_mut().zip(projector.pixels(&points)) {
                    *height_m = dem.height_m(pixel);
                }
            }
            wanted.into_iter().zip(found_m).for_each(|(column, height_m)| heights_m[column] = height_m);
        },
    );
    Ok(())
}

/// The point at a height above the spheroid on the ray through a place on the map.
fn surface_point(body: &Body, map: &Gnomonic, at_m: DVec2, height_m: f64) -> Position<BodyFixed> {
    let direction = map.map_from_body.inverse().turn(map.up(at_m).unit());
    Position::from_m(map.origin.vector_m() + radius_m(body, map, at_m, height_m) * direction)
}

/// Distance of that point from the centre of projection; NaN for the height NaN.
fn radius_m(body: &Body, map: &Gnomonic, at_m: DVec2, height_m: f64) -> f64 {
    if body.is_sphere() {
        return body.equatorial_radius_m + height_m;
    }
    let direction = map.map_from_body.inverse().turn(map.up(at_m).unit());
    let mut radius_m = map.radius_m + height_m;
    // Ray and normal part by δ ≤ 0.34° on Mars: each round leaves 1 − cos δ < 2e-5 of the error.
    for _ in 0..4 {
        let point = Position::from_m(map.origin.vector_m() + radius_m * direction);
        radius_m += height_m - body.geodetic_from_position(point).height_m;
    }
    radius_m
}
