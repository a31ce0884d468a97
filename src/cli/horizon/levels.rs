//! The levels that tiles are made from, as arguments.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use perilune_engine::ephemeris::Almanac;
use perilune_engine::geometry::{Body, Geodetic};
use perilune_engine::horizon::Request;
use perilune_engine::horizon::header::Header;
use perilune_engine::pipeline::Progress;
use perilune_engine::pipeline::ground::{self, Ground};
use perilune_engine::raster::{self, Reading};
use perilune_engine::scenario::{self, Dem};

use crate::cli::ranges;

/// How DEMs become levels.
#[derive(Debug, clap::Args)]
#[group(id = "levels")]
pub struct Args {
    /// Distance of nodes in metres, one for each DEM in turn [default: the DEM's own]
    #[arg(long, value_name = "M", value_parser = ranges::posting, allow_hyphen_values = true)]
    posting: Vec<f64>,
    /// Side in metres of the square about the centre to cover, one for each DEM in turn [default: all of the DEM]
    #[arg(long, value_name = "M", value_parser = ranges::metres, allow_hyphen_values = true)]
    extent: Vec<f64>,
    /// Cut one DEM of the whole body into the six faces of a cube
    #[arg(long, conflicts_with = "extent")]
    cube: bool,
    /// What pixels hold; auto tells heights from radii by their size
    #[arg(long, value_enum, default_value_t)]
    values: Values,
    #[command(flatten)]
    body: BodyArgs,
}

/// The reference surface.
#[derive(Debug, clap::Args)]
pub struct BodyArgs {
    /// Body, as moon, mars or any that the default kernels have constants of
    #[arg(long, default_value = "moon")]
    body: String,
    /// Take a sphere of this radius in metres for the body, as some DEMs do
    #[arg(long, value_name = "M", value_parser = ranges::radius, allow_hyphen_values = true)]
    radius: Option<f64>,
}

#[derive(Debug, Clone, Copy, Default, ValueEnum)]
pub enum Values {
    #[default]
    Auto,
    Height,
    Radius,
}

impl From<Values> for raster::Values {
    fn from(values: Values) -> Self {
        match values {
            Values::Auto => Self::Auto,
            Values::Height => Self::Height,
            Values::Radius => Self::Radius,
        }
    }
}

impl BodyArgs {
    pub fn body(&self) -> Result<Body, Box<dyn std::error::Error>> {
        let body = Almanac::default_kernels()?.body_frame(&self.body, None)?.body;
        Ok(match self.radius {
            Some(radius_m) => Body { equatorial_radius_m: radius_m, polar_radius_m: radius_m, ..body },
            None => body,
        })
    }
}

impl Args {
    /// Opens the DEMs and lifts them onto levels, as a run does.
    pub fn ground(
        &self,
        dems: &[PathBuf],
        centre: Option<Geodetic>,
        progress: &dyn Progress,
    ) -> Result<Ground, Box<dyn std::error::Error>> {
        let terrain = scenario::Terrain { centre, dems: self.dems(dems)? };
        // Only synthetic terrain is kept in a cache.
        let ground = ground::surface(Some(&terrain), &self.body.body()?, Path::new(""), progress)?;
        ground.findings.iter().for_each(|finding| progress.say(finding));
        Ok(ground)
    }

    fn dems(&self, paths: &[PathBuf]) -> Result<Vec<Dem>, String> {
        for (option, given) in [("--posting", self.posting.len()), ("--extent", self.extent.len())] {
            if given > paths.len() {
                return Err(format!("{option} is given {given} times for {} DEMs", paths.len()));
            }
        }
        let values = self.values.into();
        let at = |values: &[f64], index: usize| values.get(index).copied();
        match paths {
            [path] if self.cube => {
                let (path, reading, posting_m) = (path.clone(), Reading::default(), at(&self.posting, 0));
                Ok(vec![Dem::Cube { path, reading, values, posting_m }])
            }
            _ if self.cube => Err(format!("--cube takes one DEM of the whole body, got {}", paths.len())),
            _ => Ok(paths
                .iter()
                .enumerate()
                .map(|(index, path)| Dem::File {
                    path: path.clone(),
                    reading: Reading::default(),
                    values,
                    posting_m: at(&self.posting, index),
                    extent_m: at(&self.extent, index),
                })
                .collect()),
        }
    }
}

/// The face and level whose horizons a tile holds.
pub fn find(ground: &Ground, tile: &Path, header: &Header) -> Result<(usize, usize), String> {
    let faces = &ground.surface.terrain.faces;
    let all =
        faces.iter().enumerate().flat_map(|(face, nodes)| (0..nodes.levels.len()).map(move |level| (face, level)));
    let made_it = |&(face, level): &(usize, usize)| {
        let Header { settings, encoding, .. } = *header;
        Request { body: &ground.surface.terrain.body, face: &faces[face], level, settings, encoding }.key()
            == header.key
    };
    all.into_iter().find(made_it).ok_or_else(|| {
        let [columns, rows] = [header.columns, header.rows];
        let posting_m = header.map.posting_m;
        format!(
            "{} was made from other heights or another map than these DEMs give: it has {columns} × {rows} nodes at \
             {posting_m} m; pass the DEMs, the centre, the body, --posting, --extent and --cube that it was built with",
            tile.display()
        )
    })
}
