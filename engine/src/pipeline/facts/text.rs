//! Facts as lines of text.

use super::{CostFacts, Facts, ShadowFacts, SignalFacts, SunFacts, ViewFacts};
use crate::pipeline::models::ModelFacts;
use crate::pipeline::warnings::{kilometres, percent};

/// Width of the first column.
const KEY: usize = 26;

impl Facts {
    /// For people, in parts with a heading each.
    pub fn text(&self) -> String {
        let parts = [
            ("elevation models, the finest first", self.models.iter().map(model).collect()),
            ("camera", view(&self.view)),
            ("Sun", sun(&self.sun)),
            ("light (estimate: reflectance law on the facets in view, cast shadows left out)", signal(&self.signal)),
            ("shadows", shadows(&self.shadows)),
            ("cost (estimate)", cost(&self.cost)),
        ];
        let shown = parts.into_iter().filter(|(_, lines)| !lines.is_empty());
        shown.map(|(heading, lines): (_, Vec<String>)| format!("{heading}\n{}", lines.concat())).collect()
    }
}

fn line(key: &str, value: impl std::fmt::Display) -> String {
    let gap = if key.chars().count() >= KEY { "  " } else { "" };
    format!("  {key:KEY$}{gap}{value}\n")
}

fn model(model: &ModelFacts) -> String {
    let ModelFacts { name, crs, posting_m, columns, rows, extent, heights_m, share_without_heights } = model;
    let [width, height] = [*columns, *rows].map(|count| kilometres(count as f64 * posting_m));
    let mut text =
        line(name, format_args!("{columns} × {rows} at {}, {width} × {height}, {crs}", kilometres(*posting_m)));
    if let Some(extent) = extent {
        text += &line("", extent);
    }
    text += &match heights_m {
        Some([low, high]) => line("", format_args!("heights {low:.1} to {high:.1} m")),
        None => line("", "heights not made or not looked through yet"),
    };
    if *share_without_heights > 0.0 {
        text += &line("", format_args!("{} without heights", percent(*share_without_heights)));
    }
    text
}

fn view(view: &ViewFacts) -> Vec<String> {
    let mut lines = vec![
        line("exposures looked at", format_args!("{}, {} rays each", view.exposures_looked_at, view.rays_each)),
        line("height above the ground", range(view.height_above_ground_m, kilometres)),
    ];
    if let Some(pixel_m) = view.pixel_m {
        lines.push(line("a pixel on the ground", range(pixel_m, fine)));
    }
    let few = |advised: &u32| *advised > view.rays_a_pixel;
    if let (Some(advised), Some([_, pixel_m]), Some(posting_m)) =
        (view.rays_advised().filter(few), view.pixel_m, view.finest_posting_m)
    {
        let (rays, postings) = (view.rays_a_pixel, significant(pixel_m / posting_m));
        lines.push(line(
            "rays a pixel",
            format_args!(
                "{rays} over {postings} postings; (postings)²/4 = {advised} leave little aliasing (RMS at a low Sun with 4: 1.5 % \
                 over 3 postings, 6.3 % over 12)"
            ),
        ));
    }
    if let Some(shares) = view.share_on_models {
        lines.push(line("ground on the models", range(shares, percent)));
    }
    if view.share_on_body != [1.0; 2] {
        lines.push(line("image on the body", range(view.share_on_body, percent)));
    }
    if let Some(target) = view.target {
        lines.push(line("looks at", target));
    }
    lines
}

fn sun(sun: &SunFacts) -> Vec<String> {
    let degrees = |angle_deg: f64| format!("{angle_deg:.2}°");
    /// Farther apart there is no way that is the short one.
    const ALL_ROUND_DEG: f64 = 300.0;
    let [from, until] = sun.azimuth_deg;
    let azimuth = match until - from {
        wide if wide > ALL_ROUND_DEG => "all around".into(),
        _ => range([from, until].map(|angle_deg| ((100.0 * angle_deg).round() / 100.0).rem_euclid(360.0)), degrees),
    };
    vec![line("azimuth at the target", azimuth), line("elevation at the target", range(sun.elevation_deg, degrees))]
}

fn signal(signal: &SignalFacts) -> Vec<String> {
    let Some(radiance) = signal.radiance_w_m2_sr else { return vec![line("radiance", "no lit ground in view")] };
    let mut lines = vec![line("radiance", range(radiance, |value| format!("{} W/m²/sr", significant(value))))];
    let Some(detector) = &signal.detector else { return lines };
    let milliseconds = |seconds: f64| format!("{} ms", significant(1e3 * seconds));
    lines.push(line("exposure", range(detector.exposure_s, milliseconds)));
    let Some([darkest, brightest]) = detector.electrons else { return lines };
    let electrons = |count: f64| format!("{} electrons", significant(count));
    let filled = percent(brightest / detector.full_well_e);
    lines.push(line(
        "dim lit ground (5 %)",
        format_args!("{}, {} of the full well", electrons(darkest), percent(darkest / detector.full_well_e)),
    ));
    lines.push(line(
        "brightest ground",
        format_args!("{}, {filled} of the full well of {}", electrons(brightest), electrons(detector.full_well_e)),
    ));
    lines.push(line(
        "saturated, at most",
        format_args!(
            "{} of the ground in view, from {} on",
            percent(detector.share_saturated),
            electrons(detector.capacity_e)
        ),
    ));
    lines
}

fn shadows(shadows: &ShadowFacts) -> Vec<String> {
    let ShadowFacts { method, why, renderer, adapter_cannot } = shadows;
    let mut lines = vec![line("method", method)];
    lines.extend(why.as_ref().map(|why| line("chosen", why.trim_start_matches("shadows: "))));
    lines.push(line("rendered by", renderer));
    lines.extend(adapter_cannot.as_ref().map(|reason| line("for", reason)));
    lines
}

fn cost(cost: &CostFacts) -> Vec<String> {
    let CostFacts { images, columns, rows, channels, threads, .. } = cost;
    let counted = if *images == 1 { "1 image".into() } else { format!("{images} images") };
    let mut lines = vec![
        line("images", format_args!("{counted} of {columns} × {rows} pixels, {channels} channels")),
        line("disk", format_args!("up to {}; compressed planes take about half", bytes(cost.disk_bytes))),
    ];
    let available = cost.memory_available_bytes.map_or(String::new(), |left| format!(" of {} available", bytes(left)));
    lines.push(line("memory", format_args!("about {}{available}", bytes(cost.memory_bytes))));
    let part = |what: &str, seconds: Option<f64>| seconds.map(|seconds| format!("{what} {}", duration(seconds)));
    let parts: Vec<String> =
        [part("horizons", cost.horizons_s), part("images", cost.images_s)].into_iter().flatten().collect();
    if !parts.is_empty() {
        lines.push(line("time", format_args!("{} on {threads} threads", parts.join(", "))));
    }
    lines
}

/// One value where both are shown alike.
fn range(values: [f64; 2], shown: impl Fn(f64) -> String) -> String {
    let [low, high] = values.map(shown);
    if low == high { low } else { format!("{low} to {high}") }
}

fn fine(metres: f64) -> String {
    if metres < 1000.0 { format!("{} m", significant(metres)) } else { kilometres(metres) }
}

/// Three digits.
fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let digits = 2 - value.abs().log10().floor() as i32;
    match digits {
        ..-4 => format!("{value:.2e}"),
        -4..=0 => format!("{value:.0}"),
        1..=6 => format!("{value:.*}", digits as usize),
        _ => format!("{value:.2e}"),
    }
}

fn bytes(bytes: f64) -> String {
    if bytes < 1e9 { format!("{:.0} MB", (bytes / 1e6).ceil()) } else { format!("{:.1} GB", bytes / 1e9) }
}

fn duration(seconds: f64) -> String {
    match seconds {
        short if short < 1.0 => "a second".into(),
        short if short < 90.0 => format!("{short:.0} s"),
        long if long < 5400.0 => format!("{:.0} min", long / 60.0),
        long => format!("{:.1} h", long / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!([0.1234, 12.34, 1234.0, 0.0, 1e-9].map(significant), ["0.123", "12.3", "1234", "0", "1.00e-9"]);
        assert_eq!(range([1.0, 1.0], fine), "1.00 m");
        assert_eq!([0.2, 61.0, 600.0, 9000.0].map(duration), ["a second", "61 s", "10 min", "2.5 h"]);
    }
}
