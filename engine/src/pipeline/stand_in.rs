//! Ground in place of models that are not made yet: flat, of their places and nodes.

use crate::geometry::{Body, Geodetic};
use crate::scenario::{Dem, Terrain};
use crate::terrain::{Face, Gnomonic, Level};

use super::models::{Extent, ModelFacts};

/// A face of flat levels for models that are all made, the finest first; `None` where one is not.
pub fn face(body: &Body, terrain: &Terrain) -> Option<(Face, Geodetic)> {
    let centre_of = |dem: &Dem| match dem {
        Dem::Synthetic { centre, .. } => Some(*centre),
        _ => None,
    };
    let centre = terrain.centre.or_else(|| centre_of(terrain.dems.first()?))?;
    let map = Gnomonic::about(body, centre);
    let level = |dem: &Dem| {
        let &Dem::Synthetic { columns, rows, posting_m, centre, .. } = dem else { return None };
        let (columns, rows) = (columns as usize, rows as usize);
        let middle = map.lifted_from_body(body.position_from_geodetic(Geodetic { height_m: 0.0, ..centre }))?;
        let half = |count: usize| (count - 1) as f64 * posting_m / 2.0;
        let (west_m, south_m) = (middle.x - half(columns), middle.y - half(rows));
        let gap = vec![false; columns * rows];
        let empty = Level { columns, rows, posting_m, west_m, south_m, heights_m: Vec::new(), gap, margin: 0 };
        let height_m =
            |index: usize| map.lifted_height_m(empty.node_m(index % columns, index / columns), map.radius_m) as f32;
        let heights_m = (0..columns * rows).map(height_m).collect();
        Some(Level { heights_m, ..empty })
    };
    let levels = terrain.dems.iter().map(level).collect::<Option<Vec<_>>>()?;
    Some((Face { map, levels }, centre))
}

/// What is known of a model that is not made yet.
pub fn model(body: &Body, dem: &Dem) -> Option<ModelFacts> {
    let &Dem::Synthetic { columns, rows, posting_m, centre, .. } = dem else { return None };
    let map = Gnomonic::about(body, centre);
    let half = [columns, rows].map(|count| f64::from(count) * posting_m / 2.0);
    let steps = (0..9).map(|step| f64::from(step) / 4.0 - 1.0);
    let corners = steps.clone().flat_map(|y| steps.clone().map(move |x| glam::DVec2::new(x * half[0], y * half[1])));
    let place = |at: glam::DVec2| {
        body.geodetic_from_position(map.body_from_lifted(at.extend(map.lifted_height_m(at, map.radius_m))))
    };
    let places: Vec<Geodetic> = corners.map(place).collect();
    let pole = [-90.0, 90.0].map(|latitude_deg| {
        let pole = body.position_from_geodetic(Geodetic::from_degrees(latitude_deg, 0.0, 0.0));
        map.lifted_from_body(pole).is_some_and(|at| at.x.abs() <= half[0] && at.y.abs() <= half[1])
    });
    Some(ModelFacts {
        name: "Synthetic".into(),
        crs: "made by the first run".into(),
        posting_m,
        columns: columns as usize,
        rows: rows as usize,
        extent: Extent::around(&places, pole),
        heights_m: None,
        share_without_heights: 0.0,
    })
}
