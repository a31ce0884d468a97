//! The key of a tile: what its content follows from, as a SHA-256.
//!
//! It covers the heights, the map, the settings, the encoding, and the versions of the format and of the search. What
//! enters it is written out here, number by number and word by word: renaming a type changes no key.

use bytemuck::cast_slice;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::band::ElevationBand;
use super::fit::bit_allocation;
use super::pack::Family;
use super::request::Request;
use super::settings::Method;
use super::sweep;
use crate::terrain::Level;

/// Changes whenever a file of the same inputs would hold other bytes.
pub const FORMAT_VERSION: u32 = 4;

/// What identifies a tile.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Key(String);

impl Key {
    /// The key of the horizons asked for.
    pub fn of(request: &Request) -> Self {
        let Request { body, face, level, settings, encoding } = *request;
        let mut hash = Sha256::new();
        hash.update(FORMAT_VERSION.to_le_bytes());
        hash.update(&body.name);
        hash.update(cast_slice::<f64, u8>(&[body.equatorial_radius_m, body.polar_radius_m]));
        let map = &face.map;
        let numbers =
            [map.origin.vector_m().to_array(), [map.radius_m, settings.observer_height_m, settings.search_limit_m()]];
        hash.update(cast_slice::<f64, u8>(numbers.as_flattened()));
        hash.update(cast_slice::<f64, u8>(&map.map_from_body.matrix().to_cols_array()));
        hash.update((settings.azimuths as u64).to_le_bytes());
        hash.update(encoding.name());
        if encoding.family() == Family::Quantised {
            hash.update([bit_allocation::REVISION]);
        }
        match settings.method {
            Method::Sweep => hash.update([sweep::REVISION]),
            Method::Exact => hash.update("Exact"),
            Method::Gpu => hash.update("Gpu"),
        }
        if let Some(ElevationBand { towards, reach_rad }) = settings.band {
            hash.update(b"band");
            hash.update(cast_slice::<f64, u8>(&[towards[0], towards[1], towards[2], reach_rad]));
        }
        for level in &face.levels[level..] {
            hash.update(level_hash(level));
        }
        Self(crate::digest::hex(&hash.finalize()))
    }

    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Request<'_> {
    /// What identifies the tile.
    pub fn key(&self) -> Key {
        Key::of(self)
    }
}

/// What a level of heights is, as a SHA-256.
pub fn level_hash(level: &Level) -> [u8; 32] {
    let mut hash = Sha256::new();
    let sizes = [level.columns as u64, level.rows as u64, level.margin as u64];
    hash.update(cast_slice::<u64, u8>(&sizes));
    hash.update(cast_slice::<f64, u8>(&[level.posting_m, level.west_m, level.south_m]));
    hash.update(cast_slice::<f32, u8>(&level.heights_m));
    hash.update(level.gap.iter().map(|gap| u8::from(*gap)).collect::<Vec<_>>());
    hash.finalize().into()
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::*;
    use crate::geometry::{Body, Position, Rotation};
    use crate::horizon::{Encoding, Settings};
    use crate::terrain::{Face, Gnomonic};

    /// A key that changes leaves every tile out there to be made anew: that is what the revisions are for, and no renaming.
    #[test]
    fn keys_are_those_of_tiles_that_were_kept() {
        let map = Gnomonic {
            origin: Position::from_m(DVec3::ZERO),
            map_from_body: Rotation::from_matrix(DMat3::IDENTITY),
            radius_m: 1_737_400.0,
        };
        let level = Level {
            columns: 3,
            rows: 2,
            posting_m: 20.0,
            west_m: -20.0,
            south_m: 0.0,
            heights_m: vec![0.0, 1.5, -2.25, 3.0, 4.0, 5.0],
            gap: vec![false, false, false, false, false, true],
            margin: 0,
        };
        let (body, face) = (Body::moon(), Face { map, levels: vec![level] });
        let settings = Settings::default();
        let band = ElevationBand { towards: [0.6, 0.0, 0.8], reach_rad: 0.02 };
        let cases = [
            (Encoding::Fm16, settings, "b362cf92984bccd1218f25f24b833a1aa0b4d59ff732b2abdb42324f8cfaabb2"),
            (Encoding::W21, settings, "05896367a963970354e5a4c6ff14019c92293f81b2668f4b0b5ea6062e533e9a"),
            (
                Encoding::Raw8,
                Settings { method: Method::Exact, observer_height_m: 2.0, ..settings },
                "1dc9d1469d6eb66b6ee309f901b4551a523459ca972044b3c54cbf4e94cb959f",
            ),
            (
                Encoding::Fm16,
                Settings { method: Method::Gpu, search_m: Some(4000.0), ..settings },
                "fc294b8bc033cc90e261d144aeb2c13344d01b869268961fa6713ec1fb522f3d",
            ),
            (
                Encoding::Q,
                Settings { band: Some(band), azimuths: 96, ..settings },
                "10a187734f96d4f92600aa38c5f1b91ebc214858ba8ad8fa7d120aba1845f6bc",
            ),
        ];
        for (encoding, settings, expected) in cases {
            let request = Request { body: &body, face: &face, level: 0, settings, encoding };
            assert_eq!(request.key().as_str(), expected, "{encoding} {settings:?}");
        }
    }
}
