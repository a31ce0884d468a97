use std::f64::consts::PI;

use super::*;

fn make(side: usize, posting_m: f64, seed: u64) -> Synthetic {
    generate(&Body::moon(), &Parameters::highland(side, side, posting_m, seed), &|_, _| ()).unwrap()
}

/// Maximum-likelihood exponent of a power law cut off at both ends is near that of the tail below a
/// tenth of the largest: Crawford et al. (1970), 1/mean(ln D/D_min).
#[test]
fn the_size_distribution_has_the_published_exponent_and_density() {
    let terrain = make(1024, 20.0, 5);
    let diameters: Vec<f64> = terrain.craters.iter().map(|crater| crater.diameter_m).collect();
    let smallest_m = 80.0;
    let mean_log = diameters.iter().map(|d| (d / smallest_m).ln()).sum::<f64>() / diameters.len() as f64;
    // 1/√n of an exponent near 1.83 with n ≈ 3000, three times.
    assert!((1.0 / mean_log - 1.83).abs() < 0.11, "{} of {}", 1.0 / mean_log, diameters.len());
    let over_100_m = diameters.iter().filter(|d| **d > 100.0).count() as f64 / (20.48f64 * 20.48);
    // Trask (1966): 7.9 per km² over 100 m; Hartmann (1984): 5.0. Poisson noise of 2000 craters is 2 %.
    assert!((4.5..8.0).contains(&over_100_m), "{over_100_m}");
}

#[test]
fn fresh_craters_are_as_deep_as_measured_and_old_ones_shallower() {
    let terrain = make(512, 20.0, 6);
    let (fresh, old): (Vec<&Crater>, Vec<&Crater>) = terrain.craters.iter().partition(|c| c.degradation < 0.005);
    let ratio = |crater: &&Crater| crater.depth_m / crater.diameter_m;
    // Pike (1977): 0.196 for simple craters, ± 0.02 for the youngest ones' first decay.
    assert!(!fresh.is_empty() && fresh.iter().all(|crater| (0.15..0.21).contains(&ratio(crater))));
    assert!(old.iter().all(|crater| ratio(crater) < 0.196));
}

/// Rosenburg et al. (2011): median slopes of the highlands are 5–10° at 17–25 m baselines; polar massifs
/// stand at the upper end.
#[test]
fn median_slopes_are_those_of_highlands() {
    let terrain = make(1024, 20.0, 7);
    let slope = |index: usize| {
        let [h, right, below] = [index, index + 1, index + 1024].map(|k| f64::from(terrain.heights_m[k]));
        ((right - h) / 20.0).hypot((below - h) / 20.0).atan().to_degrees()
    };
    let mut slopes: Vec<f64> = (0..1023 * 1024).filter(|index| index % 1024 < 1023).step_by(7).map(slope).collect();
    slopes.sort_by(f64::total_cmp);
    let median = slopes[slopes.len() / 2];
    eprintln!("median slope {median:.1} deg");
    assert!((5.0..15.0).contains(&median), "{median}");
    // Nothing but crater walls of later impacts on slopes exceeds the angle of repose by much.
    let steep = slopes[slopes.len() * 999 / 1000];
    assert!(steep < 45.0, "{steep}");
}

#[test]
fn the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| make(300, 10.0, 8));
    let three = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap().install(|| make(300, 10.0, 8));
    assert!(one == three);
    assert!(one != make(300, 10.0, 9));
}

/// A lone fresh crater on a plain: its list entry describes the hole that is there.
#[test]
fn a_listed_crater_is_in_the_heights() {
    let usual = Parameters::highland(1024, 1024, 10.0, 4);
    let flat = Parameters { relief_m: 0.0, roughness: 0.0, density: 0.1, smallest_m: 300.0, largest_m: 600.0, ..usual };
    let terrain = generate(&Body::moon(), &flat, &|_, _| ()).unwrap();
    let alone = |crater: &&Crater| {
        let far = |other: &&Crater| {
            (other.x_m - crater.x_m).hypot(other.y_m - crater.y_m) > 2.0 * (crater.diameter_m + other.diameter_m)
        };
        crater.x_m.abs().max(crater.y_m.abs()) + crater.diameter_m < 5000.0
            && terrain.craters.iter().filter(|other| other.id != crater.id).all(|other| far(&other))
    };
    let crater = terrain.craters.iter().find(alone).expect("at this density craters stand apart");
    let [west, _, _, north, ..] = terrain.geotransform;
    let (column, row) = ((crater.x_m - west) / 10.0, (north - crater.y_m) / 10.0);
    let at = |c: f64, r: f64| f64::from(terrain.heights_m[r as usize * 1024 + c as usize]);
    let radius = crater.diameter_m / 20.0;
    let rim = (0..64).map(|k| DVec2::from_angle(f64::from(k) * PI / 32.0) * radius);
    let rim_m = rim.map(|offset| at(column + offset.x, row + offset.y)).sum::<f64>() / 64.0;
    let depth_m = rim_m - at(column, row);
    // A pixel of 10 m on walls of up to 30° in a crater of 300 m and more.
    assert!((depth_m - crater.depth_m).abs() < 0.12 * crater.depth_m + 3.0, "{depth_m} {crater:?}");
}

#[test]
fn impossible_parameters_are_refused_with_their_name() {
    let good = Parameters::highland(64, 64, 10.0, 1);
    let refused = |bad: Parameters| generate(&Body::moon(), &bad, &|_, _| ()).unwrap_err().to_string();
    assert!(refused(Parameters { columns: 1, ..good.clone() }).contains("columns"));
    assert!(refused(Parameters { posting_m: f64::NAN, ..good.clone() }).contains("posting_m = NaN"));
    assert!(refused(Parameters { largest_m: 1.0, ..good.clone() }).contains("largest_m = 1"));
    assert!(refused(Parameters { density: -1.0, ..good }).contains("density = -1"));
}

/// A terrain of 20 km and one of 5 km in its middle, on odd counts: every fourth fine pixel is a coarse one.
fn nested(seed: u64, change: impl Fn(Parameters) -> Parameters) -> [Synthetic; 2] {
    let coarse = generate(&Body::moon(), &Parameters::highland(257, 257, 80.0, seed), &|_, _| ()).unwrap();
    let parameters = change(Parameters::highland(257, 257, 20.0, seed));
    let fine = generate_within(&Body::moon(), &parameters, &coarse, &|_, _| ()).unwrap();
    [coarse, fine]
}

/// Fine minus coarse heights at the coarse pixels that the fine terrain holds, row by row, 65 a side.
fn differences_m([coarse, fine]: &[Synthetic; 2]) -> Vec<f64> {
    let pairs = (0..65 * 65).map(|index: usize| (index % 65, index / 65));
    let at = |(c, r): (usize, usize)| (fine.heights_m[4 * r * 257 + 4 * c], coarse.heights_m[(96 + r) * 257 + 96 + c]);
    pairs.map(at).map(|(fine_m, coarse_m)| f64::from(fine_m - coarse_m)).collect()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// Without anything of its own a finer terrain is the coarser one with pixels in between.
#[test]
fn a_finer_terrain_repeats_the_coarser_one() {
    let bare = |parameters| Parameters { density: 0.0, roughness: 0.0, ..parameters };
    let differences_m = differences_m(&nested(10, bare));
    assert!(differences_m.iter().all(|difference_m| difference_m.abs() < 1e-3), "{}", rms(&differences_m));
}

/// What a finer terrain adds are craters under four coarse pixels: 320 m across and, by Pike (1977), 63 m deep.
/// Means over coarse pixels differ by a tenth of that; the coarser relief is tens of times larger.
#[test]
fn a_finer_terrain_averages_to_the_coarser_one() {
    let terrains = nested(11, |parameters| parameters);
    let [coarse, fine] = &terrains;
    let mean = |c: usize, r: usize| {
        let block = (0..25).map(|k| fine.heights_m[(4 * r + 2 + k / 5) * 257 + 4 * c + 2 + k % 5]);
        block.map(f64::from).sum::<f64>() / 25.0
    };
    let interior = (0..63 * 63).map(|index| (index % 63, index / 63));
    let differences_m: Vec<f64> =
        interior.map(|(c, r)| mean(c, r) - f64::from(coarse.heights_m[(97 + r) * 257 + 97 + c])).collect();
    let heights_m: Vec<f64> = coarse.heights_m.iter().map(|&height_m| f64::from(height_m)).collect();
    let mean_m = heights_m.iter().sum::<f64>() / heights_m.len() as f64;
    let relief_m = rms(&heights_m.iter().map(|height_m| height_m - mean_m).collect::<Vec<_>>());
    eprintln!("means differ by {:.2} m RMS, relief {relief_m:.0} m", rms(&differences_m));
    assert!(rms(&differences_m) < 6.3, "{}", rms(&differences_m));
    assert!(relief_m > 100.0, "{relief_m}");
    // Another seed is another terrain: the comparison can fail.
    let other = nested(12, |parameters| parameters);
    let mixed = self::differences_m(&[coarse.clone(), other[1].clone()]);
    assert!(rms(&mixed) > 50.0, "{}", rms(&mixed));
}

/// No new crater crosses the border, so only the fractal's short octaves and the last of ejecta differ there.
#[test]
fn terrains_agree_along_the_border() {
    let differences_m = differences_m(&nested(11, |parameters| parameters));
    let on_border = |index: &usize| [index % 65, index / 65].into_iter().any(|k| k == 0 || k == 64);
    let border: Vec<f64> = (0..65 * 65).filter(on_border).map(|index| differences_m[index]).collect();
    // New octaves of 306, 164 and 88 m with slopes of 0.014: amplitudes of 6.9, 3.8 and 2.1 m times 0.25, the RMS
    // of gradient noise, make 2.0 m. Ejecta beyond 3 radii of 320 m add 0.2 m at most.
    assert!(rms(&border) < 2.3, "{}", rms(&border));
}

/// Craters of both lists, each over the area where it is complete, against the one power law, bin by bin.
#[test]
fn sizes_go_on_from_the_coarser_to_the_finer_terrain() {
    let [coarse, fine] = nested(13, |parameters| parameters);
    let count = |terrain: &Synthetic, half_m: f64, from_m: f64, to_m: f64| {
        let [west, step, _, north, ..] = terrain.geotransform;
        let middle = DVec2::new(west, north) + DVec2::new(1.0, -1.0) * step * terrain.columns as f64 / 2.0;
        let inside = |crater: &&Crater| {
            (DVec2::new(crater.x_m, crater.y_m) - middle).abs().max_element() < half_m
                && (from_m..to_m).contains(&crater.diameter_m)
        };
        terrain.craters.iter().filter(inside).count() as f64
    };
    let expected = |half_m: f64, from_m: f64, to_m: f64| {
        let over = |diameter_m: f64| DENSITY_PER_KM2 * (diameter_m / 1000.0).powf(-EQUILIBRIUM_EXPONENT);
        (half_m / 500.0).powi(2) * (over(from_m) - over(to_m))
    };
    // The finer terrain's own craters are complete 8 coarse pixels inside its border.
    for (terrain, half_m, from_m, to_m) in [
        (&fine, 1900.0, 80.0, 113.0),
        (&fine, 1900.0, 113.0, 160.0),
        (&fine, 1900.0, 160.0, 320.0),
        (&fine, 2560.0, 320.0, 5000.0),
        (&coarse, 10_000.0, 320.0, 640.0),
    ] {
        let (got, want) = (count(terrain, half_m, from_m, to_m), expected(half_m, from_m, to_m));
        // Poisson noise, three times.
        assert!((got - want).abs() < 3.0 * want.sqrt(), "{from_m} to {to_m} m: {got} craters, {want:.1} expected");
    }
    // Every coarse crater on the finer raster is in its list.
    let shared = count(&coarse, 2570.0, 320.0, f64::INFINITY);
    assert_eq!(count(&fine, 2570.0, 320.0, f64::INFINITY), shared);
}

#[test]
fn a_nest_has_the_same_bits_on_any_number_of_threads() {
    let make = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| nested(14, |parameters| parameters))
    };
    assert!(make(1) == make(3));
}

#[test]
fn a_terrain_that_cannot_continue_another_is_refused() {
    let coarse = make(64, 80.0, 1);
    let good = Parameters::highland(64, 64, 20.0, 1);
    let refused = |bad: Parameters| generate_within(&Body::moon(), &bad, &coarse, &|_, _| ()).unwrap_err().to_string();
    let elsewhere = Geodetic::from_degrees(-80.0, 0.0, 0.0);
    assert!(refused(Parameters { centre: elsewhere, ..good.clone() }).contains("centre = Gnomonic about -80"));
    assert!(refused(Parameters { posting_m: 80.0, ..good.clone() }).contains("posting_m = 80"));
    assert!(refused(Parameters { columns: 300, ..good }).contains("columns, rows = [6000, 1280] m"));
}
