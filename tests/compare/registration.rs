//! Known motions are found within their stated errors.

use glam::DVec2;
use perilune_engine::compare::photometric::Response;
use perilune_engine::compare::register::{Freedom, Motion, register, register_detail, warped};
use perilune_engine::compare::{Error, Model, ScalarImage};

const SIZE: usize = 200;

/// A smooth scene without period: hills of 4 to 9 pixels at places of Weyl's sequences.
fn scene(at: DVec2) -> f64 {
    (1..=340)
        .map(|k| {
            let turn = |step: f64| (f64::from(k) * step).fract();
            let centre = DVec2::new(turn(0.754_877_666), turn(0.569_840_291)) * (SIZE as f64 + 40.0) - 20.0;
            let width = 4.0 + 5.0 * turn(0.381_966);
            let height = if turn(0.618_034) > 0.5 { 1.0 } else { -0.7 };
            height * (-(at - centre).length_squared() / (2.0 * width * width)).exp()
        })
        .sum()
}

fn image(value: impl Fn(DVec2) -> f64) -> ScalarImage {
    let at = |i: usize| DVec2::new((i % SIZE) as f64, (i / SIZE) as f64);
    ScalarImage::new(SIZE, SIZE, (0..SIZE * SIZE).map(|i| value(at(i))).collect())
}

/// The scene as a photograph of a motion shows it, written out once more.
fn photographed(shift: [f64; 2], rotation_rad: f64, scale: f64) -> ScalarImage {
    let middle = (SIZE as f64 - 1.0) / 2.0;
    let (sin, cos) = rotation_rad.sin_cos();
    image(|p| {
        let (x, y) = (p.x - middle, p.y - middle);
        let turned = DVec2::new(cos * x - sin * y, sin * x + cos * y) * (1.0 + scale);
        scene(turned + middle + DVec2::from(shift))
    })
}

/// Without what the high-pass (a Gaussian of 10 px, 35 px wide) sees of the edges.
fn inner(image: &ScalarImage) -> ScalarImage {
    image.without_border(36, 36)
}

fn high(image: &ScalarImage) -> ScalarImage {
    image.high_pass(10.0)
}

#[test]
fn an_image_and_itself_register_exactly() {
    let found = register(&inner(&high(&image(scene))), &high(&image(scene)), Freedom::Similarity).unwrap();
    assert_eq!((found.motion, found.sigma), (Motion::default(), Motion::default()));
    assert!((found.correlation - 1.0).abs() < 1e-12);
}

/// Shift, rotation and a field of view wrong by half a percent, under gain and offset. Cubic interpolation of hills of
/// 4 px errs by 1e-3 of their height, which moves nothing by more than 0.01 px.
#[test]
fn a_known_motion_is_found() {
    for (shift, rotation_rad, scale) in
        [([2.3, -1.4], 0.0, 0.0), ([0.0, 0.0], 0.01, 0.0), ([-7.6, 5.2], -0.006, 0.005), ([0.4, 0.3], 0.0, -0.005)]
    {
        let photo = photographed(shift, rotation_rad, scale).map(|value| 37.0 * value + 120.0);
        let found = register(&inner(&high(&photo)), &high(&image(scene)), Freedom::Similarity).unwrap();
        let Motion { shift_px, rotation_rad: rotation, scale: scaled } = found.motion;
        assert!((DVec2::from(shift_px) - DVec2::from(shift)).length() < 0.02, "{found:?}");
        assert!((rotation - rotation_rad).abs() < 2e-4 && (scaled - scale).abs() < 2e-4, "{found:?}");
        let Response::Gain { gain, offset } =
            Response::fit(Model::Gain, &inner(&photo), &warped(&image(scene), &found.motion))
        else {
            panic!()
        };
        assert!((gain / 37.0 - 1.0).abs() < 2e-3 && (offset - 120.0).abs() < 0.1, "{gain} {offset}");
    }
}

/// The high-pass sees the edges, whose ground the two do not share: a twentieth of a wrong field of view is not lost.
#[test]
fn the_images_edges_bias_nothing() {
    let photo = photographed([3.0, -2.0], 0.0, 0.005).without_border(6, 6);
    let found = register_detail(&photo, &image(scene), 10.0, Freedom::Similarity).unwrap();
    assert!((found.motion.scale - 0.005).abs() < 1.5e-4, "{found:?}");
}

/// Noise moves what is found by what it says, over 12 draws: errors over sigmas have an RMS near 1. Of 48 numbers it
/// lies within 0.6 and 1.5 unless the sigmas are wrong.
#[test]
fn the_stated_errors_are_those_made() {
    let truth = ([1.7, -2.2], 0.003, 0.002);
    let clean = photographed(truth.0, truth.1, truth.2);
    let (mut sum, mut count) = (0.0, 0.0);
    for draw in 0..12_u32 {
        let mut state = 0x9e37_79b9_u32.wrapping_mul(draw + 1);
        let mut noise = || {
            (0..12)
                .map(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    f64::from(state >> 8) / f64::from(1 << 24)
                })
                .sum::<f64>()
                - 6.0
        };
        let values = clean.values.iter().map(|value| value + 0.3 * noise()).collect();
        let photo = ScalarImage::new(SIZE, SIZE, values);
        let found = register(&inner(&high(&photo)), &high(&image(scene)), Freedom::Similarity).unwrap();
        let (m, s) = (found.motion, found.sigma);
        for (error, sigma) in [
            (m.shift_px[0] - truth.0[0], s.shift_px[0]),
            (m.shift_px[1] - truth.0[1], s.shift_px[1]),
            (m.rotation_rad - truth.1, s.rotation_rad),
            (m.scale - truth.2, s.scale),
        ] {
            sum += (error / sigma).powi(2);
            count += 1.0;
        }
    }
    let rms = f64::sqrt(sum / count);
    assert!((0.6..1.5).contains(&rms), "{rms}");
}

/// Blur is no motion: the correlation falls, the motion stays.
#[test]
fn blur_lowers_the_likeness_and_moves_nothing() {
    let photo = photographed([1.2, 0.7], 0.0, 0.0);
    let alike =
        |photo: &ScalarImage| register(&inner(&high(photo)), &high(&image(scene)), Freedom::Similarity).unwrap();
    let (sharp, blurred) = (alike(&photo), alike(&photo.blurred(4.0)));
    assert!(blurred.correlation < sharp.correlation - 0.005, "{} {}", blurred.correlation, sharp.correlation);
    let moved = DVec2::from(blurred.motion.shift_px) - DVec2::new(1.2, 0.7);
    assert!(moved.length() < 0.1, "{moved}");
}

#[test]
fn what_shows_nothing_is_not_registered() {
    let flat = image(|_| 5.0);
    assert!(matches!(register(&flat, &image(scene), Freedom::Shift), Err(Error::Featureless { .. })));
    let empty = image(|_| f64::NAN);
    assert!(matches!(register(&empty, &image(scene), Freedom::Shift), Err(Error::NothingShared { .. })));
}
