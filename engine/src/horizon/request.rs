//! Which horizons a tile shall hold.

use super::error::Error;
use super::pack::Encoding;
use super::settings::Settings;
use crate::geometry::Body;
use crate::terrain::{Face, Level};

/// The horizons of one level of a face, and how they are compressed: all that shapes a tile.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    pub body: &'a Body,
    pub face: &'a Face,
    /// Index of the level that gets horizons; finer ones take no part in them.
    pub level: usize,
    pub settings: Settings,
    pub encoding: Encoding,
}

impl<'a> Request<'a> {
    /// The level that gets horizons.
    pub fn nodes(&self) -> &'a Level {
        &self.face.levels[self.level]
    }

    /// Whether horizons can be made as asked for.
    pub fn check(&self) -> Result<(), Error> {
        let Self { level, settings, encoding, .. } = *self;
        let levels = self.face.levels.len();
        let nodes = self.face.levels.get(level).ok_or(Error::NoLevel { got: level, levels })?;
        let seen = |nodes: usize, margin: usize| nodes.saturating_sub(2 * margin);
        let (columns, rows) = (seen(nodes.columns, nodes.margin), seen(nodes.rows, nodes.margin));
        if columns < 2 || rows < 2 {
            return Err(Error::TooSmall { level, columns, rows });
        }
        let least = encoding.least_azimuths();
        if settings.azimuths < least {
            return Err(Error::TooFewAzimuths { got: settings.azimuths, encoding, least });
        }
        if !(0.0..=1e6).contains(&settings.observer_height_m) {
            return Err(Error::ObserverHeight { got: settings.observer_height_m });
        }
        match settings.search_m {
            Some(got) if got.is_nan() || got <= 0.0 => Err(Error::SearchDistance { got }),
            _ => Ok(()),
        }
    }
}
