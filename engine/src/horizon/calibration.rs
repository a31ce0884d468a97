//! The bounds of a map's errors, by split-conformal prediction.
//!
//! For each node the largest error `m` of the decoded series against the swept skyline is found over every `s`-th azimuth
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
//! samples that do not.
//!
//! # Assumptions
//! The measured nodes are spread evenly, which stands for drawing them at random.
//!
//! # References
//! Lei et al. (2018), *Distribution-free predictive inference for regression*, doi:10.1080/01621459.2017.1307116.

use std::borrow::Cow;

use rayon::prelude::*;

use super::axis::Major;
use super::band_limits::BandLimits;
use super::bound::{Bounds, UNKNOWN, decode_rad, encode, least_rad};
use super::decode::Decoder;
use super::elevation_plane::ElevationPlane;
use super::error::Error;
use super::request::Request;
use super::search::Search;
use super::statistics::{BoundStatistics, ErrorStatistics};
use super::texel_store::TexelStore;
use crate::gpu::Gpu;

/// Azimuths at which every node is compared with its sweep, at least.
pub const AZIMUTHS: usize = 60;
/// Planes that one decoding of the map serves, where there is memory for them.
pub const BLOCK: usize = 4;
/// Nodes of which one may lie beyond its bound.
const ONE_BEYOND: usize = 20;

/// The skylines that a map is compared with.
#[derive(Debug, Clone, Copy)]
pub struct Swept<'a> {
    pub request: &'a Request<'a>,
    /// Where the search wants one.
    pub device: Option<&'a Gpu>,
    /// The planes at hand; the others are swept again, `block` at a time.
    pub planes: &'a [ElevationPlane],
    pub block: usize,
}

/// The bounds of a map, from its swept skylines and the traced errors of some nodes, `[node][azimuth]`.
pub fn bounds(
    swept: &Swept,
    texels: &TexelStore,
    nodes: &[[usize; 2]],
    errors_rad: &[Vec<f64>],
) -> Result<(Bounds, BoundStatistics), Error> {
    let (level, map) = (swept.request.nodes(), texels.map());
    let probed: Vec<usize> = probed(swept.request.settings.azimuths).collect();
    let largest_rad = largest_errors_rad(swept, texels, &probed)?;
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
    let [nodes_beyond, samples_beyond] = bounds.exceeded(nodes, errors_rad);
    let rms_fraction = rms_fraction(&bounds, nodes, errors_rad);
    Ok((bounds, BoundStatistics { azimuths: probed.len(), factor, rms_fraction, nodes_beyond, samples_beyond }))
}

/// RMS of errors as fractions of their nodes' bounds, `[node][azimuth]`, in the header's digits.
fn rms_fraction(bounds: &Bounds, nodes: &[[usize; 2]], errors_rad: &[Vec<f64>]) -> f64 {
    let fractions = nodes.iter().zip(errors_rad).flat_map(|([column, row], errors_rad)| {
        let bound_rad = decode_rad(bounds.codes[row * bounds.columns + column]).unwrap_or(f64::INFINITY);
        errors_rad.iter().map(move |error_rad| error_rad / bound_rad)
    });
    ErrorStatistics::of(fractions).rms_rad
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

/// Expected fraction of nodes beyond their bound where so many were measured.
pub fn fraction_beyond(measured: usize) -> f64 {
    rank(measured) as f64 / (measured + 1) as f64
}

/// The largest error of each node's series against the skylines of some azimuths.
fn largest_errors_rad(swept: &Swept, texels: &TexelStore, probed: &[usize]) -> Result<Vec<f32>, Error> {
    let Request { face, level, settings, .. } = swept.request;
    let (columns, rows) = (texels.map().columns, texels.map().rows);
    let mut largest_rad = vec![0.0_f32; columns * rows];
    let limits =
        |major: Major| settings.band.map(|band| BandLimits::of(&band, &face.map, swept.request.nodes(), major));
    let at_hand = |azimuth: usize| swept.planes.iter().find(|plane| plane.azimuth == azimuth);
    let row_limits = limits(Major::Row);
    for major in [Major::Row, Major::Column] {
        let along = |azimuth: &&usize| Major::of(settings.direction(**azimuth)) == major;
        let azimuths: Vec<usize> = probed.iter().filter(along).copied().collect();
        let search = match azimuths.iter().all(|azimuth| at_hand(*azimuth).is_some()) {
            true => None,
            false => Some((Search::new(face, *level, major, settings, swept.device)?, limits(major))),
        };
        for block in azimuths.chunks(swept.block) {
            let plane = |&azimuth: &usize| match at_hand(azimuth) {
                Some(plane) => Ok(Cow::Borrowed(plane)),
                None => {
                    let (search, limits) = search.as_ref().expect("made where a plane is not at hand");
                    search.plane(limits.as_ref(), settings, azimuth).map(Cow::Owned)
                }
            };
            let planes = block.par_iter().map(plane).collect::<Result<Vec<_>, Error>>()?;
            let directions: Vec<_> = block.iter().map(|azimuth| settings.direction(*azimuth)).collect();
            for strip in texels.strips() {
                let strip = strip?;
                let decoder = Decoder::new(&strip.map, &directions);
                let largest_rad = &mut largest_rad[strip.rows.start * columns..strip.rows.end * columns];
                largest_rad.par_chunks_mut(columns).enumerate().for_each(|(i, largest_rad)| {
                    let row = strip.rows.start + i;
                    let decoded = decoder.row(row - strip.first);
                    for (plane, decoded_rad) in planes.iter().zip(decoded.chunks(columns)) {
                        for (column, largest_rad) in largest_rad.iter_mut().enumerate() {
                            let swept_rad = plane.at(major, column, row);
                            let decoded_rad = match &row_limits {
                                Some(limits) => limits.clamped(row * columns + column, decoded_rad[column]),
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
