//! Known cameras, as pieces of a scenario: each figure stands beside its source in `presets/`.

use serde::Deserialize;

use super::spec::{Camera, Detector, Preset, Spec};

/// What a preset's file holds.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Figures {
    camera: Camera,
    /// Absent where too little is published of it.
    #[serde(default)]
    detector: Option<Detector>,
}

impl Preset {
    pub const ALL: [Self; 6] =
        [Self::LroNac, Self::LroWac, Self::KaguyaTc, Self::ApolloMetric, Self::OsirisRexNavCam, Self::Descent];

    /// Its figures with their sources, in the words of a scenario.
    pub fn text(self) -> &'static str {
        match self {
            Self::LroNac => include_str!("presets/lro_nac.ron"),
            Self::LroWac => include_str!("presets/lro_wac.ron"),
            Self::KaguyaTc => include_str!("presets/kaguya_tc.ron"),
            Self::ApolloMetric => include_str!("presets/apollo_metric.ron"),
            Self::OsirisRexNavCam => include_str!("presets/osiris_rex_navcam.ron"),
            Self::Descent => include_str!("presets/descent.ron"),
        }
    }

    fn figures(self) -> Figures {
        super::text::read(self.text()).expect("presets are read by a test")
    }
}

/// The scenario with its preset's figures where it gives none itself.
pub fn completed(spec: &Spec) -> Spec {
    let Some(preset) = spec.camera.preset else { return spec.clone() };
    let Figures { camera, detector } = preset.figures();
    Spec { camera: completed_camera(&spec.camera, camera), detector: spec.detector.or(detector), ..spec.clone() }
}

fn completed_camera(written: &Camera, known: Camera) -> Camera {
    let given_field = written.field_of_view_deg.is_some() || written.focal_length_mm.is_some();
    let given_lens = written.distortion.is_some() || written.correction.is_some() || given_field;
    let window = |whole: Option<u32>, part: Option<u32>| {
        whole.zip(part).map_or(0.0, |(whole, part)| 0.5 * (f64::from(whole) - f64::from(part)))
    };
    // A window in the middle of the preset's image.
    let principal_point = known.principal_point.map(|point| super::spec::PrincipalPoint {
        column: point.column - window(known.columns, written.columns),
        row: point.row - window(known.rows, written.rows),
    });
    Camera {
        columns: written.columns.or(known.columns),
        rows: written.rows.or(known.rows),
        focal_length_mm: written.focal_length_mm.or(known.focal_length_mm.filter(|_| !given_field)),
        pixel_pitch_um: written.pixel_pitch_um.or(known.pixel_pitch_um),
        principal_point: written.principal_point.or(principal_point),
        distortion: written.distortion.or(known.distortion.filter(|_| !given_lens)),
        correction: written.correction.or(known.correction.filter(|_| !given_lens)),
        vignetting: written.vignetting.or(known.vignetting),
        psf: written.psf.clone().or(known.psf),
        shutter: written.shutter.or(known.shutter),
        band_nm: written.band_nm.or(known.band_nm.filter(|_| written.response.is_none())),
        f_number: written.f_number.or(known.f_number),
        transmission: written.transmission.or(known.transmission),
        exposure_s: written.exposure_s.or(known.exposure_s),
        ..written.clone()
    }
}
