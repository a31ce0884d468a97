//! Jung et al. (2020), figure 6: how the light rises across a shadow's edge.
//!
//! The share of the disc above a straight edge against one that grows evenly with the distance, as where the disc is taken
//! for a box. The paper shows a profile of an LROC WAC image, and prints no numbers: disc occlusion tracks it, the box
//! underestimates the lit side. The photograph is not at hand; a limb-darkened disc stands for it.
//!
//! # References
//! Jung, Schrempf & Son (2020), Optimally fast soft shadows on curved terrain with dynamic programming and maximum
//! mipmaps; Hestroffer & Magnan (1998), A&A 333, 338.

use crate::{Error, Table, Value};
use perilune_engine::photometry::{LimbDarkening, SolarDisk};
use perilune_engine::report::plot::{Axis, Curve, Plot};
use perilune_engine::statistics::Errors;

/// Of the WAC's band that Sato et al. (2014) take.
const WAVELENGTH_NM: f64 = 643.0;
const STEPS: usize = 400;

/// The profile and its errors.
pub fn figure_6() -> Result<(Table, Plot), Error> {
    let darkened = SolarDisk::new(LimbDarkening::hestroffer_magnan(WAVELENGTH_NM)?)?;
    let uniform = SolarDisk::new(LimbDarkening::Uniform)?;
    let heights: Vec<f64> = (0..=STEPS).map(|i| 2.4 * i as f64 / STEPS as f64 - 1.2).collect();
    let truth: Vec<f64> = heights.iter().map(|height| darkened.visible_above(*height)).collect();
    let profiles: [(&str, Vec<f64>); 2] = [
        ("disc occlusion, uniform", heights.iter().map(|height| uniform.visible_above(*height)).collect()),
        ("box", heights.iter().map(|height| (0.5 - 0.5 * height).clamp(0.0, 1.0)).collect()),
    ];
    let mut table = Table::new(
        "jung_6",
        "Jung 2020, figure 6: light across a shadow's edge against the limb-darkened disc at 643 nm",
        &[
            ("profile", ""),
            ("mean", "of full Sun"),
            ("RMS", "of full Sun"),
            ("max", "of full Sun"),
            ("ratio to the box", ""),
        ],
    );
    let errors = profiles.each_ref().map(|(_, profile)| Errors::of(profile.iter().zip(&truth).map(|(a, b)| a - b)));
    let mut curve = vec![("limb-darkened disc", &truth)];
    for ((name, profile), found) in profiles.iter().zip(&errors) {
        let mut row = vec![(*name).into()];
        row.extend([found.mean, found.rms, found.max, found.rms / errors[1].rms].map(Value::from));
        table.rows.push(row);
        curve.push((name, profile));
    }
    let curves = curve.into_iter().map(|(name, shares)| Curve {
        name: name.into(),
        points: heights.iter().zip(shares).map(|(height, share)| [-height, *share]).collect(),
        joined: true,
    });
    Ok((
        table,
        Plot {
            title: "Jung 2020, figure 6: across a shadow's edge".into(),
            x: Axis::linear("Sun's centre above the edge [radii]"),
            y: Axis::linear("light [full Sun]"),
            curves: curves.collect(),
        },
    ))
}
