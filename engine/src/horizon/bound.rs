//! How far each node's decoded skyline may be off, in one byte.
//!
//! A renderer may trust a shadow where the light stands further from the decoded skyline than the node's bound `B`. For
//! each node the largest error `m` of the decoded series against the swept skyline is found over every `s`-th azimuth
//! ([`AZIMUTHS`] of them, kept from the sweep or, for large tiles, swept again: a sixth of the work where 360 were swept).
//! Between those azimuths the error may be larger, and the sweep itself errs: on the nodes that a tile measures itself on,
//! whose error `e` against *traced* skylines is known at all azimuths, the ratio `e/m` is known, and
//!
//! ```text
//! B = f · max(m, m₀)      f = the k-th largest e/max(m, m₀) of n measured nodes,  k = max(1, ⌊(n + 1)/20⌋)
//! ```
//!
//! By split-conformal prediction a node drawn like the measured ones lies, at *every* azimuth, within its bound with
//! probability `1 − k/(n + 1)` or more: 95 % for 64 nodes, whatever the terrain. The header counts the measured nodes and
//! samples that do not. The bound is stored rounded up:
//!
//! ```text
//! B = 2^(c/16 − 15) rad      c = 0 … 254: 0.0017° to 105° in steps of 4.4 %      c = 255: nothing is known
//! ```
//!
//! # Assumptions
//! Between nodes the skyline is interpolated: [`Bounds::bound_rad`] gives the largest bound of the four nodes around, which
//! covers the interpolation of their errors and not what the terrain does between them. Nodes in gaps have no bound. The measured
//! nodes are spread evenly, which stands for drawing them at random.
//!
//! # References
//! Lei et al. (2018), *Distribution-free predictive inference for regression*, doi:10.1080/01621459.2017.1307116.

use std::borrow::Cow;

use glam::DVec2;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::band::Ends;
use super::decode::Decoder;
use super::error::{Error, ErrorStatistics};
use super::fit::Plane;
use super::method::Search;
use super::request::Request;
use super::shelf::Shelf;
use super::sweep::grid::Major;

/// Azimuths at which every node is compared with its sweep, at least.
pub const AZIMUTHS: usize = 60;
/// Planes that one decoding of the map serves, where there is memory for them.
pub const BLOCK: usize = 4;
/// Codes of one doubling, and the binary logarithm of the bound of code 0, in radians.
const CODES_PER_OCTAVE: f64 = 16.0;
const LEAST_EXPONENT: f64 = -15.0;
/// The code of a node without a bound.
pub const UNKNOWN: u8 = u8::MAX;
/// Nodes of which one may lie beyond its bound.
const ONE_BEYOND: usize = 20;

/// The code of the smallest stored bound that is not below a given one.
pub fn encode(bound_rad: f64) -> u8 {
    let code = (CODES_PER_OCTAVE * (bound_rad.log2() - LEAST_EXPONENT)).ceil();
    // A NaN is nothing known, not a bound of zero.
    if code < f64::from(UNKNOWN) { code.max(0.0) as u8 } else { UNKNOWN }
}

/// The bound that a code stands for.
pub fn decode_rad(code: u8) -> Option<f64> {
    (code != UNKNOWN).then(|| (f64::from(code) / CODES_PER_OCTAVE + LEAST_EXPONENT).exp2())
}

fn least_rad() -> f64 {
    LEAST_EXPONENT.exp2()
}

/// The codes of all nodes of a map, rows up the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    pub columns: usize,
    pub codes: Vec<u8>,
}

impl Bounds {
    /// A map of which nothing is known.
    pub fn unknown(columns: usize, rows: usize) -> Self {
        Self { columns, codes: vec![UNKNOWN; columns * rows] }
    }

    /// The largest bound of the nodes around a grid point; `None` where one of them has none.
    pub fn bound_rad(&self, grid: DVec2) -> Option<f64> {
        let last = DVec2::new((self.columns - 1) as f64, (self.codes.len() / self.columns - 1) as f64);
        let at = grid.clamp(DVec2::ZERO, last);
        let corner = |at: DVec2| self.codes[at.y as usize * self.columns + at.x as usize];
        let (low, high) = (at.floor(), at.ceil());
        let corners = [low, DVec2::new(high.x, low.y), DVec2::new(low.x, high.y), high];
        decode_rad(corners.into_iter().map(corner).fold(0, u8::max))
    }
}

/// What a tile's bounds rest on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct BoundStatistics {
    /// Azimuths at which every node was compared with the sweep.
    pub azimuths: usize,
    /// From the largest error there to the bound; 0 where no node was measured and no bound is known.
    pub factor: f64,
    /// RMS of the measured samples' errors as shares of their nodes' bounds: times a bound, a standard deviation.
    pub rms_share: f64,
    /// Measured nodes, and samples of them, beyond their bound.
    pub nodes_beyond: usize,
    pub samples_beyond: usize,
}

impl BoundStatistics {
    /// Counts traced errors beyond their nodes' bounds: `[node][azimuth]`, with the nodes' (column, row).
    pub fn beyond(bounds: &Bounds, nodes: &[[usize; 2]], errors_rad: &[Vec<f64>]) -> [usize; 2] {
        let beyond = |([column, row], errors_rad): (&[usize; 2], &Vec<f64>)| {
            let bound_rad = decode_rad(bounds.codes[row * bounds.columns + column]);
            errors_rad.iter().filter(|error_rad| bound_rad.is_some_and(|bound_rad| error_rad.abs() > bound_rad)).count()
        };
        let counts: Vec<usize> = nodes.iter().zip(errors_rad).map(beyond).collect();
        [counts.iter().filter(|count| **count > 0).count(), counts.iter().sum()]
    }
}

/// The skylines that a map is compared with.
#[derive(Debug, Clone, Copy)]
pub struct Swept<'a> {
    pub request: &'a Request<'a>,
    /// Those at hand; the others are swept again, `block` at a time.
    pub planes: &'a [Plane],
    pub block: usize,
}

/// The bounds of a map, from its swept skylines and the traced errors of some nodes, `[node][azimuth]`.
pub fn bounds(
    swept: &Swept,
    shelf: &Shelf,
    nodes: &[[usize; 2]],
    errors_rad: &[Vec<f64>],
) -> Result<(Bounds, BoundStatistics), Error> {
    let (level, map) = (swept.request.nodes(), shelf.map());
    let probed: Vec<usize> = probed(swept.request.settings.azimuths).collect();
    let largest_rad = largest_errors_rad(swept, shelf, &probed)?;
    let at = |[column, row]: [usize; 2]| f64::from(largest_rad[row * map.columns + column]).max(least_rad());
    let largest = |errors_rad: &Vec<f64>| errors_rad.iter().fold(0.0, |worst: f64, e| worst.max(e.abs()));
    let ratios = nodes.iter().zip(errors_rad).map(|(node, errors_rad)| largest(errors_rad) / at(*node));
    let factor = factor(ratios.collect());
    let code = |index: usize| {
        let (column, row) = (index % map.columns, index / map.columns);
        let is_gap = level.gap[level.index(column + level.margin, row + level.margin)];
        if is_gap || factor == 0.0 { UNKNOWN } else { encode(factor * at([column, row])) }
    };
    let bounds = Bounds { columns: map.columns, codes: (0..largest_rad.len()).map(code).collect() };
    let [nodes_beyond, samples_beyond] = BoundStatistics::beyond(&bounds, nodes, errors_rad);
    let rms_share = rms_share(&bounds, nodes, errors_rad);
    Ok((bounds, BoundStatistics { azimuths: probed.len(), factor, rms_share, nodes_beyond, samples_beyond }))
}

/// RMS of errors as shares of their nodes' bounds, `[node][azimuth]`, in the header's digits.
fn rms_share(bounds: &Bounds, nodes: &[[usize; 2]], errors_rad: &[Vec<f64>]) -> f64 {
    let shares = nodes.iter().zip(errors_rad).flat_map(|([column, row], errors_rad)| {
        let bound_rad = decode_rad(bounds.codes[row * bounds.columns + column]).unwrap_or(f64::INFINITY);
        errors_rad.iter().map(move |error_rad| error_rad / bound_rad)
    });
    ErrorStatistics::of(shares).rms_rad
}

/// Every so-many-th azimuth, none of them a cardinal one where there is a choice.
pub fn probed(azimuths: usize) -> impl Iterator<Item = usize> {
    (0..azimuths).filter(move |azimuth| is_probed(*azimuth, azimuths))
}

pub fn is_probed(azimuth: usize, azimuths: usize) -> bool {
    let step = (azimuths / AZIMUTHS).max(1);
    azimuth % step == step / 2
}

/// The k-th largest ratio, in the header's digits and not below it; 0 where no node was measured and nothing is known.
fn factor(mut ratios: Vec<f64>) -> f64 {
    ratios.sort_by(|a, b| b.total_cmp(a));
    let k = rank(ratios.len());
    ratios.get(k - 1).map_or(0.0, |ratio| (ratio * 1e3).ceil() / 1e3)
}

/// Which of so many ratios the factor is: the first, the second, …
fn rank(nodes: usize) -> usize {
    ((nodes + 1) / ONE_BEYOND).max(1)
}

/// Expected share of nodes beyond their bound where so many were measured.
pub fn share_beyond(measured: usize) -> f64 {
    rank(measured) as f64 / (measured + 1) as f64
}

/// The largest error of each node's series against the skylines of some azimuths.
fn largest_errors_rad(swept: &Swept, shelf: &Shelf, probed: &[usize]) -> Result<Vec<f32>, Error> {
    let Request { face, level, settings, .. } = swept.request;
    let (columns, rows) = (shelf.map().columns, shelf.map().rows);
    let mut largest_rad = vec![0.0_f32; columns * rows];
    let ends = |major: Major| settings.band.map(|band| Ends::of(&band, &face.map, swept.request.nodes(), major));
    let at_hand = |azimuth: usize| swept.planes.iter().find(|plane| plane.azimuth == azimuth);
    let row_ends = ends(Major::Row);
    for major in [Major::Row, Major::Column] {
        let along = |azimuth: &&usize| Major::of(settings.direction(**azimuth)) == major;
        let azimuths: Vec<usize> = probed.iter().filter(along).copied().collect();
        let search = match azimuths.iter().all(|azimuth| at_hand(*azimuth).is_some()) {
            true => None,
            false => Some((Search::new(face, *level, major, settings)?, ends(major))),
        };
        for block in azimuths.chunks(swept.block) {
            let plane = |&azimuth: &usize| match at_hand(azimuth) {
                Some(plane) => Ok(Cow::Borrowed(plane)),
                None => {
                    let (search, ends) = search.as_ref().expect("made where a plane is not at hand");
                    super::build::plane(search, ends.as_ref(), settings, azimuth).map(Cow::Owned)
                }
            };
            let planes = block.par_iter().map(plane).collect::<Result<Vec<_>, Error>>()?;
            let directions: Vec<_> = block.iter().map(|azimuth| settings.direction(*azimuth)).collect();
            for strip in shelf.strips() {
                let strip = strip?;
                let decoder = Decoder::new(&strip.map, &directions);
                let largest_rad = &mut largest_rad[strip.rows.start * columns..strip.rows.end * columns];
                largest_rad.par_chunks_mut(columns).enumerate().for_each(|(i, largest_rad)| {
                    let row = strip.rows.start + i;
                    let decoded = decoder.row(row - strip.first);
                    for (plane, decoded_rad) in planes.iter().zip(decoded.chunks(columns)) {
                        for (column, largest_rad) in largest_rad.iter_mut().enumerate() {
                            let swept_rad = plane.at(major, column, row);
                            let decoded_rad = match &row_ends {
                                Some(ends) => ends.clamped(row * columns + column, decoded_rad[column]),
                                None => decoded_rad[column],
                            };
                            *largest_rad = largest_rad.max((decoded_rad - swept_rad).abs());
                        }
                    }
                });
            }
        }
    }
    Ok(largest_rad)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stored_bound_is_never_below_the_one_it_stands_for_nor_far_above() {
        for i in 0..10_000 {
            let bound_rad = least_rad() * (1.0 + f64::from(i) * 3.0).min(5e4);
            let stored_rad = decode_rad(encode(bound_rad)).unwrap();
            // One code is 2^(1/16); the rest is rounding.
            assert!(
                stored_rad >= bound_rad * (1.0 - 1e-12) && stored_rad <= bound_rad * 1.0443,
                "{bound_rad} {stored_rad}"
            );
        }
        assert_eq!((encode(0.0), encode(1e-9)), (0, 0));
        assert_eq!((encode(f64::INFINITY), encode(f64::NAN), encode(3.0)), (UNKNOWN, UNKNOWN, UNKNOWN));
    }

    #[test]
    fn a_place_between_nodes_has_the_largest_bound_around_it() {
        let bounds = Bounds { columns: 3, codes: vec![0, 16, 32, 48, 64, UNKNOWN] };
        let at = |x: f64, y: f64| bounds.bound_rad(DVec2::new(x, y)).map(f64::log2);
        assert_eq!((at(0.0, 0.0), at(0.5, 0.0), at(0.3, 0.2)), (Some(-15.0), Some(-14.0), Some(-11.0)));
        assert_eq!((at(1.5, 0.5), at(-4.0, 9.0)), (None, Some(-12.0)));
    }

    #[test]
    fn one_node_in_twenty_may_lie_beyond() {
        let ratios = |count: u32| (1..=count).map(f64::from).collect::<Vec<_>>();
        assert_eq!((factor(ratios(64)), factor(ratios(18)), factor(ratios(39))), (62.0, 18.0, 38.0));
        assert_eq!(factor(Vec::new()), 0.0);
    }

    #[test]
    fn sixty_azimuths_are_probed_whatever_their_number() {
        let count = |azimuths: usize| probed(azimuths).count();
        assert_eq!([36, 60, 360, 720].map(count), [36, 60, 60, 60]);
        assert!(probed(360).all(|azimuth| azimuth % 90 != 0));
    }
}
