//! View rays from a coarse mesh against rays that are cast exactly from the camera.

use perilune_engine::render::{Renderer, Samples, ViewRays};

use super::render::{compare, scenes};

/// With 16 cells and 8 steps most rays end their steps above the ground and are cast exactly from there.
const HYBRIDS: [ViewRays; 2] =
    [ViewRays::Hybrid { mesh_cells: 8, steps: 32 }, ViewRays::Hybrid { mesh_cells: 16, steps: 8 }];

fn ranges(samples: &Samples) -> Vec<Option<f64>> {
    samples.centres.iter().map(|centre| centre.map(|hit| hit.distance_m)).collect()
}

/// What a step may jump over are crests thinner than a cell; the bounds are those of the pass against the reference.
#[test]
fn rays_from_the_mesh_meet_what_exact_rays_meet() {
    let Some(gpu) = super::gpu() else { return };
    for (name, mut scene, view) in scenes() {
        let exact = Renderer::on(gpu).samples(&scene, &view).unwrap();
        for hybrid in HYBRIDS {
            scene = scene.with_view_rays(hybrid);
            let stepped = Renderer::on(gpu).samples(&scene, &view).unwrap();
            let agreement = compare(&view, &exact, &stepped);
            println!("{name}, {hybrid:?}: {agreement:?}");
            assert!(agreement.radiance >= 0.999, "{name}: {agreement:?}");
            assert!(agreement.ground >= 0.998, "{name}: {agreement:?}");
            assert!(agreement.range < 1e-5, "{name}: {agreement:?}");
            if name == "nested, nadir" {
                assert_ne!(ranges(&exact), ranges(&stepped), "the last digits tell that rays were stepped");
            }
        }
    }
}
