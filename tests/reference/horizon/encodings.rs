//! The published encodings word by word against a few lines written from the papers, and ours against theirs.

use std::f64::consts::TAU;

use glam::DVec2;
use half::f16;
use perilune_engine::horizon::axis::Major;
use perilune_engine::horizon::elevation_plane::ElevationPlane;
use perilune_engine::horizon::fit::Accumulator;
use perilune_engine::horizon::pack::Family;
use perilune_engine::horizon::{Encoding, HorizonMap};

const SIDE: usize = 32;
const AZIMUTHS: usize = 144;

/// A skyline of two hills, one of them a cliff, that move and grow over the map.
fn elevation_rad(column: usize, row: usize, azimuth: usize) -> f64 {
    let (x, y) = (column as f64 / SIDE as f64, row as f64 / SIDE as f64);
    let a = TAU * azimuth as f64 / AZIMUTHS as f64;
    let hill = 0.2 * (1.0 + x) * (3.0 * ((a - 1.0 - 2.0 * y).cos() - 1.0)).exp();
    let cliff = if (a - 4.0 - x).cos() > 0.9 { 0.1 + 0.1 * y } else { -0.01 };
    hill + cliff
}

fn planes() -> Vec<ElevationPlane> {
    let plane = |azimuth: usize| {
        let nodes = 0..SIDE * SIDE;
        let elevations_rad = nodes.map(|node| elevation_rad(node % SIDE, node / SIDE, azimuth) as f32).collect();
        ElevationPlane { azimuth, stride: SIDE, elevations_rad }
    };
    (0..AZIMUTHS).map(plane).collect()
}

fn encoded(encoding: Encoding) -> HorizonMap {
    let mut sums = Accumulator::new(encoding, SIDE, SIDE, AZIMUTHS);
    sums.add(&planes(), Major::Row);
    sums.map()
}

/// Both halves of a word as half floats.
fn halves(word: u32) -> [f64; 2] {
    [word as u16, (word >> 16) as u16].map(|bits| f64::from(f16::from_bits(bits).to_f32()))
}

/// Section 3.2 of Fritsch et al. (2025): the discrete Fourier transform of the horizon, "k_i downsampled by 2^⌊i/4⌋" with a
/// box filter, complex numbers as two 16-bit floats in a channel of 32 bits, four of them in a texel; equation 3 then sums
/// X_k e^{ikθ} from 0 to N − 1, which needs twice the transform's numbers for k ≥ 1.
#[test]
fn fourier_maps_hold_the_words_of_the_paper() {
    let all = [Encoding::Fm4, Encoding::Fm8, Encoding::Fm12, Encoding::Fm16, Encoding::F8, Encoding::F16];
    for encoding in all {
        let map = encoded(encoding);
        for (page, level) in map.levels.iter().enumerate() {
            let side = if encoding.name().starts_with("fm") { 1 << page } else { 1 };
            assert_eq!((level.columns, level.rows, level.words_per_texel), (SIDE / side, SIDE / side, 4));
            for (column, row) in [(0, 0), (1, 3), (3, 2)] {
                for slot in 0..4 {
                    let k = 4 * page + slot;
                    let (mut re, mut im) = (0.0, 0.0);
                    for node in 0..side * side {
                        let (x, y) = (column * side + node % side, row * side + node / side);
                        for i in 0..AZIMUTHS {
                            let turn = TAU * (k * i) as f64 / AZIMUTHS as f64;
                            re += elevation_rad(x, y, i) * turn.cos();
                            im -= elevation_rad(x, y, i) * turn.sin();
                        }
                    }
                    let norm = if k == 0 { 1.0 } else { 2.0 } / (AZIMUTHS * side * side) as f64;
                    let got = halves(level.texel(column, row)[slot]);
                    for (got, wanted) in got.into_iter().zip([re * norm, im * norm]) {
                        // Half a unit in the last of 11 bits, and sums in f32.
                        let bound = wanted.abs() / 2048.0 + 2e-7;
                        assert!((got - wanted).abs() <= bound, "{encoding} X{k}: {got}, not {wanted}");
                    }
                }
            }
        }
    }
}

/// Max (1988): elevations at fixed azimuths, linear between them.
#[test]
fn sampled_maps_hold_their_azimuths_and_lines_between() {
    for encoding in [Encoding::Raw8, Encoding::Raw12, Encoding::Raw16] {
        let map = encoded(encoding);
        let count = encoding.samples();
        let every = AZIMUTHS / count;
        for (column, row) in [(0, 0), (5, 9), (31, 31)] {
            let horizon = map.horizon(DVec2::new(column as f64, row as f64));
            let texel = map.levels[0].texel(column, row);
            for sample in 0..count {
                let wanted = elevation_rad(column, row, sample * every);
                let got = halves(texel[sample / 2])[sample % 2];
                assert!(
                    (got - wanted).abs() <= wanted.abs() / 2048.0 + 2e-7,
                    "{encoding} {sample}: {got}, not {wanted}"
                );
                let next = elevation_rad(column, row, (sample + 1) % count * every);
                for share in [0.25, 0.5, 0.75] {
                    let (sin, cos) = (TAU * (sample as f64 + share) / count as f64).sin_cos();
                    let (got, slope) = horizon.evaluate_towards(DVec2::new(sin, cos));
                    // Two half floats of up to 0.5.
                    assert!((got - (wanted + share * (next - wanted))).abs() < 2.5e-4, "{encoding} {sample} + {share}");
                    assert!((slope - (next - wanted) * count as f64 / TAU).abs() < 1.5e-3, "{encoding} {sample}");
                }
            }
        }
    }
}

fn rms_rad(map: &HorizonMap) -> f64 {
    let mut squares = 0.0;
    for node in 0..SIDE * SIDE {
        let horizon = map.horizon(DVec2::new((node % SIDE) as f64, (node / SIDE) as f64));
        for azimuth in 0..AZIMUTHS {
            let (sin, cos) = (TAU * azimuth as f64 / AZIMUTHS as f64).sin_cos();
            let wanted = elevation_rad(node % SIDE, node / SIDE, azimuth);
            squares += (horizon.evaluate_towards(DVec2::new(sin, cos)).0 - wanted).powi(2);
        }
    }
    (squares / (SIDE * SIDE * AZIMUTHS) as f64).sqrt()
}

/// More bytes are better within each family, and a pyramid is better than the published maps of its size.
#[test]
fn more_bytes_err_less_and_water_filled_ones_least() {
    let error = |encoding: Encoding| rms_rad(&encoded(encoding));
    let falling = |encodings: &[Encoding]| encodings.iter().map(|e| error(*e)).is_sorted_by(|a, b| a > b);
    assert!(falling(&[Encoding::Fm4, Encoding::Fm8, Encoding::Fm12, Encoding::Fm16]));
    assert!(falling(&[Encoding::F4, Encoding::F8, Encoding::F12, Encoding::F16]));
    assert!(falling(&[Encoding::Raw8, Encoding::Raw12, Encoding::Raw16]));
    assert!(falling(&[Encoding::W11, Encoding::W16, Encoding::W21]));
    assert!(error(Encoding::W21) < 0.7 * error(Encoding::Fm16) && error(Encoding::W16) < 0.8 * error(Encoding::F4));
}

/// Nothing is spent on a bit that a texel does not have, no two fields share one, and the coefficients of a constant map come back.
#[test]
fn fields_fill_the_words_without_meeting_each_other() {
    for encoding in [Encoding::W11, Encoding::W16, Encoding::W21] {
        assert_eq!(encoding.family(), Family::Quantised);
        let map = encoded(encoding);
        for (level, fields) in map.levels.iter().zip(&map.fields) {
            let mut used = vec![0_u32; level.words_per_texel];
            for field in fields {
                let bits = (((1_u64 << field.width) - 1) << field.shift) as u32;
                assert_eq!(used[field.word] & bits, 0, "{encoding} {field:?}");
                used[field.word] |= bits;
            }
            let spent: u32 = used.iter().map(|word| word.count_ones()).sum();
            assert!(spent as usize > 28 * level.words_per_texel, "{encoding} spends {spent} bits");
        }
    }
}
