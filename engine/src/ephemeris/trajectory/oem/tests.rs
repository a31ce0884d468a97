use std::fmt::Write;

use super::*;

const MU_KM3_S2: f64 = 4_902.800_118_457_55;
const RADIUS_KM: f64 = 1837.4;

/// A circular orbit in the plane of x and z.
fn circular_km(elapsed_s: f64) -> [DVec3; 2] {
    let rate_rad_s = (MU_KM3_S2 / RADIUS_KM.powi(3)).sqrt();
    let (sin, cos) = (rate_rad_s * elapsed_s).sin_cos();
    [DVec3::new(cos, 0.0, sin) * RADIUS_KM, DVec3::new(-sin, 0.0, cos) * RADIUS_KM * rate_rad_s]
}

fn message(extra_meta: &str) -> String {
    let mut text = format!(
        "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = X\n\nMETA_START\n\
         OBJECT_NAME = TEST\nOBJECT_ID = 2026-001A\nCENTER_NAME = MOON\nREF_FRAME = ICRF\nTIME_SYSTEM = TDB\n\
         START_TIME = 2026-01-01T00:00:00\nSTOP_TIME = 2026-01-01T01:00:00\n{extra_meta}META_STOP\nCOMMENT states\n"
    );
    for minute in (0..=60).step_by(2) {
        let [r, v] = circular_km(f64::from(minute) * 60.0);
        let (hour, minute) = (minute / 60, minute % 60);
        writeln!(text, "2026-001T{hour:02}:{minute:02}:00 {} {} {} {} {} {}", r.x, r.y, r.z, v.x, v.y, v.z).unwrap();
    }
    text + "COVARIANCE_START\nEPOCH = 2026-01-01T00:00:00\n1.0\n2.0 3.0\nCOVARIANCE_STOP\n"
}

fn parse(text: &str) -> Result<Oem, TrajectoryError> {
    Oem::parse(Path::new("orbit.oem"), text)
}

/// Largest errors in m and m/s between the states.
fn errors(text: &str) -> (f64, f64) {
    let oem = parse(text).unwrap();
    let start = crate::ephemeris::parse_epoch("2026-01-01T00:00:00 TDB").unwrap();
    (0..=360).map(|i| f64::from(i) * 10.0).fold((0.0, 0.0), |(worst_m, worst_m_s), elapsed_s| {
        let (position_m, velocity_m_s) = oem.segments[0].interpolate(start + elapsed_s * Unit::Second);
        let [r, v] = circular_km(elapsed_s).map(|km| km * M_PER_KM);
        (f64::max(worst_m, position_m.distance(r)), f64::max(worst_m_s, velocity_m_s.distance(v)))
    })
}

/// Degree 7 errs by R (ω h)⁸ (9/16 · 1/4)²/8! = 1e-5 m between states h apart, degree 9 by about as little.
#[test]
fn states_two_minutes_apart_give_a_low_orbit_to_millimetres() {
    let (hermite_m, hermite_m_s) = errors(&message(""));
    assert!(hermite_m < 5e-3 && hermite_m_s < 1e-3, "{hermite_m} m {hermite_m_s} m/s");
    let (lagrange_m, _) = errors(&message("INTERPOLATION = LAGRANGE\nINTERPOLATION_DEGREE = 9\n"));
    assert!(lagrange_m < 1.0, "{lagrange_m} m");
    let (linear_m, _) = errors(&message("INTERPOLATION = LINEAR\nINTERPOLATION_DEGREE = 1\n"));
    // The sagitta of the chord: R (ω h)²/8.
    let sagitta_m = MU_KM3_S2 / RADIUS_KM.powi(2) * 120.0_f64.powi(2) / 8.0 * M_PER_KM;
    assert!((linear_m / sagitta_m - 1.0).abs() < 0.01, "{linear_m} m {sagitta_m} m");
}

/// The orbit of [`message`] with positions, or velocities, or both, times a factor.
fn scaled(position: f64, velocity: f64) -> String {
    let number = |(index, word): (usize, &str)| match word.parse::<f64>() {
        Ok(number) if index > 0 => (number * if index < 4 { position } else { velocity }).to_string(),
        _ => word.to_owned(),
    };
    let line = |line: &str| match line.starts_with("2026-001T") {
        true => line.split(' ').enumerate().map(number).collect::<Vec<_>>().join(" "),
        false => line.to_owned(),
    };
    message("").lines().map(line).collect::<Vec<_>>().join("\n")
}

#[test]
fn metres_and_velocities_that_contradict_positions_are_refused() {
    assert!(parse(&scaled(1.0, 1.0)).is_ok());
    let said = |text: &str| parse(text).unwrap_err().to_string();
    assert!(said(&scaled(1e3, 1e3)).contains("line 15: a velocity of 16"));
    for (position, velocity) in [(1e3, 1.0), (1.0, 0.1), (1.0, -1.0), (1.2, 1.0)] {
        assert!(said(&scaled(position, velocity)).contains("line 16: the positions"), "{position} {velocity}");
    }
    // Where velocities are left out and not used nothing contradicts them.
    let without = scaled(1.0, 0.0).replace("META_STOP", "INTERPOLATION = LAGRANGE\nMETA_STOP");
    assert!(parse(&without).is_ok());
    assert!(said(&scaled(1.0, 0.0)).contains("line 16: the positions"));
}

#[test]
fn segments_that_overlap_need_useable_times() {
    let first = message("");
    let second = first[first.find("META_START").unwrap()..].to_owned();
    let later = second.replace("2026-001T01:", "2026-001T02:").replace("2026-001T00:", "2026-001T01:");
    // The last state of the one is the first of the other.
    assert!(parse(&format!("{first}{later}")).is_ok());
    let error = parse(&format!("{first}{second}")).unwrap_err().to_string();
    assert!(error.contains("segments overlap from 2025-12-31T23:58:50"), "{error}");
    let half = "USEABLE_STOP_TIME = 2026-01-01T00:30:00\nMETA_STOP";
    let rest = "USEABLE_START_TIME = 2026-01-01T00:30:00\nMETA_STOP";
    assert!(parse(&(first.replace("META_STOP", half) + &second.replace("META_STOP", rest))).is_ok());
}

#[test]
fn useable_times_narrow_the_span() {
    let oem = parse(&message("USEABLE_START_TIME = 2026-01-01T00:10:00\nUSEABLE_STOP_TIME = 2026-01-01T00:50:00\n"));
    let (from, until) = oem.unwrap().span();
    // Epochs are kept in TAI, which runs with TDB to 4e-10.
    assert!(((until - from).to_seconds() - 2400.0).abs() < 1e-5);
}

#[test]
fn faults_are_told_with_their_line() {
    let fault = |from: &str, to: &str| parse(&message("").replacen(from, to, 1)).unwrap_err().to_string();
    assert!(fault("TIME_SYSTEM = TDB", "TIME_SYSTEM = MET").contains("line 13: TIME_SYSTEM = MET"));
    assert!(fault("TIME_SYSTEM = TDB\n", "").contains("lack TIME_SYSTEM"));
    assert!(fault("CENTER_NAME = MOON\n", "").contains("lack CENTER_NAME"));
    assert!(fault("2026-001T00:02:00", "2026-001T00:62:00").contains("line 16: epoch `2026-001T00:62:00`"));
    assert!(fault("2026-001T00:04:00", "2026-001T00:02:00").contains("line 17: the epoch is not later"));
    assert!(fault("1837.4 0 0", "1837.4 0 x").contains("line 15: `x` is not a number"));
    assert!(fault("1837.4 0 0", "1837.4 0").contains("line 15: a state has 6 or 9 numbers"));
    assert!(fault("REF_FRAME = ICRF", "REF_FRAME ICRF").contains("line 9: `REF_FRAME ICRF` is not KEYWORD"));
    assert!(
        fault("REF_FRAME = ICRF", "REF_FRAME = GCRF")
            .contains("REF_FRAME = GCRF; allowed are ICRF, EME2000, J2000, IAU_")
    );
    assert!(fault("OBJECT_ID = ", "REF_FRAME = ICRF\nOBJECT_ID = ").contains("REF_FRAME is given twice"));
    assert!(fault("OBJECT_ID = ", "UNITS = m\nOBJECT_ID = ").contains("line 7: UNITS is not a keyword"));
    assert!(fault("COVARIANCE_STOP\n", "").contains("COVARIANCE_START without COVARIANCE_STOP"));
    assert!(parse("CCSDS_OEM_VERS = 2.0\n").unwrap_err().to_string().contains("no META_START"));
}
