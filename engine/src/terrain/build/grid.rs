//! Which nodes a level has: extents, postings, and the lattice that all levels share.

use glam::DVec2;

use super::{Error, NestedDem};
use crate::geometry::{Body, Position};
use crate::raster::Dem;
use crate::terrain::{Gnomonic, Level};

/// Points along each side of the lattice of pixels that finds a model's extent on the map.
const PROBES: usize = 129;

/// A requested posting may miss a multiple of the finer one by this share.
const MULTIPLE_TOLERANCE: f64 = 1e-6;

/// Part of the map, in map metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rectangle {
    pub low_m: DVec2,
    pub high_m: DVec2,
}

impl Rectangle {
    pub fn of(level: &Level) -> Self {
        let far = level.node_m(level.columns - 1, level.rows - 1);
        Self { low_m: level.node_m(0, 0), high_m: far }
    }

    fn common(self, other: Self) -> Self {
        Self { low_m: self.low_m.max(other.low_m), high_m: self.high_m.min(other.high_m) }
    }
}

/// Nodes at `anchor + posting · (first + (column, row))`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grid {
    anchor_m: DVec2,
    pub posting_m: f64,
    first: [i64; 2],
    pub columns: usize,
    pub rows: usize,
}

impl Grid {
    /// `nodes` nodes to each side of the map's centre.
    pub fn centred(posting_m: f64, nodes: usize) -> Self {
        let (first, side) = (-(nodes as i64), 2 * nodes + 1);
        Self { anchor_m: DVec2::ZERO, posting_m, first: [first; 2], columns: side, rows: side }
    }

    /// Nodes `low` to `high` of a lattice, both included.
    pub fn between(anchor_m: DVec2, posting_m: f64, low: [i64; 2], high: [i64; 2]) -> Self {
        let [columns, rows] = [0, 1].map(|axis| (high[axis] - low[axis] + 1) as usize);
        Self { anchor_m, posting_m, first: low, columns, rows }
    }

    /// Its parts of at most `side × side` nodes.
    pub fn blocks(&self, side: usize) -> impl Iterator<Item = Self> + '_ {
        let starts =
            (0..self.rows).step_by(side).flat_map(move |row| (0..self.columns).step_by(side).map(move |c| (c, row)));
        starts.map(move |(column, row)| Self {
            first: [self.first[0] + column as i64, self.first[1] + row as i64],
            columns: side.min(self.columns - column),
            rows: side.min(self.rows - row),
            ..*self
        })
    }

    /// Puts the values of a part into those of the whole.
    pub fn put(&self, part: &Self, values: &[f64], whole: &mut [f64]) {
        let [column, row] = [0, 1].map(|axis| (part.first[axis] - self.first[axis]) as usize);
        for (i, values) in values.chunks(part.columns).enumerate() {
            whole[(row + i) * self.columns + column..][..part.columns].copy_from_slice(values);
        }
    }

    /// All nodes of a lattice inside a rectangle, if they make a cell at least.
    fn inside(anchor_m: DVec2, posting_m: f64, rectangle: Rectangle) -> Option<Self> {
        let slack = DVec2::splat(1e-6);
        let first = ((rectangle.low_m - anchor_m) / posting_m - slack).ceil();
        let last = ((rectangle.high_m - anchor_m) / posting_m + slack).floor();
        let count = last - first + 1.0;
        (count.min_element() >= 2.0).then_some(Self {
            anchor_m,
            posting_m,
            first: [first.x as i64, first.y as i64],
            columns: count.x as usize,
            rows: count.y as usize,
        })
    }

    /// The nodes that lie inside `rectangle` too.
    pub fn within(&self, rectangle: &Rectangle) -> Option<Self> {
        Self::inside(self.anchor_m, self.posting_m, self.rectangle().common(*rectangle))
    }

    fn rectangle(&self) -> Rectangle {
        Rectangle { low_m: self.at(0, 0), high_m: self.at(self.columns - 1, self.rows - 1) }
    }

    pub fn nodes(&self) -> usize {
        self.columns * self.rows
    }

    pub fn west_south_m(&self) -> DVec2 {
        self.anchor_m + self.posting_m * DVec2::new(self.first[0] as f64, self.first[1] as f64)
    }

    pub fn at(&self, column: usize, row: usize) -> DVec2 {
        self.west_south_m() + self.posting_m * DVec2::new(column as f64, row as f64)
    }

    pub fn node_m(&self, index: usize) -> DVec2 {
        self.at(index % self.columns, index / self.columns)
    }

    /// Steps from a node to the nearest border of the grid.
    pub fn nodes_to_border(&self, index: usize) -> usize {
        let (column, row) = (index % self.columns, index / self.columns);
        column.min(row).min(self.columns - 1 - column).min(self.rows - 1 - row)
    }

    /// At most `max` nodes a side, or `slack` more.
    pub fn check_size(&self, dem: &Dem, max: usize, slack: usize) -> Result<(), Error> {
        let nodes = self.columns.max(self.rows);
        if nodes <= max + slack {
            return Ok(());
        }
        let fitting_posting_m = self.posting_m * (nodes as f64 / max as f64).ceil();
        let fitting_extent_m = self.posting_m * (max.max(2) - 1) as f64;
        let path = dem.path.clone();
        Err(Error::TooLarge { path, nodes, posting_m: self.posting_m, max, fitting_posting_m, fitting_extent_m })
    }

    /// Without the outer rows and columns that have no height; `None` where less than a cell is left.
    pub fn trim(&self, heights_m: Vec<f64>) -> Option<(Self, Vec<f64>)> {
        let valid = |column: usize, row: usize| !heights_m[row * self.columns + column].is_nan();
        let has_row = |row: &usize| (0..self.columns).any(|column| valid(column, *row));
        let has_column = |column: &usize| (0..self.rows).any(|row| valid(*column, row));
        let (south, north) = ((0..self.rows).find(has_row)?, (0..self.rows).rfind(has_row)?);
        let (west, east) = ((0..self.columns).find(has_column)?, (0..self.columns).rfind(has_column)?);
        if east == west || north == south {
            return None;
        }
        let kept = (south..=north).flat_map(|row| &heights_m[row * self.columns..][west..=east]).copied().collect();
        let first = [self.first[0] + west as i64, self.first[1] + south as i64];
        Some((Self { first, columns: east - west + 1, rows: north - south + 1, ..*self }, kept))
    }
}

/// The grid of each level before its size is checked and its empty edges are dropped.
pub(super) fn plan(body: &Body, map: &Gnomonic, dems: &[NestedDem]) -> Result<Vec<Grid>, Error> {
    let finest = dems.first().ok_or(Error::NoDem)?;
    for nested in dems {
        check_lengths(nested)?;
    }
    let natural = dems.iter().map(|nested| Pixel::nearest(body, map, nested.dem)).collect::<Result<Vec<_>, _>>()?;
    let mut posting_m = finest.posting_m.unwrap_or(natural[0].posting_m);
    let anchor_m = natural[0].at_m - posting_m * (natural[0].at_m / posting_m).round();
    let mut grids = Vec::with_capacity(dems.len());
    for (index, nested) in dems.iter().enumerate() {
        if index > 0 {
            posting_m = coarser_posting(nested, natural[index].posting_m, posting_m)?;
        }
        let covered = extent(body, map, nested)?;
        let path = || nested.dem.path.clone();
        grids.push(Grid::inside(anchor_m, posting_m, covered).ok_or_else(|| Error::Apart { path: path() })?);
    }
    Ok(grids)
}

fn check_lengths(nested: &NestedDem) -> Result<(), Error> {
    for (key, length_m) in [("posting_m", nested.posting_m), ("extent_m", nested.extent_m)] {
        if let Some(got) = length_m.filter(|length_m| !(length_m.is_finite() && *length_m > 0.0)) {
            return Err(Error::Length { path: nested.dem.path.clone(), key, got });
        }
    }
    Ok(())
}

/// A posting that is a whole multiple of the finer level's: as asked for, else near the model's own.
fn coarser_posting(nested: &NestedDem, natural_m: f64, finer_m: f64) -> Result<f64, Error> {
    let wanted_m = nested.posting_m.unwrap_or(natural_m);
    let multiple = (wanted_m / finer_m).round();
    let asked_for_another =
        nested.posting_m.is_some() && (wanted_m / finer_m - multiple).abs() > MULTIPLE_TOLERANCE * multiple;
    if multiple < 2.0 || asked_for_another {
        return Err(Error::Postings { path: nested.dem.path.clone(), posting_m: wanted_m, finer_m });
    }
    Ok(multiple * finer_m)
}

/// A model's pixel nearest to the map's centre.
struct Pixel {
    at_m: DVec2,
    /// Its larger side on the map, since cells that shrink along parallels hold no more detail; the nominal
    /// side where it is that within 2 %.
    posting_m: f64,
}

impl Pixel {
    fn nearest(body: &Body, map: &Gnomonic, dem: &Dem) -> Result<Self, Error> {
        let projector = dem.georeference.projector()?;
        let centre =
            Position::from_m(map.origin.vector_m() + map.map_from_body.inverse().turn(glam::DVec3::Z * map.radius_m));
        let at = projector.pixels(&[centre])[0];
        let middle = DVec2::new((dem.columns - 1) as f64, (dem.rows - 1) as f64) / 2.0;
        // Ties between pixels, as in the middle of an even number, must not hang on rounding.
        let nearest = if at.is_nan() { middle } else { (at + 1e-6).floor().clamp(DVec2::ZERO, 2.0 * middle) };
        let steps = [DVec2::ZERO, DVec2::X / 2.0, -DVec2::X / 2.0, DVec2::Y / 2.0, -DVec2::Y / 2.0];
        let pixels: Vec<DVec2> = steps.iter().map(|step| (nearest + step).max(DVec2::ZERO).min(2.0 * middle)).collect();
        let on_map: Vec<Option<DVec2>> = dem
            .points(body, &pixels)?
            .into_iter()
            .map(|point| map.lifted_from_body(point).map(|lifted| lifted.truncate()))
            .collect();
        let outside = || {
            let [latitude_rad, longitude_rad] = map_centre(map);
            let (latitude_deg, longitude_deg) = (latitude_rad.to_degrees(), longitude_rad.to_degrees());
            Error::Outside { path: dem.path.clone(), latitude_deg, longitude_deg }
        };
        let [at_m, right, left, down, up] = match on_map[..] {
            [Some(a), Some(b), Some(c), Some(d), Some(e)] => [a, b, c, d, e],
            _ => return Err(outside()),
        };
        let span = [pixels[1].x - pixels[2].x, pixels[3].y - pixels[4].y];
        let natural_m = ((right - left) / span[0]).length().max(((down - up) / span[1]).length());
        let nominal_m = dem.georeference.posting_m();
        let posting_m = if (natural_m / nominal_m - 1.0).abs() < 0.02 { nominal_m } else { natural_m };
        if at_m.is_finite() && posting_m.is_normal() { Ok(Self { at_m, posting_m }) } else { Err(outside()) }
    }
}

/// Planetocentric latitude and longitude of the map's axis.
fn map_centre(map: &Gnomonic) -> [f64; 2] {
    let axis = map.map_from_body.matrix().row(2);
    [axis.z.asin(), axis.y.atan2(axis.x)]
}

/// The rectangle of the map that holds all of the model, or the part of it asked for.
fn extent(body: &Body, map: &Gnomonic, nested: &NestedDem) -> Result<Rectangle, Error> {
    let dem = nested.dem;
    let limit_m = nested.extent_m.map_or(map.radius_m, |extent_m| (extent_m / 2.0).min(map.radius_m));
    let probe = |index: usize, count: usize| index as f64 / (PROBES - 1) as f64 * (count - 1) as f64;
    let pixels: Vec<DVec2> = (0..PROBES * PROBES)
        .map(|index| DVec2::new(probe(index % PROBES, dem.columns), probe(index / PROBES, dem.rows)))
        .collect();
    let points = dem.points(body, &pixels)?.into_iter();
    // Points far off keep their side of the map: the model reaches at least that far.
    let in_view = points.map(|point| map.map_vector(point)).filter(|p| p.z > 0.05 * map.radius_m);
    let (mut low_m, mut high_m) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for p in in_view {
        let at_m = p.truncate() * (map.radius_m / p.z);
        (low_m, high_m) = (low_m.min(at_m), high_m.max(at_m));
    }
    let limit = DVec2::splat(limit_m);
    // Edges of the model bend between probes: a hundredth of its size covers that, and trimming removes it.
    let bend = (high_m - low_m) * 0.01;
    Ok(Rectangle { low_m: low_m - bend, high_m: high_m + bend }.common(Rectangle { low_m: -limit, high_m: limit }))
}
