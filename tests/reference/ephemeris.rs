//! The ephemeris against JPL Horizons, CSPICE (toolkit N0067), NAIF's documents and eclipse canons.

use std::path::PathBuf;

use glam::{DMat3, DVec3};
use hifitime::{Epoch, Unit};
use perilune_engine::ephemeris::{Almanac, BodyFrame, DEFAULT_KERNELS, earth, horizontal, parse_epoch, sun};
use perilune_engine::geometry::Geodetic;
use perilune_engine::quantity::{ASTRONOMICAL_UNIT_M, SPEED_OF_LIGHT_M_S};

use crate::fixtures::data;

pub(super) const DE440_KERNELS: [&str; 5] = [
    "de440s_sun_emb_earth_moon_2000_2030.bsp",
    "moon_pa_de440_2000_2030.bpc",
    "moon_fk_de440.epa",
    "pck00011.tpc",
    "gm_de440.tpc",
];

pub(super) fn load(names: &[&str]) -> Option<Almanac> {
    let folder = data("kernels")?;
    let paths: Vec<PathBuf> = names.iter().map(|name| folder.join(name)).collect();
    Some(Almanac::load(&paths).unwrap())
}

pub(super) fn kernel_folder() -> PathBuf {
    concat!(env!("CARGO_MANIFEST_DIR"), "/kernels").into()
}

pub(super) fn default_almanac() -> Almanac {
    Almanac::load(&DEFAULT_KERNELS.map(|name| kernel_folder().join(name))).unwrap()
}

/// One row of the table from Horizons.
struct Site {
    label: String,
    epoch: Epoch,
    at: Geodetic,
    /// Azimuth and elevation, degrees.
    sun_deg: [f64; 2],
    sun_diameter_arcsec: f64,
    sun_range_au: f64,
    earth_deg: [f64; 2],
}

fn sites() -> Option<Vec<Site>> {
    let text = std::fs::read_to_string(data("ephemeris_reference/horizons_moon_sites.csv")?).unwrap();
    let rows = text.lines().filter(|line| line.starts_with("20"));
    Some(
        rows.map(|row| {
            let cells: Vec<&str> = row.split(',').collect();
            let number = |i: usize| cells[i].parse::<f64>().unwrap();
            Site {
                label: format!("{} {}", cells[1], cells[0]),
                epoch: parse_epoch(&format!("{}Z", cells[0])).unwrap(),
                at: Geodetic::from_degrees(number(2), number(3), 0.0),
                sun_deg: [number(4), number(5)],
                sun_diameter_arcsec: number(6),
                sun_range_au: number(7),
                earth_deg: [number(8), number(9)],
            }
        })
        .collect(),
    )
}

/// The largest differences from Horizons over all sites.
#[derive(Debug, Default)]
struct Worst {
    sun_deg: f64,
    earth_deg: f64,
    diameter_arcsec: f64,
    range_au: f64,
}

fn compare_with_horizons(almanac: &Almanac, frame: &BodyFrame) -> Option<Worst> {
    let mut worst = Worst::default();
    for site in sites()? {
        let point = frame.body.position_from_geodetic(site.at);
        let sun = sun(almanac, frame, point, site.epoch).unwrap();
        let earth = earth(almanac, frame, point, site.epoch).unwrap();
        let off_deg = |direction, [azimuth_deg, elevation_deg]: [f64; 2]| {
            let at = horizontal(&frame.body, site.at, direction);
            let across_deg = (at.azimuth_rad.to_degrees() - azimuth_deg + 180.0).rem_euclid(360.0) - 180.0;
            let off_deg = (across_deg * at.elevation_rad.cos()).abs();
            off_deg.max((at.elevation_rad.to_degrees() - elevation_deg).abs())
        };
        let diameter_arcsec = 2.0 * sun.angular_radius_rad.to_degrees() * 3600.0;
        worst.sun_deg = worst.sun_deg.max(off_deg(sun.direction, site.sun_deg));
        worst.earth_deg = worst.earth_deg.max(off_deg(earth.direction, site.earth_deg));
        worst.diameter_arcsec = worst.diameter_arcsec.max((diameter_arcsec - site.sun_diameter_arcsec).abs());
        worst.range_au = worst.range_au.max((sun.distance_m / ASTRONOMICAL_UNIT_M - site.sun_range_au).abs());
        println!("{}: {worst:?}", site.label);
    }
    Some(worst)
}

#[test]
fn with_de440_the_sun_and_the_earth_stand_where_horizons_has_them() {
    let Some(almanac) = load(&DE440_KERNELS) else { return };
    let frame = almanac.body_frame("moon", None).unwrap();
    assert_eq!(frame.frame_name, "MOON_ME_DE440_ME421");
    let Some(worst) = compare_with_horizons(&almanac, &frame) else { return };
    // Horizons prints 1e-6 degrees; 1e-6 degrees of the Earth are 6 m.
    assert!(worst.sun_deg < 2e-6 && worst.earth_deg < 2e-6, "{worst:?}");
    // Printed to 0.001 arcsec; 1e-10 au are 15 m.
    assert!(worst.diameter_arcsec < 0.002 && worst.range_au < 1e-10, "{worst:?}");
}

#[test]
fn the_default_kernels_come_within_their_stated_error_of_horizons() {
    let almanac = default_almanac();
    let frame = almanac.body_frame("moon", None).unwrap();
    assert_eq!(frame.frame_name, "MOON_ME_DE440_ME421");
    let Some(worst) = compare_with_horizons(&almanac, &frame) else { return };
    println!("{worst:?}");
    // The series of the Sun err by 0.028 arcsec, those of the Earth by 10.7.
    assert!(worst.sun_deg < 2e-5 && worst.earth_deg < 0.0031, "{worst:?}");
    assert!(worst.diameter_arcsec < 0.05, "{worst:?}");
}

/// The tabulated orientation of the default kernels ends in January 2030; what goes on is the frame of the constants, and a line
/// says so. A frame that was asked for stays.
#[test]
fn beyond_the_tabulated_orientation_the_frame_is_another_one_and_said() {
    let almanac = default_almanac();
    let epochs = |last: &str| [parse_epoch("2029-12-01Z").unwrap(), parse_epoch(last).unwrap()];
    let (frame, note) = almanac.body_frame_at("moon", None, &epochs("2029-12-31Z")).unwrap();
    assert_eq!((frame.frame_name.as_str(), note), ("MOON_ME_DE440_ME421", None));
    let (frame, note) = almanac.body_frame_at("moon", None, &epochs("2031-01-01Z")).unwrap();
    let note = note.unwrap();
    assert_eq!(frame.frame_name, "IAU_MOON");
    assert!(note.contains("IAU_MOON, up to 0.005° from MOON_ME_DE440_ME421") && note.contains("2030-01-"), "{note}");
    let asked = almanac.body_frame_at("moon", Some("MOON_ME"), &epochs("2031-01-01Z")).unwrap();
    assert_eq!((asked.0.frame_name.as_str(), asked.1), ("MOON_ME_DE440_ME421", None));
}

/// Without aberration the comparison above fails: it is able to.
#[test]
fn the_comparison_with_horizons_sees_a_wrong_frame() {
    let Some(almanac) = load(&DE440_KERNELS) else { return };
    let frame = almanac.body_frame("moon", Some("MOON_PA_DE440")).unwrap();
    let Some(worst) = compare_with_horizons(&almanac, &frame) else { return };
    // PA and ME are 0.029 degrees apart.
    assert!(worst.sun_deg > 0.01, "{worst:?}");
}

/// NAIF, `moon_de440_220930.tf`: the Earth from the Moon at ET 717768000, geometric, in ME and in PA.
#[test]
fn mean_earth_turns_into_principal_axes_as_naif_prints_it() {
    for rotation in ["moon_fk_de440.epa", "moon_de440_220930.tf"] {
        let kernels = [DE440_KERNELS[0], DE440_KERNELS[1], rotation];
        let Some(almanac) = load(&kernels) else { return };
        let epoch = Epoch::from_et_seconds(717_768_000.0);
        let golden_km = [
            ("MOON_ME", DVec3::new(374_008.654, -23_435.970, 10_141.334)),
            ("MOON_PA", DVec3::new(373_997.028, -23_558.987, 10_284.057)),
        ];
        for (name, expected_km) in golden_km {
            let frame = almanac.body_frame("moon", Some(name)).unwrap();
            let (earth, _) = almanac.state_of(399, &frame, epoch).unwrap();
            let error_km = (earth.vector_m() / 1000.0).distance(expected_km);
            // NAIF prints metres and used the same DE440; this excerpt keeps its coefficients.
            assert!(error_km < 2e-3, "{name}: {error_km} km");
        }
    }
}

/// CSPICE `spkezr`, no correction: LRO on 2009-09-15 at 07:30:00 UTC.
#[test]
fn a_real_orbit_is_read_as_cspice_reads_it() {
    let kernels =
        ["lro_20090915_0718_0740.bsp", "moon_pa_de421_1900-2050.bpc", "moon_080317.tf", "pck00011.tpc", "gm_de440.tpc"];
    let Some(almanac) = load(&kernels) else { return };
    let epoch = parse_epoch("2009-09-15T07:30:00Z").unwrap();
    let golden = [
        (
            "MOON_ME_DE421",
            DVec3::new(-211.433_736_838_509_05, -443.062_291_282_808, -1_703.214_844_273_124_3),
            DVec3::new(0.729_925_140_747_390_5, 1.469_708_718_784_15, -0.441_421_170_787_614_5),
        ),
        (
            "IAU_MOON",
            DVec3::new(-211.432_209_716_061_72, -443.135_874_620_659_14, -1_703.195_890_701_171_7),
            DVec3::new(0.729_909_663_271_439_5, 1.469_697_535_110_918_3, -0.441_484_093_421_985_14),
        ),
    ];
    for (name, position_km, velocity_km_s) in golden {
        let frame = almanac.body_frame("moon", Some(name)).unwrap();
        let (position, velocity_m_s) = almanac.state_of(-85, &frame, epoch).unwrap();
        let error_m = position.vector_m().distance(position_km * 1000.0);
        let error_m_s = velocity_m_s.distance(velocity_km_s * 1000.0);
        // The orbit's 1.6 km/s times the 10 ns to which two programs count TDB, and rounding.
        assert!(error_m < 1e-3, "{name}: {error_m} m");
        assert!(error_m_s < 1e-5, "{name}: {error_m_s} m/s");
    }
}

/// CSPICE `sxform` from J2000 on 2024-05-01 at 12:00:00 UTC with `pck00011.tpc`.
#[test]
fn constant_rotations_are_those_of_cspice() {
    let golden = [
        (
            "mars",
            [
                [0.08018968970121138, -0.869105674450499, -0.488082923593488],
                [0.8913719146728885, 0.28167898162094934, -0.3551240079822452],
                [0.446122991335363, -0.40658612612171175, 0.7972841392195505],
            ],
            DVec3::new(6.318238393991082e-05, 1.9966020643457106e-05, -2.517196460028755e-05),
        ),
        (
            "mercury",
            [
                [-0.9866949223782256, 0.07643774440049794, 0.14349355868467162],
                [-0.13451594244301646, -0.8795225058395895, -0.4564489269899935],
                [0.0913158878930399, -0.46967800986698693, 0.8781024858555476],
            ],
            DVec3::new(-1.6677714794766834e-07, -1.0904599239346456e-06, -5.659199538178174e-07),
        ),
        (
            "moon",
            [
                [-0.7271503789456084, 0.6384817502809713, 0.2521772808113484],
                [-0.6864453653499267, -0.6726847319068779, -0.2762028454758883],
                [-0.0067146696764424476, -0.3739469294131446, 0.9274257960578932],
            ],
            DVec3::new(-1.8269768184700643e-06, -1.790792362130024e-06, -7.340020620305103e-07),
        ),
    ];
    let Some(almanac) = load(&["pck00011.tpc"]) else { return };
    let epoch = parse_epoch("2024-05-01T12:00:00Z").unwrap();
    for (body, rows, rate_of_x) in golden {
        let frame = almanac.body_frame(body, Some(&format!("IAU_{body}"))).unwrap();
        let orientation = almanac.orientation(&frame, epoch).unwrap();
        let expected = DMat3::from_cols_array_2d(&rows).transpose();
        let error_rad = (orientation.body_from_icrf.matrix() - expected)
            .to_cols_array()
            .into_iter()
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        // 1 ms of Mars's rotation is 7e-8 rad; TDB is counted to 30 µs.
        assert!(error_rad < 3e-9, "{body}: {error_rad} rad");
        let relative = orientation.rate_per_s.row(0).distance(rate_of_x) / rate_of_x.length();
        assert!(relative < 1e-6, "{body}: {relative}");
    }
    // The committed excerpt rotates Mars and the Moon alike, bit for bit.
    let excerpt = default_almanac();
    for body in ["mars", "moon"] {
        let [whole, part] = [&almanac, &excerpt].map(|almanac| {
            let frame = almanac.body_frame(body, Some(&format!("IAU_{body}"))).unwrap();
            almanac.orientation(&frame, epoch).unwrap()
        });
        assert_eq!(whole, part, "{body}");
    }
}

/// Hard case 38: 20.5 arcsec at right angles, towards the velocity.
#[test]
fn aberration_turns_the_sun_towards_the_apex_by_v_over_c() {
    let almanac = default_almanac();
    let frame = almanac.body_frame("moon", None).unwrap();
    let point = frame.body.position_from_geodetic(Geodetic::from_degrees(-89.0, 30.0, 0.0));
    for month in 1..=12 {
        let epoch = Epoch::from_gregorian_utc_at_midnight(2027, month, 1);
        let seen = sun(&almanac, &frame, point, epoch).unwrap().direction;
        let rotation = almanac.orientation(&frame, epoch).unwrap().body_from_icrf;
        // The Sun hardly moves, so its geometric direction stands for the one without aberration (0.01 arcsec).
        let (sun_at, _) = almanac.state_of(10, &frame, epoch).unwrap();
        let geometric = point.direction_to(sun_at).unwrap();
        let velocity_m_s = moon_velocity_icrf_m_s(&almanac, epoch);
        let towards = rotation.turn(velocity_m_s);
        let across = towards - towards.dot(geometric.unit()) * geometric.unit();
        let expected_rad = across.length() / SPEED_OF_LIGHT_M_S;
        let turned_rad = seen.angle_to(geometric);
        // 0.05 arcsec: the light time's 0.01 arcsec and the velocity by differences.
        assert!((turned_rad - expected_rad).abs() < 2.5e-7, "month {month}: {turned_rad} {expected_rad}");
        assert!((turned_rad.to_degrees() * 3600.0 - 20.49).abs() < 1.2, "month {month}");
        assert!((seen.unit() - geometric.unit()).dot(towards) > 0.0, "month {month}: the sense is wrong");
    }
}

/// Velocity of the Moon against the Sun, by differences over two minutes: all but that against the barycentre.
fn moon_velocity_icrf_m_s(almanac: &Almanac, epoch: Epoch) -> DVec3 {
    let frame = almanac.body_frame("moon", None).unwrap();
    let moon_from_sun_m = |epoch: Epoch| {
        let (sun, _) = almanac.state_of(10, &frame, epoch).unwrap();
        -almanac.body_from_icrf(&frame, epoch).unwrap().inverse().turn(sun.vector_m())
    };
    let minute = 1.0 * Unit::Minute;
    (moon_from_sun_m(epoch + minute) - moon_from_sun_m(epoch - minute)) / 120.0
}

/// Hard case 39.
#[test]
fn one_second_outside_coverage_is_an_error_that_names_body_span_and_kernel() {
    let almanac = default_almanac();
    let frame = almanac.body_frame("moon", Some("IAU_MOON")).unwrap();
    let segment = &almanac.kernels()[0].segments[0];
    let state = |et_s: f64| almanac.state_of(10, &frame, Epoch::from_et_seconds(et_s));
    for inside_s in [segment.start_et_s + 1.0, segment.end_et_s - 1.0] {
        assert!(state(inside_s).is_ok());
    }
    for outside_s in [segment.start_et_s - 1.0, segment.end_et_s + 1.0] {
        let text = state(outside_s).unwrap_err().to_string();
        for part in ["the position of", "2019-12-31T00:00:00Z to 2041-01-", "perilune_2020_2040.bsp"] {
            assert!(text.contains(part), "{text}");
        }
    }
}

#[test]
fn one_second_outside_a_tabulated_orientation_is_an_error_too() {
    let Some(almanac) = load(&DE440_KERNELS) else { return };
    let frame = almanac.body_frame("moon", None).unwrap();
    let segment = &almanac.kernels()[1].segments[0];
    assert!(almanac.orientation(&frame, Epoch::from_et_seconds(segment.end_et_s - 1.0)).is_ok());
    for outside_s in [segment.start_et_s - 1.0, segment.end_et_s + 1.0] {
        let text = almanac.orientation(&frame, Epoch::from_et_seconds(outside_s)).unwrap_err().to_string();
        assert!(text.contains("MOON_PA_DE440") && text.contains("moon_pa_de440_2000_2030.bpc"), "{text}");
    }
}

#[test]
fn what_the_kernels_lack_is_named() {
    let almanac = default_almanac();
    let error = |frame: &str| almanac.body_frame("moon", Some(frame)).unwrap_err().to_string();
    assert!(error("MOON_ME_DE421").contains("moon_pa_de421_1900-2050.bpc"), "{}", error("MOON_ME_DE421"));
    assert!(error("MOON_ME_DE421").contains("loaded are perilune_2020_2040.bsp"));
    assert!(error("LUNAR").contains("unknown"), "{}", error("LUNAR"));
    assert!(almanac.body("ceres").unwrap_err().to_string().contains("radii of ceres"));
    let frame = almanac.body_frame("moon", None).unwrap();
    let missing = almanac.state_of(-85, &frame, Epoch::from_gregorian_utc_at_midnight(2027, 1, 1)).unwrap_err();
    assert!(missing.to_string().contains("no loaded kernel has the position of -85"), "{missing}");
}

#[test]
fn a_file_that_is_cut_short_is_corrupted() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = std::fs::read(kernel_folder().join(DEFAULT_KERNELS[0])).unwrap();
    let path = folder.path().join("cut.bsp");
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let error = Almanac::load(&[path]).unwrap_err().to_string();
    assert!(error.contains("cut.bsp is corrupted"), "{error}");
}

/// Lunar eclipse of 2025-03-14: partial from 05:09 to 08:47 UTC, total from 06:26 to 07:31 (science.nasa.gov).
#[test]
fn in_a_total_lunar_eclipse_the_earth_hides_the_sun_from_the_whole_near_side() {
    let almanac = default_almanac();
    let frame = almanac.body_frame("moon", None).unwrap();
    let hidden = |utc: &str, latitude_deg: f64, longitude_deg: f64| {
        let epoch = parse_epoch(&format!("{utc}Z")).unwrap();
        let point = frame.body.position_from_geodetic(Geodetic::from_degrees(latitude_deg, longitude_deg, 0.0));
        let (sun, earth) =
            (sun(&almanac, &frame, point, epoch).unwrap(), earth(&almanac, &frame, point, epoch).unwrap());
        sun.direction.angle_to(earth.direction) < earth.angular_radius_rad - sun.angular_radius_rad
    };
    let limb = [(0.0, 0.0), (80.0, 0.0), (-80.0, 0.0), (0.0, 80.0), (0.0, -80.0)];
    // The canon enlarges the Earth by its atmosphere, about 1 %: two minutes.
    for utc in ["2025-03-14T06:29:00", "2025-03-14T06:58:47", "2025-03-14T07:28:30"] {
        assert!(limb.iter().all(|(latitude, longitude)| hidden(utc, *latitude, *longitude)), "{utc}");
    }
    for utc in ["2025-03-14T06:20:00", "2025-03-14T07:38:00"] {
        assert!(limb.iter().any(|(latitude, longitude)| !hidden(utc, *latitude, *longitude)), "{utc}");
    }
    for utc in ["2025-03-14T05:05:00", "2025-03-14T08:53:00"] {
        assert!(limb.iter().all(|(latitude, longitude)| !hidden(utc, *latitude, *longitude)), "{utc}");
    }
}
