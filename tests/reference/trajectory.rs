//! Trajectories against the flown orbit of LRO, through every frame they may be given in.

use std::fmt::Write;

use glam::DVec3;
use hifitime::{Epoch, TimeScale, Unit};
use perilune_engine::ephemeris::trajectory::{Oem, SpkObject, SplineEnds, Trajectory, TwoBody, Waypoints};
use perilune_engine::ephemeris::{Almanac, BodyFrame, parse_epoch};
use perilune_engine::geometry::Position;

use super::ephemeris::load;

const LRO: Trajectory = Trajectory::Spk(SpkObject { naif_id: -85 });
const KERNELS: [&str; 5] =
    ["lro_20090915_0718_0740.bsp", "moon_pa_de421_1900-2050.bpc", "moon_fk_de421.epa", "pck00011.tpc", "gm_de440.tpc"];

fn start() -> Epoch {
    parse_epoch("2009-09-15T07:20:00Z").unwrap()
}

/// States of LRO by SPK, ten seconds apart over ten minutes, in a body's frame or in ICRF.
fn states(almanac: &Almanac, frame: &BodyFrame, in_icrf: bool) -> Vec<(f64, DVec3, DVec3)> {
    let state = |i: i32| {
        let (offset_s, epoch) = (f64::from(i) * 10.0, start() + f64::from(i) * 10.0 * Unit::Second);
        let (position, velocity_m_s) = LRO.state(almanac, frame, epoch).unwrap();
        if in_icrf {
            let (r, v) = almanac.orientation(frame, epoch).unwrap().turn_state_back(position, velocity_m_s);
            return (offset_s, r, v);
        }
        (offset_s, position.vector_m(), velocity_m_s)
    };
    (0..=60).map(state).collect()
}

fn message(frame: &str, states: &[(f64, DVec3, DVec3)]) -> String {
    let mut text = format!(
        "CCSDS_OEM_VERS = 2.0\nMETA_START\nOBJECT_NAME = LRO\nCENTER_NAME = MOON\nREF_FRAME = {frame}\n\
         TIME_SYSTEM = TAI\nMETA_STOP\n"
    );
    for (offset_s, r, v) in states {
        let epoch = (start() + *offset_s * Unit::Second).to_gregorian_str(TimeScale::TAI);
        let epoch = epoch.trim_end_matches(" TAI");
        let (r, v) = (*r / 1000.0, *v / 1000.0);
        writeln!(text, "{epoch} {} {} {} {} {} {}", r.x, r.y, r.z, v.x, v.y, v.z).unwrap();
    }
    text
}

/// Largest distance in m and difference of velocity in m/s from LRO, between the states.
fn compare(trajectory: &Trajectory, almanac: &Almanac, frame: &BodyFrame) -> (f64, f64) {
    let epochs = (0..=199).map(|i| start() + (f64::from(i) * 3.0 + 1.0) * Unit::Second);
    epochs.fold((0.0, 0.0), |worst: (f64, f64), epoch| {
        let (position, velocity_m_s) = trajectory.state(almanac, frame, epoch).unwrap();
        let (flown, flown_m_s) = LRO.state(almanac, frame, epoch).unwrap();
        (worst.0.max(position.distance_m(flown)), worst.1.max(velocity_m_s.distance(flown_m_s)))
    })
}

#[test]
fn a_message_in_any_frame_gives_the_orbit_it_states() {
    let Some(almanac) = load(&KERNELS) else { return };
    let frame = almanac.body_frame("moon", None).unwrap();
    assert_eq!(frame.frame_name, "MOON_ME_DE421");
    let folder = tempfile::tempdir().unwrap();
    for name in ["ICRF", "MOON_ME_DE421", "MOON_PA_DE421", "IAU_MOON"] {
        let in_icrf = name == "ICRF";
        let given = if in_icrf { frame.clone() } else { almanac.body_frame("moon", Some(name)).unwrap() };
        let path = folder.path().join("lro.oem");
        std::fs::write(&path, message(name, &states(&almanac, &given, in_icrf))).unwrap();
        let (error_m, error_m_s) = compare(&Trajectory::Oem(Oem::read(&path).unwrap()), &almanac, &frame);
        println!("{name}: {error_m:.1e} m {error_m_s:.1e} m/s");
        // States ten seconds apart err far less; the SPK itself joins its states by polynomials.
        assert!(error_m < 1e-2 && error_m_s < 1e-2, "{name}: {error_m} m {error_m_s} m/s");
    }
}

#[test]
fn waypoints_of_an_orbit_follow_it() {
    let Some(almanac) = load(&KERNELS) else { return };
    let frame = almanac.body_frame("moon", None).unwrap();
    let states = states(&almanac, &frame, false);
    let points: Vec<_> = states.iter().map(|(offset_s, r, _)| (*offset_s, Position::from_m(*r))).collect();
    let ends = SplineEnds::Clamped { first_m_s: states[0].2, last_m_s: states[60].2 };
    let path = Trajectory::Waypoints(Waypoints::new(start(), &points, ends).unwrap());
    let (error_m, error_m_s) = compare(&path, &almanac, &frame);
    println!("waypoints: {error_m:.1e} m {error_m_s:.1e} m/s");
    // A spline through points h apart errs by 5/384 h⁴ times the fourth derivative, R ω⁴: 2e-4 m.
    assert!(error_m < 1e-2 && error_m_s < 1e-2, "{error_m} m {error_m_s} m/s");
}

/// Lunar gravity beyond the point mass moves LRO by 138 m in ten minutes; J2 alone, 4e-4 m/s², gives 70 m.
#[test]
fn kepler_motion_follows_a_real_orbit_for_minutes() {
    let Some(almanac) = load(&KERNELS) else { return };
    let frame = almanac.body_frame("moon", None).unwrap();
    let (_, position_m, velocity_m_s) = states(&almanac, &frame, true)[0];
    let mass_m3_s2 = almanac.gravitational_parameter_m3_s2(&frame.body).unwrap();
    let orbit = Trajectory::TwoBody(TwoBody::from_state(start(), position_m, velocity_m_s, mass_m3_s2).unwrap());
    let (error_m, error_m_s) = compare(&orbit, &almanac, &frame);
    println!("two-body against LRO: {error_m:.1} m {error_m_s:.3} m/s");
    assert!((1.0..300.0).contains(&error_m), "{error_m} m");
}

#[test]
fn a_message_of_another_body_frame_or_epoch_is_refused() {
    let Some(almanac) = load(&KERNELS) else { return };
    let frame = almanac.body_frame("moon", None).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lro.oem");
    let text = message("ICRF", &states(&almanac, &frame, true));
    let error = |text: &str, epoch: Epoch| {
        std::fs::write(&path, text).unwrap();
        Trajectory::Oem(Oem::read(&path).unwrap()).state(&almanac, &frame, epoch).unwrap_err().to_string()
    };
    let earth = error(&text.replace("= MOON", "= EARTH"), start());
    assert!(earth.contains("CENTER_NAME = EARTH, but the body is moon"), "{earth}");
    let early = error(&text, start() - 1.0 * Unit::Second);
    assert!(early.contains("2009-09-15T07:19:59Z is outside its span 2009-09-15T07:20:00Z"), "{early}");
    std::fs::write(&path, text.replace("= ICRF", "= TEME")).unwrap();
    let unknown = Oem::read(&path).unwrap_err().to_string();
    assert!(unknown.contains("REF_FRAME = TEME; allowed are ICRF, EME2000"), "{unknown}");
    assert!(Oem::read(&folder.path().join("none.oem")).unwrap_err().to_string().contains("none.oem cannot be read"));
}
