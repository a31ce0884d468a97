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
