//! Hostile values: of every number of a scenario, of every number among the arguments, of the environment. None is silent, none
//! ends the process by a signal.
//!
//! `SIM_WRITE=attacks` writes `docs/experiments/attacks.md` from the outcomes.

use std::path::Path;
use std::process::{Command, Output};

use perilune_engine::scenario::{SearchPath, resolve};
use rayon::prelude::*;
use tempfile::TempDir;

use super::run::SMALL;

/// Scenarios whose numbers are replaced one by one; together they have most keys that take a number.
const SCENARIOS: [&str; 3] = [SMALL, MANY_KEYS, SWEPT];

const MANY_KEYS: &str = r#"(
    title: "many keys",
    terrain: (dems: [
        Synthetic(columns: 64, rows: 64, posting_m: 20, latitude_deg: -80, longitude_deg: 10, seed: 1),
    ], centre: (latitude_deg: -80, longitude_deg: 10)),
    shadows: Auto(max_irradiance_error: 0.02),
    horizon: Settings(azimuths: 90, search_m: 10000, observer_height_m: 1),
    surface: (photometry: Hapke(w: 0.3, b: 0.2, c: 0.3, bs0: 1.8, hs: 0.07, theta_bar_deg: 10)),
    sun: (irradiance_w_m2: 1361, disc: LimbDarkened(wavelength_nm: 550)),
    earthshine: (albedo: 0.4),
    ambient: (radiance_w_m2_sr: 0.01),
    trajectory: Orbit(epoch: "2026-08-01T00:00:00 UTC", semi_major_axis_m: 1850000, eccentricity: 0.01, inclination_deg: 90,
        node_deg: 10, periapsis_deg: 20, true_anomaly_deg: 200),
    pointing: (towards: At(latitude_deg: -80, longitude_deg: 10, height_m: 5), roll_deg: 3),
    camera: (columns: 64, rows: 48, focal_length_mm: 50, pixel_pitch_um: 10, band_nm: (450, 850), f_number: 4, transmission: 0.9, exposure_s: 0.01,
        samples_per_pixel: 4, moments: 3, distortion: (k1: 0.01, k2: 0.001, k3: 0, p1: 0.001, p2: 0.001)),
    detector: (quantum_efficiency: 0.5, full_well_e: 50000, dark_current_e_per_s: 3, read_noise_e: 8, gain_e_per_dn: 12,
        offset_dn: 64, bits: 12, prnu: 0.01, dsnu_e: 2),
    hazards: (footprint_m: 10, slope_deg: 10, roughness_m: 0.3, sunlit_share: 0.5),
    exposures: Series(start: "2026-08-01T00:00:00 UTC", step_s: 20, count: 4),
    outputs: (planes: [radiance, depth], preview: White(radiance_w_m2_sr: 3)),
    seed: 5,
)
"#;

const SWEPT: &str = r#"(
    title: "swept",
    terrain: (dems: [
        Synthetic(columns: 64, rows: 64, posting_m: 20, latitude_deg: -80, longitude_deg: 10, seed: 1),
    ]),
    sun: (fixed: (azimuth_deg: 10, elevation_deg: 20, range_au: 1)),
    surface: (photometry: Minnaert(k: 0.7), albedo: Constant(0.12)),
    trajectory: Waypoints(points: [(t_s: 0, latitude_deg: -80, longitude_deg: 10, height_m: 3000)]),
    pointing: (towards: Quaternion(w: 1, x: 0, y: 0, z: 0)),
    camera: (columns: 64, rows: 64, field_of_view_deg: 30),
    exposures: List(["2026-08-01T00:00:00 UTC"]),
    sweep: (design: Sobol(count: 8, seed: 1), sun_azimuth_deg: Range(from: 0, to: 90)),
    split: (train: 0.5, validation: 0.3, test: 0.2, cell_m: 3000),
    outputs: (planes: [radiance]),
)
"#;

/// What stands in place of a number.
const VALUES: [&str; 7] = ["NaN", "inf", "-inf", "1e300", "-1e300", "\"many\"", "(1, 2)"];

/// Commands with their arguments that take a number.
const ARGUMENTS: [(&str, &str); 10] = [
    ("horizon", "azimuths search observer-height memory posting extent radius"),
    ("horizon globe", "posting cells margin azimuths observer-height memory check radius"),
    ("horizon verify", "count seed posting"),
    ("horizon query", "azimuth-step radius"),
    ("illuminate", "best apart observer-height azimuths memory check posting extent step lit"),
    ("terrain", "columns rows posting seed largest smallest density exponent relief roughness at"),
    ("compare", "dark size image band"),
    ("bench shadows", "exposure size repeat elevations"),
    ("bench frame", "repeat frames"),
    ("run", "frames"),
];

const HOSTILE: [&str; 6] = ["-1", "NaN", "inf", "-inf", "1e300", "many"];

/// Single attacks by arguments: the command line, its exit code, a part of what is said.
const SINGLE: [(&str, i32, &str); 14] = [
    ("horizon x.tif -o t --azimuths 1000000000", 2, "want 4 to 3600"),
    ("horizon x.tif -o t --search -1", 2, "want 0.001 to 10000000 m"),
    ("horizon x.tif -o t --memory 0", 2, "want 64 to 16777216 MiB"),
    ("horizon x.tif -o t --extent 1e12", 2, "want 0.001 to 10000000 m"),
    ("horizon x.tif -o t --cube --posting 1000000", 2, "want 0.001 to 100000 m"),
    ("horizon missing.tif -o t", 1, "missing.tif"),
    ("terrain -o t.tif --columns 100000 --rows 100000", 2, "want 8 to 32768 pixels"),
    ("terrain -o t.tif --columns 64 --rows 64 --smallest 500 --largest 400", 1, "more than smallest_m"),
    ("run small.ron --frames 3..1", 1, "names no exposure"),
    ("run small.ron --frames 0..99", 1, "names no exposure"),
    ("run .", 1, "."),
    ("run missing.ron", 1, "no scenario missing.ron"),
    ("check missing.ron", 1, "no scenario missing.ron"),
    ("inspect missing", 1, "missing"),
];

/// Attacks through the shell, in a folder with `small.ron`: exit code, a part of what is said. `SIM` is the program.
const SHELL: [(&str, i32, &str); 8] = [
    ("RAYON_NUM_THREADS=100000 SIM check small.ron", 0, "threads are started"),
    ("RAYON_NUM_THREADS=many SIM check small.ron", 0, "no problems"),
    ("ulimit -v 200000; SIM run small.ron", 1, "memory: the process may take"),
    ("ulimit -v 500000; SIM run small.ron", 1, "memory: the process may take"),
    ("ulimit -v 800000; SIM run small.ron", 1, "memory: the process may take"),
    ("ulimit -v 4000000; SIM run wide.ron", 1, "memory: the run takes about"),
    ("ulimit -v 4000000; SIM check wide.ron", 1, "memory: the run takes about"),
    (
        "ulimit -v 4000000; SIM terrain -o t.tif --columns 32768 --rows 32768",
        1,
        "memory: 32768 × 32768 pixels take about",
    ),
];

/// An attack and what became of it.
struct Outcome {
    attack: String,
    code: String,
    said: String,
}

/// Places of the numbers of a text that stand behind a key: the key, and where its number begins and ends.
fn numbers(text: &str) -> Vec<(String, usize, usize)> {
    let bytes = text.as_bytes();
    let is_number = |at: usize| bytes[at].is_ascii_digit() || b"-.e".contains(&bytes[at]);
    let mut found = Vec::new();
    for (colon, _) in text.match_indices(": ") {
        let start = colon + 2;
        let end = (start..bytes.len()).find(|at| !is_number(*at)).unwrap_or(bytes.len());
        let key_start = text[..colon].rfind(|c: char| !c.is_alphanumeric() && c != '_').map_or(0, |at| at + 1);
        if text[start..end].parse::<f64>().is_ok() {
            found.push((text[key_start..colon].to_owned(), start, end));
        }
    }
    found
}

/// Every number of every scenario by every hostile value: refused with the key, before anything is opened.
fn of_scenarios() -> Vec<Outcome> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("attacked.ron");
    let places = SearchPath { beside: folder.path().into(), data: Vec::new() };
    let mut outcomes = Vec::new();
    for text in SCENARIOS {
        resolve(&path, text, &places, &|_| None).unwrap();
        for (key, start, end) in numbers(text) {
            for value in VALUES {
                let attacked = format!("{}{value}{}", &text[..start], &text[end..]);
                let attack = format!("`{key}: {value}`");
                let problems = match resolve(&path, &attacked, &places, &|_| None) {
                    Ok(_) => panic!("{attack} is taken in silence"),
                    Err(error) => error,
                };
                let named = problems.problems().iter().find(|problem| problem.key.contains(&key));
                let said = named.unwrap_or_else(|| panic!("{attack}: {problems}")).to_string();
                outcomes.push(Outcome { attack, code: "refused".into(), said });
            }
        }
    }
    outcomes
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout)
}

/// The line that says what is wrong, without the folder of the test.
fn line(told: &str, part: &str, folder: &Path) -> String {
    let line = told.lines().find(|line| line.contains(part)).or(told.lines().next()).unwrap_or_default();
    line.replace(&folder.display().to_string(), "").trim_start_matches("error: ").to_owned()
}

fn sim(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sim"))
        .args(arguments)
        .current_dir(folder)
        .env("XDG_CACHE_HOME", folder)
        .output()
        .unwrap()
}

/// Every number among the arguments by every hostile value: refused as a wrong argument, by its name.
fn of_arguments(folder: &Path) -> Vec<Outcome> {
    let flags = ARGUMENTS.iter().flat_map(|(command, flags)| flags.split(' ').map(move |flag| (*command, flag)));
    let attacks: Vec<_> = flags.flat_map(|(command, flag)| HOSTILE.map(|value| (command, flag, value))).collect();
    let outcome = |&(command, flag, value): &(&str, &str, &str)| {
        let argument = format!("--{flag}={value}");
        let arguments: Vec<&str> = command.split(' ').chain([argument.as_str()]).collect();
        let output = sim(folder, &arguments);
        let attack = format!("`sim {command} {argument}`");
        let said = told(&output);
        assert_eq!(output.status.code(), Some(2), "{attack}: {said}");
        assert!(said.contains(&format!("--{flag}")), "{attack}: {said}");
        Outcome { attack, code: "2".into(), said: line(&said, "--", folder) }
    };
    attacks.par_iter().map(outcome).collect()
}

fn of_single_lines(folder: &Path) -> Vec<Outcome> {
    let outcome = |&(arguments, code, part): &(&str, i32, &str)| {
        let output = sim(folder, &arguments.split(' ').collect::<Vec<_>>());
        checked(&format!("sim {arguments}"), &output, code, part, folder)
    };
    let mut outcomes: Vec<Outcome> = SINGLE.par_iter().map(outcome).collect();
    if cfg!(target_os = "linux") {
        outcomes.extend(SHELL.iter().map(|&(script, code, part)| {
            let program = script.replace("SIM", env!("CARGO_BIN_EXE_sim"));
            let output = Command::new("sh")
                .args(["-c", &program])
                .current_dir(folder)
                .env("XDG_CACHE_HOME", folder)
                .output()
                .unwrap();
            checked(&script.replace("SIM", "sim"), &output, code, part, folder)
        }));
    }
    outcomes
}

fn checked(attack: &str, output: &Output, code: i32, part: &str, folder: &Path) -> Outcome {
    let said = told(output);
    assert!(output.status.code() == Some(code) && said.contains(part), "{attack}: {:?}, {said}", output.status);
    Outcome { attack: format!("`{attack}`"), code: code.to_string(), said: line(&said, part, folder) }
}

#[test]
fn no_attack_is_silent() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("small.ron"), SMALL).unwrap();
    let wide = SMALL.replace("columns: 64, rows: 64,", "columns: 16384, rows: 4096,");
    std::fs::write(folder.path().join("wide.ron"), wide).unwrap();
    let groups = [
        ("Numbers of a scenario", of_scenarios()),
        ("Numbers among the arguments", of_arguments(folder.path())),
        ("Sizes, files, environment, limits", of_single_lines(folder.path())),
    ];
    let attacks: usize = groups.iter().map(|(_, outcomes)| outcomes.len()).sum();
    assert!(attacks > 200, "{attacks}");
    if std::env::var("SIM_WRITE").is_ok_and(|wanted| wanted == "attacks") {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/experiments/attacks.md");
        std::fs::write(page, page_of(&groups, attacks)).unwrap();
    }
}

fn page_of(groups: &[(&str, Vec<Outcome>)], attacks: usize) -> String {
    let mut page = format!(
        "# Attacks\n\nWhat does the program say to hostile numbers, sizes, limits? {attacks} attacks; none is silent, none ends the \
         process by a signal.\n\nCommand: `SIM_WRITE=attacks cargo test --release --test perilune no_attack_is_silent`, which holds \
         every outcome against what is expected. What it does not show: files of other programs, which the tests of readers \
         attack, and time.\n"
    );
    for (group, outcomes) in groups {
        page += &format!("\n## {group}\n\n| attack | exit code | what is said |\n|---|---|---|\n");
        for Outcome { attack, code, said } in outcomes {
            let [attack, said] = [attack, said].map(|text| text.replace('|', "\\|"));
            page += &format!("| {attack} | {code} | {said} |\n");
        }
    }
    page
}
