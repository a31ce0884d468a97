//! The same light from tables, for renderers: 0.1 µs where one line cuts the disc, 1 µs where two do.
//!
//! Lines that do not cross inside the disc are sums of single ones. Where they cross, columns parallel to the
//! edge that hides more are summed from that edge to where the other leaves the disc; the rest is whole.
//!
//! Shares are cubics between knots of even steps of `u = √(1 − |h|)`, over which they have no kink at the limb,
//! through their exact derivatives
//!
//! ```text
//! dV/du = 2u (1 − h²)^((α+1)/2) / N      N: the norm of lines; for chords α − 1 takes the place of α
//! ```
//!
//! The quadrature of the parent module is the truth this is held to: 1e-6 of the whole Sun.

use super::super::quadrature::gauss_legendre;
use super::light::{DiskLight, HalfPlane};
use super::quadrature::Quadrature;

/// Knots of a table over `u` from 0 to 1.
const KNOTS: usize = 129;

/// Columns between the corners of a wedge.
const COLUMNS: usize = 24;

/// Sine of the angle under which two lines count as parallel.
const PARALLEL_SINE: f64 = 1e-9;

/// Tables of one disc.
#[derive(Debug, Clone, PartialEq)]
pub struct Fast {
    alpha: f64,
    line_norm: f64,
    chord_norm: f64,
    /// Share of the disc's light above a line, and of a chord's above a point, with derivatives by `u`.
    lines: Vec<[f64; 2]>,
    chords: Vec<[f64; 2]>,
    columns: Vec<(f64, f64)>,
}

impl Fast {
    /// Tables of the shares that `disk` integrates.
    pub fn new(disk: &Quadrature) -> Self {
        let knots = (0..KNOTS).map(|i| i as f64 / (KNOTS - 1) as f64);
        let table = |share: &dyn Fn(f64) -> f64, power: f64, norm: f64| {
            let knot = |u: f64| {
                let height = 1.0 - u * u;
                [share(height), 2.0 * u * rest(height).powf(power) / norm]
            };
            knots.clone().map(knot).collect()
        };
        Self {
            alpha: disk.alpha,
            line_norm: disk.line_norm,
            chord_norm: disk.chord_norm,
            lines: table(&|h| disk.visible_above(h), (disk.alpha + 1.0) / 2.0, disk.line_norm),
            chords: table(&|h| disk.chord_above(h), disk.alpha / 2.0, disk.chord_norm),
            columns: gauss_legendre(COLUMNS),
        }
    }

    /// `∫ cos^(α+1) φ dφ` of a column's visible part, and the same with `sin φ` as a factor, for `y = chord sin φ`.
    pub(super) fn column(&self, planes: [HalfPlane; 2], x: f64, chord: f64) -> (f64, f64) {
        let Some([low, high]) = HalfPlane::column(planes, x, chord) else { return (0.0, 0.0) };
        let end = |t: f64| rest(t).powf(self.alpha / 2.0 + 1.0);
        let share = self.chord_norm * (self.chord_above(low) - self.chord_above(high));
        (share, (end(low) - end(high)) / (self.alpha + 2.0))
    }

    pub(super) fn chord_above(&self, height: f64) -> f64 {
        look_up(&self.chords, height)
    }

    pub(super) fn light_above_line(&self, plane: HalfPlane) -> DiskLight {
        DiskLight { fraction: self.share_above(plane.height), moment: self.moment_above(plane.height) * plane.normal }
    }

    pub(super) fn light_above_both(&self, a: HalfPlane, b: HalfPlane) -> DiskLight {
        let (sine, cosine) = (a.normal.perp_dot(b.normal), a.normal.dot(b.normal));
        if sine.abs() < PARALLEL_SINE {
            return match cosine < 0.0 {
                true => self.light_between(a, b),
                false => self.light_above_line(if a.height >= b.height { a } else { b }),
            };
        }
        if lines_cross(a.height, b.height, sine, cosine) {
            // Columns along the line that hides more: they are shorter.
            return if a.height >= b.height { self.light_in_wedge(a, b) } else { self.light_in_wedge(b, a) };
        }
        match (a.height * cosine >= b.height, b.height * cosine >= a.height) {
            (true, true) => self.light_between(a, b),
            (true, false) => self.light_above_line(a),
            (false, true) => self.light_above_line(b),
            (false, false) => DiskLight::NONE,
        }
    }

    /// What two caps that do not overlap leave of the disc.
    fn light_between(&self, a: HalfPlane, b: HalfPlane) -> DiskLight {
        let [a, b] = [a, b].map(|plane| self.light_above_line(plane));
        let fraction = a.fraction + b.fraction - 1.0;
        if fraction > 0.0 { DiskLight { fraction, moment: a.moment + b.moment } } else { DiskLight::NONE }
    }

    fn light_in_wedge(&self, a: HalfPlane, b: HalfPlane) -> DiskLight {
        let (sine, cosine) = (a.normal.perp_dot(b.normal), a.normal.dot(b.normal));
        let along = sine.signum() * a.normal.perp();
        let end = (b.height * cosine + rest(b.height).sqrt() * sine.abs()).clamp(a.height, 1.0);
        // Over the angle, columns keep no root of their distance from the limb.
        let (from_rad, to_rad) = (a.height.asin(), end.asin());
        let (mut fraction, mut across, mut aside) = (0.0, 0.0, 0.0);
        for &(node, weight) in &self.columns {
            let (x, chord) = (from_rad + (to_rad - from_rad) * node).sin_cos();
            let t = ((b.height - cosine * x) / (sine.abs() * chord)).clamp(-1.0, 1.0);
            let weight = (to_rad - from_rad) * weight * chord.powf(self.alpha + 2.0) / self.line_norm;
            let share = self.chord_above(t);
            fraction += weight * share;
            across += weight * x * share;
            let offset = rest(t).powf(0.5 * self.alpha + 1.0) / ((self.alpha + 2.0) * self.chord_norm);
            aside += weight * chord * offset;
        }
        if cosine >= b.height {
            fraction += self.share_above(end);
            across += self.moment_above(end);
        }
        DiskLight { fraction, moment: across * a.normal + aside * along }
    }

    pub(super) fn share_above(&self, height: f64) -> f64 {
        look_up(&self.lines, height)
    }

    fn moment_above(&self, height: f64) -> f64 {
        rest(height).powf((self.alpha + 3.0) / 2.0) / ((self.alpha + 3.0) * self.line_norm)
    }
}

/// `1 − x²`, and 0 beyond the limb.
fn rest(x: f64) -> f64 {
    ((1.0 - x) * (1.0 + x)).max(0.0)
}

/// The share above `height`: Hermite's cubic between two knots of a table, mirrored below the centre.
fn look_up(table: &[[f64; 2]], height: f64) -> f64 {
    let place = (1.0 - height.abs()).max(0.0).sqrt() * (KNOTS - 1) as f64;
    let knot = (place as usize).min(KNOTS - 2);
    let (t, step) = (place - knot as f64, 1.0 / (KNOTS - 1) as f64);
    let ([low, low_rate], [high, high_rate]) = (table[knot], table[knot + 1]);
    let s = 1.0 - t;
    let share =
        s * s * ((1.0 + 2.0 * t) * low + t * step * low_rate) + t * t * ((1.0 + 2.0 * s) * high - s * step * high_rate);
    if height < 0.0 { 1.0 - share } else { share }
}

/// Whether two lines meet inside the disc: a² + b² − 2ab cos < sin², written so that nearly parallel ones keep
/// digits.
fn lines_cross(a: f64, b: f64, sine: f64, cosine: f64) -> bool {
    let turned = if cosine >= 0.0 { b } else { -b };
    (a - turned).powi(2) < sine * sine * (1.0 - 2.0 * a * turned / (1.0 + cosine.abs()))
}

#[cfg(test)]
mod tests {
    use super::super::{Facet, HorizonLine, LimbDarkening, SolarDisk};
    use glam::DVec2;

    /// 1e-6 of the whole Sun is 2e-5 of what a Sun shows that has all but set; columns end like a fractional power.
    #[test]
    fn tables_give_what_the_quadrature_gives() {
        let mut worst = 0.0f64;
        for alpha in [0.0, 0.2690, 0.5079, 0.8668, 2.0] {
            let disk = SolarDisk::new(LimbDarkening::Power { alpha }).unwrap();
            for i in 0..20_000 {
                // Additive sequence of the generalised golden ratio in four dimensions.
                let [a, b, c, d] = [0.8567, 0.7339, 0.6287, 0.5386].map(|ratio: f64| (f64::from(i) * ratio).fract());
                let horizon = HorizonLine { height: 2.6 * a - 1.3, slope: (2.4 * b - 1.2).tan() };
                let facet = Facet {
                    height: 2.6 * c - 1.3,
                    slope: DVec2::from_angle(7.0 * d) * (0.2 + 0.8 * (5.0 * d).fract()),
                };
                let (fast, believed) = (disk.light(horizon, facet), disk.light_by_quadrature(horizon, facet));
                let error =
                    (fast.fraction - believed.fraction).abs().max((fast.moment - believed.moment).abs().max_element());
                worst = worst.max(error);
                assert!(error < 1e-6, "{alpha} {horizon:?} {facet:?} {fast:?} {believed:?}");
            }
        }
        println!("worst {worst:e}");
    }
}
