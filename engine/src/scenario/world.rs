//! Resolves body, kernels, terrain and surface.

use super::check::Check;
use super::resolved::{Albedo, Dem, Globe, Horizon, Photometry, Terrain};
use super::spec::{self, Spec};
use crate::ephemeris::KernelSource;
use crate::geometry::{Body, Geodetic};
use crate::horizon::Encoding;
use crate::photometry::{DiscFunction, Hapke, MultipleScattering, PhaseFunction, Reflectance};
use crate::raster::{self, Reading};
use crate::shadow::method::Flaw;

/// Normal albedo of the mean lunar surface at 665 nm: ROLO's disc in opposition (Kieffer & Stone 2005).
const LUNAR_ALBEDO: f64 = 0.19;
/// Normal albedo where nothing makes up for the missing fall of light with the phase angle: ROLO's disc at 10°.
const ALBEDO_WITHOUT_PHASE: f64 = 0.12;

pub fn body(written: &spec::Body) -> Body {
    match written {
        spec::Body::Moon => Body::moon(),
        spec::Body::Mars => Body::mars(),
        spec::Body::Custom { name, naif_id, equatorial_radius_m, polar_radius_m } => Body {
            name: name.clone(),
            naif_id: *naif_id,
            equatorial_radius_m: *equatorial_radius_m,
            polar_radius_m: *polar_radius_m,
        },
    }
}

pub fn frame(spec: &Spec, check: &mut Check) -> Option<String> {
    let known_body = !matches!(spec.body, spec::Body::Custom { .. });
    check.needs(spec.frame.is_some() || known_body, "body", "needs frame, the name of its body-fixed frame");
    let frame = spec.frame.as_deref()?;
    let is_name = |byte: u8| byte.is_ascii_uppercase() || byte.is_ascii_digit() || byte == b'_';
    let named = !frame.is_empty() && frame.bytes().all(is_name);
    check.rule(named, "frame", format!("{frame:?}"), "is not a frame's name, as in MOON_ME_DE440_ME421");
    Some(frame.into())
}

pub fn kernels(written: &[String], check: &mut Check) -> Vec<KernelSource> {
    check.rule(!written.is_empty(), "kernels", "[]", "names no kernel; leave the key out for the shipped ones");
    let mut found = Vec::new();
    for (index, name) in written.iter().enumerate() {
        let key = format!("kernels[{index}]");
        check.rule(!written[..index].contains(name), &key, format!("{name:?}"), "is listed twice");
        found.push(check.kernel(&key, name));
    }
    found
}

pub fn terrain(written: &spec::Terrain, check: &mut Check) -> Terrain {
    let centre = written.centre.map(|place| Geodetic::from_degrees(place.latitude_deg, place.longitude_deg, 0.0));
    let resolved = |(index, dem)| resolved_dem(index, dem, centre, check);
    let dems: Vec<Dem> = written.dems.iter().enumerate().map(resolved).collect();
    finest_first(&dems, check);
    one_synthetic_map(&dems, check);
    detail_of_measured(&dems, check);
    Terrain { centre, dems }
}

fn resolved_dem(index: usize, written: &spec::Dem, centre: Option<Geodetic>, check: &mut Check) -> Dem {
    let dem_key = format!("terrain.dems[{index}]");
    let key = format!("{dem_key}.path");
    let reading = raster_reading(written, &dem_key, check);
    match *written {
        spec::Dem::File { ref path, values, posting_m, extent_m, .. } => {
            Dem::File { path: check.raster(&key, path), reading, values, posting_m, extent_m }
        }
        spec::Dem::Cube { ref path, values, posting_m, .. } => {
            Dem::Cube { path: check.raster(&key, path), reading, values, posting_m }
        }
        spec::Dem::Globe { ref path, values, posting_m, ref tiles, posting_px, most_tiles, .. } => {
            let tiles_key = format!("terrain.dems[{index}].tiles");
            Dem::Globe(Globe {
                path: check.raster(&key, path),
                reading,
                values,
                posting_m,
                tiles: tiles.as_ref().map(|folder| check.folder(&tiles_key, folder)),
                posting_px,
                most_tiles,
            })
        }
        spec::Dem::Detail { posting_m, extent_m, seed, craters, boulders_per_km2 } => {
            Dem::Detail { posting_m, extent_m, centre, seed, craters, boulders_per_km2 }
        }
        spec::Dem::Synthetic { columns, rows, posting_m, latitude_deg, longitude_deg, seed } => Dem::Synthetic {
            columns,
            rows,
            posting_m,
            centre: Geodetic::from_degrees(latitude_deg, longitude_deg, 0.0),
            seed,
        },
    }
}

/// What the user says of a model's file.
fn raster_reading(written: &spec::Dem, key: &str, check: &mut Check) -> Reading {
    let reading = match written.clone() {
        spec::Dem::File { band, nodata, scale, offset, unit, crs, .. }
        | spec::Dem::Cube { band, nodata, scale, offset, unit, crs, .. }
        | spec::Dem::Globe { band, nodata, scale, offset, unit, crs, .. } => {
            Reading { band, nodata, scale, offset, unit, crs }
        }
        spec::Dem::Synthetic { .. } | spec::Dem::Detail { .. } => Reading::default(),
    };
    let known = reading.unit.as_deref().is_none_or(|unit| raster::metres_in(unit).is_some());
    checked_reading(reading, known, raster::LENGTHS, key, check)
}

fn checked_reading(reading: Reading, known: bool, units: &str, key: &str, check: &mut Check) -> Reading {
    let unit = format!("{:?}", reading.unit.as_deref().unwrap_or_default());
    check.rule(known, &format!("{key}.unit"), unit, format!("is none of the units {units}"));
    check.rule(reading.scale != Some(0.0), &format!("{key}.scale"), 0, "makes all values the same");
    reading
}

/// Postings that are given must grow; those of files are checked once the files are open.
fn finest_first(dems: &[Dem], check: &mut Check) {
    let mut finer: Option<(usize, f64)> = None;
    for (index, dem) in dems.iter().enumerate() {
        let key = format!("terrain.dems[{index}]");
        let is_last = index + 1 == dems.len();
        check.needs(is_last || !matches!(dem, Dem::Cube { .. }), &key, "covers the whole body, so it must be the last");
        check.needs(
            dems.len() == 1 || !matches!(dem, Dem::Globe(_)),
            &key,
            "must be the only model: it has all levels",
        );
        let Some(posting_m) = posting_m(dem) else { continue };
        if let Some((earlier, earlier_m)) = finer {
            let rule = format!("is not coarser than the {earlier_m} m of dems[{earlier}]; the finest comes first");
            check.rule(posting_m > earlier_m, &format!("{key}.posting_m"), posting_m, rule);
        }
        finer = Some((index, posting_m));
    }
}

/// Made-up ground comes first, once, and continues a file.
fn detail_of_measured(dems: &[Dem], check: &mut Check) {
    for (index, dem) in dems.iter().enumerate() {
        if matches!(dem, Dem::Detail { .. }) {
            let continues = index == 0 && matches!(dems.get(1), Some(Dem::File { .. }));
            let needs = "must be the first model and be followed by the File that it continues";
            check.needs(continues, &format!("terrain.dems[{index}]"), needs);
        }
    }
}

/// Synthetic models continue each other, so they share a centre and lie inside each other.
fn one_synthetic_map(dems: &[Dem], check: &mut Check) {
    let mut finer: Option<(usize, Geodetic, [f64; 2])> = None;
    for (index, dem) in dems.iter().enumerate() {
        let Dem::Synthetic { columns, rows, posting_m, centre, .. } = *dem else { continue };
        let sides_m = [columns, rows].map(|count| f64::from(count) * posting_m);
        let key = format!("terrain.dems[{index}]");
        if let Some((earlier, its_centre, its_sides_m)) = finer {
            let needs = format!("the centre of dems[{earlier}]: synthetic models continue each other about one centre");
            check.needs(centre == its_centre, &key, needs);
            let holds = sides_m[0] >= its_sides_m[0] && sides_m[1] >= its_sides_m[1];
            check.needs(holds, &key, format!("to be as wide and high as dems[{earlier}], which lies in it"));
        }
        finer = Some((index, centre, sides_m));
    }
}

fn posting_m(dem: &Dem) -> Option<f64> {
    match *dem {
        Dem::File { posting_m, .. } | Dem::Cube { posting_m, .. } => posting_m,
        Dem::Globe(Globe { posting_m, .. }) => posting_m,
        Dem::Synthetic { posting_m, .. } | Dem::Detail { posting_m, .. } => Some(posting_m),
    }
}

/// A globe's tiles stand alone: light that is followed over the ground ends at their sides, horizon maps do not.
pub fn lights_of_globe(spec: &Spec, check: &mut Check) {
    let dems = spec.terrain.as_ref().map_or(&[][..], |terrain| &terrain.dems);
    if !dems.iter().any(|dem| matches!(dem, spec::Dem::Globe { .. })) {
        return;
    }
    let serves = spec.shadows.method().is_none_or(|method| method.serves_globe());
    check.needs(serves, "shadows", "must come from horizon maps, be chosen by Auto, or be none over a Globe");
    check.needs(!spec.refine, "refine", "needs other terrain than a Globe, beyond whose tiles no ray is traced");
    check.needs(
        spec.bounce.is_none(),
        "bounce",
        "needs other terrain than a Globe, beyond whose tiles no light is followed",
    );
}

pub fn horizon(written: &spec::Horizon, check: &mut Check) -> Horizon {
    match *written {
        spec::Horizon::Settings { azimuths, search_m, observer_height_m, encoding, band } => {
            let least = encoding.least_azimuths();
            let rule = format!("is too few for the encoding {encoding}, at least {least} are needed");
            check.rule(azimuths as usize >= least, "horizon.azimuths", azimuths, rule);
            Horizon { azimuths, search_m, observer_height_m, encoding, band }
        }
        spec::Horizon::Auto => Horizon {
            azimuths: spec::DEFAULT_AZIMUTHS,
            search_m: None,
            observer_height_m: 0.0,
            encoding: Encoding::default(),
            band: false,
        },
    }
}

/// The shadows in their current spelling.
pub fn shadows(written: &spec::Shadows, encoding: Encoding, check: &mut Check) -> spec::Shadows {
    if let Some(Flaw { key, got, rule }) = written.method().and_then(|method| method.flaw(encoding)) {
        let key = written.key(key);
        match got {
            Some(got) => check.rule(false, &key, got, rule),
            None => check.needs(false, &key, rule),
        }
    }
    written.current()
}

/// The law of reflection, with the phase function that is written or that the body and the law imply.
pub fn photometry(spec: &Spec, check: &mut Check) -> Photometry {
    use spec::Photometry as Law;
    let photometry = match spec.surface.photometry {
        Law::Lambert => empirical(DiscFunction::Lambert, spec, check),
        Law::LommelSeeliger => empirical(DiscFunction::LommelSeeliger, spec, check),
        Law::LunarLambert => empirical(DiscFunction::LunarLambert, spec, check),
        Law::Minnaert { k } => empirical(DiscFunction::Minnaert { exponent: k }, spec, check),
        Law::Akimov { eta } => empirical(DiscFunction::Akimov { smoothness: eta }, spec, check),
        Law::LrocNac2019 => Photometry::LrocNac2019,
        Law::HapkeMoon => Photometry::Hapke(Hapke::moon()),
        Law::HapkeMars => Photometry::Hapke(Hapke::mars()),
        Law::HapkeMercury => Photometry::Hapke(Hapke::mercury()),
        Law::Hapke { w, b, c, bs0, hs, bc0, hc, theta_bar_deg, phi } => Photometry::Hapke(Hapke {
            single_scattering_albedo: w,
            asymmetry: b,
            backscatter: c,
            shadow_hiding_amplitude: bs0,
            shadow_hiding_width: hs,
            coherent_amplitude: bc0,
            coherent_width: hc,
            mean_slope_rad: theta_bar_deg.to_radians(),
            filling_factor: phi,
            multiple_scattering: MultipleScattering::Hapke2002,
            scale: 1.0,
        }),
    };
    let has_two = photometry.is_absolute() && spec.surface.phase_function.is_some();
    check.needs(!has_two, "surface.phase_function", "needs a model without a phase function of its own");
    photometry
}

fn empirical(disc: DiscFunction, spec: &Spec, check: &mut Check) -> Photometry {
    let lunar = spec.body == spec::Body::Moon && disc != DiscFunction::Lambert;
    let implied = if lunar { spec::PhaseFunction::Moon } else { spec::PhaseFunction::Constant };
    let phase = match spec.surface.phase_function.unwrap_or(implied) {
        spec::PhaseFunction::Constant => PhaseFunction::CONSTANT,
        spec::PhaseFunction::Moon => Reflectance::lunar_phase(disc).unwrap_or_else(|error| {
            check.needs(false, "surface.photometry", error.to_string());
            PhaseFunction::CONSTANT
        }),
    };
    Photometry::Empirical { disc, phase }
}

pub fn albedo(written: &spec::Surface, photometry: &Photometry, check: &mut Check) -> Albedo {
    match &written.albedo {
        None => Albedo::Constant(match photometry {
            Photometry::Hapke(_) | Photometry::LrocNac2019 => 1.0,
            Photometry::Empirical { phase: PhaseFunction::CONSTANT, .. } => ALBEDO_WITHOUT_PHASE,
            Photometry::Empirical { .. } => LUNAR_ALBEDO,
        }),
        Some(spec::Albedo::Constant(value)) => Albedo::Constant(*value),
        Some(written @ spec::Albedo::Map { path, .. }) => {
            Albedo::Map(check.raster("surface.albedo.path", path), albedo_reading(written, check))
        }
        Some(written @ spec::Albedo::SingleScattering { path, .. }) => {
            let is_hapke = matches!(photometry, Photometry::Hapke(_));
            check.needs(is_hapke, "surface.albedo", "needs one of the Hapke models: it is a map of their w");
            Albedo::SingleScattering(check.raster("surface.albedo.path", path), albedo_reading(written, check))
        }
    }
}

fn albedo_reading(written: &spec::Albedo, check: &mut Check) -> Reading {
    let reading = match written.clone() {
        spec::Albedo::Map { band, nodata, scale, offset, unit, crs, .. }
        | spec::Albedo::SingleScattering { band, nodata, scale, offset, unit, crs, .. } => {
            Reading { band, nodata, scale, offset, unit, crs }
        }
        spec::Albedo::Constant(_) => Reading::default(),
    };
    let known = reading.unit.as_deref().is_none_or(|unit| raster::shares_in(unit).is_some());
    checked_reading(reading, known, raster::SHARES, "surface.albedo", check)
}
