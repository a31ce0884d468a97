//! Albedo maps on the nodes of a surface.
//!
//! A map finer than the nodes is averaged, `n × n` of its pixels to one, so that a node has the mean of the ground about it and not
//! one sample of it; a coarser one is bilinear between its pixels.

use std::f64::consts::SQRT_2;
use std::path::Path;

use glam::DVec2;

use super::Error;
use super::names::file_name;
use crate::geometry::{Body, Position};
use crate::raster::{Around, Content, Dem, Options, Reading, Values};
use crate::terrain::{Face, Gnomonic, Level, Surface, Terrain};

/// A map on the nodes of a surface.
#[derive(Debug)]
pub struct AlbedoOnNodes {
    /// By face and level; NaN where the map has none.
    pub values: Vec<Vec<Vec<f32>>>,
    /// What a user should know of the map's file, a line each.
    pub findings: Vec<String>,
}

/// Values of an albedo map on the nodes of all levels, times `scale`.
pub fn albedo(surface: &Surface, path: &Path, reading: &Reading, scale: f64) -> Result<AlbedoOnNodes, Error> {
    let Terrain { body, faces } = &surface.terrain;
    let mut findings = Vec::new();
    let mut of_level = |face: &Face, level: &Level| -> Result<Vec<f32>, Error> {
        // Faces of a cube go around the body, and so does their map.
        let around = if faces.len() == 1 { Some(around(body, &face.map, level)) } else { None };
        let options = Options { around, posting_m: Some(level.posting_m), ..options(reading) };
        let map = Dem::open(path, body, &options)?;
        for finding in &map.survey.findings {
            let finding = format!("{}: {finding}", file_name(path));
            if !findings.contains(&finding) {
                findings.push(finding);
            }
        }
        let node = |index: usize| level.lifted_node(index % level.columns, index / level.columns);
        let points: Vec<_> = (0..level.heights_m.len()).map(|index| face.map.body_from_lifted(node(index))).collect();
        let pixels = map.georeference.projector()?.pixels(&points);
        Ok(pixels.into_iter().map(|pixel| (scale * map.bilinear_m(pixel)) as f32).collect())
    };
    let mut of_face =
        |face: &Face| face.levels.iter().map(|level| of_level(face, level)).collect::<Result<Vec<_>, _>>();
    let values = faces.iter().map(&mut of_face).collect::<Result<Vec<_>, _>>()?;
    Ok(AlbedoOnNodes { values, findings })
}

/// Looks at all of a map: what a user should know of it, a line each.
pub fn look_at_albedo(path: &Path, reading: &Reading, body: &Body) -> Result<Vec<String>, Error> {
    let survey = Dem::survey(path, body, &options(reading))?;
    Ok(survey.findings.into_iter().map(|finding| format!("{}: {finding}", file_name(path))).collect())
}

pub(super) fn options(reading: &Reading) -> Options {
    Options { reading: reading.clone(), values: Values::Height, content: Content::Albedo, ..Options::default() }
}

/// A circle around all nodes of a level.
fn around(body: &Body, map: &Gnomonic, level: &Level) -> Around {
    let far = level.node_m(level.columns - 1, level.rows - 1);
    let middle_m = 0.5 * (level.node_m(0, 0) + far);
    let towards = map.map_from_body.inverse().turn(map.up(middle_m).unit());
    let centre = body.geodetic_from_position(Position::from_m(map.origin.vector_m() + map.radius_m * towards));
    // Away from the map's middle its metres are longer than those about the level's.
    let stretch = 1.0 + middle_m.length_squared() / (map.radius_m * map.radius_m);
    let reach_m = (far - middle_m).abs().max_element() * SQRT_2 + DVec2::splat(level.posting_m).max_element();
    Around { centre, distance_m: reach_m * stretch }
}
