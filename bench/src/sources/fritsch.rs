//! Fritsch et al. (2025): hard shadows of five scenes (figures 11 to 13), soft ones (figure 14), bytes (table 1).
//!
//! Hard shadows have the Sun's centre at 6° in 180 azimuths, soft ones a disc of 20° radius at 35°. The truth of both are
//! horizons of 360 azimuths without compression, and of the soft ones twenty boxes, as in the paper; beside it the disc
//! itself, in rays of equal solid angle on the sphere.
//!
//! # References
//! Fritsch et al. (2025), *Fast Planetary Shadows using Fourier-Compressed Horizon Maps*, doi:10.2312/hpg.20251171.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::Options;
use crate::horizons::encodings::{AZIMUTHS, Patch, SUNS, decoded};
use crate::scenes::Scene;
use crate::{Error, Table, Value};
use perilune_engine::horizon::settings::direction;
use perilune_engine::horizon::{Encoding, Horizon, Settings};
use perilune_engine::image_metrics::{ScalarImage, flip, ssim};
use perilune_engine::photometry::{LimbDarkening, SolarDisk};
use perilune_engine::pipeline::Progress;
use perilune_engine::report::plot::{Axis, Curve, Plot};
use perilune_engine::shadow::horizon_maps::Visibility;
use perilune_engine::shadow::horizon_maps::visibility::DiscGeometry;
use perilune_engine::statistics::quantile;

/// What the figures compare, the baseline first.
const ENCODINGS: [Encoding; 8] = [
    Encoding::Raw12,
    Encoding::Fm4,
    Encoding::Fm8,
    Encoding::Fm12,
    Encoding::Fm16,
    Encoding::F8,
    Encoding::F12,
    Encoding::F16,
];

/// Elevation of the Sun over hard shadows.
const HARD_DEG: f64 = 6.0;
/// Elevation and radius of the Sun over soft shadows.
const SOFT_DEG: [f64; 2] = [35.0, 20.0];
/// Rays over a disc: the share is right to 0.5 %.
const RAYS: usize = 256;
/// A share that error bars show.
const BAR: f64 = 0.8;

/// Three terrains for the paper's three patches of MOLA, which are not at hand, and its two worst cases.
fn scenes(options: &Options) -> Result<Vec<Scene>, Error> {
    let (nodes, side) = if options.quick { (192, 64) } else { (512, 256) };
    let scenes = vec![
        Scene::synthetic(nodes, 1)?,
        Scene::fractal(nodes, 2)?,
        Scene::smooth(nodes, 3),
        Scene::blocks(nodes, 4),
        Scene::peaks(nodes, 5),
    ];
    Ok(scenes.into_iter().map(|scene| scene.cut(side)).collect())
}

/// Figures 11 to 14.
pub fn figures(options: &Options, progress: &dyn Progress) -> Result<(Vec<Table>, Vec<Plot>), Error> {
    let mut hard = Table::new(
        "fritsch_11_13",
        "Fritsch 2025, figures 11 and 13: hard shadows, Sun at 6°, means over 180 azimuths (no numbers printed; said there: \
         better than raw12 everywhere with 8 and 16 coefficients, 4 are too few)",
        &[
            ("scene", ""),
            ("horizons", ""),
            ("pixel error rate", "%"),
            ("80th percentile", "%"),
            ("ratio to raw12", ""),
            ("SSIM", ""),
            ("FLIP", ""),
        ],
    );
    let mut soft = Table::new(
        "fritsch_14",
        "Fritsch 2025, figure 14: soft shadows of fm16, Sun of 20° radius at 35° (no numbers printed; said there: cs, r2 and \
         r3 gain little over mv, more boxes gain)",
        &[
            ("scene", ""),
            ("visibility", ""),
            ("MSE against 20 boxes", ""),
            ("80th percentile", ""),
            ("ratio to middle value", ""),
            ("MSE against the disc", ""),
        ],
    );
    let mut plots = Vec::new();
    let scenes = scenes(options)?;
    let settings = Settings { azimuths: AZIMUTHS, ..Settings::default() };
    progress.begin("Fritsch, figures 11 to 14", scenes.len(), "scenes");
    for (done, scene) in scenes.iter().enumerate() {
        let patch = Patch::of(scene, &settings);
        let curves = hard_shadows(scene, &patch, &settings, options, &mut hard.rows);
        if done == 0 {
            plots.push(Plot {
                title: format!("Fritsch 2025, figure 12: {}", scene.name),
                x: Axis::linear("azimuth of the Sun [deg]"),
                y: Axis::linear("pixel error rate [%]"),
                curves,
            });
        }
        soft.rows.extend(soft_shadows(scene, &patch, options)?);
        progress.at(done + 1, scenes.len());
    }
    Ok((vec![hard, soft, bytes()], plots))
}

/// Table 1.
fn bytes() -> Table {
    let mut table = Table::new(
        "fritsch_1",
        "Fritsch 2025, table 1: a patch of 256²",
        &[("horizons", ""), ("ours", "MiB"), ("paper", "MB"), ("ratio to raw12", ""), ("paper's ratio", "")],
    );
    let printed =
        [(Encoding::Raw12, Some(1.5)), (Encoding::Fm16, Some(1.33)), (Encoding::F16, Some(4.0)), (Encoding::W21, None)];
    let mib = |bytes_per_pixel: f64| bytes_per_pixel * 65536.0 / 1048576.0;
    let raw_mib = mib(Encoding::Raw12.bytes_per_pixel());
    let row = |name: &str, ours: f64, paper: Option<f64>| {
        vec![name.into(), ours.into(), paper.into(), (ours / raw_mib).into(), paper.map(|paper| paper / 1.5).into()]
    };
    table.rows.push(row("360 samples, half floats", mib(720.0), Some(45.0)));
    table.rows.extend(printed.map(|(encoding, paper)| row(encoding.name(), mib(encoding.bytes_per_pixel()), paper)));
    table
}

/// Rows of all encodings, and the curves of figure 12.
fn hard_shadows(
    scene: &Scene,
    patch: &Patch,
    settings: &Settings,
    options: &Options,
    rows: &mut Vec<Vec<Value>>,
) -> Vec<Curve> {
    let sun_rad = HARD_DEG.to_radians();
    let truth = patch.suns();
    let image = |elevations_rad: &[f32]| {
        let lit = |elevation_rad: &f32| f64::from(u8::from(f64::from(*elevation_rad) < sun_rad));
        ScalarImage::new(patch.columns, patch.rows, elevations_rad.iter().map(lit).collect())
    };
    let (mut curves, mut baseline) = (Vec::new(), f64::NAN);
    for encoding in ENCODINGS {
        let tried = decoded(&patch.fitted(encoding, |elevation_rad| elevation_rad).map(), settings);
        let wrong = |sun: usize| {
            let lit = |elevation_rad: &f32| f64::from(*elevation_rad) < sun_rad;
            let pairs = truth[sun].iter().zip(&tried[sun]);
            let wrong = pairs.filter(|(truth, tried)| lit(truth) != lit(tried)).count();
            100.0 * wrong as f64 / patch.nodes() as f64
        };
        let rates: Vec<f64> = (0..SUNS).map(wrong).collect();
        let suns: Vec<usize> = (0..SUNS).step_by(if options.quick { 20 } else { 5 }).collect();
        let compared = suns.par_iter().map(|&sun| {
            let [truth, tried] = [image(&truth[sun]), image(&tried[sun])];
            DVec2::new(ssim::mean(&truth, &tried, 1.0), flip::mean(&truth, &tried))
        });
        let compared = compared.sum::<DVec2>() / suns.len() as f64;
        let mean = rates.iter().sum::<f64>() / SUNS as f64;
        if encoding == ENCODINGS[0] {
            baseline = mean;
        }
        let mut row = vec![scene.name.as_str().into(), encoding.name().into()];
        row.extend([mean, quantile(rates.clone(), BAR), mean / baseline, compared.x, compared.y].map(Value::from));
        rows.push(row);
        if [Encoding::Raw12, Encoding::Fm8, Encoding::Fm16].contains(&encoding) {
            let points = rates.iter().enumerate().map(|(sun, rate)| [360.0 * sun as f64 / SUNS as f64, *rate]);
            curves.push(Curve { name: encoding.name().into(), points: points.collect(), joined: true });
        }
    }
    curves
}

/// A way to soft shadows.
#[derive(Debug, Clone, Copy)]
enum Way {
    Of(Visibility),
    /// Equation 10 as it is printed: no clamp, equal weights, azimuths off by `x r`; `i` from 0.
    Printed(u32),
}

const WAYS: [(&str, Way); 9] = [
    ("middle value", Way::Of(Visibility::MiddleValue)),
    ("circular segment", Way::Of(Visibility::CircularSegment)),
    ("2 boxes", Way::Of(Visibility::Boxes(2))),
    ("3 boxes", Way::Of(Visibility::Boxes(3))),
    ("5 boxes", Way::Of(Visibility::Boxes(5))),
    ("7 boxes", Way::Of(Visibility::Boxes(7))),
    ("20 boxes", Way::Of(Visibility::Boxes(20))),
    ("line (ours)", Way::Of(Visibility::Line)),
    ("5 boxes as printed", Way::Printed(5)),
];

/// A row of every way.
fn soft_shadows(scene: &Scene, patch: &Patch, options: &Options) -> Result<Vec<Vec<Value>>, Error> {
    let disk = SolarDisk::new(LimbDarkening::Uniform)?;
    let [elevation_rad, angular_radius_rad] = SOFT_DEG.map(f64::to_radians);
    let geometry = DiscGeometry { elevation_rad, angular_radius_rad };
    let map = patch.fitted(Encoding::Fm16, |elevation_rad| elevation_rad).map();
    let (every_node, every_sun) = if options.quick { (23, 12) } else { (41, 2) };
    let nodes: Vec<usize> = (0..patch.nodes()).step_by(every_node).collect();
    let rays = rays(geometry);
    let suns: Vec<f64> = (0..SUNS).step_by(every_sun).map(|sun| TAU * sun as f64 / SUNS as f64).collect();
    // Squared errors against twenty boxes and the disc, by way, of one Sun.
    let of_sun = |&sun_rad: &f64| {
        let mut squares = [[0.0; 2]; WAYS.len()];
        for &node in &nodes {
            let whole = |azimuth_rad: f64| (sampled(patch, node, azimuth_rad), 0.0);
            let about = |sine: f64| sun_rad + sine.asin();
            let boxes = Visibility::Boxes(20).share(&disk, geometry, |sine| whole(about(sine)));
            let seen = rays.iter().filter(|ray| ray[1] > whole(sun_rad + ray[0]).0).count();
            let exact = seen as f64 / RAYS as f64;
            let grid = DVec2::new((node % patch.columns) as f64, (node / patch.columns) as f64);
            let series = map.horizon(grid);
            for (squares, (_, way)) in squares.iter_mut().zip(WAYS) {
                let share = match way {
                    Way::Of(visibility) => {
                        visibility.share(&disk, geometry, |sine| series.evaluate_towards(direction(about(sine))))
                    }
                    Way::Printed(boxes) => printed(boxes, geometry, &series, sun_rad),
                };
                squares[0] += (share - boxes).powi(2);
                squares[1] += (share - exact).powi(2);
            }
        }
        squares.map(|squares| squares.map(|square| square / nodes.len() as f64))
    };
    let by_sun: Vec<_> = suns.par_iter().map(of_sun).collect();
    let column = |way: usize, truth: usize| by_sun.iter().map(|of_sun| of_sun[way][truth]).collect::<Vec<_>>();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let middle = mean(&column(0, 0));
    let row = |(way, (name, _)): (usize, &(&str, Way))| {
        let [boxes, disc] = [column(way, 0), column(way, 1)];
        let mut row = vec![scene.name.as_str().into(), (*name).into()];
        row.extend([mean(&boxes), quantile(boxes.clone(), BAR), mean(&boxes) / middle, mean(&disc)].map(Value::from));
        row
    };
    Ok(WAYS.iter().enumerate().map(row).collect())
}

/// Equations 8 to 10 as they are printed.
fn printed(boxes: u32, geometry: DiscGeometry, horizon: &Horizon, sun_rad: f64) -> f64 {
    let DiscGeometry { elevation_rad, angular_radius_rad: r } = geometry;
    let occlusion = (0..boxes).map(|i| {
        let x = r / f64::from(boxes) * f64::from(2 * i + 1) - r;
        (horizon.evaluate_towards(direction(sun_rad + x)).0 - elevation_rad) / (2.0 * (r * r - x * x).sqrt())
    });
    1.0 - (occlusion.sum::<f64>() / f64::from(boxes) + 0.5)
}

/// The uncompressed skyline between two samples.
fn sampled(patch: &Patch, node: usize, azimuth_rad: f64) -> f64 {
    let place = (azimuth_rad / TAU).rem_euclid(1.0) * AZIMUTHS as f64;
    let at = |index: usize| f64::from(patch.planes[index % AZIMUTHS].elevations_rad[node]);
    let share = place.fract();
    (1.0 - share) * at(place as usize) + share * at(place as usize + 1)
}

/// Azimuths from the disc's centre and elevations of rays of equal solid angle.
fn rays(geometry: DiscGeometry) -> Vec<[f64; 2]> {
    let (sin_a, cos_a) = geometry.elevation_rad.sin_cos();
    let (up, level) = (DVec3::new(-sin_a, 0.0, cos_a), DVec3::new(cos_a, 0.0, sin_a));
    let golden_rad = PI * (3.0 - 5f64.sqrt());
    let ray = |i: usize| {
        let cosine = 1.0 - (i as f64 + 0.5) / RAYS as f64 * (1.0 - geometry.angular_radius_rad.cos());
        let (sin, cos) = (golden_rad * i as f64).sin_cos();
        let ray = cosine * level + (1.0 - cosine * cosine).sqrt() * (cos * up + sin * DVec3::Y);
        [ray.y.atan2(ray.x), ray.z.asin()]
    };
    (0..RAYS).map(ray).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A skyline at the elevation of the centre hides less than half of a large disc: parallels of latitude bend upwards
    /// at its sides, and rays near the zenith count once.
    #[test]
    fn rays_fill_the_disc_evenly() {
        let geometry = DiscGeometry { elevation_rad: 0.0, angular_radius_rad: 0.3 };
        let share =
            |lit: &dyn Fn(&[f64; 2]) -> bool| rays(geometry).iter().filter(|ray| lit(ray)).count() as f64 / RAYS as f64;
        assert!((share(&|ray| ray[1] > 0.0) - 0.5).abs() < 0.01);
        assert!((share(&|ray| ray[0] > 0.0) - 0.5).abs() < 0.01);
        // Above half the radius: 0.1955 of a flat disc.
        assert!((share(&|ray| ray[1] > 0.15) - 0.1955).abs() < 0.01);
        assert!(rays(geometry).iter().all(|ray| ray[0].abs() < 0.3001 && ray[1].abs() < 0.3001));
    }
}
