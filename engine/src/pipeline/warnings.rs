//! What a user should know of images that will be made all the same: no Sun, no ground, nothing in view, too much or too little
//! light. One line a kind, each with what can be done.

use super::facts::look::Look;
use super::facts::signal::Expected;
use super::models::{Extent, ModelFacts};
use crate::geometry::Geodetic;

/// What is odd about an exposure. Kinds are told in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    NoGround,
    NoTerrain,
    NoAlbedo,
    SunDown,
    Saturated,
    Black,
    NoValue,
}

impl Kind {
    /// As records have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::NoGround => "no_ground",
            Self::NoTerrain => "no_terrain",
            Self::NoAlbedo => "no_albedo",
            Self::SunDown => "sun_down",
            Self::Saturated => "saturated",
            Self::Black => "black",
            Self::NoValue => "no_value",
        }
    }
}

/// What is odd about one exposure.
#[derive(Debug, Clone, PartialEq)]
pub struct Warning {
    pub kind: Kind,
    pub text: String,
}

/// Below this share of the ground in view a model or a map is as good as missed.
const MISSED: f64 = 0.1;
/// From this share of saturated pixels on, and from this share of black ones and of those without a value.
const SATURATED: f64 = 0.2;
const NEARLY_ALL: f64 = 0.999;

/// Where what may be missed lies.
#[derive(Debug, Clone, Copy, Default)]
pub struct Places {
    /// Of all elevation models; `None`: there is no terrain.
    pub models: Option<Extent>,
    /// `None`: there is no albedo map.
    pub albedo: Option<Extent>,
}

/// What the geometry of an exposure says before it is rendered.
pub fn of_look(look: &Look, places: &Places) -> Vec<Warning> {
    let ground = look.on_ground();
    if ground == 0 {
        let text = format!(
            "the camera looks past the body, {} above the ground: no ray meets it; change pointing, trajectory or field of view",
            kilometres(look.height_m)
        );
        return vec![Warning { kind: Kind::NoGround, text }];
    }
    let share = |part: usize| part as f64 / ground as f64;
    let mut warnings = Vec::new();
    if let Some(extent) = places.models.filter(|_| share(look.on_models) < MISSED) {
        let text = format!(
            "the camera sees {} of the elevation models, which lie at {extent}; it looks at {}; change trajectory, pointing or \
             terrain",
            part(share(look.on_models)),
            degrees(look.target)
        );
        warnings.push(Warning { kind: Kind::NoTerrain, text });
    }
    if let Some((extent, covered)) = places.albedo.zip(look.on_albedo).filter(|(_, covered)| share(*covered) < MISSED) {
        let text = format!(
            "the albedo map covers {} of the ground in view and lies at {extent}; the camera looks at {}; pixels without an \
             albedo have no value",
            part(share(covered)),
            degrees(look.target)
        );
        warnings.push(Warning { kind: Kind::NoAlbedo, text });
    }
    if look.sun_up == 0 {
        let text = format!(
            "the Sun is below the horizon of all ground in view: azimuth {:.1} deg, elevation {:.2} deg at {}; change exposures \
             or set sun.fixed",
            look.sun.azimuth_rad.to_degrees(),
            look.sun.elevation_rad.to_degrees(),
            degrees(look.target)
        );
        warnings.push(Warning { kind: Kind::SunDown, text });
    }
    warnings
}

/// What the light to be expected says before an exposure is rendered.
pub fn of_expected(expected: &Expected, sun_up: bool) -> Vec<Warning> {
    let saturated = expected.share_saturated();
    if saturated >= SATURATED {
        return vec![saturation(saturated, expected.exposure_s, Some(expected.fullest()))];
    }
    if sun_up && expected.is_black() {
        return vec![blackness(1.0, Some(expected.exposure_s))];
    }
    Vec::new()
}

/// Shares of an image's pixels.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shares {
    /// `None`: there is no detector.
    pub saturated: Option<f64>,
    pub black: f64,
    pub without_value: f64,
}

/// What a rendered image says.
pub fn of_image(shares: &Shares, exposure_s: f64) -> Vec<Warning> {
    let mut warnings = Vec::new();
    if let Some(saturated) = shares.saturated.filter(|share| *share >= SATURATED) {
        warnings.push(saturation(saturated, exposure_s, None));
    }
    if shares.black >= NEARLY_ALL {
        warnings.push(blackness(shares.black, shares.saturated.map(|_| exposure_s)));
    }
    if shares.without_value >= NEARLY_ALL {
        let text = "no pixel has a value: the ground in view has no heights, or no albedo".into();
        warnings.push(Warning { kind: Kind::NoValue, text });
    }
    warnings
}

fn saturation(share: f64, exposure_s: f64, fullest: Option<f64>) -> Warning {
    let shorter = fullest
        .filter(|fullest| *fullest > 0.0)
        .map_or(String::new(), |fullest| format!(", to about {:.2} ms,", 1e3 * 0.8 * exposure_s / fullest));
    let text = format!(
        "{} of the pixels are saturated after {}; shorten camera.exposure_s{shorter} or use camera.auto_exposure",
        percent(share),
        milliseconds(exposure_s)
    );
    Warning { kind: Kind::Saturated, text }
}

fn blackness(share: f64, exposure_s: Option<f64>) -> Warning {
    let text = match exposure_s {
        Some(exposure_s) => format!(
            "{} of the pixels hold less than a digital number after {}; lengthen camera.exposure_s, or see where the Sun stands",
            percent(share),
            milliseconds(exposure_s)
        ),
        None => {
            format!("{} of the pixels are black; see where the Sun stands and where the camera looks", percent(share))
        }
    };
    Warning { kind: Kind::Black, text }
}

/// Relief of less than this over kilometres is a flat plate, and slopes of more than this over the whole model a wall.
const FLAT_M: f64 = 1.0;
const WALL: f64 = 1.5;

/// Heights whose unit is hardly the metre.
pub fn of_model(model: &ModelFacts) -> Option<String> {
    let [low, high] = model.heights_m?;
    let extent_m = model.posting_m * model.columns.min(model.rows) as f64;
    let (relief_m, name) = (high - low, &model.name);
    if relief_m > 0.0 && relief_m < FLAT_M && extent_m > 1000.0 {
        return Some(format!(
            "{name}: heights from {low:.4} to {high:.4} m, a relief of {relief_m:.3} m over {}: are they kilometres?",
            kilometres(extent_m)
        ));
    }
    (relief_m > WALL * extent_m && relief_m > 100.0).then(|| {
        format!(
            "{name}: heights from {low:.0} to {high:.0} m over {}: are they another unit than metres, or fill values?",
            kilometres(extent_m)
        )
    })
}

/// More memory than there is.
pub fn of_memory(needed_bytes: f64, available_bytes: Option<f64>) -> Option<String> {
    let available_bytes = available_bytes.filter(|available| *available < needed_bytes)?;
    Some(format!(
        "a run takes about {:.1} GB of memory, {:.1} GB are available; ask for fewer pixels, planes or nodes",
        needed_bytes / 1e9,
        available_bytes / 1e9
    ))
}

/// A line for each kind of what is odd about some exposures of those that were `looked` at, told by their index.
pub fn summed(odd: &[(usize, Vec<Warning>)], looked: usize) -> Vec<String> {
    let mut kinds: Vec<Kind> = odd.iter().flat_map(|(_, warnings)| warnings).map(|warning| warning.kind).collect();
    kinds.sort();
    kinds.dedup();
    let line = |kind: &Kind| {
        let of_kind = |warnings: &[Warning]| warnings.iter().find(|warning| warning.kind == *kind).cloned();
        let found: Vec<(usize, Warning)> =
            odd.iter().filter_map(|(index, warnings)| Some((*index, of_kind(warnings)?))).collect();
        let indices: Vec<usize> = found.iter().map(|(index, _)| *index).collect();
        let text = found.first().map_or("", |(_, warning)| &warning.text);
        let whose = match indices.len() {
            count if count == looked && looked > 1 => format!("in all {looked} exposures"),
            1 => format!("in exposure {}", ranges(&indices)),
            count => format!("in {count} of {looked} exposures ({})", ranges(&indices)),
        };
        match indices.len() {
            1 => format!("{whose} {text}"),
            _ => format!("{whose} {text} (exposure {})", indices[0]),
        }
    };
    kinds.iter().map(line).collect()
}

/// `0, 4 to 7, 9`; the first few.
fn ranges(indices: &[usize]) -> String {
    /// More are not read.
    const SHOWN: usize = 6;
    let mut spans: Vec<[usize; 2]> = Vec::new();
    for &index in indices {
        match spans.last_mut() {
            Some(span) if span[1] + 1 == index => span[1] = index,
            _ => spans.push([index; 2]),
        }
    }
    let shown = spans.iter().take(SHOWN).map(|[from, until]| match until - from {
        0 => from.to_string(),
        1 => format!("{from}, {until}"),
        _ => format!("{from} to {until}"),
    });
    let more = if spans.len() > SHOWN { ", …" } else { "" };
    shown.collect::<Vec<_>>().join(", ") + more
}

fn milliseconds(seconds: f64) -> String {
    let number = 1e3 * seconds;
    match number < 0.01 {
        true => format!("{number:.1e} ms"),
        false => format!("{} ms", format!("{number:.3}").trim_end_matches('0').trim_end_matches('.')),
    }
}

/// How much of something is there.
fn part(share: f64) -> String {
    if share == 0.0 { "nothing".into() } else { percent(share) }
}

pub fn percent(share: f64) -> String {
    match 100.0 * share {
        small if small > 0.0 && small < 1.0 => format!("{small:.1} %"),
        nearly if nearly > 99.0 && nearly < 100.0 => format!("{nearly:.1} %"),
        percent => format!("{percent:.0} %"),
    }
}

pub fn degrees(place: Geodetic) -> String {
    let longitude_deg = place.longitude_east_rad.to_degrees().rem_euclid(360.0);
    format!("latitude {:.3}, longitude {longitude_deg:.3} east", place.latitude_rad.to_degrees())
}

pub fn kilometres(metres: f64) -> String {
    match metres.abs() {
        near if near < 10.0 => format!("{metres:.2} m"),
        near if near < 10_000.0 => format!("{metres:.0} m"),
        near if near < 1e6 => format!("{:.1} km", metres / 1e3),
        _ => format!("{:.0} km", metres / 1e3),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(kind: Kind) -> Vec<Warning> {
        vec![Warning { kind, text: "it is dark".into() }]
    }

    #[test]
    fn a_kind_is_one_line_whatever_the_number_of_exposures() {
        let odd: Vec<_> = [0, 4, 5, 6, 9].map(|index| (index, of(Kind::Black))).into();
        assert_eq!(summed(&odd, 24), ["in 5 of 24 exposures (0, 4 to 6, 9) it is dark (exposure 0)"]);
        assert_eq!(summed(&odd[1..2], 24), ["in exposure 4 it is dark"]);
        assert_eq!(summed(&odd, 5), ["in all 5 exposures it is dark (exposure 0)"]);
        let two = [(1, of(Kind::Saturated)), (1, of(Kind::NoGround))];
        assert!(summed(&two, 2)[0].contains("exposure 1") && summed(&two, 2).len() == 2);
        assert!(summed(&[], 3).is_empty());
    }

    #[test]
    fn an_image_is_odd_from_shares_on_that_leave_little_to_see() {
        let fine = Shares { saturated: Some(0.1), black: 0.6, without_value: 0.5 };
        assert_eq!(of_image(&fine, 0.01), []);
        let full = of_image(&Shares { saturated: Some(0.97), ..fine }, 0.01);
        assert!(
            full.len() == 1 && full[0].text.starts_with("97 % of the pixels are saturated after 10 ms"),
            "{full:?}"
        );
        assert_eq!(of_image(&Shares { black: 1.0, ..fine }, 0.01)[0].kind, Kind::Black);
        assert_eq!(of_image(&Shares { without_value: 1.0, ..fine }, 0.01)[0].kind, Kind::NoValue);
    }
}
