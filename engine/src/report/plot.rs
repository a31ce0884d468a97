//! A plot as SVG text: points, joined or not, on linear or logarithmic axes.

use std::fmt::Write;

/// An axis with what it shows.
#[derive(Debug, Clone)]
pub struct Axis {
    pub label: String,
    pub logarithmic: bool,
}

/// Points that belong together, by name.
#[derive(Debug, Clone)]
pub struct Curve {
    pub name: String,
    pub points: Vec<[f64; 2]>,
    pub joined: bool,
}

#[derive(Debug, Clone)]
pub struct Plot {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    pub curves: Vec<Curve>,
}

const SIZE: [f64; 2] = [640.0, 400.0];
/// Left, right, top and bottom of the frame.
const FRAME: [f64; 4] = [70.0, 450.0, 30.0, 350.0];

/// Joined points beyond this many get no marks.
const MARKED: usize = 60;

/// Okabe and Ito's colours, told apart by the colour-blind.
const COLOURS: [&str; 8] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#F0E442"];

impl Plot {
    /// Values that an axis cannot show (no number, or not positive on a logarithmic one) are left out.
    pub fn svg(&self) -> String {
        let shown = |p: &[f64; 2]| self.x.shows(p[0]) && self.y.shows(p[1]);
        let points = || self.curves.iter().flat_map(|curve| curve.points.iter().filter(|p| shown(p)));
        let [x, y] = [Scale::of(&self.x, points().map(|p| p[0])), Scale::of(&self.y, points().map(|p| p[1]))];
        let at = |p: &[f64; 2]| {
            let [left, right, top, bottom] = FRAME;
            [left + (right - left) * x.share(p[0]), bottom - (bottom - top) * y.share(p[1])]
        };
        let mut svg = self.frame(&x, &y);
        for (curve, colour) in self.curves.iter().zip(COLOURS.iter().cycle()) {
            let places: Vec<_> = curve.points.iter().filter(|p| shown(p)).map(at).collect();
            if curve.joined {
                let path: Vec<_> = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
                push(&mut svg, format_args!("<polyline points='{}' fill='none' stroke='{colour}'/>", path.join(" ")));
            }
            // So many points are a line.
            let marked = if curve.joined && places.len() > MARKED { Vec::new() } else { places };
            for [x, y] in marked {
                push(&mut svg, format_args!("<circle cx='{x:.1}' cy='{y:.1}' r='4' fill='{colour}'/>"));
            }
        }
        self.legend(&mut svg);
        svg + "</svg>\n"
    }

    fn frame(&self, x: &Scale, y: &Scale) -> String {
        let [width, height] = SIZE;
        let [left, right, top, bottom] = FRAME;
        let mut svg = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width} {height}' width='{width}' \
             font-family='sans-serif' font-size='12'>\n"
        );
        let middle = (left + right) / 2.0;
        push(&mut svg, format_args!("<text x='{left}' y='18' font-weight='bold'>{}</text>", escaped(&self.title)));
        let (across, down) = (right - left, bottom - top);
        push(
            &mut svg,
            format_args!("<rect x='{left}' y='{top}' width='{across}' height='{down}' fill='none' stroke='#888'/>"),
        );
        for tick in x.ticks() {
            let at = left + across * x.share(tick);
            push(&mut svg, format_args!("<path d='M{at:.1} {top}V{bottom}' stroke='#ddd'/>"));
            push(
                &mut svg,
                format_args!("<text x='{at:.1}' y='{}' text-anchor='middle'>{}</text>", bottom + 16.0, label(tick)),
            );
        }
        for tick in y.ticks() {
            let at = bottom - down * y.share(tick);
            push(&mut svg, format_args!("<path d='M{left} {at:.1}H{right}' stroke='#ddd'/>"));
            push(
                &mut svg,
                format_args!("<text x='{}' y='{:.1}' text-anchor='end'>{}</text>", left - 6.0, at + 4.0, label(tick)),
            );
        }
        let below = bottom + 36.0;
        push(
            &mut svg,
            format_args!("<text x='{middle}' y='{below}' text-anchor='middle'>{}</text>", escaped(&self.x.label)),
        );
        let beside = (top + bottom) / 2.0;
        push(
            &mut svg,
            format_args!(
                "<text transform='translate(14 {beside}) rotate(-90)' text-anchor='middle'>{}</text>",
                escaped(&self.y.label)
            ),
        );
        svg
    }

    fn legend(&self, svg: &mut String) {
        let left = FRAME[1] + 14.0;
        for (line, (curve, colour)) in self.curves.iter().zip(COLOURS.iter().cycle()).enumerate() {
            let y = FRAME[2] + 12.0 + 18.0 * line as f64;
            push(svg, format_args!("<circle cx='{left}' cy='{}' r='4' fill='{colour}'/>", y - 4.0));
            push(svg, format_args!("<text x='{}' y='{y}'>{}</text>", left + 10.0, escaped(&curve.name)));
        }
    }
}

impl Axis {
    pub fn linear(label: &str) -> Self {
        Self { label: label.into(), logarithmic: false }
    }

    pub fn logarithmic(label: &str) -> Self {
        Self { label: label.into(), logarithmic: true }
    }

    fn shows(&self, value: f64) -> bool {
        value.is_finite() && (!self.logarithmic || value > 0.0)
    }
}

/// From values to shares of an axis.
struct Scale {
    logarithmic: bool,
    low: f64,
    high: f64,
}

impl Scale {
    /// From round values below all to round values above all.
    fn of(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let Axis { logarithmic, .. } = *axis;
        let range = values.fold(None, |range: Option<[f64; 2]>, v| {
            Some(range.map_or([v, v], |[low, high]| [low.min(v), high.max(v)]))
        });
        let [low, high] = range.unwrap_or([1.0, 10.0]);
        if logarithmic {
            let [low, high] = [low.log10().floor(), high.log10().ceil()];
            return Self { logarithmic, low, high: high.max(low + 1.0) };
        }
        let high = if high > 0.0 { 1.05 * high } else { 1.0 };
        Self { logarithmic, low: low.min(0.0), high }
    }

    fn share(&self, value: f64) -> f64 {
        let value = if self.logarithmic { value.log10() } else { value };
        (value - self.low) / (self.high - self.low)
    }

    fn ticks(&self) -> Vec<f64> {
        if self.logarithmic {
            return (self.low as i32..=self.high as i32).map(|power| 10f64.powi(power)).collect();
        }
        let rough = (self.high - self.low) / 5.0;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= rough).unwrap_or(rough);
        let (first, last) = ((self.low / step).ceil() as i64, (self.high / step).floor() as i64);
        (first..=last).map(|i| i as f64 * step).collect()
    }
}

fn label(tick: f64) -> String {
    if tick != 0.0 && !(1e-3..1e5).contains(&tick.abs()) {
        return format!("{tick:e}");
    }
    // A tick is a small multiple of a power of ten: what follows the sixth digit is rounding.
    format!("{}", (tick * 1e6).round() / 1e6)
}

fn push(svg: &mut String, element: std::fmt::Arguments) {
    writeln!(svg, "{element}").expect("text takes all");
}

/// Text without the letters that mean something in XML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('\'', "&#39;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_in_the_middle_of_the_axes_is_in_the_middle_of_the_frame() {
        let plot = Plot {
            title: "a < b".into(),
            x: Axis::logarithmic("x"),
            y: Axis::logarithmic("y"),
            curves: vec![Curve {
                name: "c".into(),
                points: vec![[1.0, 1.0], [10.0, 0.1], [100.0, 0.01], [f64::NAN, 1.0], [0.0, 1.0]],
                joined: true,
            }],
        };
        let svg = plot.svg();
        assert!(svg.contains("cx='260.0' cy='190.0'"), "{svg}");
        assert!(svg.contains("a &lt; b"));
        // Three points and one in the legend; what a logarithm cannot show is left out.
        assert_eq!(svg.matches("<circle").count(), 4);
    }
}
