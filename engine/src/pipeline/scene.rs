//! From the scenario's camera, Sun and surface to what a renderer reads.

use std::path::Path;

use super::Error;
use crate::camera::{Camera as Optics, Detector, Distortion, Kernel, Pose, Psf};
use crate::horizon::{self, HorizonMap};
use crate::photometry::{Hapke, LimbDarkening, Reflectance, SolarDisk, VISIBLE_NM};
use crate::raster::Picture;
use crate::render::{self, AlbedoRole, Imaging, Light, Timing, View};
use crate::scenario::{Albedo, Ambient, LimbDarkened, LimbLaw, Photometry, Scenario, Sky};
use crate::shadow::multiscale::Multiscale;
use crate::shadow::sky::{self, AllRound, FromMaps, Harmonic};
use crate::terrain::{Face, Surface};

/// Pitch of the detector's pixels where the scenario gives a field of view only.
const DEFAULT_PIXEL_PITCH_M: f64 = 5e-6;

/// Those of one exposure: of a scanner, its line or framelet.
pub fn optics(scenario: &Scenario) -> Result<Optics, Error> {
    let camera = &scenario.camera;
    let [column, row] = camera.principal_point_px;
    if let Some(isd) = &camera.isd {
        let optics = isd.camera.optics.clone().with_lens(camera.f_number, camera.transmission)?;
        return Ok(optics.with_vignetting(camera.vignetting)?);
    }
    let rows = camera.shutter.exposed_rows(camera.rows);
    let optics = Optics::pinhole(camera.columns, rows, glam::DVec2::splat(camera.focal_length_px))?
        .with_principal_point(glam::DVec2::new(column, row) - 0.5)
        .with_lens(camera.f_number, camera.transmission)?
        .with_vignetting(camera.vignetting)?;
    Ok(match (&camera.distortion, camera.correction) {
        (None, None) => optics,
        (None, Some(correction)) => optics.with_correction(correction)?,
        (Some(written), _) => optics.with_distortion(Distortion {
            radial: [written.k1, written.k2, written.k3, 0.0, 0.0, 0.0],
            tangential: [written.p1, written.p2],
        })?,
    })
}

/// When the camera's poses are asked for.
pub fn timing(scenario: &Scenario) -> Timing {
    let camera = &scenario.camera;
    Timing { rows: camera.rows, shutter: camera.shutter, moments: camera.moments as usize }
}

/// Of the horizons that a scenario asks for.
pub fn horizon_settings(scenario: &Scenario) -> horizon::Settings {
    horizon::Settings {
        azimuths: scenario.horizon.azimuths as usize,
        search_m: scenario.horizon.search_m,
        observer_height_m: scenario.horizon.observer_height_m,
        ..Default::default()
    }
}

/// What a scenario's camera sees from a pose.
pub fn view(scenario: &Scenario, pose: Pose, lights: Vec<Light>) -> Result<View, Error> {
    Ok(View {
        reflectance: reflectance(scenario)?,
        samples_per_side: scenario.camera.samples_per_pixel.isqrt() as usize,
        band_width_nm: scenario.band.as_ref().map(|band| band.width_nm),
        detector: detector(scenario)?,
        quantities: scenario.outputs.planes.clone(),
        ..View::new(pose, optics(scenario)?, lights)
    })
}

/// What the camera does beyond a pinhole that stands still.
pub fn imaging(scenario: &Scenario) -> Result<Imaging, Error> {
    let camera = &scenario.camera;
    let kernel = camera.kernel.as_deref().map(kernel).transpose()?;
    let blurs = !camera.spreads.is_empty() || kernel.is_some();
    let side = camera.samples_per_pixel.isqrt() as usize;
    let psf = blurs.then(|| Psf::new(&camera.spreads, kernel.as_ref(), side)).transpose()?;
    Ok(Imaging { timing: timing(scenario), psf })
}

/// A measured kernel from an image or from numbers in lines.
fn kernel(path: &Path) -> Result<Kernel, Error> {
    let is_text = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
    let (columns, rows, values) = if is_text {
        numbers(path)?
    } else {
        let picture = Picture::open(path, None)?;
        (picture.columns, picture.rows, picture.values.into_iter().map(f64::from).collect())
    };
    Ok(Kernel::new(columns, rows, &values)?)
}

/// Lines of numbers with commas between them; lines that begin with # are comments.
fn numbers(path: &Path) -> Result<(usize, usize, Vec<f64>), Error> {
    let text = crate::text::read(path).map_err(|source| Error::UnreadableKernel { path: path.into(), source })?;
    let mut table: Vec<Vec<f64>> = Vec::new();
    for (index, line) in text.lines().enumerate().filter(|(_, line)| !line.is_empty() && !line.starts_with('#')) {
        let error = |got: &str| Error::KernelLine { path: path.into(), line: index + 1, got: got.into() };
        let number = |cell: &str| cell.trim().parse().map_err(|_| error(cell));
        let row = line.split(',').map(number).collect::<Result<Vec<f64>, _>>()?;
        if table.first().is_some_and(|first| first.len() != row.len()) {
            return Err(error(line));
        }
        table.push(row);
    }
    Ok((table.first().map_or(0, Vec::len), table.len(), table.concat()))
}

pub fn detector(scenario: &Scenario) -> Result<Option<Detector>, Error> {
    let camera = &scenario.camera;
    let Some(written) = &scenario.detector else { return Ok(None) };
    let detector = Detector {
        exposure_s: camera.exposure_s,
        pixel_pitch_m: camera.pixel_pitch_m.unwrap_or(DEFAULT_PIXEL_PITCH_M),
        wavelength_m: scenario.band.as_ref().map_or(VISIBLE_NM, |band| band.wavelength_nm) * 1e-9,
        quantum_efficiency: written.quantum_efficiency,
        dark_current_e_s: written.dark_current_e_per_s,
        read_noise_e: written.read_noise_e,
        full_well_e: written.full_well_e,
        gain_dn_e: 1.0 / written.gain_e_per_dn,
        offset_dn: written.offset_dn,
        bits: written.bits,
        prnu: written.prnu,
        dsnu_e: written.dsnu_e,
        blooming: written.blooming,
        seed: scenario.seed,
    };
    detector.check()?;
    Ok(Some(detector))
}

pub fn disk(scenario: &Scenario) -> Result<SolarDisk, Error> {
    Ok(SolarDisk::new(limb_darkening(scenario)?)?)
}

pub fn limb_darkening(scenario: &Scenario) -> Result<LimbDarkening, Error> {
    let law = match scenario.sun.limb_darkening {
        None => LimbDarkening::Uniform,
        Some(LimbDarkened { law: LimbLaw::HestrofferMagnan, wavelength_m }) => {
            LimbDarkening::hestroffer_magnan(wavelength_m * 1e9)?
        }
        Some(LimbDarkened { law: LimbLaw::NeckelLabs, wavelength_m }) => {
            LimbDarkening::neckel_labs(wavelength_m * 1e9)?
        }
    };
    Ok(law)
}

/// The limb-darkening law in words, for records.
pub fn disk_name(scenario: &Scenario) -> String {
    match scenario.sun.limb_darkening {
        None => "uniform".into(),
        Some(LimbDarkened { law, wavelength_m }) => {
            let who = match law {
                LimbLaw::HestrofferMagnan => "Hestroffer & Magnan 1998",
                LimbLaw::NeckelLabs => "Neckel & Labs 1994",
            };
            format!("{who} at {:.0} nm", wavelength_m * 1e9)
        }
    }
}

/// Albedo of the law that an albedo map scales: any value within all laws' domains serves.
const SCALED_ALBEDO: f64 = 0.1;

/// What a value of the albedo map multiplies the reflectance by: it is the normal albedo of an empirical law, and
/// a factor on those of Hapke and LROC.
pub fn albedo_scale(scenario: &Scenario) -> f64 {
    if scenario.photometry.is_absolute() { 1.0 } else { 1.0 / SCALED_ALBEDO }
}

pub fn albedo_role(scenario: &Scenario) -> AlbedoRole {
    match scenario.albedo {
        Albedo::SingleScattering(..) => AlbedoRole::SingleScattering,
        Albedo::Constant(_) | Albedo::Map(..) => AlbedoRole::Factor,
    }
}

pub fn reflectance(scenario: &Scenario) -> Result<Reflectance, Error> {
    let constant = match &scenario.albedo {
        Albedo::Constant(albedo) => Some(*albedo),
        Albedo::Map(..) | Albedo::SingleScattering(..) => None,
    };
    let scale = constant.unwrap_or(1.0);
    let reflectance = match scenario.photometry {
        Photometry::Empirical { disc, phase } => {
            Reflectance::Empirical { normal_albedo: constant.unwrap_or(SCALED_ALBEDO), disc, phase }
        }
        Photometry::LrocNac2019 => Reflectance::LrocNac2019 { scale },
        Photometry::Hapke(set) => Reflectance::Hapke(Hapke { scale, ..set }),
    };
    reflectance.check()?;
    Ok(reflectance)
}

/// Azimuths in which horizon maps are summed over the sky: twice their harmonics.
const SKY_AZIMUTHS: usize = 32;

/// The ambient light that the scenario asks for; `maps` are horizon maps by face and level.
pub fn ambient(scenario: &Scenario, surface: &Surface, maps: &[Vec<HorizonMap>]) -> Option<render::Ambient> {
    let Ambient { radiance_w_m2_sr, sky } = scenario.ambient?;
    let sky: Box<dyn AllRound> = match sky {
        Sky::Horizons => Box::new(FromMaps { maps, azimuths: SKY_AZIMUTHS }),
        Sky::Multiscale { level_step, level_offset, azimuths } => {
            let multiscale = Multiscale::new(&surface.terrain, level_step, level_offset, 0.0);
            Box::new(Harmonic::new(multiscale, azimuths as usize))
        }
    };
    let of_face = |(face, levels): (usize, &Face)| {
        (0..levels.levels.len()).map(|level| sky::shares(surface, [face, level], sky.as_ref())).collect()
    };
    let shares = surface.terrain.faces.iter().enumerate().map(of_face).collect();
    Some(render::Ambient { radiance_w_m2_sr, shares })
}
