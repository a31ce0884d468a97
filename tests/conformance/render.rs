//! The compute pass against the reference renderer, image by image.

use glam::{DVec2, DVec3};
pub use perilune_bench::stability::scenes::cube;
use perilune_bench::stability::scenes::{level, waves};
use perilune_engine::camera::{Camera as Optics, Pose};
use perilune_engine::geometry::{Body, Geodetic, Position, Rotation};
use perilune_engine::photometry::{DiscFunction, Reflectance};
use perilune_engine::render::{Light, Quantity, Renderer, Samples, Scene, View};
use perilune_engine::terrain::{Face, Gnomonic, Ground, Surface, Terrain};

fn nested() -> Terrain {
    let map = Gnomonic::about(&Body::moon(), Geodetic::from_degrees(-88.0, 25.0, 0.0));
    let heights = waves(2300.0, 110.0);
    let coarse = level(&map, 160.0, 120, 0, &heights);
    let mut fine = level(&map, 40.0, 100, 0, &heights);
    for index in 0..fine.heights_m.len() {
        let (column, row) = (index % fine.columns, index / fine.columns);
        if [0, 200].contains(&column) || [0, 200].contains(&row) {
            fine.heights_m[index] = coarse.bilinear_m(coarse.grid_from_map(fine.node_m(column, row))).unwrap() as f32;
        }
    }
    // A hole in the near field.
    for (column, row) in [(60, 70), (61, 70), (61, 71)] {
        let index = fine.index(column, row);
        fine.gap[index] = true;
    }
    Terrain { body: Body::moon(), faces: vec![Face { map, levels: vec![fine, coarse] }] }
}

fn scene(terrain: Terrain) -> Scene {
    Scene::new(Surface::new(terrain))
}

/// The view through a camera of that field of view.
fn wide(view: View, field_of_view_deg: f64) -> View {
    let (columns, rows) = (160, 120);
    let focal_px = f64::from(columns) / 2.0 / (field_of_view_deg.to_radians() / 2.0).tan();
    view.with_optics(Optics::pinhole(columns, rows, DVec2::splat(focal_px)).unwrap())
}

/// A camera at a point that looks at another, with the Sun at an elevation over the first's horizon.
fn view(body: &Body, from: Geodetic, at: Geodetic, sun_elevation_deg: f64) -> View {
    let position = body.position_from_geodetic(from);
    let boresight = position.direction_to(body.position_from_geodetic(at)).unwrap().unit();
    let right = boresight.cross(body.up(from).unit() + 1e-3 * DVec3::new(0.3, 0.5, 0.1)).normalize();
    let local = body.local_from_body(at).inverse();
    let (sin, cos) = sun_elevation_deg.to_radians().sin_cos();
    let sun = local.turn(DVec3::new(0.6 * cos, 0.8 * cos, sin));
    let camera_from_body = Rotation::from_axes(right, boresight.cross(right), boresight);
    let sun =
        Light { position: Position::from_m(1.496e11 * sun), angular_radius_rad: 0.00465, irradiance_w_m2: 1361.0 };
    View::new(Pose { position, camera_from_body }, Optics::pinhole(1, 1, DVec2::ONE).unwrap(), vec![sun])
        .with_reflectance(Reflectance::empirical(0.12, DiscFunction::LunarLambert))
        .with_samples_per_side(2)
        .with_quantities([Quantity::Radiance, Quantity::Range])
}

pub fn scenes() -> Vec<(&'static str, Scene, View)> {
    let moon = Body::moon();
    let at = |lat, lon, h| Geodetic::from_degrees(lat, lon, h);
    let bare = || Terrain { body: Body::moon(), faces: vec![] };
    let mars = Body::mars();
    let oblate = Terrain { body: mars.clone(), faces: vec![] };
    vec![
        (
            "nested, oblique",
            scene(nested()),
            wide(view(&moon, at(-87.8, 24.0, 4000.0), at(-88.0, 25.0, 0.0), 3.0), 50.0),
        ),
        ("nested, low", scene(nested()), wide(view(&moon, at(-88.0, 25.5, 300.0), at(-88.02, 24.0, 200.0), 1.5), 60.0)),
        ("nested, nadir", scene(nested()), wide(view(&moon, at(-88.0, 25.0, 2500.0), at(-88.0, 25.0, 0.0), 2.0), 40.0)),
        ("cube from 100 km", scene(cube(150)), wide(view(&moon, at(10.0, 60.0, 1e5), at(18.0, 66.0, 0.0), 15.0), 70.0)),
        (
            "cube from 5000 km",
            scene(cube(150)),
            wide(view(&moon, at(40.0, -20.0, 5e6), at(41.0, -21.0, 0.0), 40.0), 35.0),
        ),
        (
            "sphere from 5000 km",
            scene(bare()),
            wide(view(&moon, at(40.0, -20.0, 5e6), at(41.0, -21.0, 0.0), 40.0), 35.0),
        ),
        ("spheroid", scene(oblate), wide(view(&mars, at(40.0, -20.0, 3e6), at(41.0, -21.0, 0.0), 10.0), 60.0)),
    ]
}

/// How two renderings of a scene agree.
#[derive(Debug)]
pub struct Agreement {
    /// Share of pixels away from depth edges within 1e-3 relative radiance.
    pub radiance: f64,
    /// Share of centres that meet the same kind of ground.
    pub ground: f64,
    /// 99th percentile of the range's relative difference.
    pub range: f64,
}

pub fn compare(view: &View, a: &Samples, b: &Samples) -> Agreement {
    let smooth: Vec<usize> = (0..a.pixels.len()).filter(|&pixel| !at_depth_edge(view, a, pixel)).collect();
    let same = |&&pixel: &&usize| {
        let (p, q) = (a.pixels[pixel].radiance_w_m2_sr, b.pixels[pixel].radiance_w_m2_sr);
        // Below a ten-thousandth of sunlit ground's radiance a relative bound means nothing.
        p.is_nan() && q.is_nan() || (p - q).abs() <= 1e-3 * p.abs().max(q.abs()) + 1e-4
    };
    let kind = |samples: &Samples, pixel: usize| {
        samples.centres[pixel].map(|hit| match hit.ground {
            Ground::Dem { level, .. } => level,
            Ground::Gap => 100,
            Ground::Bare => 101,
        })
    };
    let mut ranges: Vec<f64> = (0..a.centres.len())
        .filter_map(|pixel| Some((a.centres[pixel]?.distance_m, b.centres[pixel]?.distance_m)))
        .map(|(p, q)| (p / q - 1.0).abs())
        .collect();
    ranges.sort_by(f64::total_cmp);
    Agreement {
        radiance: smooth.iter().filter(same).count() as f64 / smooth.len() as f64,
        ground: (0..a.centres.len()).filter(|&p| kind(a, p) == kind(b, p)).count() as f64 / a.centres.len() as f64,
        range: ranges.get(ranges.len() * 99 / 100).copied().unwrap_or(0.0),
    }
}

/// True where a neighbour's range differs by more than 2 % or one of the two sees the sky or a gap.
fn at_depth_edge(view: &View, samples: &Samples, pixel: usize) -> bool {
    let (columns, rows) = (view.optics.columns as usize, view.optics.rows as usize);
    let (column, row) = (pixel % columns, pixel / columns);
    let range =
        |c: usize, r: usize| samples.centres[r * columns + c].map(|hit| (hit.distance_m, hit.ground == Ground::Gap));
    let here = range(column, row);
    let neighbours = (row.saturating_sub(1)..=(row + 1).min(rows - 1))
        .flat_map(|r| (column.saturating_sub(1)..=(column + 1).min(columns - 1)).map(move |c| (c, r)));
    neighbours.into_iter().any(|(c, r)| match (here, range(c, r)) {
        (Some((p, a)), Some((q, b))) => (p / q - 1.0).abs() > 0.02 || a != b,
        (None, None) => false,
        _ => true,
    })
}

#[test]
fn the_pass_renders_what_the_reference_renders() {
    let Some(gpu) = super::gpu() else { return };
    for (name, scene, view) in scenes() {
        let reference = Renderer::Reference.samples(&scene, &view).unwrap();
        let passes = Renderer::on(gpu).samples(&scene, &view).unwrap();
        let agreement = compare(&view, &reference, &passes);
        println!("{name}: {agreement:?}");
        assert!(agreement.radiance >= 0.999, "{name}: {agreement:?}");
        assert!(agreement.ground >= 0.998, "{name}: {agreement:?}");
        assert!(agreement.range < 1e-4, "{name}: {agreement:?}");
    }
}

#[test]
fn the_comparison_rejects_a_sun_a_hundredth_of_a_degree_off() {
    let (_, scene, view) = scenes().swap_remove(0);
    let mut moved = view.clone();
    let sun = &mut moved.lights[0];
    sun.position = Position::from_m(sun.position.vector_m() + 1.496e11 * DVec3::new(0.0, 0.0, 1.75e-4));
    let (a, b) =
        (Renderer::Reference.samples(&scene, &view).unwrap(), Renderer::Reference.samples(&scene, &moved).unwrap());
    assert!(compare(&view, &a, &b).radiance < 0.999);
}
