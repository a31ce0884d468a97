//! A skyline as SVG: elevation over azimuth, the decoded one in front of the traced one.

use std::fmt::Write as _;

use super::query::Row;

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 360.0;
/// Space for titles and numbers: left, top, right, bottom.
const MARGINS: [f64; 4] = [64.0, 40.0, 20.0, 48.0];
const DECODED: &str = "#c2410c";
const TRACED: &str = "#1d4ed8";
const BOUND: &str = "#fde8d8";

/// Elevations shown, with the distance of the lines between.
struct Scale {
    low: f64,
    high: f64,
    step: f64,
}

impl Scale {
    fn of(rows: &[Row], bound: f64) -> Self {
        let around = |decoded: f64| [decoded - bound, decoded + bound];
        let values = || rows.iter().flat_map(|row| row.traced.into_iter().chain(around(row.decoded)));
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        // About six lines, a round number of degrees apart.
        let rough = ((high - low) / 6.0).max(1e-3);
        let power = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power).into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(10.0 * power);
        Self { low: (low / step).floor() * step, high: (high / step).ceil() * step, step }
    }

    fn y(&self, elevation: f64) -> f64 {
        let share = (elevation - self.low) / (self.high - self.low).max(self.step);
        HEIGHT - MARGINS[3] - share * (HEIGHT - MARGINS[1] - MARGINS[3])
    }
}

fn x(azimuth: f64) -> f64 {
    MARGINS[0] + azimuth / 360.0 * (WIDTH - MARGINS[0] - MARGINS[2])
}

/// The picture as text.
pub fn svg(title: &str, rows: &[Row], bound: Option<f64>) -> String {
    let scale = Scale::of(rows, bound.unwrap_or(0.0));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" \
         font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{}\" y=\"24\" font-size=\"15\">{title}</text>\n",
        MARGINS[0]
    );
    grid(&mut svg, &scale);
    let traced: Vec<_> = rows.iter().filter_map(|row| Some((row.azimuth, row.traced?))).collect();
    let decoded: Vec<_> = rows.iter().map(|row| (row.azimuth, row.decoded)).collect();
    if let Some(bound) = bound {
        band(&mut svg, &scale, &decoded, bound);
        legend(&mut svg, WIDTH - 290.0, "within bound", BOUND);
    }
    if !traced.is_empty() {
        curve(&mut svg, &scale, &traced, TRACED);
        legend(&mut svg, WIDTH - 180.0, "traced", TRACED);
    }
    curve(&mut svg, &scale, &decoded, DECODED);
    legend(&mut svg, WIDTH - 100.0, "decoded", DECODED);
    svg + "</svg>\n"
}

fn grid(svg: &mut String, scale: &Scale) {
    let lines = ((scale.high - scale.low) / scale.step).round() as usize;
    let decimals = (-scale.step.log10().floor()).max(0.0) as usize;
    for line in 0..=lines {
        let elevation = scale.low + line as f64 * scale.step;
        let y = scale.y(elevation);
        let (from, to) = (x(0.0), x(360.0));
        let _ = writeln!(
            svg,
            "<path d=\"M{from:.1} {y:.1}H{to:.1}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{:.1}\" \
             text-anchor=\"end\">{elevation:.decimals$}°</text>",
            from - 6.0,
            y + 4.0
        );
    }
    for (azimuth, name) in [(0, "N"), (90, "E"), (180, "S"), (270, "W"), (360, "N")] {
        let (x, low, high) = (x(f64::from(azimuth)), HEIGHT - MARGINS[3], MARGINS[1]);
        let _ = writeln!(
            svg,
            "<path d=\"M{x:.1} {low}V{high}\" stroke=\"#ddd\"/><text x=\"{x:.1}\" y=\"{}\" \
             text-anchor=\"middle\">{name} {azimuth}°</text>",
            low + 18.0
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">azimuth, clockwise from north</text>",
        x(180.0),
        HEIGHT - 10.0
    );
}

/// All that lies within the bound of the decoded skyline.
fn band(svg: &mut String, scale: &Scale, decoded: &[(f64, f64)], bound: f64) {
    let closed: Vec<_> = decoded.iter().copied().chain(decoded.first().map(|first| (360.0, first.1))).collect();
    let above = closed.iter().map(|(azimuth, elevation)| (*azimuth, elevation + bound));
    let below = closed.iter().rev().map(|(azimuth, elevation)| (*azimuth, elevation - bound));
    let point = |(azimuth, elevation): (f64, f64)| format!("{:.2},{:.2}", x(azimuth), scale.y(elevation));
    let points: Vec<String> = above.chain(below).map(point).collect();
    let _ = writeln!(svg, "<polygon fill=\"{BOUND}\" points=\"{}\"/>", points.join(" "));
}

/// The first azimuth again at the end: the skyline is closed.
fn curve(svg: &mut String, scale: &Scale, points: &[(f64, f64)], color: &str) {
    let closed = points.iter().copied().chain(points.first().map(|first| (360.0, first.1)));
    let points: Vec<String> =
        closed.map(|(azimuth, elevation)| format!("{:.2},{:.2}", x(azimuth), scale.y(elevation))).collect();
    let _ = writeln!(
        svg,
        "<polyline fill=\"none\" stroke=\"{color}\" stroke-width=\"1.4\" points=\"{}\"/>",
        points.join(" ")
    );
}

fn legend(svg: &mut String, x: f64, name: &str, color: &str) {
    let _ = writeln!(
        svg,
        "<path d=\"M{x} 20h20\" stroke=\"{color}\" stroke-width=\"2\"/><text x=\"{}\" y=\"24\">{name}</text>",
        x + 26.0
    );
}
