//! Which pixels of a file are read.

use std::path::Path;

use glam::DVec2;

use super::{Error, Georeference};
use crate::geometry::{Body, Geodetic, Position};

/// A rectangle of pixels. Where columns run all the way around the body it may go on past the last one with the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    pub column: usize,
    pub row: usize,
    pub columns: usize,
    pub rows: usize,
}

/// The ground within a distance of a place, on the gnomonic map about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Around {
    pub centre: Geodetic,
    pub distance_m: f64,
}

pub fn check_window(path: &Path, (width, height): (usize, usize), window: Option<Window>) -> Result<Window, Error> {
    let Window { column, row, columns, rows } =
        window.unwrap_or(Window { column: 0, row: 0, columns: width, rows: height });
    let fits = |start: usize, count: usize, size: usize| start.checked_add(count).is_some_and(|end| end <= size);
    if !fits(column, columns, width) || !fits(row, rows, height) {
        return Err(Error::Window { path: path.into(), column, row, columns, rows, width, height });
    }
    if columns < 2 || rows < 2 {
        return Err(Error::TooSmall { path: path.into(), columns, rows });
    }
    Ok(Window { column, row, columns, rows })
}

/// Pixels to average along a side: as many as fit the posting. Where columns run around the body they
/// must divide the raster, so that its seams stay whole.
pub fn reduction(georeference: &Georeference, window: Window, posting_m: Option<f64>) -> usize {
    let pixel_m = georeference.posting_m();
    let most = window.columns.min(window.rows) / 2;
    let wanted = posting_m.map_or(1, |posting_m| ((posting_m / pixel_m * (1.0 + 1e-9)) as usize).clamp(1, most));
    let divides = |n: &usize| window.columns.is_multiple_of(*n) && window.rows.is_multiple_of(*n);
    match georeference.period_columns {
        Some(_) => (1..=wanted).rev().find(divides).unwrap_or(1),
        None => wanted,
    }
}

/// The part of a window that holds the ground around a place, in whole blocks of `reduction` pixels, so that
/// blocks are those of the window. Where columns run around the body the part may lie across the seam.
pub fn needed(
    whole: &Georeference,
    body: &Body,
    window: Window,
    reduction: usize,
    Around { centre, distance_m }: Around,
) -> Result<Window, Error> {
    const PROBES: i32 = 32;
    let middle_m = body.position_from_geodetic(centre).vector_m();
    // Any two directions across each other will do.
    let east_m = middle_m.normalize().any_orthonormal_vector() * distance_m;
    let north_m = middle_m.normalize().cross(east_m);
    let place = |index: i32| {
        let (x, y) = (index % (2 * PROBES + 1) - PROBES, index / (2 * PROBES + 1) - PROBES);
        (middle_m + (f64::from(x) * east_m + f64::from(y) * north_m) / f64::from(PROBES)).normalize()
            * middle_m.length()
    };
    let places: Vec<_> = (0..(2 * PROBES + 1).pow(2)).map(|index| Position::from_m(place(index))).collect();
    let seen = whole.projector()?.pixels(&places).into_iter().filter(|pixel| pixel.is_finite());
    let seen: Vec<DVec2> = seen.collect();
    let (low, high) = seen.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    // Edges bend between probes, and interpolation looks two blocks further.
    let margin = (high - low) * 0.01 + 3.0 * reduction as f64;
    let part = |low: f64, high: f64, start: usize, count: usize| {
        let blocks = (count / reduction) as f64;
        let first = ((low - start as f64) / reduction as f64).floor().clamp(0.0, blocks) as usize * reduction;
        let end = ((high - start as f64) / reduction as f64).ceil().clamp(0.0, blocks) as usize * reduction;
        (start + first, end.saturating_sub(first))
    };
    let (low, high) = (low - margin, high + margin);
    let (row, rows) = part(low.y, high.y, window.row, window.rows);
    let inside = row > window.row && row + rows < window.row + window.rows / reduction * reduction;
    let (column, columns) = match whole.period_columns {
        // Over a pole the map goes on half a turn away.
        Some(period) if inside && (window.columns as f64 - period).abs() < 0.01 => {
            around_the_body(&seen, window.columns, reduction)
        }
        Some(_) => (window.column, window.columns),
        None => part(low.x, high.x, window.column, window.columns),
    };
    // A place outside the file is an error of whoever needs heights there.
    let some = columns >= 2 * reduction && rows >= 2 * reduction;
    Ok(if some { Window { column, row, columns, rows } } else { window })
}

/// The shortest run of columns around the body that holds all pixels seen, widened by a margin, in whole blocks; all
/// columns where that is most of them.
fn around_the_body(seen: &[DVec2], columns: usize, reduction: usize) -> (usize, usize) {
    let period = columns as f64;
    let mut at: Vec<f64> = seen.iter().map(|pixel| pixel.x.rem_euclid(period)).collect();
    at.sort_by(f64::total_cmp);
    // What is left out is the widest gap.
    let next = |i: usize| if i + 1 < at.len() { at[i + 1] } else { at[0] + period };
    let Some(end) = (0..at.len()).max_by(|a, b| (next(*a) - at[*a]).total_cmp(&(next(*b) - at[*b]))) else {
        return (0, columns);
    };
    let gap = next(end) - at[end];
    let margin = (period - gap) * 0.01 + 3.0 * reduction as f64;
    let blocks = ((period - gap + 2.0 * margin) / reduction as f64) as usize + 2;
    let first = ((next(end) - margin).rem_euclid(period) / reduction as f64) as usize * reduction;
    if gap < 0.5 * period || blocks * reduction >= columns { (0, columns) } else { (first, blocks * reduction) }
}

/// The affine map of the pixels of a window, averaged `reduction` × `reduction`.
pub fn part(g: [f64; 6], window: Window, reduction: usize) -> [f64; 6] {
    let (column, row, n) = (window.column as f64, window.row as f64, reduction as f64);
    [g[0] + column * g[1] + row * g[2], g[1] * n, g[2] * n, g[3] + column * g[4] + row * g[5], g[4] * n, g[5] * n]
}
