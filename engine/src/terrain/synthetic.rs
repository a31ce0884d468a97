//! A synthetic cratered highland with published statistics, for scenes without data.
//!
//! ```text
//! h = massif + Σ craters, oldest first, + fractal
//! ```
//!
//! **Craters** have the cumulative density `N(>D) = 0.0736 (D/km)^−b` per km² with `b = 1.83`: the
//! empirical equilibrium (saturation) of densely cratered surfaces, which small craters reach everywhere.
//! Their places are uniform, their shapes and ages in `profile.rs`. A younger crater erases the relief of
//! what it hits before its own is added, as far as it is fresh, so that large young craters hold no old
//! small ones.
//!
//! **Fractal.** Octaves of gradient noise from the breakover at 2 km down to four pixels with amplitudes
//! `λ^H`, `H = 0.95`: self-affine up to about 1 km as measured over the lunar highlands. It lies over
//! craters too, as the regolith does.
//!
//! **Massif.** A ridge across the map, bent and notched by noise of long wavelength, of a given relief.
//!
//! # Nesting
//! A finer terrain about the same centre continues a coarser one: it repeats the coarser one's massif, craters
//! and octaves at its own pixels, each crater on the ground that it met there, and adds craters from the coarser
//! one's smallest diameter down and octaves from its shortest wavelength down. So every size and wavelength
//! comes from one draw, rims of large craters are as sharp as the finer pixels allow, and both terrains differ
//! only by what the coarser one cannot hold. New craters that would cross the border are left out: within
//! 2 + 6 postings of the coarser terrain their density falls to 0, the largest first.
//!
//! Every random number is a function of the seed and of what it is for (a stream of ChaCha8 for each
//! crater and each octave), so that neither the number of threads nor their order changes a bit.
//!
//! # Assumptions
//! Sizes are metres of the map: a crater is round on the map, and on the ground as far as the projection
//! is conformal and true to scale (gnomonic: `sec² c`, 1.0005 at 40 km from the centre). No boulders, no
//! secondaries in rays, no complex craters: keep diameters under 15 km.
//!
//! # References
//! Hartmann (1984), Icarus 60, 56, doi:10.1016/0019-1035(84)90138-6, density and exponent, taken from
//! Minton et al. (2019), Icarus 326, 63, who give them as a cumulative distribution by radius (Hartmann's
//! line, log N = −1.33 − 1.83 log D, seems to count bins of √2; his paper was not read);
//! Trask (1966), JPL Technical Report 32-800, `N(>D) = 10^10.9 D^−2` per 10⁶ km², D in m: 1.6 times that at
//! 100 m, so much do published equilibria differ;
//! Xiao & Werner (2015), JGR Planets 120, 2277, doi:10.1002/2015JE004860, equilibrium on the Moon;
//! Rosenburg et al. (2011), JGR 116, E02001, doi:10.1029/2010JE003716, Hurst exponents and slopes.

mod craters;
mod detail;
mod noise;
mod profile;
mod relief;

use glam::DVec2;
use rayon::prelude::*;

pub use craters::Crater;
use craters::Field;
pub use detail::{Continued, Detail, Structure, continue_below};
use relief::{Fractal, Massif};

use crate::geometry::{Body, Geodetic};
use crate::raster::{self, GeoTiff, GeoTiffBand, Georeference};

/// Cumulative number of craters larger than 1 km in a km². Minton et al. (2019), after Hartmann (1984).
pub const DENSITY_PER_KM2: f64 = 0.0736;

/// Exponent of the cumulative size distribution. Hartmann (1984).
pub const EQUILIBRIUM_EXPONENT: f64 = 1.83;

/// How the map lies on the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Projection {
    Gnomonic,
    PolarStereographic,
    Equirectangular,
    Orthographic,
}

/// What to make.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    pub columns: usize,
    pub rows: usize,
    pub posting_m: f64,
    pub seed: u64,
    pub centre: Geodetic,
    pub projection: Projection,
    /// Diameters of the largest and the smallest crater.
    pub largest_m: f64,
    pub smallest_m: f64,
    /// Craters per area, in units of the equilibrium density.
    pub density: f64,
    pub exponent: f64,
    /// Height of the massif over its surroundings.
    pub relief_m: f64,
    /// RMS slope of the fractal on pixels of 20 m, whatever the posting.
    pub roughness: f64,
}

impl Parameters {
    /// A polar highland: 1.5 km of relief where the map is large enough to hold it.
    pub fn highland(columns: usize, rows: usize, posting_m: f64, seed: u64) -> Self {
        let side_m = columns.min(rows) as f64 * posting_m;
        Self {
            columns,
            rows,
            posting_m,
            seed,
            centre: Geodetic::from_degrees(-89.0, 0.0, 0.0),
            projection: Projection::Gnomonic,
            largest_m: (side_m / 4.0).min(12_000.0),
            smallest_m: 4.0 * posting_m,
            density: 1.0,
            exponent: EQUILIBRIUM_EXPONENT,
            relief_m: (0.05 * side_m).min(1500.0),
            roughness: 0.035,
        }
    }

    fn check(&self) -> Result<(), Error> {
        let refuse = |key, got, allowed| Err(Error::Range { key, got, allowed });
        if self.columns < 2 || self.rows < 2 {
            return refuse("columns, rows", self.columns.min(self.rows) as f64, "2 and more");
        }
        let positive = [("posting_m", self.posting_m), ("smallest_m", self.smallest_m), ("exponent", self.exponent)];
        for (key, got) in positive {
            if !(got.is_finite() && got > 0.0) {
                return refuse(key, got, "more than 0");
            }
        }
        for (key, got) in [("density", self.density), ("relief_m", self.relief_m), ("roughness", self.roughness)] {
            if !(got.is_finite() && got >= 0.0) {
                return refuse(key, got, "0 and more");
            }
        }
        if !(self.largest_m.is_finite() && self.largest_m > self.smallest_m) {
            return refuse("largest_m", self.largest_m, "more than smallest_m");
        }
        Ok(())
    }

    /// Whether this terrain can continue a coarser one.
    fn check_within(&self, coarse: &Self) -> Result<(), Error> {
        let half_m = |parameters: &Self| Raster::of(parameters).half_m();
        let apart = |key, got: String, coarse: String, rule| Err(Error::Apart { key, got, coarse, rule });
        if (self.centre, self.projection) != (coarse.centre, coarse.projection) {
            let place = |it: &Self| {
                let Geodetic { latitude_rad, longitude_east_rad, .. } = it.centre;
                format!(
                    "{:?} about {:.6}, {:.6} deg",
                    it.projection,
                    latitude_rad.to_degrees(),
                    longitude_east_rad.to_degrees()
                )
            };
            return apart("centre", place(self), place(coarse), "both share one map");
        }
        if self.smallest_m >= coarse.smallest_m || self.posting_m >= coarse.posting_m {
            return apart("posting_m", self.posting_m.to_string(), coarse.posting_m.to_string(), "it is finer");
        }
        if half_m(self).cmpgt(half_m(coarse)).any() {
            let size = |it: &Self| format!("{} m", 2.0 * half_m(it));
            return apart("columns, rows", size(self), size(coarse), "it lies inside");
        }
        Ok(())
    }

    /// The CRS as a PROJ string on the body's figure.
    fn crs(&self, body: &Body) -> String {
        let (a, b) = (body.equatorial_radius_m, body.polar_radius_m);
        let figure = if body.is_sphere() { format!("+R={a}") } else { format!("+a={a} +b={b}") };
        let (latitude_deg, longitude_deg) =
            (self.centre.latitude_rad.to_degrees(), self.centre.longitude_east_rad.to_degrees());
        let projection = match self.projection {
            Projection::Gnomonic => format!("+proj=gnom +lat_0={latitude_deg} +lon_0={longitude_deg}"),
            Projection::Orthographic => format!("+proj=ortho +lat_0={latitude_deg} +lon_0={longitude_deg}"),
            Projection::PolarStereographic => {
                format!("+proj=stere +lat_0={} +lon_0=0 +k=1", 90f64.copysign(latitude_deg))
            }
            Projection::Equirectangular => format!("+proj=eqc +lat_ts={latitude_deg} +lon_0={longitude_deg}"),
        };
        format!("{projection} {figure} +units=m +no_defs")
    }
}

/// What keeps a terrain from being made.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("{key} = {got} is outside the allowed range: {allowed}")]
    Range { key: &'static str, got: f64, allowed: &'static str },
    #[error("{key} = {got} does not continue the coarser terrain's {coarse}: {rule}")]
    Apart { key: &'static str, got: String, coarse: String, rule: &'static str },
    #[error(transparent)]
    Raster(#[from] raster::Error),
}

/// Heights and the craters in them.
#[derive(Debug, Clone, PartialEq)]
pub struct Synthetic {
    pub columns: usize,
    pub rows: usize,
    /// Metres above the body's spheroid, row by row from the top left.
    pub heights_m: Vec<f32>,
    /// All whose centre lies on the raster, those of coarser terrains too, the largest first.
    pub craters: Vec<Crater>,
    /// PROJ string.
    pub crs: String,
    pub geotransform: [f64; 6],
    parameters: Parameters,
    massif: Massif,
    field: Field,
    fractal: Fractal,
}

/// Pixels in metres east and north of the raster's middle; their own coordinates are integers at centres.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Raster {
    columns: usize,
    rows: usize,
    posting_m: f64,
}

impl Raster {
    fn of(&Parameters { columns, rows, posting_m, .. }: &Parameters) -> Self {
        Self { columns, rows, posting_m }
    }

    fn at_m(&self, column: usize, row: usize) -> DVec2 {
        let half = DVec2::new((self.columns - 1) as f64, (self.rows - 1) as f64) / 2.0;
        DVec2::new(column as f64 - half.x, half.y - row as f64) * self.posting_m
    }

    fn pixel(&self, at_m: DVec2) -> DVec2 {
        let half = DVec2::new((self.columns - 1) as f64, (self.rows - 1) as f64) / 2.0;
        DVec2::new(half.x + at_m.x / self.posting_m, half.y - at_m.y / self.posting_m)
    }

    fn half_m(&self) -> DVec2 {
        DVec2::new(self.columns as f64, self.rows as f64) * (self.posting_m / 2.0)
    }
}

/// Makes a terrain; `progress` hears of craters done and of all there are.
pub fn generate(
    body: &Body,
    parameters: &Parameters,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Synthetic, Error> {
    parameters.check()?;
    let Parameters { columns, rows, posting_m, seed, relief_m, roughness, .. } = *parameters;
    let side_m = columns.min(rows) as f64 * posting_m;
    let massif = Massif::new(seed, side_m, relief_m);
    let fractal = Fractal::default().continued(seed, posting_m, side_m / 2.0, roughness);
    lay(body, parameters, massif, Field::draw(parameters), fractal, progress)
}

/// Makes a terrain that continues a coarser one about the same centre. Its largest craters are a little smaller
/// than the coarser one's smallest, and the massif is the coarser one's, whatever the parameters say.
pub fn generate_within(
    body: &Body,
    parameters: &Parameters,
    coarse: &Synthetic,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Synthetic, Error> {
    let parameters = Parameters { largest_m: coarse.parameters.smallest_m, ..parameters.clone() };
    parameters.check_within(&coarse.parameters)?;
    parameters.check()?;
    let Parameters { posting_m, seed, roughness, .. } = parameters;
    let fractal = coarse.fractal.clone().continued(seed, posting_m, f64::INFINITY, roughness);
    let field = Field::draw_within(&parameters, &coarse.field);
    lay(body, &parameters, coarse.massif.clone(), field, fractal, progress)
}

/// Massif, craters and fractal, one over the other.
fn lay(
    body: &Body,
    parameters: &Parameters,
    massif: Massif,
    mut field: Field,
    fractal: Fractal,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Synthetic, Error> {
    let (crs, geotransform) = georeference(body, parameters)?;
    let raster = Raster::of(parameters);
    let mut heights_m = vec![0.0; raster.columns * raster.rows];
    add(&mut heights_m, &raster, |at_m| massif.height_m(at_m));
    field.stamp(&mut heights_m, progress);
    add(&mut heights_m, &raster, |at_m| fractal.height_m(at_m));
    let craters = field.listed(&crs, geotransform)?;
    let Raster { columns, rows, .. } = raster;
    let parameters = parameters.clone();
    Ok(Synthetic { columns, rows, heights_m, craters, crs, geotransform, parameters, massif, field, fractal })
}

impl Synthetic {
    pub fn write(&self, path: &std::path::Path) -> Result<(), Error> {
        let bands = vec![GeoTiffBand { name: "height", unit: "m", values: &self.heights_m }];
        let Self { columns, rows, geotransform, .. } = *self;
        Ok(GeoTiff { columns, rows, bands, crs: &self.crs, geotransform }.write(path)?)
    }

    /// The craters as comma-separated values.
    pub fn craters_csv(&self) -> String {
        craters_csv(&self.craters)
    }
}

/// Craters as comma-separated values.
pub fn craters_csv(craters: &[Crater]) -> String {
    let header = "id,longitude_deg,latitude_deg,x_m,y_m,diameter_m,depth_m,degradation,buried\n";
    craters.iter().fold(header.to_owned(), |text, crater| text + &crater.csv_line())
}

/// CRS and affine map with the centre of the raster on the centre asked for.
fn georeference(body: &Body, parameters: &Parameters) -> Result<(String, [f64; 6]), Error> {
    let crs = parameters.crs(body);
    let probe = Georeference::new(&crs, [0.0, 1.0, 0.0, 0.0, 0.0, 1.0], parameters.columns)?;
    let centre = body.position_from_geodetic(Geodetic { height_m: 0.0, ..parameters.centre });
    // Pixels of one metre counted from the origin of the map.
    let middle = probe.projector()?.pixels(&[centre])[0] + 0.5;
    let half = DVec2::new(parameters.columns as f64, parameters.rows as f64) * (parameters.posting_m / 2.0);
    let middle = if middle.length() < 1e-3 { DVec2::ZERO } else { middle };
    let (west, north) = (middle.x - half.x, middle.y + half.y);
    Ok((crs, [west, parameters.posting_m, 0.0, north, 0.0, -parameters.posting_m]))
}

/// Adds a field of heights, given by metres from the raster's middle.
fn add(heights_m: &mut [f32], raster: &Raster, field_m: impl Fn(DVec2) -> f64 + Sync) {
    heights_m.par_chunks_mut(raster.columns).enumerate().for_each(|(row, line)| {
        for (column, height_m) in line.iter_mut().enumerate() {
            *height_m += field_m(raster.at_m(column, row)) as f32;
        }
    });
}

#[cfg(test)]
mod tests;
