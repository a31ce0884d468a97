//! The default kernels against DE440, and the manifest against the files at hand.

use glam::DVec3;
use hifitime::{Epoch, Unit};
use perilune_engine::ephemeris::{
    Almanac, DEFAULT_KERNELS, EARTH_RADIUS_M, Kernel, apparent, known_file, make_default_kernels, parse_epoch, sun,
};
use perilune_engine::geometry::{Geodetic, Position};

use super::ephemeris::{DE440_KERNELS, default_almanac, kernel_folder, load};
use crate::fixtures::data;

#[test]
fn a_mars_scenario_runs_with_the_default_kernels() {
    let almanac = default_almanac();
    let frame = almanac.body_frame("mars", None).unwrap();
    assert_eq!((frame.frame_name.as_str(), frame.body.polar_radius_m), ("IAU_MARS", 3_376_200.0));
    let Some(de440) = load(&["de440s_all_2023_2025.bsp", "pck00011.tpc"]) else { return };
    let point = frame.body.position_from_geodetic(Geodetic::from_degrees(-4.6, 137.4, 0.0));
    let (mut worst_arcsec, mut worst_km) = (0.0_f64, 0.0_f64);
    for day in 0..1095 {
        let epoch = parse_epoch("2023-01-01Z").unwrap() + f64::from(day) * Unit::Day;
        let [a, b] = [&almanac, &de440].map(|almanac| sun(almanac, &frame, point, epoch).unwrap());
        worst_arcsec = worst_arcsec.max(a.direction.angle_to(b.direction).to_degrees() * 3600.0);
        worst_km = worst_km.max((a.distance_m - b.distance_m).abs() / 1000.0);
    }
    println!("Sun from Mars {worst_arcsec:.1} arcsec {worst_km:.0} km");
    // SOFA states 17 arcsec and 7700 km for 1800 to 2050; the Sun's radius is 630 arcsec.
    assert!(worst_arcsec < 17.0 && worst_km < 7700.0, "{worst_arcsec} arcsec {worst_km} km");
}

/// The numbers that `ephemeris/default_kernels.rs` states, from DE440.
#[test]
fn the_default_kernels_err_no_more_than_their_document_says() {
    let Some(de440) = load(&DE440_KERNELS) else { return };
    let default = default_almanac();
    let frame = de440.body_frame("moon", Some("IAU_MOON")).unwrap();
    let origin = Position::from_m(DVec3::ZERO);
    let mut worst_arcsec = [0.0_f64; 2];
    let mut worst_km = [0.0_f64; 2];
    // Steps of 3.7 days sample all phases of the month.
    for i in 0..980 {
        let epoch = Epoch::from_gregorian_utc_at_midnight(2020, 1, 1) + f64::from(i) * 3.7 * Unit::Day;
        for (k, (id, radius_m)) in [(10, 6.957e8), (399, EARTH_RADIUS_M)].into_iter().enumerate() {
            let [a, b] =
                [&default, &de440].map(|almanac| apparent(almanac, &frame, id, radius_m, origin, epoch).unwrap());
            worst_arcsec[k] = worst_arcsec[k].max(a.direction.angle_to(b.direction).to_degrees() * 3600.0);
            worst_km[k] = worst_km[k].max((a.distance_m - b.distance_m).abs() / 1000.0);
        }
    }
    println!(
        "Sun {:.3} arcsec {:.1} km, Earth {:.1} arcsec {:.1} km",
        worst_arcsec[0], worst_km[0], worst_arcsec[1], worst_km[1]
    );
    assert!(worst_arcsec[0] < 0.03 && worst_km[0] < 16.0, "{worst_arcsec:?} {worst_km:?}");
    assert!(worst_arcsec[1] < 11.0 && worst_km[1] < 11.0, "{worst_arcsec:?} {worst_km:?}");
}

#[test]
fn the_committed_kernels_are_those_that_the_program_makes() {
    let folder = tempfile::tempdir().unwrap();
    let (from, until) = (parse_epoch("2030-01-01Z").unwrap(), parse_epoch("2030-03-01Z").unwrap());
    let paths = make_default_kernels(folder.path(), from, until).unwrap();
    let again = tempfile::tempdir().unwrap();
    let twice = make_default_kernels(again.path(), from, until).unwrap();
    for (once, twice) in paths.iter().zip(&twice) {
        assert_eq!(std::fs::read(once).unwrap(), std::fs::read(twice).unwrap(), "the bytes differ");
    }
    let (made, committed) = (Almanac::load(&paths).unwrap(), default_almanac());
    let frame = committed.body_frame("moon", Some("IAU_MOON")).unwrap();
    for day in 0..59 {
        let epoch = from + f64::from(day) * Unit::Day;
        for object in [0, 10, 399, 4] {
            let [a, b] = [&made, &committed].map(|almanac| almanac.state_of(object, &frame, epoch).unwrap().0);
            assert!(a.distance_m(b) < 1000.0, "{object} on day {day}: {} m", a.distance_m(b));
        }
    }
}

/// The manifest states what lies in `kernels/` and, where present, in the folder of real data.
#[test]
fn the_manifest_states_the_files_at_hand() {
    let folders: Vec<_> = [Some(kernel_folder()), data("kernels"), data("dem")].into_iter().flatten().collect();
    let mut bytes_in_all = 0;
    for (i, folder) in folders.iter().enumerate() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let bytes = std::fs::read(&path).unwrap();
            if i == 0 {
                bytes_in_all += bytes.len();
            }
            if name == "manifest.ron" {
                continue;
            }
            let known = known_file(&name).unwrap_or_else(|| panic!("{name} is not in the manifest"));
            assert_eq!(known.sha256.as_deref(), Some(perilune_engine::digest::sha256_hex(&bytes).as_str()), "{name}");
        }
    }
    assert!(bytes_in_all < 4_000_000, "kernels/ holds {bytes_in_all} bytes");
}

#[test]
fn a_kernel_lists_what_it_covers() {
    let kernel = Kernel::open(&kernel_folder().join(DEFAULT_KERNELS[0])).unwrap();
    let text = kernel.describe().join("\n");
    assert!(text.contains("moon (301) from earth-moon barycenter (3) in ICRF"), "{text}");
    assert_eq!(kernel.segments.len(), 5);
}

/// A damaged kernel gives an error or numbers, never a panic. Bytes of the first records and of the first segment's
/// directory are overwritten, in a fixed sequence.
#[test]
fn damaged_kernels_do_not_panic() {
    let folder = tempfile::tempdir().unwrap();
    let whole = std::fs::read(kernel_folder().join(DEFAULT_KERNELS[0])).unwrap();
    let path = folder.path().join("damaged.bsp");
    let constants = kernel_folder().join(DEFAULT_KERNELS[1]);
    let epoch = parse_epoch("2027-01-01Z").unwrap();
    let mut state = 1_u64;
    // Knuth's MMIX generator.
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    // The first segment's last four doubles say where its records lie.
    let directory = 4 * 1024 + (240 * 29) * 8;
    let (mut refused, mut read) = (0, 0);
    for round in 0..400 {
        let mut bytes = whole.clone();
        for _ in 0..3 {
            let at = if round % 2 == 0 { random() % 4096 } else { directory + random() % 64 };
            bytes[at] = random() as u8;
        }
        std::fs::write(&path, &bytes).unwrap();
        let result = Almanac::load(&[path.clone(), constants.clone()]).and_then(|almanac| {
            let frame = almanac.body_frame("moon", None)?;
            sun(&almanac, &frame, Position::from_m(DVec3::X * 1.7374e6), epoch)
        });
        if result.is_err() { refused += 1 } else { read += 1 }
    }
    assert!(refused > 0 && read > 0, "{refused} refused, {read} read");
}
