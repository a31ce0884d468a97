//! Ground below the posting of a measured model: it goes on as it was, and measured again it is what was measured.

use glam::DVec2;
use perilune_engine::geometry::{Body, Geodetic};
use perilune_engine::raster::{Dem, GeoTiff, GeoTiffBand, Options};
use perilune_engine::terrain::synthetic::{Continued, Detail, Structure, continue_below};

const SIDE: usize = 201;
const OLD_M: f64 = 20.0;
const HURST: f64 = 0.6;

/// A plane wave of random direction and phase, by a multiplicative generator: not the program's noise.
fn waves() -> Vec<(DVec2, f64, f64)> {
    let mut state = 20_26u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1u64 << 31) as f64
    };
    // 40 a factor of 1.3 in wavelength, from 2 km to the measured Nyquist wavelength; amplitudes λ^H.
    (0..15)
        .flat_map(|k| std::iter::repeat_n(2000.0 / 1.3f64.powi(k), 40))
        .filter(|wavelength_m| *wavelength_m > 2.0 * OLD_M)
        .map(|wavelength_m| {
            let direction = DVec2::from_angle(std::f64::consts::TAU * random());
            let phase_rad = std::f64::consts::TAU * random();
            (direction * std::f64::consts::TAU / wavelength_m, phase_rad, 0.02 * wavelength_m.powf(HURST))
        })
        .collect()
}

/// A self-affine model of 4 km about a place on the Moon, as a file.
fn measured(folder: &std::path::Path) -> Dem {
    let waves = waves();
    let height_m = |index: usize| {
        let at_m = DVec2::new((index % SIDE) as f64, (index / SIDE) as f64) * OLD_M;
        waves.iter().map(|(k, phase_rad, amplitude_m)| amplitude_m * (k.dot(at_m) + phase_rad).sin()).sum::<f64>()
            as f32
    };
    let heights_m: Vec<f32> = (0..SIDE * SIDE).map(height_m).collect();
    let half_m = SIDE as f64 * OLD_M / 2.0;
    let crs = "+proj=gnom +lat_0=-80 +lon_0=40 +R=1737400 +units=m +no_defs";
    let geotransform = [-half_m, OLD_M, 0.0, half_m, 0.0, -OLD_M];
    let bands = vec![GeoTiffBand { name: "height", unit: "m", values: &heights_m }];
    let path = folder.join("measured.tif");
    GeoTiff { columns: SIDE, rows: SIDE, bands, crs, geotransform }.write(&path).unwrap();
    Dem::open(&path, &Body::moon(), &Options::default()).unwrap()
}

fn detail() -> Detail {
    Detail {
        posting_m: 1.25,
        extent_m: 800.0,
        centre: Geodetic::from_degrees(-80.0, 40.0, 0.0),
        seed: 3,
        craters: 0.0,
        boulders_per_km2: 0.0,
    }
}

fn rms_difference_m(heights_m: &[f32], columns: usize, lag: usize) -> f64 {
    let pairs = (0..heights_m.len()).filter(|index| index % columns + lag < columns);
    let squares: Vec<f64> = pairs.map(|index| f64::from(heights_m[index + lag] - heights_m[index]).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn differences_go_on_by_the_measured_power_law() {
    let folder = tempfile::tempdir().unwrap();
    let Continued { columns, heights_m, measured_m, structure, .. } =
        continue_below(&Body::moon(), &detail(), &measured(folder.path())).unwrap();
    println!("{structure:?}");
    // Waves of one direction each, 40 of a kind, and the ends of the range bend the law by some hundredths.
    assert!((structure.hurst - HURST).abs() < 0.15, "{structure:?}");
    for lag in [4, 8, 16] {
        let lag_m = 1.25 * lag as f64;
        let law_m = structure.rms_1m * f64::powf(lag_m, structure.hurst);
        let [new_m, old_m] = [&heights_m, &measured_m].map(|heights_m| rms_difference_m(heights_m, columns, lag));
        println!("{lag_m} m: {new_m:.3} m, by the law {law_m:.3} m, without detail {old_m:.3} m");
        assert!((new_m / law_m - 1.0).abs() < 0.3, "{lag_m} m: {new_m} {law_m}");
        // What was only interpolated is too smooth: the comparison can fail.
        assert!(lag > 4 || (old_m / law_m - 1.0).abs() > 0.3, "{old_m} {law_m}");
    }
}

#[test]
fn means_over_the_measured_posting_are_the_measured_ones() {
    let folder = tempfile::tempdir().unwrap();
    let measured = measured(folder.path());
    let with_all = Detail { craters: 1.0, boulders_per_km2: 5000.0, ..detail() };
    let made = continue_below(&Body::moon(), &with_all, &measured).unwrap();
    let added_m: Vec<f64> = made.heights_m.iter().zip(&made.measured_m).map(|(h, m)| f64::from(h - m)).collect();
    let rms = |values: &[f64]| (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
    let cell = 16;
    let mean = |column: usize, row: usize| {
        let pixels =
            (0..cell * cell).map(|k| added_m[(row * cell + k / cell) * made.columns + column * cell + k % cell]);
        pixels.sum::<f64>() / (cell * cell) as f64
    };
    let cells = made.columns / cell;
    let means: Vec<f64> = (0..cells * cells).map(|index| mean(index % cells, index / cells)).collect();
    println!("added {:.3} m RMS, means over 20 m {:.4} m", rms(&added_m), rms(&means));
    assert!(rms(&added_m) > 0.05);
    assert!(rms(&means) < 0.03 * rms(&added_m), "{} {}", rms(&means), rms(&added_m));
    assert!(made.craters.len() > 10 && made.craters.iter().all(|crater| crater.diameter_m <= 2.0 * OLD_M));
    // The same seed is the same ground, another one is not.
    assert_eq!(made, continue_below(&Body::moon(), &with_all, &measured).unwrap());
    assert!(
        made.heights_m != continue_below(&Body::moon(), &Detail { seed: 4, ..with_all }, &measured).unwrap().heights_m
    );
}

#[test]
fn ground_that_is_no_finer_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let coarse = Detail { posting_m: 15.0, ..detail() };
    let error = continue_below(&Body::moon(), &coarse, &measured(folder.path())).unwrap_err();
    assert!(error.to_string().contains("posting_m = 15 is outside"), "{error}");
}

/// `s L^H` exactly along a line of one dimension: Brownian heights by a running sum have H = ½.
#[test]
fn the_exponent_of_a_random_walk_is_one_half() {
    let mut state = 7u64;
    let mut height_m = 0.0;
    let columns = 4096;
    let walk: Vec<f64> = (0..columns)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            height_m += if state >> 63 == 1 { 1.0 } else { -1.0 };
            height_m
        })
        .collect();
    // Many equal columns below each other: differences along columns are 0, half of the squares.
    let heights_m: Vec<f64> = (0..32).flat_map(|_| walk.clone()).collect();
    let structure = Structure::of(&heights_m, columns, 1.0);
    assert!((structure.hurst - 0.5).abs() < 0.05, "{structure:?}");
    assert!((structure.rms_1m - 0.5f64.sqrt()).abs() < 0.1, "{structure:?}");
}
