//! Areas of a map: which nodes they hold, and their light as a whole.

use glam::DVec2;

use super::blocks::Blocks;
use super::maps::Maps;
use super::series::Series;
use crate::geometry::{Body, Geodetic};
use crate::terrain::{Gnomonic, Level};

/// A piece of ground.
#[derive(Debug, Clone, PartialEq)]
pub enum Area {
    /// All points within a distance along the ground.
    Circle { centre: Geodetic, radius_m: f64 },
    /// What rings of great circles enclose, the last corner joined to the first; a ring inside another is a hole.
    Polygon(Vec<Vec<Geodetic>>),
}

/// Smallest, mean and largest value over an area's nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MinMeanMax {
    pub least: f64,
    pub mean: f64,
    pub most: f64,
}

/// An area's light over a track.
#[derive(Debug, Clone, PartialEq)]
pub struct AreaSummary {
    pub nodes: usize,
    pub lit_share: MinMeanMax,
    pub disc_share: MinMeanMax,
    /// Of each node by itself.
    pub longest_night_h: MinMeanMax,
    pub earth_share: MinMeanMax,
    /// Longest time that nothing of the area is lit.
    pub longest_dark_h: f64,
    /// Share of the steps at which some of the area is lit.
    pub some_lit_share: f64,
}

impl Area {
    /// Which of a level's seen nodes with heights lie inside; `None` where a corner is not on the map's side of the body.
    pub fn nodes(&self, body: &Body, map: &Gnomonic, level: &Level) -> Option<Vec<bool>> {
        let on_map = |at: &Geodetic| {
            let at = Geodetic { height_m: 0.0, ..*at };
            Some(map.lifted_from_body(body.position_from_geodetic(at))?.truncate())
        };
        let inside: Box<dyn Fn(DVec2) -> bool> = match self {
            Self::Circle { centre, radius_m } => {
                let centre = map.up(on_map(centre)?).unit();
                // The chord of the angle.
                let within = 2.0 * (0.5 * radius_m / map.radius_m).sin();
                Box::new(move |at_m| map.up(at_m).unit().distance(centre) <= within)
            }
            // Great circles are straight on the map.
            Self::Polygon(rings) => {
                let ring = |corners: &Vec<Geodetic>| corners.iter().map(on_map).collect::<Option<Vec<_>>>();
                let rings = rings.iter().map(ring).collect::<Option<Vec<_>>>()?;
                Box::new(move |at_m| rings.iter().filter(|ring| encloses(ring, at_m)).count() % 2 == 1)
            }
        };
        let blocks = Blocks::of(level);
        let counts = |index: usize| {
            let [column, row] = [index % blocks.columns, index / blocks.columns].map(|index| index + level.margin);
            !level.gap[level.index(column, row)] && inside(level.node_m(column, row))
        };
        Some((0..blocks.nodes()).map(counts).collect())
    }
}

/// Whether a ray towards +x crosses the ring an odd number of times.
fn encloses(ring: &[DVec2], at: DVec2) -> bool {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    let crossed =
        edges.filter(|(a, b)| (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x));
    crossed.count() % 2 == 1
}

impl AreaSummary {
    /// Of an area's nodes and series, with steps of `step_h` hours.
    pub fn of(maps: &Maps, counts: &[bool], series: &Series, step_h: f64) -> Self {
        let spread = |plane: &[f32]| MinMeanMax::of(plane, counts);
        let steps = series.lit_share.len() as f64;
        let dark = series.lit_share.split(|share| *share > 0.0).map(<[f64]>::len).max().unwrap_or(0);
        Self {
            nodes: counts.iter().filter(|counts| **counts).count(),
            lit_share: spread(&maps.lit_share),
            disc_share: spread(&maps.disc_share),
            longest_night_h: spread(&maps.longest_night_h),
            earth_share: spread(&maps.earth_share),
            longest_dark_h: dark as f64 * step_h,
            some_lit_share: series.lit_share.iter().filter(|share| **share > 0.0).count() as f64 / steps,
        }
    }
}

impl MinMeanMax {
    /// Of the values that count and are known.
    pub fn of(plane: &[f32], counts: &[bool]) -> Self {
        let known = || plane.iter().zip(counts).filter(|(value, counts)| **counts && value.is_finite());
        let values = || known().map(|(value, _)| f64::from(*value));
        Self {
            least: values().fold(f64::INFINITY, f64::min),
            mean: values().sum::<f64>() / values().count().max(1) as f64,
            most: values().fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A level of 400 m about the south pole.
    fn level(map: &Gnomonic, nodes: usize) -> Level {
        let low_m = -((nodes - 1) as f64) * 200.0;
        let height_m = map.lifted_height_m(DVec2::ZERO, map.radius_m) as f32;
        Level {
            columns: nodes,
            rows: nodes,
            posting_m: 400.0,
            west_m: low_m,
            south_m: low_m,
            heights_m: vec![height_m; nodes * nodes],
            gap: vec![false; nodes * nodes],
            margin: 0,
        }
    }

    fn km2(area: &Area) -> f64 {
        let body = Body::moon();
        let map = Gnomonic::about(&body, Geodetic::from_degrees(-90.0, 0.0, 0.0));
        let counts = area.nodes(&body, &map, &level(&map, 301)).unwrap();
        counts.iter().filter(|counts| **counts).count() as f64 * 0.16
    }

    /// The map stretches areas by 1/cos³ of the distance, 0.02 % at 20 km; nodes of 400 m resolve a ring of 20 km to 0.2 %.
    #[test]
    fn circles_and_polygons_about_the_pole_have_their_areas() {
        let centre = Geodetic::from_degrees(-89.8, 70.0, 0.0);
        let circle = km2(&Area::Circle { centre, radius_m: 20_000.0 });
        assert!((circle / (std::f64::consts::PI * 400.0) - 1.0).abs() < 3e-3, "{circle}");
        // A triangle around the pole, corners 30 km from it: its sides are great circles.
        let deg = 30_000.0_f64.atan2(1_737_400.0).to_degrees() - 90.0;
        let corners = [10.0, 130.0, 250.0].map(|longitude| Geodetic::from_degrees(deg, longitude, 0.0));
        let triangle = km2(&Area::Polygon(vec![corners.to_vec()]));
        assert!((triangle / (0.75 * 3.0_f64.sqrt() * 900.0) - 1.0).abs() < 3e-3, "{triangle}");
        // With a hole of a quarter of it.
        let deg = 15_000.0_f64.atan2(1_737_400.0).to_degrees() - 90.0;
        let hole = [10.0, 130.0, 250.0].map(|longitude| Geodetic::from_degrees(deg, longitude, 0.0));
        let left = km2(&Area::Polygon(vec![corners.to_vec(), hole.to_vec()]));
        assert!((left / triangle / 0.75 - 1.0).abs() < 3e-3, "{left}");
    }

    #[test]
    fn a_hollow_is_outside() {
        let ring = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]].map(DVec2::from);
        assert!(encloses(&ring, DVec2::new(0.5, 1.0)) && encloses(&ring, DVec2::new(3.5, 2.0)));
        assert!(!encloses(&ring, DVec2::new(2.0, 3.0)) && !encloses(&ring, DVec2::new(-1.0, 1.0)));
    }
}
