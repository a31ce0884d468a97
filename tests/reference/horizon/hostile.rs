//! Tiles that lie about themselves, or are damaged: errors from every function that reads one, and never the end of the process.

use std::fs;
use std::path::Path;

use perilune_engine::geometry::Body;
use perilune_engine::horizon::{Encoding, HorizonMap, Request, Settings, build, header::Header, store};
use serde_json::{Value as Json, json};

use super::scene::cratered;

/// A tile of an encoding as bytes.
fn tile(encoding: Encoding) -> Vec<u8> {
    let directory = tempfile::tempdir().unwrap();
    let (body, face) = (Body::moon(), cratered(33, 20.0, 1));
    let settings = Settings { azimuths: 96, ..Settings::default() };
    let request = Request { body: &body, face: &face, level: 0, settings, encoding };
    build(&request, directory.path(), &|_, _| ()).unwrap();
    fs::read(store::path_for(directory.path(), &request.key())).unwrap()
}

fn read(path: &Path, bytes: &[u8]) -> Result<(Header, HorizonMap), String> {
    fs::write(path, bytes).unwrap();
    store::read(path).map_err(|error| {
        format!("{error}{}", std::error::Error::source(&error).map_or(String::new(), |source| format!(": {source}")))
    })
}

/// The tile with another header of the same length: the texts that describe it make room.
fn with_header(tile: &[u8], change: &dyn Fn(&mut Json)) -> Vec<u8> {
    let start = tile.windows(10).position(|window| window == b"{\"format\":").unwrap();
    let length = tile[start..].iter().position(|byte| *byte == 0).unwrap();
    let mut header: Json = serde_json::from_slice(&tile[start..start + length]).unwrap();
    for key in ["series", "azimuth", "elevation", "pixel", "generator"] {
        header[key] = "".into();
    }
    change(&mut header);
    let mut text = serde_json::to_vec(&header).unwrap();
    assert!(text.len() <= length, "{} of {length}", text.len());
    text.resize(length, b' ');
    let mut changed = tile.to_vec();
    changed[start..start + length].copy_from_slice(&text);
    changed
}

/// One lie about a number each; what is unchanged is read.
#[test]
fn a_header_that_cannot_be_true_is_refused_by_the_key_that_lies() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tile.tif");
    let tile = tile(Encoding::Q);
    assert!(read(&path, &with_header(&tile, &|_| ())).is_ok());
    let lies: [(&str, Json, &str); 26] = [
        ("/columns", json!(0), "0 × 33 nodes"),
        ("/columns", json!(1), "1 × 33 nodes"),
        ("/columns", json!(1_u64 << 32), "4294967296 × 33 nodes"),
        ("/columns", json!(16_000_000), "no room"),
        ("/rows", json!(u64::MAX), "nodes"),
        ("/columns", json!(34), "not those of q"),
        ("/pages/0/columns", json!((1_u64 << 32) + 33), "not those of q"),
        ("/pages/0/scale", json!(0), "not those of q"),
        ("/pages/0/name", json!("re 0"), "not those of q"),
        ("/pages/0/field/width", json!(0), "not those of q"),
        ("/pages/0/field/width", json!(33), "not those of q"),
        ("/pages/0/field/shift", json!(32), "not those of q"),
        ("/pages/0/field/word", json!(8), "not those of q"),
        ("/pages/0/field/real", json!(4096), "not those of q"),
        ("/pages/0/field/step_rad", json!(1e300), "not those of q"),
        ("/pages", json!([]), "not those of q"),
        ("/encoding", json!("fm16"), "not those of fm16"),
        ("/body/polar_radius_m", json!(0.0), "body.polar_radius_m = 0"),
        ("/map/radius_m", json!(-1.0), "map.radius_m = -1"),
        ("/map/posting_m", json!(0.0), "map.posting_m = 0"),
        ("/map/west_m", json!(1e300), "map.west_m"),
        ("/map/right", json!([0.0, 0.0, 0.0]), "axes of a right-handed frame"),
        ("/map/centre_deg", json!([91.0, 0.0]), "latitude of map.centre_deg = 91"),
        ("/settings/azimuths", json!(0), "settings.azimuths = 0"),
        ("/settings/observer_height_m", json!(-1.0), "settings.observer_height_m = -1"),
        ("/settings/search_m", json!(0.0), "settings.search_m = 0"),
    ];
    for (key, value, expected) in lies {
        let lie =
            with_header(&tile, &|header| *header.pointer_mut(key).unwrap_or_else(|| panic!("{key}")) = value.clone());
        let error = read(&path, &lie).unwrap_err();
        assert!(error.contains(expected), "{key} = {value}: {error}");
    }
    // Two fields in the same bits.
    let doubled = with_header(&tile, &|header| {
        let field = header["pages"][0]["field"].clone();
        for key in ["word", "shift"] {
            header["pages"][1]["field"][key] = field[key].clone();
        }
    });
    assert!(read(&path, &doubled).unwrap_err().contains("not those of q"));
}

/// Bytes changed at random, half of them in the first page and its header: an error or a tile, in whatever build.
#[test]
fn damage_ends_no_process() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tile.tif");
    let mut state = 1_u64;
    let mut next = |below: usize| {
        // Knuth's linear congruence.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for encoding in [Encoding::Fm16, Encoding::W21, Encoding::Raw8] {
        let tile = tile(encoding);
        let mut refused = 0;
        for round in 0..400 {
            let mut damaged = tile.clone();
            for _ in 0..=next(4) {
                let at = next(if round % 2 == 0 { damaged.len() } else { damaged.len() / 20 });
                damaged[at] = [0, 0xff, damaged[at] ^ 1 << next(8), next(256) as u8][next(4)];
            }
            if round % 5 == 0 {
                damaged.truncate(next(tile.len()));
            }
            refused += usize::from(read(&path, &damaged).is_err());
        }
        assert!(refused > 100, "{refused} of 400 noticed");
    }
}

/// Found by a fuzzer; each ended the process.
#[test]
fn tiles_that_once_ended_the_process_are_refused() {
    let Some(folder) = crate::fixtures::data("inputs/111_tile_crashes") else { return };
    for name in ["tile_1.tif", "tile_2.tif", "tile_3.tif", "tile_4.tif"] {
        let error = store::read(&folder.join(name)).unwrap_err();
        println!("{name}: {error}");
    }
}
