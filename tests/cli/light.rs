//! What records and planes say about the light of a run.

use perilune_engine::dataset::read_exr;
use serde_json::Value as Json;

use super::run::{Run, SMALL};

/// The first record of a run of `SMALL` with replacements, and its first image.
fn run(replacements: &[(&str, &str)], files: &[(&str, &str)]) -> (Run, Json) {
    let changed = replacements.iter().fold(SMALL.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    let run = Run::of(&changed);
    files.iter().for_each(|(name, text)| std::fs::write(run.path(name), text).unwrap());
    run.succeed(&["--frames", "0..1"]);
    let record = std::fs::read_to_string(run.path("out/exposure_0000.json")).unwrap();
    (run, serde_json::from_str(&record).unwrap())
}

fn channel(run: &Run, name: &str) -> Vec<f32> {
    let file = read_exr(&run.path("out/exposure_0000.exr")).unwrap();
    file.channels.into_iter().find(|channel| channel.0 == name).unwrap().1
}

/// Half of a top hat from 450 to 850 nm, 627.65 W/m² at 1 au, is half of that over 200 nm.
#[test]
fn a_response_gives_irradiance_and_radiance_per_nanometre() {
    let (run, record) = run(
        &[
            ("field_of_view_deg: 40)", "field_of_view_deg: 40, response: \"filter.csv\")"),
            ("[radiance,", "[radiance, spectral_radiance,"),
            ("title: \"a small descent\",", "title: \"a small descent\", sun: (disc: LimbDarkened(law: NeckelLabs)),"),
        ],
        &[("filter.csv", "# nm, share\n450, 0.5\n850, 0.5\n")],
    );
    let radiometry = &record["radiometry"];
    assert_eq!(radiometry["spectrum"], "TSIS-1 HSRS v2, 1 nm");
    assert_eq!(radiometry["response"], "filter.csv");
    assert_eq!(radiometry["band_nm"], serde_json::json!([450.0, 850.0]));
    let number = |name: &str| radiometry[name].as_f64().unwrap();
    assert!((number("irradiance_1au_w_m2") - 627.65 / 2.0).abs() < 0.01, "{radiometry}");
    assert!((number("band_width_nm") - 200.0).abs() < 1e-9, "{radiometry}");
    // Redder than the middle of the sunlight's peak, bluer than the band's: 625.8 nm.
    assert!((number("mean_wavelength_nm") - 625.76).abs() < 0.01, "{radiometry}");
    assert!(record["sun"]["limb_darkening"].as_str().unwrap().contains("Neckel & Labs 1994 at 626 nm"));
    let (all, per_nm) = (channel(&run, "RADIANCE"), channel(&run, "SPECTRAL_RADIANCE"));
    assert!(all.iter().any(|value| *value > 0.0));
    for (all, per_nm) in all.iter().zip(&per_nm) {
        assert!((all - 200.0 * per_nm).abs() <= 1e-6 * all.abs() || all.is_nan() && per_nm.is_nan());
    }
}

/// Totality of 2025-03-14 is from 06:26 to 07:31 (science.nasa.gov); an hour and a half before only the penumbra is left.
#[test]
fn the_earth_hides_the_sun_from_the_moon_unless_told_not_to() {
    let at = |time: &str, eclipses: &str| {
        let title = format!("title: \"a small descent\",{eclipses}");
        run(&[("2026-11-06T00:00:00", &format!("2025-03-14T{time}")), ("title: \"a small descent\",", &title)], &[])
    };
    let (dark, record) = at("06:58:00", "");
    assert_eq!(record["sun"]["eclipse_share"], 0.0);
    assert!(channel(&dark, "RADIANCE").iter().all(|value| *value == 0.0));
    let (lit, record) = at("06:58:00", "sun: (eclipses: false),");
    assert!(record["sun"]["eclipse_share"].is_null());
    let brightest = |run: &Run| channel(run, "RADIANCE").into_iter().fold(0.0, f32::max);
    let (partial, record) = at("04:40:00", "");
    let share = record["sun"]["eclipse_share"].as_f64().unwrap();
    assert!((0.05..0.95).contains(&share), "{share}");
    assert!(brightest(&partial) < brightest(&lit), "{} {}", brightest(&partial), brightest(&lit));
}

/// Horizons within a band of elevations cannot be had where the Sun goes round, or where light comes from elsewhere.
#[test]
fn a_band_that_would_leave_nothing_out_is_refused() {
    let banded = SMALL.replace("Settings(azimuths: 64)", "Settings(azimuths: 64, band: true)");
    let cases = [
        (banded.replace("step_s: 10, count: 4", "step_s: 850000, count: 3"), "the Sun goes through more than 120°"),
        (banded.replace("shadows:", "ambient: (radiance_w_m2_sr: 1), shadows:"), "ambient light comes from elsewhere"),
        (banded.replace("shadows:", "bounce: (), shadows:"), "bounced light comes from elsewhere"),
        (banded.replace("shadows:", "earthshine: (), shadows:"), "earthshine comes from elsewhere"),
    ];
    for (text, said) in cases {
        let text = text.replace("(t_s: 30, ", "(t_s: 4000000, ");
        let run = Run::of(&text);
        let output = run.sim(&[]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{error}");
        assert!(error.contains("horizon.band: true") && error.contains(said), "{error}\nwanted: {said}");
    }
    Run::of(&banded).succeed(&["--frames", "0"]);
}
