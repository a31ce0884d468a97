//! Illumination against what can be counted without a horizon map.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use hifitime::{Epoch, Unit};
use perilune_bench::illumination as percentages;
use perilune_engine::ephemeris::Almanac;
use perilune_engine::geometry::{Body, Geodetic};
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::horizon::{self, Encoding, Request, Settings};
use perilune_engine::illumination::{
    Area, AreaSummary, Lit, Maps, Seen, Series, Skylines, Study, Swept, Traced, Track, best_places,
};
use perilune_engine::photometry::{LimbDarkening, SolarDisk};
use perilune_engine::pipeline::Silent;
use perilune_engine::raster::{Dem, Options};
use perilune_engine::report::Value;
use perilune_engine::terrain::{Face, Gnomonic, Level};

use crate::fixtures;

const RADIUS_RAD: f64 = 0.00465;

/// A pole's Sun: it goes round 13 times while its elevation swings once between ± 1.5°. The Earth stays.
fn track() -> Track {
    const STEPS: usize = 2000;
    let seen = |azimuth_rad: f64, elevation_rad: f64| {
        let (sin, cos) = elevation_rad.sin_cos();
        // At the south pole up is -z.
        let towards = DVec3::new(cos * azimuth_rad.cos(), cos * azimuth_rad.sin(), -sin);
        Seen { towards, angular_radius_rad: RADIUS_RAD }
    };
    let sun = |i: usize| {
        let turn = TAU * i as f64 / STEPS as f64;
        seen(13.0 * turn, 1.5_f64.to_radians() * turn.sin())
    };
    let earth = seen(0.3, 4.0_f64.to_radians());
    let start = Epoch::from_gregorian_utc_at_midnight(2026, 1, 1);
    Track {
        start,
        step: 1.0 * Unit::Hour,
        sun: (0..STEPS).map(sun).collect(),
        earth: vec![earth; STEPS],
        sunlight: vec![1.0; STEPS],
    }
}

/// A face about the south pole with heights above the sphere.
fn face(nodes: usize, posting_m: f64, height_m: impl Fn(DVec2) -> f64) -> Face {
    let map = Gnomonic::about(&Body::moon(), Geodetic::from_degrees(-90.0, 0.0, 0.0));
    let low_m = -((nodes - 1) as f64) * posting_m / 2.0;
    let mut level = Level {
        columns: nodes,
        rows: nodes,
        posting_m,
        west_m: low_m,
        south_m: low_m,
        heights_m: Vec::new(),
        gap: vec![false; nodes * nodes],
        margin: 0,
    };
    for index in 0..nodes * nodes {
        let at_m = level.node_m(index % nodes, index / nodes);
        level.heights_m.push(map.lifted_height_m(at_m, map.radius_m + height_m(at_m)) as f32);
    }
    Face { map, levels: vec![level] }
}

/// Waves 2 km and 7 km long.
fn rough(at_m: DVec2) -> f64 {
    let k = TAU / 2000.0;
    40.0 * (k * at_m.x).sin() * (0.9 * k * at_m.y).cos() + 120.0 * (0.29 * k * (at_m.x + 0.4 * at_m.y)).sin()
}

/// By a tile.
fn mapped(face: &Face, encoding: Encoding, lit: Lit) -> Maps {
    let folder = tempfile::tempdir().unwrap();
    let (body, settings) = (Body::moon(), Settings::default());
    let request = Request { body: &body, face, level: 0, settings, encoding };
    let horizons = horizon::build(&request, folder.path(), &|_, _| {}).unwrap();
    studied(face, &Skylines::Decoded(&horizons), lit, &[]).0
}

/// By skylines that are swept for it.
fn swept(face: &Face, azimuths: usize, areas: &[Vec<bool>]) -> (Maps, Vec<Series>) {
    let settings = Settings { azimuths, ..Settings::default() };
    let held = perilune_engine::illumination::maps::needed_blocks(&face.levels[0], areas);
    let skylines = Skylines::Swept(Swept::new(face, 0, &settings, held, &|_, _| {}).unwrap());
    studied(face, &skylines, Lit::AnyLimb, areas)
}

fn studied(face: &Face, skylines: &Skylines, lit: Lit, areas: &[Vec<bool>]) -> (Maps, Vec<Series>) {
    let (track, disk) = (track(), disk());
    Study { face, level: 0, skylines, track: &track, disk: &disk, lit, areas }.run(&|_, _| {})
}

fn disk() -> SolarDisk {
    SolarDisk::new(LimbDarkening::Power { alpha: 0.5 }).unwrap()
}

#[test]
fn on_a_bare_sphere_a_node_is_lit_while_the_sun_is_up() {
    // At a posting of 50 m a node sees the ground fall away by 8e-4°, a sixth of what the Sun climbs in a step.
    let face = face(70, 50.0, |_| 0.0);
    let track = track();
    for (lit, least) in [(Lit::AnyLimb, -RADIUS_RAD), (Lit::Centre, 0.0)] {
        let maps = mapped(&face, Encoding::F16, lit);
        for (column, row) in [(0, 0), (35, 40), (69, 1)] {
            let up = face.map.map_from_body.inverse().turn(face.map.up(face.levels[0].node_m(column, row)).unit());
            let elevations_rad: Vec<f64> = track.sun.iter().map(|sun| up.dot(sun.towards).asin()).collect();
            // A step in which the Sun crosses the limit may count either way.
            let counted = elevations_rad.iter().filter(|elevation| **elevation > least).count() as f64;
            let share = f64::from(maps.lit_share[row * 70 + column]) * track.steps() as f64;
            assert!((share - counted).abs() <= 2.0, "{lit:?} at {column} {row}: {share} {counted}");
            let night = elevations_rad.split(|elevation| *elevation > least).map(<[f64]>::len).max().unwrap();
            let longest = f64::from(maps.longest_night_h[row * 70 + column]);
            assert!((longest - night as f64).abs() <= 2.0, "{longest} {night}");
            let seen: f64 = elevations_rad.iter().map(|e| disk().visible_above(-e / RADIUS_RAD)).sum();
            let disc = f64::from(maps.disc_share[row * 70 + column]) * track.steps() as f64;
            // A thousandth of the disc a step.
            assert!((disc - seen).abs() < 1e-3 * track.steps() as f64, "{disc} {seen}");
            assert_eq!(maps.earth_share[row * 70 + column], 1.0);
        }
    }
}

/// Swept skylines err by 0.005°, a fiftieth of the disc, where the Sun grazes them: a hundredth of the time. Between 720
/// azimuths waves of 2 km leave nothing. A tile of 16 coefficients errs by 0.1°, a fifteenth of the Sun's swing.
#[test]
fn maps_are_those_of_traced_skylines() {
    let face = face(160, 100.0, rough);
    let (track, disk, settings) = (track(), disk(), Settings::default());
    let tracer = Tracer::new(&face, &settings);
    let errors = |skylines: &Skylines| {
        let study =
            Study { face: &face, level: 0, skylines, track: &track, disk: &disk, lit: Lit::AnyLimb, areas: &[] };
        let (maps, _) = study.run(&|_, _| {});
        Traced::of(&study, &Body::moon(), &tracer, 40).check(&maps)
    };
    let held = (0..25).collect();
    let settings = Settings { azimuths: 720, ..settings };
    let of_sweep = errors(&Skylines::Swept(Swept::new(&face, 0, &settings, held, &|_, _| {}).unwrap()));
    assert_eq!(of_sweep.nodes, 40);
    assert!(of_sweep.disc_share.rms < 3e-4 && of_sweep.disc_share.max < 1e-3, "{of_sweep:?}");
    // A step of 2000 more or less.
    assert!(of_sweep.lit_share.rms < 1e-3 && of_sweep.earth_share.max < 1e-9, "{of_sweep:?}");

    let folder = tempfile::tempdir().unwrap();
    let body = Body::moon();
    let request =
        Request { body: &body, face: &face, level: 0, settings: Settings::default(), encoding: Encoding::F16 };
    let tile = horizon::build(&request, folder.path(), &|_, _| {}).unwrap();
    let of_tile = errors(&Skylines::Decoded(&tile));
    assert!(of_tile.disc_share.max < 0.06, "{of_tile:?}");
    // The comparison tells the two apart.
    assert!(of_tile.disc_share.rms > 5.0 * of_sweep.disc_share.rms, "{of_tile:?} {of_sweep:?}");
}

/// Means over time of an area's series are means over its nodes of the maps, whatever else is mapped.
#[test]
fn an_areas_series_is_the_mean_of_its_nodes() {
    let face = face(160, 100.0, rough);
    let body = Body::moon();
    let circle = Area::Circle { centre: Geodetic::from_degrees(-89.9, 40.0, 0.0), radius_m: 2500.0 };
    let deg = [[-89.95, 300.0], [-89.8, 330.0], [-89.8, 270.0]];
    let corners = deg.map(|[latitude, longitude]| Geodetic::from_degrees(latitude, longitude, 0.0));
    let areas = [circle, Area::Polygon(vec![corners.to_vec()])];
    let counts = areas.map(|area| area.nodes(&body, &face.map, &face.levels[0]).unwrap());
    let (maps, series) = swept(&face, 360, &counts);
    let (whole, _) = swept(&face, 360, &[]);
    for (counts, series) in counts.iter().zip(&series) {
        let summary = AreaSummary::of(&maps, counts, series, 1.0);
        assert!(summary.nodes > 500);
        let mean = |series: &[f64]| series.iter().sum::<f64>() / series.len() as f64;
        for (of_series, of_nodes) in [
            (&series.lit_share, summary.lit_share),
            (&series.disc_share, summary.disc_share),
            (&series.earth_share, summary.earth_share),
        ] {
            // Sums of 2000 single-precision numbers.
            assert!((mean(of_series) - of_nodes.mean).abs() < 1e-5, "{summary:?}");
        }
        // The area is dark no longer than each of its nodes, and lit somewhere at least as often as its best one.
        assert!(summary.longest_dark_h <= summary.longest_night_h.least + 1e-9, "{summary:?}");
        assert!(summary.some_lit_share >= summary.lit_share.most - 1e-6, "{summary:?}");
        let same = |node: usize| counts[node].then(|| maps.lit_share[node] == whole.lit_share[node]);
        assert!((0..counts.len()).filter_map(same).all(|same| same));
    }
    let outside = |node: usize| !counts.iter().any(|counts| counts[node]);
    assert!((0..160 * 160).all(|node| maps.disc_share[node].is_nan() == outside(node)));
}

#[test]
fn the_best_nodes_are_those_of_largest_value_that_lie_apart() {
    let face = face(60, 100.0, |_| 0.0);
    let mut values = vec![0.1; 3600];
    for (node, value) in [(30 * 60 + 30, 0.9), (30 * 60 + 33, 0.8), (30 * 60 + 36, 0.7), (5, 0.6), (6, f32::NAN)] {
        values[node] = value;
    }
    let level = &face.levels[0];
    assert_eq!(best_places(&values, &face.map, level, 3, 350.0), [1830, 1836, 5]);
    assert_eq!(best_places(&values, &face.map, level, 3, 250.0), [1830, 1833, 1836]);
    let all = best_places(&values, &face.map, level, 4000, 1.0);
    assert!(all.len() == 3599 && !all.contains(&6));
}

#[test]
fn gaps_have_no_illumination() {
    let mut face = face(40, 100.0, rough);
    face.levels[0].gap[41] = true;
    let maps = mapped(&face, Encoding::Fm16, Lit::Share(0.5));
    for plane in [&maps.lit_share, &maps.disc_share, &maps.longest_night_h, &maps.earth_share] {
        assert!(plane[41].is_nan() && plane.iter().filter(|value| value.is_nan()).count() == 1);
    }
}

/// Mazarico et al. (2011) name 89.45 S, 222.69 E as the best illuminated point of their 240 m model, lit 89.0 % of the
/// time. Ours is of the same posting and later tracks, over one nodal period: it finds the same node among 220 within
/// 2 km, lit 90.5 % of the time; 5 points are what models of one posting differ by there. That the mean share of the disc
/// is 7.6 points less than the time lit is no error: a few lines that share nothing with the program find 7.2.
#[test]
fn mazaricos_point_is_the_best_of_its_neighbourhood() {
    let kernels = percentages::KERNELS.map(|name| fixtures::data(&format!("kernels/{name}")));
    let Some(kernels) = kernels.into_iter().collect::<Option<Vec<_>>>() else { return };
    let data = fixtures::data_folder();
    let almanac = Almanac::load(&kernels).unwrap();
    let Some(table) =
        percentages::published(std::slice::from_ref(&data), &percentages::CLAIMS[..1], &almanac, &Silent).unwrap()
    else {
        println!("skipped: no elevation models in SIM_DATA");
        return;
    };
    let cell = |name: &str| {
        let column = table.columns.iter().position(|(column, _)| *column == name).unwrap();
        match &table.rows[0][column] {
            Value::Number(number) => *number,
            Value::Text(text) => text.parse().unwrap(),
            Value::Missing => f64::NAN,
        }
    };
    // One node is 240 m: 0.008 degrees of latitude.
    assert!((cell("best at latitude") + 89.45).abs() < 0.008, "{}", table.text());
    let off_m = 30_330.0 * 0.55 * (cell("longitude") - 222.69).to_radians();
    assert!(off_m.abs() < 240.0, "{}", table.text());
    assert!((cell("best, lit") - 89.0).abs() < 5.0, "{}", table.text());
    // What lies around it is far darker: a place on a ridge.
    assert!(cell("mean, disc") < 60.0, "{}", table.text());

    let dem = Dem::open(&data.join("dem/southcap_240m_1536.tif"), &Body::moon(), &Options::default()).unwrap();
    let [disc, lit] = shares_by_few_lines(&dem, cell("best at latitude"), cell("longitude"));
    // Steps miss crests between them, which lowers skylines, and the Sun's year is no circle.
    assert!((cell("best, disc") - 100.0 * disc).abs() < 1.5, "{disc} {}", table.text());
    assert!((cell("best, lit") - 100.0 * lit).abs() < 1.5, "{lit} {}", table.text());
}

/// Mean share of the disc, and share of the time with any of it in sight, by a skyline of 60 m steps over a polar
/// stereographic grid and a Sun that goes round in a synodic month and swings by 1.54° in a draconic year.
fn shares_by_few_lines(dem: &Dem, latitude_deg: f64, longitude_deg: f64) -> [f64; 2] {
    const MOON_M: f64 = 1_737_400.0;
    const SKYLINE: usize = 720;
    let (sin, cos) = latitude_deg.to_radians().sin_cos();
    let (sin_east, cos_east) = longitude_deg.to_radians().sin_cos();
    let up = DVec3::new(cos * cos_east, cos * sin_east, sin);
    let east = DVec3::new(-sin_east, cos_east, 0.0);
    let north = up.cross(east);
    let radius_m = |at: DVec3| {
        // Snyder (1987), eq. 21-33 and 21-5 to 21-6 for the south: rho = 2 R tan(45° + lat/2).
        let rho_m = 2.0 * MOON_M * (0.25 * TAU / 2.0 + 0.5 * at.z.asin()).tan();
        let (x_m, y_m) = (rho_m * at.y / at.x.hypot(at.y), rho_m * at.x / at.x.hypot(at.y));
        MOON_M + dem.bilinear_m(DVec2::new((x_m + 184_320.0) / 240.0 - 0.5, (184_320.0 - y_m) / 240.0 - 0.5))
    };
    let observer_m = radius_m(up);
    let skyline: Vec<f64> = (0..SKYLINE)
        .map(|index| {
            let (sin, cos) = (TAU * index as f64 / SKYLINE as f64).sin_cos();
            let towards = cos * north + sin * east;
            let elevation_rad = |step: usize| {
                let (sin, cos) = (60.0 * step as f64 / MOON_M).sin_cos();
                let far_m = radius_m(cos * up + sin * towards);
                (far_m * cos - observer_m).atan2(far_m * sin)
            };
            // Beyond the grid there is nothing: NaN is no maximum.
            (1..3500).map(elevation_rad).fold(f64::NEG_INFINITY, f64::max)
        })
        .collect();
    const STEPS: usize = 54_344;
    let mut sums = [0.0; 2];
    for step in 0..STEPS {
        let days = 0.125 * step as f64;
        let (sin, cos) = (1.543_f64.to_radians() * (TAU * days / 346.62).sin()).sin_cos();
        let (sin_round, cos_round) = (-TAU * days / 29.5306).sin_cos();
        let sun = DVec3::new(cos * cos_round, cos * sin_round, sin);
        let azimuth = sun.dot(east).atan2(sun.dot(north)).rem_euclid(TAU) / TAU * SKYLINE as f64;
        let (low, part) = (azimuth as usize % SKYLINE, azimuth.fract());
        let skyline_rad = (1.0 - part) * skyline[low] + part * skyline[(low + 1) % SKYLINE];
        let above = ((sun.dot(up).asin() - skyline_rad) / RADIUS_RAD).clamp(-1.0, 1.0);
        sums[0] += 0.5 + (above * (1.0 - above * above).sqrt() + above.asin()) * 2.0 / TAU;
        sums[1] += f64::from(above > -1.0);
    }
    sums.map(|sum| sum / STEPS as f64)
}
