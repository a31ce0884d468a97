//! Light against what others have published, in absolute units: one row a quantity.
//!
//! A [`Row`] is what this program gives, what the source gives, and how far they may lie apart. References are closed forms,
//! other programs and publications, never this program's own numbers.

mod contacts;

use std::f64::consts::PI;
use std::path::PathBuf;

use glam::{DVec2, DVec3};

pub use contacts::{ECLIPSES, Eclipse};

use super::{Error, Machine, Report, Table, Value};
use perilune_engine::ephemeris::{EARTH_RADIUS_M, Source};
use perilune_engine::geometry::Direction;
use perilune_engine::photometry::quadrature::{gauss_legendre, integrate};
use perilune_engine::photometry::{
    Curve, DiscFunction, Facet, Hapke, HorizonLine, LimbDarkening, MultipleScattering, Reflectance, SolarDisk,
    SolarSpectrum, lunar_disc_reflectance,
};
use perilune_engine::pipeline::lights::earthshine_w_m2;
use perilune_engine::quantity::{ASTRONOMICAL_UNIT_M, SOLAR_RADIUS_M, TOTAL_SOLAR_IRRADIANCE_W_M2};
use perilune_engine::report::plot::{self, Axis, Plot};

/// One quantity, twice.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub quantity: String,
    pub unit: &'static str,
    pub ours: f64,
    pub reference: f64,
    /// Largest difference, in the quantity's unit.
    pub allowed: f64,
    pub source: &'static str,
}

impl Row {
    /// Whether the two agree as well as they should; no number never does.
    pub fn holds(&self) -> bool {
        (self.ours - self.reference).abs() <= self.allowed
    }
}

/// All rows; those of eclipses where one of the folders holds kernels.
pub fn rows(data: &[PathBuf]) -> Result<Vec<Row>, Error> {
    let mut rows = sunlight()?;
    rows.extend(disc()?);
    rows.extend(reflectance());
    rows.extend(discs_of_bodies());
    rows.extend(earthshine());
    rows.extend(contacts::rows(data)?);
    Ok(rows)
}

/// The report that `sim bench radiometry` prints.
pub fn run(data: &[PathBuf]) -> Result<Report, Error> {
    let columns = [
        ("quantity", ""),
        ("unit", ""),
        ("ours", ""),
        ("reference", ""),
        ("difference", ""),
        ("allowed", ""),
        ("source", ""),
    ];
    let mut table = Table::new("radiometry", "Absolute checks of light", &columns);
    let rows = rows(data)?;
    let failed = rows.iter().filter(|row| !row.holds()).count();
    for row in &rows {
        let numbers = [row.ours, row.reference, row.ours - row.reference, row.allowed].map(Value::from);
        let mut cells: Vec<Value> = vec![row.quantity.as_str().into(), row.unit.into()];
        cells.extend(numbers);
        cells.push(row.source.into());
        table.rows.push(cells);
    }
    let mut notes = vec![format!("{} rows, {failed} of them beyond what is allowed.", rows.len())];
    if !rows.iter().any(|row| row.unit == "s") {
        notes.push("Contacts of eclipses are left out: no folder holds the DE440 kernels.".into());
    }
    Ok(Report {
        name: "radiometry",
        title: "Radiometry against published values".into(),
        machine: Machine::here(),
        notes,
        tables: vec![table],
        plots: vec![phase_curves()],
        figures: Vec::new(),
    })
}

/// A row whose two values may differ by a share of the reference.
fn relative(
    quantity: impl Into<String>,
    unit: &'static str,
    ours: f64,
    reference: f64,
    share: f64,
    source: &'static str,
) -> Row {
    Row { quantity: quantity.into(), unit, ours, reference, allowed: share * reference.abs(), source }
}

/// Solar spectra in bands, and the Sun's size.
fn sunlight() -> Result<Vec<Row>, Error> {
    const COPIES: &str = "integral of another copy of the table by another program, five digits";
    let (tsis, e490) = (SolarSpectrum::tsis1_hsrs(), SolarSpectrum::e490());
    let mut rows = Vec::new();
    let bands = [(&tsis, 400.0, 700.0, 535.93), (&tsis, 400.0, 1000.0, 843.38), (&tsis, 450.0, 850.0, 627.65)];
    for (spectrum, from_nm, to_nm, reference) in bands.into_iter().chain([(&e490, 400.0, 1000.0, 841.26)]) {
        let light = spectrum.through(&Curve::top_hat([from_nm, to_nm])?)?;
        let name = format!("solar irradiance, {}, {from_nm} to {to_nm} nm", spectrum.name);
        rows.push(relative(name, "W m-2", light.irradiance_w_m2, reference, 2e-5, COPIES));
    }
    let [low_nm, high_nm] = e490.curve.range_nm();
    let all = e490.through(&Curve::top_hat([low_nm, high_nm])?)?.irradiance_w_m2;
    rows.push(relative("solar constant of ASTM E490", "W m-2", all, 1366.1, 5e-5, "ASTM E490-00a"));
    let radius_arcsec = (SOLAR_RADIUS_M / ASTRONOMICAL_UNIT_M).asin().to_degrees() * 3600.0;
    rows.push(relative(
        "angular radius of the Sun at 1 au",
        "arcsec",
        radius_arcsec,
        959.23,
        1e-5,
        "IAU 2012 B2, 2015 B3",
    ));
    Ok(rows)
}

/// The limb, and ground that is lit by a part of the disc.
fn disc() -> Result<Vec<Row>, Error> {
    const BETA: &str = "incomplete beta function, six digits";
    let power = SolarDisk::new(LimbDarkening::hestroffer_magnan(550.0)?)?;
    let law = LimbDarkening::neckel_labs(579.88)?;
    let polynomial = SolarDisk::new(law)?;
    let seen = |name: &str| format!("share of the Sun above a line half a radius above its centre, {name}");
    let radius_rad = (SOLAR_RADIUS_M / ASTRONOMICAL_UNIT_M).asin();
    let sunset = Facet { height: 0.0, slope: DVec2::Y };
    let setting = power.light(HorizonLine::NONE, sunset).irradiance_factor(sunset, radius_rad);
    let (sin, cos) = 1.5f64.to_radians().sin_cos();
    let polar = Facet { height: sin / radius_rad, slope: DVec2::new(0.0, cos) };
    let half = power.light(HorizonLine { height: 0.0, slope: 0.0 }, polar);
    Ok(vec![
        relative(
            "mean over centre of the Sun's disc at 579.88 nm",
            "1",
            law.mean(),
            0.8125,
            1e-4,
            "Neckel & Labs 1994, table 1",
        ),
        relative(seen("550 nm, power law"), "1", power.visible_above(0.5), 0.174107, 4e-6, BETA),
        relative(seen("580 nm, polynomial"), "1", polynomial.visible_above(0.5), 0.176444, 6e-6, BETA),
        relative(
            "irradiance of level ground while half of the Sun has set",
            "W m-2",
            TOTAL_SOLAR_IRRADIANCE_W_M2 * setting,
            1.25653,
            1e-5,
            "closed form, six digits",
        ),
        relative(
            "polar ground at 1.5 deg, half a Sun: irradiance over half of sin 1.5 deg",
            "1",
            half.irradiance_factor(polar, radius_rad) / (0.5 * sin),
            1.071,
            6e-4,
            "closed form, four digits",
        ),
    ])
}

/// Hapke's model against USGS ISIS.
fn reflectance() -> Vec<Row> {
    const ISIS: &str = "USGS ISIS, Hapke.truth";
    let plain = Hapke {
        single_scattering_albedo: 0.5,
        asymmetry: 0.0,
        backscatter: 0.0,
        shadow_hiding_amplitude: 0.0,
        mean_slope_rad: 0.0,
        multiple_scattering: MultipleScattering::Hapke1981,
        ..Hapke::moon()
    };
    let rough = Hapke {
        shadow_hiding_amplitude: 1.0,
        shadow_hiding_width: 1.0,
        asymmetry: 0.213,
        backscatter: 1.0,
        single_scattering_albedo: 0.52,
        mean_slope_rad: 30f64.to_radians(),
        ..plain
    };
    let cases = [
        ("w 0.5, isotropic, smooth", plain, [0.0, 0.0, 0.0], 0.0965097),
        ("w 0.5, isotropic, smooth", plain, [45.0, 30.0, 60.0], 0.0832883),
        ("w 0.52, 30 deg rough, surge", rough, [0.0, 0.0, 0.0], 0.286048),
        ("w 0.52, 30 deg rough, surge", rough, [45.0, 30.0, 60.0], 0.1342),
    ];
    let row = |(name, hapke, angles_deg, reference): (&str, Hapke, [f64; 3], f64)| {
        let [incidence, emission, phase] = angles_deg.map(|deg: f64| deg.to_radians().cos());
        let ours = Reflectance::Hapke(hapke).radiance_factor(incidence, emission, phase);
        let [i, e, g] = angles_deg;
        relative(format!("I/F of Hapke's model, {name}, i {i}, e {e}, g {g} deg"), "1", ours, reference, 5e-6, ISIS)
    };
    cases.into_iter().map(row).collect()
}

/// Spheres as a whole: closed phase curves, and the Moon as ROLO saw it.
fn discs_of_bodies() -> Vec<Row> {
    const CLOSED: &str = "closed form";
    const ROLO: &str = "ROLO 665 nm, mean of waxing and waning (Kieffer & Stone 2005)";
    let g = 60f64.to_radians();
    let (lambert, seeliger) = (Reflectance::lambert(0.12), Reflectance::empirical(0.12, DiscFunction::LommelSeeliger));
    let akimov = Reflectance::empirical(0.12, DiscFunction::Akimov { smoothness: 1.0 });
    let of_lambert = 0.08 * (g.sin() + (PI - g) * g.cos()) / PI;
    let of_seeliger = 0.12 * (1.0 - (g / 2.0).sin() * (g / 2.0).tan() * (1.0 / (g / 4.0).tan()).ln());
    // ∫ cos^2.5 = B(7/4, 1/2), at 60° of phase.
    let of_akimov = 0.12 * (g / 2.0).cos() * 2.0 * (PI - g) / (PI * PI) * 1.437_768_28;
    let sphere = |law: &str| format!("disc-integrated I/F of a sphere of albedo 0.12 at 60 deg, {law}");
    let mut rows = vec![
        relative(sphere("Lambert"), "1", lambert.disc_reflectance(g), of_lambert, 1e-6, CLOSED),
        relative(sphere("Lommel-Seeliger"), "1", seeliger.disc_reflectance(g), of_seeliger, 1e-4, CLOSED),
        relative(sphere("Akimov"), "1", akimov.disc_reflectance(g), of_akimov, 1e-5, CLOSED),
    ];
    for (name, law) in laws_of_the_moon() {
        for (phase_deg, reference) in [(2.0f64, 0.159), (7.0, 0.1227), (30.0, 0.068), (60.0, 0.033), (90.0, 0.0135)] {
            let ours = law.disc_reflectance(phase_deg.to_radians());
            let what = format!("disc-integrated I/F of the Moon at {phase_deg} deg, {name}");
            let allowed = if name.starts_with("LROC") { 0.1 } else { 0.05 };
            rows.push(relative(what, "1", ours, reference, allowed, ROLO));
        }
    }
    rows
}

/// Every law that a scenario of the Moon may name, with the albedo that it has by default.
fn laws_of_the_moon() -> Vec<(&'static str, Reflectance)> {
    let empirical = |disc| Reflectance::lunar(0.19, disc).expect("a law of a lunar scenario");
    vec![
        ("lunar-Lambert", empirical(DiscFunction::LunarLambert)),
        ("Lommel-Seeliger", empirical(DiscFunction::LommelSeeliger)),
        ("Akimov", empirical(DiscFunction::Akimov { smoothness: 1.0 })),
        ("Minnaert k = 0.5", empirical(DiscFunction::Minnaert { exponent: 0.5 })),
        ("LROC 2019", Reflectance::LrocNac2019 { scale: 1.0 }),
        ("Hapke", Reflectance::Hapke(Hapke::moon())),
    ]
}

/// Disc-integrated I/F over the phase angle: every lunar law beside ROLO, and one law without a phase function.
fn phase_curves() -> Plot {
    let curve = |name: &str, of: &dyn Fn(f64) -> f64, degrees: std::ops::RangeInclusive<u32>| plot::Curve {
        name: name.into(),
        points: degrees.map(f64::from).map(|phase_deg| [phase_deg, of(phase_deg.to_radians())]).collect(),
        joined: true,
    };
    let without = Reflectance::empirical(0.12, DiscFunction::LunarLambert);
    let laws = laws_of_the_moon();
    let mut curves = vec![curve("ROLO, 665 nm", &lunar_disc_reflectance, 2..=97)];
    curves.extend(laws.iter().map(|(name, law)| curve(name, &|phase_rad| law.disc_reflectance(phase_rad), 1..=130)));
    curves.push(curve("no phase function", &|phase_rad| without.disc_reflectance(phase_rad), 1..=130));
    Plot {
        title: "The Moon's disc, I/F".into(),
        x: Axis::linear("phase angle [deg]"),
        y: Axis::logarithmic("disc-integrated I/F"),
        curves,
    }
}

/// The Earth's light on the ground of the Moon, and all that it sends back.
fn earthshine() -> Vec<Row> {
    const ALBEDO: f64 = 0.196;
    let mean_m = 384_400e3;
    let source = |direction: DVec3, distance_m: f64| Source {
        direction: Direction::new(direction).expect("a unit vector"),
        distance_m,
        angular_radius_rad: 0.0,
    };
    // The Sun at 1 au from the Earth, seen from where the Earth's phase angle is `phase_rad`.
    let at = |phase_rad: f64| {
        let to_earth = mean_m * DVec3::X;
        let from_earth = ASTRONOMICAL_UNIT_M * DVec3::new(-phase_rad.cos(), phase_rad.sin(), 0.0);
        let to_sun = to_earth + from_earth;
        let (sun, earth) = (source(to_sun.normalize(), to_sun.length()), source(DVec3::X, mean_m));
        earthshine_w_m2(&sun, &earth, ALBEDO, TOTAL_SOLAR_IRRADIANCE_W_M2)
    };
    let sent_w = integrate(&gauss_legendre(48), 0.0, PI, |phase_rad| {
        at(phase_rad) * 2.0 * PI * phase_rad.sin() * mean_m * mean_m
    });
    let caught_w = TOTAL_SOLAR_IRRADIANCE_W_M2 * PI * EARTH_RADIUS_M * EARTH_RADIUS_M;
    vec![
        relative(
            "earthshine of a full Earth, sunlight only",
            "W m-2",
            at(0.0),
            0.075,
            0.1,
            "half of the 0.15 W m-2 of Glenar et al. 2019",
        ),
        relative(
            "share of sunlight that the Earth sends back in all directions",
            "1",
            sent_w / caught_w,
            0.29,
            0.03,
            "CERES, Stephens et al. 2015",
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_that_is_off_or_no_number_does_not_hold() {
        let row = relative("x", "1", 1.0, 1.0, 1e-6, "");
        assert!(row.holds());
        assert!(!Row { ours: 1.0 + 2e-6, ..row.clone() }.holds());
        assert!(!Row { ours: f64::NAN, ..row }.holds());
    }
}
