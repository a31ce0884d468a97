//! Horizon tiles: built, stored, read back, resumed, refused.

use std::fs;
use std::sync::{LazyLock, Mutex};

use glam::DVec3;
use perilune_engine::geometry::{Body, Direction};
use perilune_engine::horizon::build::Builder;
use perilune_engine::horizon::inspect::TilePoint;
use perilune_engine::horizon::store;
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::horizon::verify::verify;
use perilune_engine::horizon::{
    ElevationBand, Encoding, Error, Memory, Request, Settings, build, build_at, open_or_build,
};
use perilune_engine::terrain::Face;

use super::scene::cratered;

fn settings() -> Settings {
    Settings { azimuths: 40, ..Settings::default() }
}

fn moon() -> &'static Body {
    static MOON: LazyLock<Body> = LazyLock::new(Body::moon);
    &MOON
}

fn request(face: &Face) -> Request<'_> {
    Request { body: moon(), face, level: 0, settings: settings(), encoding: Encoding::Fm16 }
}

#[test]
fn a_tile_read_back_is_the_tile_that_was_built() {
    let directory = tempfile::tempdir().unwrap();
    let face = cratered(101, 20.0, 1);
    for encoding in Encoding::ALL {
        let settings = Settings { azimuths: 96, ..settings() };
        let request = Request { encoding, settings, ..request(&face) };
        let built = build(&request, directory.path(), &|_, _| ()).unwrap();
        let key = request.key();
        let (header, read) = store::read(&store::path_for(directory.path(), &key)).unwrap();
        assert!(read == built);
        assert_eq!(header.key, key);
        assert!(built.errors.swept.p95_rad.to_degrees() < 0.01);
        assert!(built.errors.decoded.rms_rad > built.errors.swept.rms_rad);
        assert_eq!(
            built.levels.iter().map(|l| l.columns).collect::<Vec<_>>(),
            encoding.pages().iter().map(|page| 101_usize.div_ceil(page.scale)).collect::<Vec<_>>()
        );
    }
    let files = fs::read_dir(directory.path()).unwrap().count();
    assert_eq!(files, Encoding::ALL.len(), "nothing but the tiles is left behind");
}

/// About a light as high as that over the pole.
fn band(elevation_rad: f64) -> ElevationBand {
    let (sin, cos) = elevation_rad.sin_cos();
    ElevationBand::about(&[(Direction::new(DVec3::new(cos, 0.0, -sin)).unwrap(), 0.004_65)]).unwrap()
}

/// In craters the skyline stands above the band, on their rims below it: none of that needs coefficients any more.
#[test]
fn a_tile_with_a_band_errs_less_within_it_and_verifies() {
    let directory = tempfile::tempdir().unwrap();
    let face = cratered(101, 20.0, 1);
    let settings = Settings { band: Some(band(0.03)), ..settings() };
    let build_with = |settings: &Settings| {
        build(&Request { settings: *settings, ..request(&face) }, directory.path(), &|_, _| ()).unwrap()
    };
    let (clamped, whole) = (build_with(&settings), build_with(&Settings { band: None, ..settings }));
    let key = Request { settings, ..request(&face) }.key();
    let (header, read) = store::read(&store::path_for(directory.path(), &key)).unwrap();
    assert_eq!(header.settings, settings);
    let found = verify(&face, 0, &header, &read, 64, 1);
    assert!(found.repeats() && found.agrees(), "{found:?}");
    // The whole skylines, judged within the band.
    let of_whole = verify(&face, 0, &header, &whole, 64, 1);
    assert!(!of_whole.repeats());
    assert!(clamped.errors.decoded.rms_rad < of_whole.repeated.rms_rad, "{:?} {of_whole:?}", clamped.errors);
}

#[test]
fn a_second_run_reuses_the_tile_and_a_changed_height_does_not() {
    let directory = tempfile::tempdir().unwrap();
    let mut face = cratered(65, 20.0, 1);
    let calls = Mutex::new(0);
    let count = |_: usize, _: usize| *calls.lock().unwrap() += 1;
    let first = open_or_build(&request(&face), directory.path(), Memory::default(), &count).unwrap();
    let after_first = *calls.lock().unwrap();
    assert!(open_or_build(&request(&face), directory.path(), Memory::default(), &count).unwrap() == first);
    assert_eq!(*calls.lock().unwrap(), after_first);
    face.levels[0].heights_m[7] += 1.0;
    open_or_build(&request(&face), directory.path(), Memory::default(), &count).unwrap();
    assert!(*calls.lock().unwrap() > after_first);
}

#[test]
fn everything_that_shapes_a_tile_changes_its_key() {
    let face = cratered(33, 20.0, 1);
    let base = request(&face).key();
    let mut keys = vec![base, Request { encoding: Encoding::F16, ..request(&face) }.key()];
    for settings in [
        Settings { azimuths: 41, ..settings() },
        Settings { observer_height_m: 2.0, ..settings() },
        Settings { search_m: Some(1e4), ..settings() },
        Settings { band: Some(band(0.03)), ..settings() },
        Settings { band: Some(band(0.04)), ..settings() },
    ] {
        keys.push(Request { settings, ..request(&face) }.key());
    }
    let change = |edit: &dyn Fn(&mut perilune_engine::terrain::Face)| {
        let mut face = face.clone();
        edit(&mut face);
        request(&face).key()
    };
    keys.push(change(&|face| face.levels[0].heights_m[0] += 0.01));
    keys.push(change(&|face| face.levels[0].gap[3] = true));
    keys.push(change(&|face| face.levels[0].margin = 1));
    keys.push(change(&|face| face.levels[0].posting_m = 21.0));
    keys.push(change(&|face| face.map.radius_m += 1.0));
    keys.push(Request { body: &Body { name: "other".into(), ..Body::moon() }, ..request(&face) }.key());
    let count = keys.len();
    keys.sort_by(|a, b| a.as_str().cmp(b.as_str()));
    keys.dedup();
    assert_eq!(keys.len(), count);
}

#[test]
fn threads_do_not_change_a_byte() {
    let face = cratered(97, 20.0, 4);
    let bytes = |threads: usize| {
        let directory = tempfile::tempdir().unwrap();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| build(&request(&face), directory.path(), &|_, _| ())).unwrap();
        fs::read(store::path_for(directory.path(), &request(&face).key())).unwrap()
    };
    assert!(bytes(1) == bytes(3));
}

#[test]
fn damaged_and_foreign_tiles_are_named_and_rebuilt() {
    let directory = tempfile::tempdir().unwrap();
    let face = cratered(65, 20.0, 1);
    let key = request(&face).key();
    let built = build(&request(&face), directory.path(), &|_, _| ()).unwrap();
    let path = store::path_for(directory.path(), &key);
    let whole = fs::read(&path).unwrap();

    fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    let message = store::read_of(directory.path(), &key).unwrap_err().to_string();
    assert!(message.contains("truncated") && message.contains("horizon_"), "{message}");
    assert!(open_or_build(&request(&face), directory.path(), Memory::default(), &|_, _| ()).unwrap() == built);

    let other = Request { settings: Settings { azimuths: 48, ..settings() }, ..request(&face) }.key();
    fs::write(store::path_for(directory.path(), &other), &whole).unwrap();
    assert!(matches!(store::read_of(directory.path(), &other), Err(Error::OtherKey { .. })));

    fs::write(&path, b"not a tiff").unwrap();
    assert!(matches!(store::read(&path), Err(Error::Decode { .. })));
    assert!(matches!(store::read(&directory.path().join("absent.tif")), Err(Error::Read { .. })));
}

#[test]
fn elevations_that_grow_otherwise_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("w16.tif");
    let mut tile = include_bytes!("../../vectors/w16.tif").to_vec();
    let growth = b"\"growth\":2.5";
    let at = tile.windows(growth.len()).position(|bytes| bytes == growth).unwrap();
    fs::write(&path, &tile).unwrap();
    assert!(store::read(&path).is_ok());
    tile[at + growth.len() - 1] = b'0';
    fs::write(&path, &tile).unwrap();
    let message = store::read(&path).unwrap_err().to_string();
    assert!(message.contains("w16.tif") && message.contains("its growth is not that of w16"), "{message}");
}

#[test]
fn a_tile_that_cannot_be_written_is_an_error_with_its_path() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("file");
    fs::write(&file, b"").unwrap();
    let error = build(&request(&cratered(33, 20.0, 1)), &file.join("tiles"), &|_, _| ()).unwrap_err();
    assert!(error.to_string().contains("file/tiles"), "{error}");
    // A name that no file can take.
    let key = request(&cratered(33, 20.0, 1)).key();
    fs::create_dir_all(store::path_for(directory.path(), &key).join("inside")).unwrap();
    let error = build(&request(&cratered(33, 20.0, 1)), directory.path(), &|_, _| ()).unwrap_err();
    assert!(matches!(error, Error::Write { .. }), "{error}");
    let names = fs::read_dir(directory.path()).unwrap().map(|entry| entry.unwrap().file_name());
    assert_eq!(names.filter(|name| name.to_string_lossy().ends_with(".partial")).count(), 0);
}

#[test]
fn settings_out_of_range_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let face = cratered(33, 20.0, 1);
    for settings in [
        Settings { azimuths: 30, ..settings() },
        Settings { observer_height_m: -1.0, ..settings() },
        Settings { observer_height_m: f64::NAN, ..settings() },
        Settings { search_m: Some(0.0), ..settings() },
    ] {
        assert!(build(&Request { settings, ..request(&face) }, directory.path(), &|_, _| ()).is_err(), "{settings:?}");
    }
    assert!(matches!(
        build(&Request { level: 1, ..request(&face) }, directory.path(), &|_, _| ()),
        Err(Error::NoLevel { .. })
    ));
}

/// With a budget of nothing the sums are kept on disk.
#[test]
fn memory_does_not_change_a_byte() {
    let face = cratered(97, 20.0, 4);
    for encoding in [Encoding::Fm16, Encoding::F16] {
        let request = Request { encoding, ..request(&face) };
        let bytes = |memory: Memory| {
            let directory = tempfile::tempdir().unwrap();
            let path = directory.path().join("tile.tif");
            build_at(&request, &path, memory, &|_, _| ()).unwrap();
            assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1, "nothing but the tile is left behind");
            fs::read(path).unwrap()
        };
        assert!(!Memory::mib(0).allowance(&request).sums_fit && Memory::default().allowance(&request).sums_fit);
        assert!(bytes(Memory::mib(0)) == bytes(Memory::default()));
    }
}

/// A build that stops half way leaves a checkpoint; the next one goes on from there, with more memory or with less.
#[test]
fn an_interrupted_build_goes_on_to_the_same_bytes() {
    let face = cratered(65, 20.0, 6);
    let (whole, broken) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let path = |directory: &std::path::Path| store::path_for(directory, &request(&face).key());
    build(&request(&face), whole.path(), &|_, _| ()).unwrap();
    let (much, none) = (Memory::default(), Memory::mib(0));
    for (stop_after, before, after) in [(5, much, much), (21, none, much), (33, much, none), (13, none, none)] {
        let mut builder = Builder::new(&request(&face), &path(broken.path()), before).unwrap();
        while builder.done() < stop_after {
            builder.step().unwrap();
        }
        builder.save().unwrap();
        drop(builder);
        let first = Mutex::new(None);
        let note = |done: usize, _: usize| {
            first.lock().unwrap().get_or_insert(done);
        };
        build_at(&request(&face), &path(broken.path()), after, &note).unwrap();
        assert!(first.lock().unwrap().unwrap() > stop_after, "it went on and did not start afresh");
        assert!(fs::read(path(whole.path())).unwrap() == fs::read(path(broken.path())).unwrap());
        assert_eq!(fs::read_dir(broken.path()).unwrap().count(), 1, "the checkpoint is gone");
        fs::remove_file(path(broken.path())).unwrap();
    }
}

/// A checkpoint with a flipped bit is not believed.
#[test]
fn a_damaged_checkpoint_is_ignored() {
    let face = cratered(65, 20.0, 6);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tile.tif");
    for memory in [Memory::default(), Memory::mib(0)] {
        let mut builder = Builder::new(&request(&face), &path, memory).unwrap();
        builder.step().unwrap();
        builder.save().unwrap();
        let checkpoint = path.with_extension("checkpoint");
        let mut bytes = fs::read(&checkpoint).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        fs::write(&checkpoint, bytes).unwrap();
        assert_eq!(Builder::new(&request(&face), &path, memory).unwrap().done(), 0);
    }
}

/// Skyline of a place by latitude and longitude, decoded and traced, azimuth from north.
#[test]
fn a_place_is_found_by_latitude_and_longitude() {
    let directory = tempfile::tempdir().unwrap();
    let (body, face) = (Body::moon(), cratered(129, 20.0, 1));
    build(&Request { encoding: Encoding::F16, ..request(&face) }, directory.path(), &|_, _| ()).unwrap();
    let path = store::path_for(directory.path(), &Request { encoding: Encoding::F16, ..request(&face) }.key());
    let (header, map) = store::read(&path).unwrap();
    assert!(TilePoint::on(&header, -80.0, 0.0).is_none());
    // 600 m from the pole towards 90° east, which the map about longitude 0 has on its right.
    let latitude_deg = -90.0 + (600.0 / body.equatorial_radius_m).to_degrees();
    let place = TilePoint::on(&header, latitude_deg, 90.0).unwrap();
    assert!((place.at_m - glam::DVec2::new(600.0, 0.0)).length() < 1e-3, "{place:?}");
    // North, away from the pole, is right on the map there; east of it, 90° clockwise, is down.
    assert!((place.direction(&header, 0.0) - glam::DVec2::X).length() < 1e-6);
    assert!((place.direction(&header, std::f64::consts::FRAC_PI_2) + glam::DVec2::Y).length() < 1e-6);
    let tracer = Tracer::new(&face, &header.settings);
    let errors = (0..40).map(|i| {
        let azimuth_rad = f64::from(i) / 40.0 * std::f64::consts::TAU;
        let traced = place.traced(&header, &tracer, azimuth_rad).unwrap();
        place.decoded_rad(&header, &map, azimuth_rad) - traced.elevation_rad
    });
    let rms_rad = (errors.map(|e| e * e).sum::<f64>() / 40.0).sqrt();
    assert!(rms_rad < 3.0 * header.errors.decoded.rms_rad, "{rms_rad}");
}
