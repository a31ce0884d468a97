//! What is written down about a run and about each exposure.

use super::capture::CapturedExposure;
use super::names::file_name;
use super::{Error, Prepared, motion, scene, sequence, split};
use crate::dataset::{
    self, BodyRecord, EpochRecord, ExposureMetadata, Input, InputRecords, PoseRecord, QualityRecord, RadiometryRecord,
    Run, SoftwareRecord, SunRecord, SweepRecord, White,
};
use crate::ephemeris::{horizontal, utc_text};
use crate::labels;
use crate::photometry::{Hapke, MultipleScattering, PhaseFunction, Reflectance};
use crate::render::{Image, Quantity, Scene, ViewRays};
use crate::scenario::{Albedo, Point, Preview, Scenario};

/// What the whole sequence is made from.
pub fn run(scenario: &Scenario, prepared: &Prepared, adapter: &str) -> Result<Run, Error> {
    let kernels = prepared.almanac.kernels().iter().map(|kernel| Input {
        role: "kernel".into(),
        name: kernel.name.clone(),
        sha256: kernel.sha256.clone(),
    });
    Ok(Run {
        title: scenario.title.clone(),
        name: scenario.name.clone(),
        scenario: scenario.text.clone(),
        body: body(prepared),
        seed: scenario.seed,
        software: software(adapter),
        inputs: prepared.ground.inputs.iter().cloned().chain(kernels).collect(),
        settings: settings(scenario, prepared)?,
        made_from: made_from(scenario, prepared, adapter),
        draft: scenario.draft,
    })
}

/// What of a run's making is known before the work.
pub fn known_before(scenario: &Scenario) -> serde_json::Value {
    serde_json::json!({ "model": dataset::model(), "draft": scenario.draft, "scenario": scenario.shape() })
}

/// All that shapes the pixels and that the exposures share. Horizon tiles follow from the rest.
fn made_from(scenario: &Scenario, prepared: &Prepared, adapter: &str) -> serde_json::Value {
    let mut all = known_before(scenario);
    let mut files = serde_json::Map::new();
    let inputs = prepared.ground.inputs.iter().filter(|input| input.role != "horizon");
    let kernels = prepared.almanac.kernels().iter().map(|kernel| ("kernel", &kernel.sha256));
    for (role, sha256) in inputs.map(|input| (input.role.as_str(), &input.sha256)).chain(kernels) {
        let count = files.keys().filter(|key| key.starts_with(&format!("{role}["))).count();
        files.insert(format!("{role}[{count}]"), sha256.as_str().into());
    }
    all["files"] = serde_json::Value::Object(files);
    all["adapter"] = adapter.into();
    all["frame"] = prepared.frame.frame_name.as_str().into();
    all["shadow_method"] = prepared.shadows.method.spelling().into();
    all["horizon_band"] =
        motion::band(scenario, &prepared.exposures).ok().flatten().map(|band| format!("{band:?}")).into();
    if let Some(globe) = &prepared.ground.globe {
        all["globe"] = globe.record();
    }
    all
}

fn settings(scenario: &Scenario, prepared: &Prepared) -> Result<serde_json::Value, Error> {
    let mut settings = serde_json::json!({
        "frame": prepared.frame.frame_name,
        "shadows": prepared.shadows.method.spelling(),
        "ambient": scenario.ambient,
        "photometry": photometry(&scene::reflectance(scenario)?),
        "limb_darkening": scene::disk_name(scenario),
        "spectrum": scenario.sun.spectrum,
        "samples_per_pixel": scenario.camera.samples_per_pixel,
        "resampling": prepared.ground.resampling,
    });
    if let Some(globe) = &prepared.ground.globe {
        settings["globe"] = globe.record();
    }
    if let Some(bounce) = scenario.bounce {
        settings["bounce"] = serde_json::json!(bounce);
    }
    if scenario.refine {
        settings["refine"] = true.into();
    }
    if scenario.view_rays != ViewRays::Exact {
        settings["view_rays"] = serde_json::json!(scenario.view_rays);
    }
    if let Some(preset) = scenario.camera.preset {
        settings["camera_preset"] = serde_json::json!({ "name": preset, "figures": preset.text() });
    }
    if let Some(invented) = labels::synthetic_detail(&prepared.ground.surface, sequence::synthetic_levels(scenario)) {
        settings["invented"] = serde_json::json!(invented);
    }
    if let Some(sweep) = &scenario.sweep {
        let values = |point: &Point| point.0.iter().map(|(_, value)| *value).collect::<Vec<f64>>();
        let varied: Vec<&str> =
            sweep.points.iter().take(1).flat_map(|point| &point.0).map(|(key, _)| key.key()).collect();
        let points: Vec<Vec<f64>> = sweep.points.iter().map(values).collect();
        settings["sweep"] = serde_json::json!({ "design": sweep.written.design, "varied": varied, "points": points });
    }
    if let Some(split) = &scenario.split {
        settings["split"] = serde_json::json!(split);
    }
    if let Some(why) = &prepared.shadows.why {
        settings["shadows_chosen"] = why.as_str().into();
    }
    Ok(settings)
}

/// A reflectance law with its parameters, as manifests have it.
fn photometry(law: &Reflectance) -> String {
    match *law {
        Reflectance::Empirical { normal_albedo, disc, phase } => {
            let of = if phase == PhaseFunction::CONSTANT { "Constant" } else { "Moon" };
            format!("{disc:?}, normal_albedo: {normal_albedo:?}, phase_function: {of}")
        }
        Reflectance::LrocNac2019 { scale } => format!("LrocNac2019 {{ scale: {scale:?} }}"),
        Reflectance::Hapke(hapke) => format!("Hapke({})", self::hapke(&hapke)),
    }
}

fn hapke(set: &Hapke) -> String {
    let multiple_scattering = match set.multiple_scattering {
        MultipleScattering::Hapke1981 => "Hapke1981",
        MultipleScattering::Hapke2002 => "Hapke2002",
    };
    format!(
        "Hapke {{ single_scattering_albedo: {:?}, asymmetry: {:?}, backscatter: {:?}, shadow_hiding_amplitude: {:?}, \
         shadow_hiding_width: {:?}, coherent_amplitude: {:?}, coherent_width: {:?}, mean_slope_rad: {:?}, filling_factor: {:?}, \
         multiple_scattering: {multiple_scattering}, scale: {:?} }}",
        set.single_scattering_albedo,
        set.asymmetry,
        set.backscatter,
        set.shadow_hiding_amplitude,
        set.shadow_hiding_width,
        set.coherent_amplitude,
        set.coherent_width,
        set.mean_slope_rad,
        set.filling_factor,
        set.scale,
    )
}

/// How previews are scaled.
pub fn white(scenario: &Scenario) -> White {
    match scenario.outputs.preview {
        Preview::Auto => White::Auto,
        Preview::White { radiance_w_m2_sr } => White::Radiance(radiance_w_m2_sr),
    }
}

fn horizon_maps(scene: &Scene) -> impl Iterator<Item = &crate::horizon::HorizonMap> {
    scene.shadows.maps().unwrap_or_default().iter().flatten()
}

fn software(adapter: &str) -> SoftwareRecord {
    SoftwareRecord {
        version: env!("CARGO_PKG_VERSION").into(),
        commit: dataset::commit(),
        adapter: adapter.into(),
        backend: if adapter.starts_with("reference") { "rust f64".into() } else { "wgpu".into() },
    }
}

fn body(prepared: &Prepared) -> BodyRecord {
    let body = &prepared.frame.body;
    BodyRecord {
        name: body.name.clone(),
        frame: prepared.frame.frame_name.clone(),
        radii_m: [body.equatorial_radius_m, body.equatorial_radius_m, body.polar_radius_m],
    }
}

/// What is known of exposure `index`.
pub fn facts(
    prepared: &Prepared,
    scene: &Scene,
    run: &Run,
    index: usize,
    image: &Image,
    captured: &CapturedExposure,
) -> ExposureMetadata {
    let exposure = &prepared.exposures[index];
    let scenario = &prepared.points[exposure.point];
    ExposureMetadata {
        frame_id: format!("{}/{index:04}", scenario.name),
        sweep: prepared.sweep.as_ref().map(|sweep| SweepRecord {
            point: exposure.point,
            values: sweep.points[exposure.point]
                .0
                .iter()
                .map(|(varied, value)| (varied.key().into(), *value))
                .collect(),
        }),
        draft: scenario.draft,
        split: scenario.split.as_ref().map(|split| split::part(split, scene, &exposure.view)),
        epoch: EpochRecord { tdb_s_past_j2000: exposure.epoch.to_et_seconds(), utc: utc_text(exposure.epoch) },
        body: run.body.clone(),
        camera: super::camera_record::camera(scenario, prepared, scene, captured, exposure),
        pose: pose(prepared, index, captured),
        sun: sun(scenario, prepared, index),
        radiometry: RadiometryRecord {
            unit: Quantity::Radiance.unit().into(),
            spectrum: scenario.sun.spectrum.clone(),
            irradiance_1au_w_m2: scenario.sun.irradiance_w_m2,
            irradiance_w_m2: exposure.view.lights[0].irradiance_w_m2,
            band_nm: scenario.band.as_ref().map(|band| band.response.range_nm()),
            response: scenario.band.as_ref().and_then(|band| band.path.as_deref()).map(file_name),
            band_width_nm: scenario.band.as_ref().map(|band| band.width_nm),
            mean_wavelength_nm: scenario.band.as_ref().map(|band| band.wavelength_nm),
        },
        sensor: super::camera_record::sensor(scenario, captured),
        inputs: inputs(scenario, run),
        software: run.software.clone(),
        quality: quality(scene, image),
    }
}

fn pose(prepared: &Prepared, index: usize, captured: &CapturedExposure) -> PoseRecord {
    let exposure = &prepared.exposures[index];
    let view = &exposure.view;
    let q = view.camera_from_body.quaternion();
    let place = prepared.frame.body.geodetic_from_position(view.camera_position);
    PoseRecord {
        r_body_fixed_m: view.camera_position.vector_m().to_array(),
        v_body_fixed_m_s: exposure.velocity_m_s.to_array(),
        q_wxyz: [q.w, q.x, q.y, q.z],
        latitude_deg: place.latitude_rad.to_degrees(),
        longitude_east_deg: place.longitude_east_rad.to_degrees().rem_euclid(360.0),
        height_m: place.height_m,
        rows: super::camera_record::rows(captured),
        ..Default::default()
    }
}

fn sun(scenario: &Scenario, prepared: &Prepared, index: usize) -> SunRecord {
    let sun = &prepared.exposures[index].sun;
    let sky = horizontal(&prepared.frame.body, prepared.ground.centre, sun.direction);
    let terrain = scenario.terrain.is_some();
    let centre = prepared.ground.centre;
    SunRecord {
        direction_body_fixed: sun.direction.unit().to_array(),
        seen_from: format!(
            "the surface at latitude {:.5} deg, longitude {:.5} deg",
            centre.latitude_rad.to_degrees(),
            centre.longitude_east_rad.to_degrees().rem_euclid(360.0)
        ),
        distance_m: sun.distance_m,
        angular_radius_rad: sun.angular_radius_rad,
        azimuth_deg: terrain.then_some(sky.azimuth_rad.to_degrees()),
        elevation_deg: terrain.then_some(sky.elevation_rad.to_degrees()),
        limb_darkening: scene::disk_name(scenario),
        eclipse_share: prepared.exposures[index].eclipse_share,
    }
}

fn inputs(scenario: &Scenario, run: &Run) -> InputRecords {
    let of = |role: &str| run.inputs.iter().filter(move |input| input.role == role).collect::<Vec<_>>();
    let hashes = |role: &str| of(role).iter().map(|input| input.sha256.clone()).collect();
    InputRecords {
        dem_sha256: hashes("dem"),
        horizon_sha256: hashes("horizon"),
        kernels: of("kernel").iter().map(|input| input.name.clone()).collect(),
        albedo: match &scenario.albedo {
            Albedo::Constant(albedo) => format!("constant {albedo}"),
            Albedo::Map(path, _) => file_name(path),
            Albedo::SingleScattering(path, _) => format!("{} (single scattering)", file_name(path)),
        },
    }
}

/// Standard deviation of the Sun's share from which a pixel counts as uncertain.
const UNCERTAIN: f32 = 0.01;

fn quality(scene: &Scene, image: &Image) -> QualityRecord {
    let worst_rad = horizon_maps(scene).map(|map| map.errors.decoded.max_rad).reduce(f64::max);
    QualityRecord {
        max_horizon_error_deg: worst_rad.map(f64::to_degrees),
        share_uncertain: share_above(image, Quantity::SunFractionSigma, UNCERTAIN),
        share_interpolated_dem: share_above(image, Quantity::DemGap, 0.5),
        ..QualityRecord::default()
    }
}

/// Of a plane's pixels that have a value; `None` where the plane is not written.
fn share_above(image: &Image, quantity: Quantity, limit: f32) -> Option<f64> {
    let plane = image.plane(quantity)?;
    let seen = plane.values.iter().filter(|value| value.is_finite()).count().max(1);
    Some(plane.values.iter().filter(|value| **value > limit).count() as f64 / seen as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photometry::DiscFunction;

    #[test]
    fn the_photometry_of_manifests_names_law_albedo_and_phase_function() {
        let minnaert = DiscFunction::Minnaert { exponent: 0.7 };
        let text = "Minnaert { exponent: 0.7 }, normal_albedo: 0.1, phase_function: ";
        assert_eq!(photometry(&Reflectance::empirical(0.1, minnaert)), format!("{text}Constant"));
        assert_eq!(photometry(&Reflectance::lunar(0.1, minnaert).unwrap()), format!("{text}Moon"));
        for hapke in [Reflectance::Hapke(Hapke::moon()), Reflectance::Hapke(Hapke::mars())] {
            assert_eq!(photometry(&hapke), format!("{hapke:?}"));
        }
    }
}
