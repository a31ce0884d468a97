//! Lighting factors of horizon maps: the pass against the reference, and both against the skyline's own line.

use perilune_engine::horizon::{Encoding, HorizonMap};
use perilune_engine::render::{Renderer, Samples, Scene, View};
use perilune_engine::shadow::horizon_maps::{At, HorizonMaps, Visibility};
use perilune_engine::shadow::registry;
use std::sync::Arc;

use super::render::compare;
use super::skylines::nested;

const VISIBILITIES: [Visibility; 5] = [
    Visibility::MiddleValue,
    Visibility::CircularSegment,
    Visibility::Boxes(3),
    Visibility::Boxes(7),
    Visibility::Line,
];

fn with(scene: &mut Scene, maps: &[Vec<HorizonMap>], visibility: Visibility, at: At) {
    *scene =
        scene.clone().with_shadows(Arc::new(HorizonMaps { maps: maps.to_vec(), visibility: Some(visibility), at }));
}

/// RMS difference of the Sun's share.
fn rms(a: &Samples, b: &Samples) -> f64 {
    let pairs = a.pixels.iter().zip(&b.pixels).map(|(a, b)| f64::from(a.sun_fraction - b.sun_fraction).powi(2));
    let squares: Vec<f64> = pairs.filter(|square| square.is_finite()).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn the_pass_finds_the_lighting_factors_of_the_reference() {
    let Some(gpu) = super::gpu() else { return };
    for encoding in [Encoding::Fm16, Encoding::F8, Encoding::Raw12] {
        let (mut scene, view, maps): (Scene, View, _) = nested(encoding);
        for visibility in VISIBILITIES {
            for at in [At::Pixels, At::Nodes] {
                with(&mut scene, &maps, visibility, at);
                let reference = Renderer::Reference.samples(&scene, &view).unwrap();
                let pass = Renderer::on(gpu).samples(&scene, &view).unwrap();
                let agreement = compare(&view, &reference, &pass);
                assert!(agreement.radiance >= 0.999, "{encoding} {visibility:?} {at:?}: {agreement:?}");
            }
        }
        // The comparison sees where shadows are missing.
        let shadowed = Renderer::Reference.samples(&scene, &view).unwrap();
        scene = scene.with_shadows(registry::no_shadows());
        assert!(compare(&view, &shadowed, &Renderer::on(gpu).samples(&scene, &view).unwrap()).radiance < 0.95);
    }
}

/// What a method adds to the same maps is small where the maps are the same, and grows where half of them is left out.
#[test]
fn more_boxes_come_nearer_to_many_and_fewer_coefficients_go_astray() {
    let (mut scene, view, maps) = nested(Encoding::F16);
    let mut share = |maps: &[Vec<HorizonMap>], visibility: Visibility, at: At| {
        with(&mut scene, maps, visibility, at);
        Renderer::Reference.samples(&scene, &view).unwrap()
    };
    let many = share(&maps, Visibility::Boxes(63), At::Pixels);
    let boxes = [3, 7, 15].map(|count| rms(&many, &share(&maps, Visibility::Boxes(count), At::Pixels)));
    assert!(boxes[0] > boxes[1] && boxes[1] > boxes[2] && boxes[2] < 1e-3, "{boxes:?}");
    let line = share(&maps, Visibility::Line, At::Pixels);
    assert!(rms(&many, &line) < 3e-3, "{}", rms(&many, &line));
    let nodes = share(&maps, Visibility::Boxes(63), At::Nodes);
    let cut: Vec<Vec<HorizonMap>> =
        maps.iter().map(|maps| maps.iter().map(|map| map.clone().with_coefficients(4).unwrap()).collect()).collect();
    let four = share(&cut, Visibility::Boxes(63), At::Pixels);
    println!(
        "line {:.1e}, boxes {boxes:?}, nodes {:.1e}, 4 {:.1e}",
        rms(&many, &line),
        rms(&many, &nodes),
        rms(&many, &four)
    );
    assert!(rms(&many, &nodes) > 1e-3 && rms(&many, &four) > 0.02);
}
