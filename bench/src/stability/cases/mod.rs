//! The cases, a file a group.

mod edges;
mod penumbra;
mod places;
mod precision;
mod skylines;
mod sun;

use std::f64::consts::FRAC_PI_2;

use super::Case;
use super::case::Judge;
use super::scenes::{Row, scene};
use perilune_engine::geometry::Body;
use perilune_engine::render::{Light, Renderer, Samples, Scene, View};
use perilune_engine::shadow::registry::reference;
use perilune_engine::terrain::Terrain;

/// Where the Sun of most cases stands: its light travels towards map +X.
const WEST_RAD: f64 = -FRAC_PI_2;

/// All cases, by group.
pub fn all() -> Vec<Case> {
    [sun::cases(), penumbra::cases(), edges::cases(), skylines::cases(), places::cases(), precision::cases()]
        .into_iter()
        .flatten()
        .collect()
}

/// Ground that drops by `height_m` at x = 0.
fn step(height_m: f64) -> impl Fn(glam::DVec2) -> f64 {
    move |at_m| if at_m.x <= 0.0 { height_m } else { 0.0 }
}

/// The passages of a row of pixels through half the disc lie where they are expected, view by view: the largest distance,
/// infinite where there are more or fewer.
fn passages(row: Vec<(Row, Vec<f64>)>) -> Judge {
    Box::new(move |images: &[Samples]| {
        let worst = |(image, (row, expected_m)): (&Samples, &(Row, Vec<f64>))| {
            let found_m = row.edges_m(image);
            if found_m.len() != expected_m.len() {
                return f64::INFINITY;
            }
            found_m.iter().zip(expected_m).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        images.iter().zip(&row).map(worst).fold(0.0, f64::max)
    })
}

/// Rows of pixels under lights, and where the shadow begins or ends in them.
struct Passage {
    row: Row,
    light: Light,
    expected_m: Vec<f64>,
}

/// A case about passages; `limit_m` is a posting.
fn passage_case(
    number: u8,
    name: &'static str,
    terrain: Terrain,
    limit_m: f64,
    reach_m: f64,
    seen: Vec<Passage>,
) -> Case {
    let map = terrain.faces[0].map.clone();
    let views = seen.iter().map(|one| one.row.view(&map, one.light.clone())).collect();
    let rows = seen.into_iter().map(|one| (one.row, one.expected_m)).collect();
    Case {
        number,
        name,
        error_of: "place of the shadow's edge in m",
        limit: limit_m,
        scene: scene(terrain),
        views,
        reach_m,
        soft: false,
        error: passages(rows),
    }
}

/// The largest error of the share of the disc, where `expected` knows it by view and map point.
fn shares(expected: impl Fn(usize, glam::DVec2) -> Option<f64> + 'static) -> Judge {
    Box::new(move |images: &[Samples]| {
        let points = images.iter().enumerate().flat_map(|(view, image)| {
            super::scenes::profile(image).into_iter().map(move |(at_m, share)| (view, at_m, share))
        });
        let errors = points.filter_map(|(view, at_m, share)| Some((share - expected(view, at_m)?).abs()));
        errors.fold(0.0, f64::max)
    })
}

/// The mean error of the share of the disc against a traced image of the only view.
fn against_traced(scene: &mut Scene, view: &View) -> Judge {
    *scene = scene.clone().with_shadows(reference(Default::default()));
    // Small terrain, a law and a camera in their domains: the reference renders it.
    let truth = Renderer::Reference.samples(scene, view).map(|image| image.pixels).unwrap_or_default();
    Box::new(move |images: &[Samples]| {
        let differences =
            images[0].pixels.iter().zip(&truth).map(|(a, b)| f64::from((a.sun_fraction - b.sun_fraction).abs()));
        let known: Vec<f64> = differences.filter(|difference| difference.is_finite()).collect();
        known.iter().sum::<f64>() / known.len() as f64
    })
}

fn moon() -> Body {
    Body::moon()
}
