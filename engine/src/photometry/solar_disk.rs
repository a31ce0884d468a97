//! The part of a limb-darkened disc above a horizon line and above a facet's own plane.
//!
//! On the unit disc the radiance is `μ^α`, `μ² = 1 − x² − y²`. Its share above a straight line at distance `h`
//! from the centre, and the first moment of that part, are closed:
//!
//! ```text
//! V(h) = ∫_h^1 (1 − v²)^((α+1)/2) dv / B(½, a)      M(h) = (1 − h²)^a / (2 a B(½, a))      a = (α + 3)/2
//! ```
//!
//! A polynomial in `μ` is a sum of such discs, some of negative weight.
//!
//! `V` is the regularised incomplete beta function `I_{(1−h)/2}(a, a)`; here it is a Gauss–Legendre sum in
//! `φ = asin v`, good to 1e-9. Where horizon and facet plane both cut the disc, columns of constant `x` between
//! the corners of the region are summed, each in the same way. The ground's irradiance follows to first order in
//! the angular radius `r`:
//!
//! ```text
//! E = E_n [ V n·s + r (M_x n·e_x + M_y n·e_y) ]
//! ```
//!
//! which is not `V cos i`: at 1.5° Sun elevation and half the disc hidden it is 7 % more. Axes and lines:
//! [`SunAxes`](super::SunAxes).
//!
//! # Assumptions
//! - One law for the whole band: see [`LimbDarkening`].
//! - Second order in `r` is left out: 2e-5 of the irradiance for the Sun at 1 au.
//!
//! `fast` sorts the cases instead and interpolates tables: within 1e-6 of the whole Sun. `solar_disk.wgsl` does so in
//! `f32`: within 4e-5, 1e-5 for `α = 0.5`. `tests/conformance/photometry.rs` holds it to the quadrature.
//!
//! # References
//! Max (1988), The Visual Computer 4, 109, doi:10.1007/BF01905562, for the uniform disc.

mod fast;
mod quadrature;

use std::f64::consts::{FRAC_PI_2, PI};

use fast::Fast;
use glam::DVec2;
use quadrature::Quadrature;

use super::quadrature::gauss_legendre;
use super::{Facet, HorizonLine, LimbDarkening, PhotometryError};

/// What is seen of the disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiskLight {
    /// Share of the disc's light, 0 to 1.
    pub fraction: f64,
    /// Share times the centroid of what is seen, in solar radii of the tangent plane.
    pub moment: DVec2,
}

impl DiskLight {
    pub const NONE: Self = Self { fraction: 0.0, moment: DVec2::ZERO };
    pub const FULL: Self = Self { fraction: 1.0, moment: DVec2::ZERO };

    /// Irradiance of the facet over that of a plane that faces the whole Sun.
    pub fn irradiance_factor(&self, facet: Facet, angular_radius_rad: f64) -> f64 {
        (angular_radius_rad * (facet.height * self.fraction + facet.slope.dot(self.moment))).max(0.0)
    }
}

/// The Sun's disc with its limb darkening, in units of its own radius: a sum of discs whose radiance is a power of `μ`.
#[derive(Debug, Clone, PartialEq)]
pub struct SolarDisk {
    parts: Vec<Part>,
}

#[derive(Debug, Clone, PartialEq)]
struct Part {
    /// Share of the whole light; negative where a polynomial's factor is.
    weight: f64,
    believed: Quadrature,
    fast: Fast,
}

/// The part of the plane with `normal·q ≥ height`; `normal` has length 1.
#[derive(Debug, Clone, Copy)]
struct HalfPlane {
    normal: DVec2,
    height: f64,
}

impl SolarDisk {
    pub fn new(law: LimbDarkening) -> Result<Self, PhotometryError> {
        law.check()?;
        let mean = law.mean();
        let part = |(alpha, factor): (f64, f64)| {
            let believed = Quadrature::new(alpha);
            Part { weight: 2.0 * factor / (alpha + 2.0) / mean, fast: Fast::new(&believed), believed }
        };
        Ok(Self { parts: law.powers().into_iter().map(part).collect() })
    }

    /// Share of the light above a straight line at `height` solar radii from the centre.
    pub fn visible_above(&self, height: f64) -> f64 {
        self.parts.iter().map(|part| part.weight * part.believed.visible_above(height)).sum()
    }

    /// The same from a table, to 1e-6.
    pub fn share_above(&self, height: f64) -> f64 {
        self.parts.iter().map(|part| part.weight * part.fast.share_above(height)).sum()
    }

    /// Share of the light above some heights in the columns at `x`, which stand for the disc: `[x, height]`, in solar radii.
    pub fn share_of_columns(&self, columns: &[[f64; 2]]) -> f64 {
        let of_part = |part: &Part| {
            let (mut light, mut weights) = (0.0, 0.0);
            for &[x, height] in columns {
                let chord = (1.0 - x * x).sqrt();
                let weight = chord.powf(part.believed.alpha + 1.0);
                light += weight * part.fast.chord_above(height / chord);
                weights += weight;
            }
            part.weight * light / weights
        };
        self.parts.iter().map(of_part).sum()
    }

    /// First moment of that light, across the line, in solar radii.
    pub fn moment_above(&self, height: f64) -> f64 {
        self.parts.iter().map(|part| part.weight * part.believed.moment_above(height)).sum()
    }

    /// The sum over the parts of what `light` gives for each.
    fn sum(&self, light: impl Fn(&Part) -> DiskLight) -> DiskLight {
        if let [part] = &self.parts[..] {
            return light(part);
        }
        let (mut fraction, mut moment) = (0.0, DVec2::ZERO);
        for part in &self.parts {
            let light = light(part);
            fraction += part.weight * light.fraction;
            moment += part.weight * light.moment;
        }
        DiskLight { fraction: fraction.clamp(0.0, 1.0), moment }
    }

    /// What is seen above the horizon and above the facet's own plane.
    pub fn light(&self, horizon: HorizonLine, facet: Facet) -> DiskLight {
        match Cut::of(horizon, facet) {
            Cut::None(whole) => whole,
            Cut::One(plane) => self.sum(|part| part.fast.light_above_line(plane)),
            Cut::Both(a, b) => self.sum(|part| part.fast.light_above_both(a, b)),
        }
    }

    /// The same by quadrature: 1 µs where one line cuts the disc, 0.1 ms where both do.
    pub fn light_by_quadrature(&self, horizon: HorizonLine, facet: Facet) -> DiskLight {
        match Cut::of(horizon, facet) {
            Cut::None(whole) => whole,
            Cut::One(plane) => self.sum(|part| part.believed.light_above_line(plane)),
            Cut::Both(a, b) => self.sum(|part| part.believed.light_by_columns([a, b])),
        }
    }

    /// What is seen above any skyline, given as its height at a column `x`, and above the facet's own plane: the
    /// disc in `COLUMNS_OF_SKYLINE` columns of equal angle. A smooth skyline is met to 1e-3, a step inside the
    /// disc to a column's width.
    pub fn light_above(&self, skyline: &dyn Fn(f64) -> f64, facet: Facet) -> DiskLight {
        let own = HalfPlane::new(facet.slope, facet.height);
        let width_rad = PI / f64::from(Self::COLUMNS_OF_SKYLINE);
        let columns = (0..Self::COLUMNS_OF_SKYLINE).map(|column| {
            let (x, chord) = ((f64::from(column) + 0.5) * width_rad - FRAC_PI_2).sin_cos();
            (x, chord, HalfPlane { normal: DVec2::Y, height: skyline(x) })
        });
        let columns: Vec<_> = columns.collect();
        self.sum(|part| {
            let alpha = part.believed.alpha;
            let (mut fraction, mut moment) = (0.0, DVec2::ZERO);
            for &(x, chord, horizon) in &columns {
                let weight = width_rad * chord.powf(alpha + 2.0);
                let (share, offset) = part.fast.column([horizon, own], x, chord);
                fraction += weight * share;
                moment += weight * DVec2::new(x * share, chord * offset);
            }
            let norm = (alpha + 2.0) / (2.0 * PI);
            DiskLight { fraction: norm * fraction, moment: norm * moment }
        })
    }

    const COLUMNS_OF_SKYLINE: u32 = 24;

    /// The numbers that `solar_disk.wgsl` reads, part by part: three constants and the part's weight; `V(h)` at `DISK_KNOTS`
    /// even steps of `√(1 − h)` from 0 to 1; the share of a chord above the same heights; `DISK_COLUMNS` nodes and weights
    /// on [0, 1], in turns.
    pub fn tables(&self) -> Vec<f32> {
        let heights = (0..Self::KNOTS).map(|i| 1.0 - (f64::from(i) / f64::from(Self::KNOTS - 1)).powi(2));
        let columns: Vec<_> =
            gauss_legendre(Self::COLUMNS as usize).into_iter().flat_map(|(node, weight)| [node, weight]).collect();
        let of_part = |part: &Part| {
            let Quadrature { alpha, line_norm, chord_norm, .. } = part.believed;
            let numbers = [alpha, line_norm, chord_norm, part.weight].into_iter();
            let lines = heights.clone().map(|height| part.believed.visible_above(height));
            let chords = heights.clone().map(|height| part.believed.chord_above(height));
            numbers
                .chain(lines)
                .chain(chords)
                .chain(columns.iter().copied())
                .map(|value| value as f32)
                .collect::<Vec<_>>()
        };
        self.parts.iter().flat_map(of_part).collect()
    }

    const KNOTS: u32 = 257;
    const COLUMNS: u32 = 12;

    /// The `override` values that go with [`SolarDisk::tables`].
    pub fn constants(&self) -> [(&'static str, f64); 3] {
        [
            ("DISK_KNOTS", f64::from(Self::KNOTS)),
            ("DISK_COLUMNS", f64::from(Self::COLUMNS)),
            ("DISK_PARTS", self.parts.len() as f64),
        ]
    }
}

/// What horizon and facet plane do to the disc.
enum Cut {
    /// All or nothing is seen.
    None(DiskLight),
    One(HalfPlane),
    Both(HalfPlane, HalfPlane),
}

impl Cut {
    fn of(horizon: HorizonLine, facet: Facet) -> Self {
        let horizon = HalfPlane::new(DVec2::new(-horizon.slope, 1.0), -horizon.height);
        let own = HalfPlane::new(facet.slope, facet.height);
        match [horizon, own].map(|plane| (plane.height >= 1.0, plane.height <= -1.0)) {
            [(true, _), _] | [_, (true, _)] => Self::None(DiskLight::NONE),
            [(_, true), (_, true)] => Self::None(DiskLight::FULL),
            [_, (_, true)] => Self::One(horizon),
            [(_, true), _] => Self::One(own),
            _ => Self::Both(horizon, own),
        }
    }
}

impl HalfPlane {
    /// Where `constant + gradient·q ≥ 0`.
    fn new(gradient: DVec2, constant: f64) -> Self {
        let length = gradient.length().max(f64::MIN_POSITIVE);
        Self { normal: gradient / length, height: -constant / length }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disk(alpha: f64) -> SolarDisk {
        SolarDisk::new(LimbDarkening::Power { alpha }).unwrap()
    }

    /// Hestroffer & Magnan at 550 nm.
    const ALPHA_550: f64 = 0.507_909_09;

    /// Facing the Sun, far from its own plane.
    const FACING: Facet = Facet { height: 200.0, slope: DVec2::ZERO };

    #[test]
    fn a_skyline_in_columns_meets_the_straight_horizon() {
        let disk = disk(0.508);
        let facet = Facet { height: 30.0, slope: DVec2::new(0.1, 0.9) };
        for (height, slope) in [(-0.9, 0.0), (-0.3, 0.4), (0.0, -1.0), (0.6, 0.2), (2.0, 0.0)] {
            let line = disk.light(HorizonLine { height, slope }, facet);
            let columns = disk.light_above(&|x| height + slope * x, facet);
            assert!((line.fraction - columns.fraction).abs() < 1e-3, "{height} {slope}");
            assert!((line.moment - columns.moment).length() < 1e-3, "{height} {slope}");
        }
    }

    /// Values of the incomplete beta function and of a 2-D quadrature, six digits.
    #[test]
    fn the_share_above_a_level_line_is_the_incomplete_beta_function() {
        let table = [
            (-0.90, 0.981307, 0.988485),
            (-0.50, 0.804499, 0.825893),
            (0.0, 0.5, 0.5),
            (0.25, 0.342519, 0.328644),
            (0.50, 0.195501, 0.174107),
            (0.75, 0.072147, 0.055286),
            (0.90, 0.018693, 0.011515),
        ];
        for (height, uniform, darkened) in table {
            assert!((disk(0.0).visible_above(height) - uniform).abs() < 6e-7, "{height}");
            assert!((disk(ALPHA_550).visible_above(height) - darkened).abs() < 6e-7, "{height}");
        }
    }

    /// Max (1988): V = 1/2 − (asin h + h √(1 − h²))/π for the uniform disc. Share and moment to 1e-9.
    #[test]
    fn the_uniform_disc_has_the_arcsine_share() {
        for i in -100..=100 {
            let height = f64::from(i) * 0.01;
            let expected = 0.5 - (height.asin() + height * (1.0 - height * height).sqrt()) / PI;
            assert!((disk(0.0).visible_above(height) - expected).abs() < 1e-9, "{height}");
        }
        assert!((disk(0.0).moment_above(0.0) - 2.0 / (3.0 * PI)).abs() < 1e-9);
        assert!((disk(ALPHA_550).moment_above(0.0) / 0.5 - 0.3971).abs() < 5e-5, "centroid of half a disc");
    }

    #[test]
    fn tangent_and_distant_lines_hide_all_or_nothing() {
        for alpha in [0.0, ALPHA_550] {
            for beyond in [1.0, 1.0 + 1e-7, 3.0, 1e9, f64::INFINITY] {
                assert_eq!(disk(alpha).visible_above(beyond), 0.0);
                assert!((disk(alpha).visible_above(-beyond) - 1.0).abs() < 1e-14);
                assert_eq!(disk(alpha).light(HorizonLine { height: beyond, slope: 0.0 }, FACING), DiskLight::NONE);
                assert_eq!(disk(alpha).light(HorizonLine { height: -beyond, slope: 0.0 }, FACING), DiskLight::FULL);
            }
        }
    }

    /// Columns know nothing of rotational symmetry, the closed form rests on it. 1e-8 is the columns' own error
    /// where the weight ends like a fractional power.
    #[test]
    fn columns_of_a_tilted_line_give_the_closed_form() {
        for alpha in [0.0, 0.2690, ALPHA_550, 0.8668] {
            for (height, slope) in [(0.0, 0.0), (0.3, 1.0), (-0.5, -2.0), (2.0, 30.0), (0.0, 1e6), (0.99, 0.0)] {
                let line = HalfPlane::new(DVec2::new(-slope, 1.0), -height);
                let far = HalfPlane { normal: DVec2::X, height: -2.0 };
                let (columns, closed) = (
                    disk(alpha).parts[0].believed.light_by_columns([line, far]),
                    disk(alpha).parts[0].believed.light_above_line(line),
                );
                assert!((columns.fraction - closed.fraction).abs() < 1e-8, "{alpha} {line:?} {columns:?} {closed:?}");
                assert!((columns.moment - closed.moment).length() < 1e-8, "{alpha} {line:?} {columns:?} {closed:?}");
            }
        }
    }

    /// Against two million points of a sunflower pattern, each a thing of its own: share within 2e-5.
    #[test]
    fn two_lines_across_the_disc_leave_what_a_count_of_points_leaves() {
        let (disk, points) = (disk(ALPHA_550), 2_000_000);
        let cases = [
            (HorizonLine { height: 0.2, slope: 0.3 }, Facet { height: -0.1, slope: DVec2::new(0.5, 0.2) }),
            (HorizonLine { height: -0.3, slope: -4.0 }, Facet { height: 0.05, slope: DVec2::new(0.0, -0.9) }),
            (HorizonLine { height: 0.1, slope: 0.0 }, Facet { height: 0.3, slope: DVec2::new(0.9, 0.0) }),
            (HorizonLine { height: -0.6, slope: 0.1 }, Facet { height: 0.6, slope: DVec2::new(0.1, -0.9) }),
            (HorizonLine { height: 0.6, slope: 0.1 }, Facet { height: -0.6, slope: DVec2::new(0.1, -0.9) }),
        ];
        for (horizon, facet) in cases {
            let (mut seen, mut moment, mut all) = (0.0, DVec2::ZERO, 0.0);
            for i in 0..points {
                let square = (f64::from(i) + 0.5) / f64::from(points);
                let q = square.sqrt() * DVec2::from_angle(f64::from(i) * PI * (3.0 - 5f64.sqrt()));
                let light = (1.0 - square).powf(ALPHA_550 / 2.0);
                all += light;
                if q.y >= horizon.height + horizon.slope * q.x && facet.height + facet.slope.dot(q) >= 0.0 {
                    seen += light;
                    moment += light * q;
                }
            }
            let light = disk.light(horizon, facet);
            assert!((light.fraction - seen / all).abs() < 2e-5, "{horizon:?} {light:?} {}", seen / all);
            assert!((light.moment - moment / all).length() < 2e-5, "{horizon:?} {light:?} {}", moment / all);
        }
    }

    /// A bare level surface is its own horizon: 1361 W/m² at r = 0.00465048, by the elevation in radii.
    #[test]
    fn a_bare_level_surface_is_lit_while_the_sun_sets() {
        let radius_rad = 0.004_650_48;
        let table =
            [(-0.5, 0.25369, 0.20765), (0.0, 1.34312, 1.25653), (0.5, 3.41834, 3.37230), (1.0, 6.32930, 6.32930)];
        for (elevation_radii, uniform_w_m2, darkened_w_m2) in table {
            for (alpha, expected_w_m2) in [(0.0, uniform_w_m2), (ALPHA_550, darkened_w_m2)] {
                let facet = Facet { height: elevation_radii, slope: DVec2::Y };
                let light = disk(alpha).light(HorizonLine::NONE, facet);
                let irradiance_w_m2 = 1361.0 * light.irradiance_factor(facet, radius_rad);
                assert!((irradiance_w_m2 - expected_w_m2).abs() < 2e-5, "{elevation_radii} {irradiance_w_m2}");
            }
        }
    }

    /// Irradiance of level ground over `V sin e` with part of the Sun behind a level horizon; three decimals.
    #[test]
    fn irradiance_in_the_penumbra_is_more_than_share_times_sine() {
        let radius_rad: f64 = 0.26645f64.to_radians();
        let table = [
            (1.0f64, [1.039, 1.106, 1.183, 1.250]),
            (1.5, [1.026, 1.071, 1.122, 1.166]),
            (3.0, [1.013, 1.035, 1.061, 1.083]),
            (10.0, [1.004, 1.011, 1.018, 1.025]),
        ];
        for (elevation_deg, ratios) in table {
            let (sin, cos) = elevation_deg.to_radians().sin_cos();
            let facet = Facet { height: sin / radius_rad, slope: DVec2::new(0.0, cos) };
            for (height, ratio) in [-0.5, 0.0, 0.5, 0.9].into_iter().zip(ratios) {
                let light = disk(ALPHA_550).light(HorizonLine { height, slope: 0.0 }, facet);
                let got = light.irradiance_factor(facet, radius_rad) / (light.fraction * sin);
                assert!((got - ratio).abs() < 6e-4, "{elevation_deg} {height}: {got}");
            }
        }
    }
}
