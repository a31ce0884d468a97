//! Spreads against their closed forms.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use super::*;

/// The response of `columns × rows` pixels to rays that are given by their place in pixels.
fn response(psf: &Psf, [columns, rows]: [usize; 2], ray: impl Fn(f64, f64) -> f64) -> Vec<f32> {
    let (side, reach) = (psf.side, psf.reach);
    let width = (columns + 2 * reach) * side;
    let at = |i: usize| (i as f64 + 0.5) / side as f64 - 0.5 - reach as f64;
    let rays: Vec<f32> =
        (0..width * (rows + 2 * reach) * side).map(|index| ray(at(index % width), at(index / width)) as f32).collect();
    psf.spread(&rays, [columns, rows])
}

/// Light of the one ray nearest to a place.
fn point(psf: &Psf, size: usize, place: f64) -> Vec<f32> {
    let step = 0.5 / psf.side as f64 + 1e-9;
    response(psf, [size, size], |x, y| f64::from(u8::from((x - place).abs() < step && (y - place).abs() < step)))
}

const ALL: [PsfComponent; 3] = [
    PsfComponent::Gaussian { sigma_px: 0.8 },
    PsfComponent::Airy { cutoff_px: 0.7 },
    PsfComponent::Disc { diameter_px: 2.6 },
];

/// Of `n²` rays each carries `1/n²`. Weights are f32: 1e-6.
#[test]
fn every_rays_light_is_kept() {
    for side in [1, 2, 3, 4] {
        for spread in ALL {
            let psf = Psf::new(&[spread, PsfComponent::Gaussian { sigma_px: 0.3 }], None, side).unwrap();
            let size = 2 * psf.reach + 3;
            for ray in 0..side {
                let place = psf.reach as f64 + 1.0 + (ray as f64 + 0.5) / side as f64 - 0.5;
                let sum: f32 = point(&psf, size, place).iter().sum();
                assert!((sum * (side * side) as f32 - 1.0).abs() < 1e-6, "{spread:?}, {side}, {ray}: {sum}");
            }
        }
    }
}

/// A step seen through a Gaussian and a pixel: the mean of Φ over the pixel, by `∫Φ = xΦ + φ`. Rays stand for the step as
/// points for an integral: the midpoint rule errs by at most h²/24 of the integrand's slope, `1/(σ√2π)`; cutting at 4 σ
/// adds 2e-4.
#[test]
fn a_step_through_a_gaussian_is_the_error_function() {
    for (side, sigma_px) in [(1, 1.2), (2, 0.6), (2, 1.5), (4, 0.35), (8, 0.6)] {
        let psf = Psf::new(&[PsfComponent::Gaussian { sigma_px }], None, side).unwrap();
        let seen = response(&psf, [17, 3], |x, _| f64::from(u8::from(x > 8.5)));
        let below = |x: f64| {
            let z = x / sigma_px;
            let cumulative = 0.5 * (1.0 + erf(z * FRAC_1_SQRT_2));
            sigma_px * (z * cumulative + (-0.5 * z * z).exp() / TAU.sqrt())
        };
        for column in 0..17 {
            let x = column as f64 - 8.5;
            let expected = below(x + 0.5) - below(x - 0.5);
            let got = f64::from(seen[17 + column]);
            let allowed = 1.0 / (24.0 * (side * side) as f64 * sigma_px * TAU.sqrt()) + 2e-4;
            assert!((got - expected).abs() < allowed, "{side}, {sigma_px}, {column}: {got} {expected}");
        }
    }
}

/// Born & Wolf: the first dark ring lies at 1.22 `c` and holds 83.8 %; the second at 2.233 `c`, 91.0 %. Pixels an eighth of
/// `c` wide cut the ring's edge, where it is dark.
#[test]
fn the_first_dark_ring_of_airys_pattern_holds_83_8_percent() {
    let psf = Psf::new(&[PsfComponent::Airy { cutoff_px: 8.0 }], None, 1).unwrap();
    assert!((psf.cut_off - 2.0 / (6.0 * PI * PI)).abs() < 2e-3, "48 px are 6 c: {}", psf.cut_off);
    let size = 2 * psf.reach + 1;
    let light = point(&psf, size, psf.reach as f64);
    let radius =
        |index: usize| ((index % size) as f64 - psf.reach as f64).hypot((index / size) as f64 - psf.reach as f64);
    for (ring, share) in [(1.220, 0.838), (2.233, 0.910)] {
        let inside: f64 = (0..size * size).filter(|&i| radius(i) < ring * 8.0).map(|i| f64::from(light[i])).sum();
        let got = inside * (1.0 - psf.cut_off);
        assert!((got - share).abs() < 0.002, "{ring}: {got}");
    }
    let encircled = PsfComponent::Airy { cutoff_px: 1.0 }.encircled(3.8317 / PI);
    assert!((encircled - 0.8378).abs() < 1e-4, "{encircled}");
}

/// Mean squares add: those of the spreads, and 1/12 of the pixel (Sheppard). A disc's is d²/16 along an axis.
#[test]
fn mean_squares_of_spreads_add() {
    let (gaussian, disc) = (PsfComponent::Gaussian { sigma_px: 0.9 }, PsfComponent::Disc { diameter_px: 3.0 });
    for (spreads, expected) in [(vec![gaussian], 0.81), (vec![gaussian, disc], 0.81 + 9.0 / 16.0)] {
        let psf = Psf::new(&spreads, None, 1).unwrap();
        let size = 2 * psf.reach + 1;
        let light = point(&psf, size, psf.reach as f64);
        let squares: f64 =
            (0..size * size).map(|i| f64::from(light[i]) * ((i % size) as f64 - psf.reach as f64).powi(2)).sum();
        // What is cut off at 4 σ takes 0.1 % of the mean square with it; a disc's edge lies within a cell, 1/9 px.
        assert!((squares - expected - 1.0 / 12.0).abs() < 4e-3, "{spreads:?}: {squares}");
    }
}

/// The middle of a disc of 21 pixels is even: 4/(π 21²) a pixel.
#[test]
fn a_point_out_of_focus_is_an_even_disc() {
    let psf = Psf::new(&[PsfComponent::Disc { diameter_px: 21.0 }], None, 1).unwrap();
    let size = 2 * psf.reach + 1;
    let light = point(&psf, size, psf.reach as f64);
    let expected = 4.0 / (PI * 21.0 * 21.0);
    for (place, share) in [(0, 1.0), (9, 1.0), (12, 0.0)] {
        let got = f64::from(light[psf.reach * size + (psf.reach + place).min(size - 1)]);
        assert!((got - share * expected).abs() < 2e-3 * expected, "{place}: {got} {expected}");
    }
}

#[test]
fn a_kernel_shares_a_pixels_light_as_it_lies() {
    let kernel = Kernel::new(3, 1, &[1.0, 6.0, 3.0]).unwrap();
    let psf = Psf::new(&[], Some(&kernel), 2).unwrap();
    assert_eq!(psf.reach, 1);
    let light = response(&psf, [5, 3], |x, y| f64::from(u8::from((x - 2.0).abs() < 0.5 && (y - 1.0).abs() < 0.5)));
    let expected = [0.0, 0.1, 0.6, 0.3, 0.0];
    assert!(light[5..10].iter().zip(expected).all(|(got, expected)| (got - expected).abs() < 1e-6), "{light:?}");
    assert!(light[..5].iter().chain(&light[10..]).all(|got| *got == 0.0));
    for (columns, rows, values) in [(2, 1, &[1.0, 1.0][..]), (1, 1, &[0.0]), (1, 1, &[-1.0]), (3, 1, &[1.0])] {
        assert!(matches!(Kernel::new(columns, rows, values), Err(CameraError::Kernel { .. })));
    }
}

#[test]
fn without_a_spread_pixels_are_means_of_their_rays() {
    let psf = Psf::new(&[], None, 2).unwrap();
    let seen = response(&psf, [3, 2], |x, y| x + 10.0 * y);
    assert_eq!((psf.reach, seen), (0, vec![0.0, 1.0, 2.0, 10.0, 11.0, 12.0]));
}

/// What has no value lends nothing: even light stays even about it.
#[test]
fn a_pixel_without_a_value_leaves_its_neighbours_theirs() {
    let psf = Psf::new(&[PsfComponent::Gaussian { sigma_px: 1.0 }], None, 2).unwrap();
    let hole = |x: f64, y: f64| if (x - 3.0).abs() < 0.5 && (y - 2.0).abs() < 0.5 { f64::NAN } else { 7.0 };
    let seen = response(&psf, [7, 5], hole);
    for (index, got) in seen.iter().enumerate() {
        assert!(if index == 2 * 7 + 3 { got.is_nan() } else { (got - 7.0).abs() < 1e-5 }, "{index}: {got}");
    }
}

#[test]
fn impossible_spreads_are_named() {
    let error = Psf::new(&[PsfComponent::Gaussian { sigma_px: 40.0 }], None, 1).unwrap_err();
    assert_eq!(error.to_string(), "psf sigma = 40 is outside [0.05, 12] px");
}
