//! Physical constants, each with its source.
//!
//! Values inside the program are SI with radians. Array planes carry their unit in
//! [`crate::render::image`]; scalars carry it as a suffix of their name.

/// Astronomical unit, exact. IAU 2012 Resolution B2.
pub const ASTRONOMICAL_UNIT_M: f64 = 149_597_870_700.0;

/// Nominal solar radius, exact. IAU 2015 Resolution B3.
pub const SOLAR_RADIUS_M: f64 = 695_700_000.0;

/// Nominal total solar irradiance at 1 au, exact. IAU 2015 Resolution B3.
pub const TOTAL_SOLAR_IRRADIANCE_W_M2: f64 = 1361.0;

/// Speed of light in vacuum, exact. SI.
pub const SPEED_OF_LIGHT_M_S: f64 = 299_792_458.0;

/// Radius of the sphere that lunar heights refer to. LOLA and LROC data product labels; `pck00011.tpc`.
pub const LUNAR_RADIUS_M: f64 = 1_737_400.0;

/// Planck constant, exact. SI.
pub const PLANCK_CONSTANT_J_S: f64 = 6.626_070_15e-34;
