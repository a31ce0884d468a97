//! Text that other programs write: read as they mean it, or refused by name.

use std::path::Path;
use std::process::{Command, Output};

use super::run::{Run, SMALL};
use crate::fixtures::data;

fn sun(kernels: &[&Path], more: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sim"));
    command.args(["sun", "--at", "-89.67,129.78", "--epoch", "2024-06-01T00:00:00Z", "--json"]).args(more);
    for kernel in kernels {
        command.arg("--kernel").arg(kernel);
    }
    command.output().unwrap()
}

/// Azimuth and elevation of the Sun, in degrees.
fn sun_deg(kernels: &[&Path], more: &[&str]) -> [f64; 2] {
    let output = sun(kernels, more);
    assert!(output.status.success(), "{kernels:?}: {}", String::from_utf8_lossy(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    ["sun_azimuth_deg", "sun_elevation_deg"].map(|key| json[key].as_f64().unwrap())
}

fn assert_near(got: [f64; 2], expected: [f64; 2], what: &str) {
    let error = (got[0] - expected[0]).hypot(got[1] - expected[1]);
    assert!(error < 3e-5, "{what}: {got:?}, not {expected:?}");
}

/// CSPICE N0067, light time and stellar aberration, to its five printed digits.
#[test]
fn text_kernels_are_read_as_spice_reads_them() {
    let (Some(ephemeris), Some(forms), Some(own), Some(frames), Some(axes), Some(meta)) = (
        data("kernels/de440s_all_2023_2025.bsp"),
        data("inputs/70_text_kernel_forms"),
        data("inputs/71_own_body_pck"),
        data("inputs/73_fk_forms"),
        data("kernels/moon_pa_de440_2000_2030.bpc"),
        data("inputs/72_meta_kernel/mission.tm"),
    ) else {
        return;
    };
    for name in ["base", "comma_space", "commas", "lines", "nospace", "plus", "plus2", "plus3", "plus_head"] {
        let kernel = forms.join(format!("{name}.tpc"));
        assert_near(sun_deg(&[&ephemeris, &kernel], &[]), [122.49677, -1.49543], name);
    }
    for name in ["body", "body2"] {
        let kernel = own.join(format!("{name}.tpc"));
        assert_near(sun_deg(&[&ephemeris, &kernel], &[]), [122.51279, -0.16043], name);
    }
    for name in ["base", "arcmin", "commas", "deg", "hours", "lower_units", "no_units", "plus", "rad"] {
        let kernel = frames.join(format!("{name}.tf"));
        let got = sun_deg(&[&ephemeris, &axes, &kernel], &["--frame", "MOON_ME_DE440_ME421"]);
        assert_near(got, [122.47883, -1.47743], name);
    }
    let listed = [ephemeris.clone(), data("kernels/pck00011.tpc").unwrap()];
    assert_near(sun_deg(&[&meta], &[]), sun_deg(&[&listed[0], &listed[1]], &[]), "mission.tm");
}

#[test]
fn what_a_text_kernel_says_and_nobody_evaluates_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("own.tpc");
    let ephemeris = Path::new(env!("CARGO_MANIFEST_DIR")).join("kernels/perilune_2020_2040.bsp");
    let rotation = "BODY301_POLE_RA = 266.\nBODY301_POLE_DEC = 65.\nBODY301_PM = ( 38. 13. )\n";
    for (data, expected) in [
        ("BODY301_PM = ( 38.3 13.1 0. 0. )", "own.tpc, line 3: BODY301_PM has 4 values; allowed are 1 to 3"),
        ("BODY301_PM = 38.3 13.1", "line 3: BODY301_PM has more than one value without ( )"),
        (&format!("{rotation}BODY301_NUT_PREC_RA = ( 1. )"), "more terms than BODY3_NUT_PREC_ANGLES has angles"),
        (&format!("{rotation}BODY301_CONSTANTS_JED_EPOCH = 2433282.5"), "its CONSTANTS_JED_EPOCH is 2433282.5"),
        ("KERNELS_TO_LOAD = ( '$K/a.bsp' )", "'$K/a.bsp' has a symbol that PATH_SYMBOLS does not"),
    ] {
        std::fs::write(&path, format!("KPL/PCK\n\\begindata\n{data}\n\\begintext\n")).unwrap();
        let output = sun(&[&ephemeris, &path], &[]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(1) && said.contains(expected), "{data}: {said}");
    }
    // A pole and a prime meridian, with as few numbers as there are, are a rotation.
    std::fs::write(&path, format!("KPL/PCK\n\\begindata\n{rotation}")).unwrap();
    assert!(sun(&[&ephemeris, &path], &[]).status.success());
}

fn said_of(run: &Run) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_sim")).arg("check").arg(run.path("small.ron")).output().unwrap();
    String::from_utf8(output.stderr).unwrap() + &String::from_utf8(output.stdout).unwrap()
}

/// Handed scenarios whose files are wrong: told in one line each.
#[test]
fn instruments_and_orbits_that_say_something_unknown_are_refused() {
    for (case, expected) in [
        ("50e_isd_unknown", "optical_distortion = newmodel"),
        ("50i_isd_themisir", "optical_distortion = themisir"),
        ("50k_isd_nan", "expected value at line 1 column"),
        ("60g_oem_overlap_no_useable", "segments overlap from 2026-08-01T00:01:20"),
        ("60j_oem_in_metres", "km and km/s"),
    ] {
        let Some(folder) = data(&format!("inputs/{case}")) else { return };
        let scenario = folder.join("scenario.ron");
        let output = Command::new(env!("CARGO_BIN_EXE_sim")).arg("check").arg(&scenario).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && said.contains(expected), "{case}: {said}");
        assert_eq!(said.lines().count(), 1, "{case}: {said}");
    }
    let Some(isd) = data("inputs/110_isd_zero_rotation/zero_body_rotation.json") else { return };
    let error = perilune_engine::camera::Isd::read(&isd).unwrap_err().to_string();
    assert!(error.contains("body_rotation = the quaternion [0.0, 0.0, 0.0, 0.0]"), "{error}");
}

#[test]
fn a_scenario_with_byte_order_mark_and_other_line_ends_is_read() {
    for text in [SMALL.replace('\n', "\r\n"), SMALL.replace('\n', "\r"), SMALL.to_owned()] {
        let said = said_of(&Run::of(&format!("\u{feff}{text}")));
        assert!(!said.contains("expected opening") && !said.contains("error"), "{said}");
    }
    let said = said_of(&Run::of(&SMALL.replacen("title: \"", "title: \"sub\\dem.tif ", 1)));
    assert!(said.contains("paths are written with /"), "{said}");
}

/// The first hundred problems, then how many there are beyond.
#[test]
fn a_hundred_thousand_unknown_keys_are_counted() {
    let keys: String = (0..100_000).map(|index| format!("key_{index}: 1, ")).collect();
    let said = said_of(&Run::of(&SMALL.replacen('(', &format!("({keys}"), 1)));
    assert!(said.contains("key_99 is not a key here") && !said.contains("key_100 is"), "{}", said.len());
    assert!(said.contains("and 99900 more problems"), "{}", &said[said.len().saturating_sub(300)..]);
}
