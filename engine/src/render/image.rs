//! Images as named planes, each with its quantity and unit.
#![warn(missing_docs)]

use serde::{Deserialize, Serialize};

/// What a plane holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Radiance at the pupil, in the camera's band, averaged over the pixel.
    Radiance,
    /// The same per nanometre of the camera's band.
    SpectralRadiance,
    /// Irradiance of the ground facet by the visible part of the solar disc, averaged over the pixel.
    GroundIrradiance,
    /// The same per nanometre of the camera's band.
    SpectralGroundIrradiance,
    /// I/F: `π L / E`, with `E` the irradiance of a plane that faces the Sun.
    RadianceFactor,
    /// Irradiance of the focal plane by the optics.
    FocalPlaneIrradiance,
    /// Digital numbers of the detector, noise included.
    DigitalNumber,
    /// Digital numbers of the same exposure without noise or fixed pattern.
    NoiseFreeDigitalNumber,
    /// Share of the solar disc's light above horizon and facet plane, averaged over the pixel.
    SunFraction,
    /// Standard deviation of that share at the pixel's centre, from the errors of compressed horizons; nothing where there
    /// are none.
    SunFractionSigma,
    /// Share of the pixel covered by the body.
    Hit,
    /// 1 where the pixel's centre sees ground for which no elevation model has heights: a hole, or the sphere beside the
    /// models; 0 elsewhere.
    DemGap,
    /// Distance along the boresight to the ground at the pixel's centre.
    Depth,
    /// Distance to the ground at the pixel's centre.
    Range,
    /// Outward surface normal at the pixel's centre, body-fixed.
    Normal,
    /// Planetographic latitude of the pixel's centre.
    Latitude,
    /// East longitude of the pixel's centre, 0 to 360.
    Longitude,
    /// Height above the reference spheroid at the pixel's centre.
    Height,
    /// Angle of the Sun with the surface normal at the pixel's centre.
    Incidence,
    /// Angle of the camera with the surface normal at the pixel's centre.
    Emission,
    /// Angle between the Sun and the camera at the pixel's centre.
    Phase,
    /// Distance on a plane facing the camera between the pixel's centre and the next column's.
    GroundSampleDistance,
    /// 1 where at least half of the Sun is seen, on average over the pixel, 0 in shadow.
    SunIlluminationMask,
    /// Angle of the Sun with the reference spheroid's normal at the pixel's centre.
    EllipsoidIncidence,
    /// Angle of the camera with the reference spheroid's normal at the pixel's centre.
    EllipsoidEmission,
    /// Angle of the surface normal with up at the pixel's centre.
    Slope,
    /// Azimuth of the way down the slope at the pixel's centre, clockwise from north, 0 to 360.
    Aspect,
    /// Direction of north in the image at the pixel's centre, from right towards down, 0 to 360.
    NorthAzimuth,
    /// Direction of the Sun's azimuth in the image at the pixel's centre, from right towards down, 0 to 360.
    SunAzimuth,
    /// Azimuth of the Sun at the pixel's centre, clockwise from north, 0 to 360.
    SubsolarGroundAzimuth,
    /// Where the ground at the pixel's centre is in the next exposure: columns and rows from here.
    Flow,
    /// 1 where the next exposure sees the ground at the pixel's centre, 0 where it is hidden or off the image.
    Covisible,
    /// Where the ground at the pixel's centre was in the exposure before.
    FlowBack,
    /// 1 where the exposure before sees the ground at the pixel's centre, 0 where it is hidden or off the image.
    CovisibleBack,
    /// 1 where the Sun came since the exposure before, -1 where it went, 0 elsewhere; of a camera that stands still.
    ShadowChange,
    /// Slope of the plane that fits the ground under a lander at the pixel's centre; see `hazards`.
    HazardSlope,
    /// Largest distance of the ground under a lander from that plane.
    HazardRoughness,
    /// Mean share of the Sun's disc that the ground under a lander sees.
    HazardSunlit,
    /// 1 where one of the limits of `hazards` is passed, 0 where a lander may stand.
    Hazard,
    /// Height of made-up ground over the measured at the pixel's centre: of `Detail` in `terrain.dems`; 0 on measured ground.
    InventedHeight,
}

impl Quantity {
    /// All quantities, in the order in which records list them.
    pub const ALL: [Self; 40] = [
        Self::Radiance,
        Self::SpectralRadiance,
        Self::GroundIrradiance,
        Self::SpectralGroundIrradiance,
        Self::RadianceFactor,
        Self::FocalPlaneIrradiance,
        Self::DigitalNumber,
        Self::NoiseFreeDigitalNumber,
        Self::SunFraction,
        Self::SunFractionSigma,
        Self::Hit,
        Self::DemGap,
        Self::Depth,
        Self::Range,
        Self::Normal,
        Self::Latitude,
        Self::Longitude,
        Self::Height,
        Self::Incidence,
        Self::Emission,
        Self::Phase,
        Self::GroundSampleDistance,
        Self::SunIlluminationMask,
        Self::EllipsoidIncidence,
        Self::EllipsoidEmission,
        Self::Slope,
        Self::Aspect,
        Self::NorthAzimuth,
        Self::SunAzimuth,
        Self::SubsolarGroundAzimuth,
        Self::Flow,
        Self::Covisible,
        Self::FlowBack,
        Self::CovisibleBack,
        Self::ShadowChange,
        Self::HazardSlope,
        Self::HazardRoughness,
        Self::HazardSunlit,
        Self::Hazard,
        Self::InventedHeight,
    ];

    /// Names of the channels: ISIS `phocube` names where they exist.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Radiance => &["RADIANCE"],
            Self::SpectralRadiance => &["SPECTRAL_RADIANCE"],
            Self::GroundIrradiance => &["GROUND_IRRADIANCE"],
            Self::SpectralGroundIrradiance => &["SPECTRAL_GROUND_IRRADIANCE"],
            Self::RadianceFactor => &["RADIANCE_FACTOR"],
            Self::FocalPlaneIrradiance => &["FOCAL_PLANE_IRRADIANCE"],
            Self::DigitalNumber => &["DN"],
            Self::NoiseFreeDigitalNumber => &["DN_NOISE_FREE"],
            Self::SunFraction => &["SUN_FRACTION"],
            Self::SunFractionSigma => &["SUN_FRACTION_SIGMA"],
            Self::Hit => &["HIT"],
            Self::DemGap => &["DEM_GAP"],
            Self::Depth => &["DEPTH"],
            Self::Range => &["RANGE"],
            Self::Normal => &["NORMAL.X", "NORMAL.Y", "NORMAL.Z"],
            Self::Latitude => &["LATITUDE"],
            Self::Longitude => &["LONGITUDE"],
            Self::Height => &["HEIGHT"],
            Self::Incidence => &["LOCALINCIDENCE"],
            Self::Emission => &["LOCALEMISSION"],
            Self::Phase => &["PHASE"],
            Self::GroundSampleDistance => &["PIXELRESOLUTION"],
            Self::SunIlluminationMask => &["SUNILLUMINATIONMASK"],
            Self::EllipsoidIncidence => &["INCIDENCE"],
            Self::EllipsoidEmission => &["EMISSION"],
            Self::Slope => &["SLOPE"],
            Self::Aspect => &["ASPECT"],
            Self::NorthAzimuth => &["NORTHAZIMUTH"],
            Self::SunAzimuth => &["SUNAZIMUTH"],
            Self::SubsolarGroundAzimuth => &["SUBSOLARGROUNDAZIMUTH"],
            Self::Flow => &["FLOW.X", "FLOW.Y"],
            Self::Covisible => &["COVISIBLE"],
            Self::FlowBack => &["FLOW_BACK.X", "FLOW_BACK.Y"],
            Self::CovisibleBack => &["COVISIBLE_BACK"],
            Self::ShadowChange => &["SHADOW_CHANGE"],
            Self::HazardSlope => &["HAZARD_SLOPE"],
            Self::HazardRoughness => &["HAZARD_ROUGHNESS"],
            Self::HazardSunlit => &["HAZARD_SUNLIT"],
            Self::Hazard => &["HAZARD"],
            Self::InventedHeight => &["INVENTED_HEIGHT"],
        }
    }

    /// Whether it is counted per nanometre, so that the camera needs a band.
    pub fn is_spectral(self) -> bool {
        matches!(self, Self::SpectralRadiance | Self::SpectralGroundIrradiance)
    }

    /// The unit of its values; `1` for numbers without one.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Radiance => "W m-2 sr-1",
            Self::SpectralRadiance => "W m-2 sr-1 nm-1",
            Self::SpectralGroundIrradiance => "W m-2 nm-1",
            Self::GroundIrradiance | Self::FocalPlaneIrradiance => "W m-2",
            Self::DigitalNumber | Self::NoiseFreeDigitalNumber => "DN",
            Self::RadianceFactor
            | Self::SunFraction
            | Self::SunFractionSigma
            | Self::Hit
            | Self::DemGap
            | Self::Normal
            | Self::SunIlluminationMask
            | Self::Covisible
            | Self::CovisibleBack
            | Self::ShadowChange
            | Self::HazardSunlit
            | Self::Hazard => "1",
            Self::Flow | Self::FlowBack => "px",
            Self::Depth
            | Self::Range
            | Self::Height
            | Self::GroundSampleDistance
            | Self::HazardRoughness
            | Self::InventedHeight => "m",
            Self::Latitude
            | Self::Longitude
            | Self::Incidence
            | Self::Emission
            | Self::Phase
            | Self::EllipsoidIncidence
            | Self::EllipsoidEmission
            | Self::Slope
            | Self::Aspect
            | Self::NorthAzimuth
            | Self::SunAzimuth
            | Self::SubsolarGroundAzimuth
            | Self::HazardSlope => "deg",
        }
    }
}

impl Quantity {
    /// True for planes that belong to the ray through the pixel's centre.
    pub fn is_geometric(self) -> bool {
        use Quantity::*;
        match self {
            Radiance
            | SpectralRadiance
            | GroundIrradiance
            | SpectralGroundIrradiance
            | RadianceFactor
            | FocalPlaneIrradiance
            | DigitalNumber
            | NoiseFreeDigitalNumber
            | SunFraction
            | SunIlluminationMask
            | Hit
            | ShadowChange => false,
            Flow | Covisible | FlowBack | CovisibleBack | HazardSlope | HazardRoughness | HazardSunlit | Hazard
            | InventedHeight => true,
            EllipsoidIncidence
            | EllipsoidEmission
            | Slope
            | Aspect
            | NorthAzimuth
            | SunAzimuth
            | SubsolarGroundAzimuth => true,
            SunFractionSigma | DemGap | Depth | Range | Normal | Latitude | Longitude | Height | Incidence
            | Emission | Phase | GroundSampleDistance => true,
        }
    }
}

impl Quantity {
    /// True for planes that need more than one view, or a lander: the renderers leave them to whoever knows those.
    pub fn is_label(self) -> bool {
        use Quantity::*;
        matches!(
            self,
            Flow | Covisible
                | FlowBack
                | CovisibleBack
                | ShadowChange
                | HazardSlope
                | HazardRoughness
                | HazardSunlit
                | Hazard
                | InventedHeight
        )
    }
}

/// One channel of an image, row by row from the top left. Pixels without a value are NaN.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// What the values are.
    pub quantity: Quantity,
    /// The channel's name in files.
    pub name: &'static str,
    /// Row by row from the top left; NaN where there is no value.
    pub values: Vec<f32>,
}

/// Planes of equal size. Column 0, row 0 is the top left pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Pixels of a row.
    pub columns: usize,
    /// Rows of the image.
    pub rows: usize,
    /// One for each channel of the quantities that were asked for.
    pub planes: Vec<Plane>,
}

impl Image {
    /// The first channel of a quantity.
    pub fn plane(&self, quantity: Quantity) -> Option<&Plane> {
        self.planes.iter().find(|plane| plane.quantity == quantity)
    }
}
