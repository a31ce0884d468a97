//! Units of lengths as files write them.

use gdal::spatial_ref::SpatialRef;

/// Metres in a unit of length, whatever the case of its letters; `None`: it is none that is known.
pub fn metres_in(unit: &str) -> Option<f64> {
    let plain: String = unit.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
    Some(match plain.as_str() {
        "m" | "metre" | "metres" | "meter" | "meters" => 1.0,
        "km" | "kilometre" | "kilometres" | "kilometer" | "kilometers" => 1000.0,
        "dm" | "decimetre" | "decimetres" | "decimeter" | "decimeters" => 0.1,
        "cm" | "centimetre" | "centimetres" | "centimeter" | "centimeters" => 0.01,
        "mm" | "millimetre" | "millimetres" | "millimeter" | "millimeters" => 0.001,
        "ft" | "foot" | "feet" | "internationalfoot" | "internationalfeet" => 0.3048,
        "usft" | "ftus" | "ussurveyfoot" | "ussurveyfeet" | "surveyfoot" | "surveyfeet" | "footus" | "usfoot"
        | "usfeet" => 1200.0 / 3937.0,
        "yd" | "yard" | "yards" => 0.9144,
        "mi" | "mile" | "miles" => 1609.344,
        _ => return None,
    })
}

/// The unit of heights of a compound coordinate system; where a file keeps no more of it than its name, as in
/// `… + NAVD88 height (ft)`, the unit of the name.
pub fn height_unit_m(crs: &SpatialRef) -> Option<f64> {
    if crs.is_compound() {
        return crs.get_attr_value("VERT_CS|UNIT", 1).ok().flatten()?.parse().ok();
    }
    let name = crs.name()?;
    let (_, unit) = name.split_once("height (")?;
    metres_in(unit.split_once(')')?.0)
}

/// Shares of 1 in a unit of a share.
pub fn shares_in(unit: &str) -> Option<f64> {
    match unit.trim().to_lowercase().as_str() {
        "1" | "unitless" | "dimensionless" | "reflectance" | "albedo" | "i/f" | "fraction" | "ratio" => Some(1.0),
        "%" | "percent" => Some(0.01),
        _ => None,
    }
}

/// What is written where nothing is known.
pub fn says_nothing(unit: &str) -> bool {
    let plain = unit.trim().to_lowercase();
    ["", "-", "none", "n/a", "null", "unknown", "unspecified", "user_z_unit"].contains(&plain.as_str())
}

/// What the key `unit` may be.
pub const LENGTHS: &str = "m, km, dm, cm, mm, ft, us-ft, yd, mi";
pub const SHARES: &str = "1, %";

#[cfg(test)]
mod tests {
    use super::*;

    /// NIST SP 811, appendix B.
    #[test]
    fn units_are_read_in_any_case() {
        for (unit, expected) in
            [("M", 1.0), ("Metre", 1.0), ("KILOMETER", 1e3), ("Km", 1e3), ("foot", 0.3048), ("FT", 0.3048)]
        {
            assert_eq!(metres_in(unit), Some(expected), "{unit}");
        }
        for unit in ["US survey foot", "us-ft", "ftUS", "Foot_US"] {
            assert!((metres_in(unit).unwrap() - 0.304_800_609_601_219).abs() < 1e-15, "{unit}");
        }
        assert_eq!([metres_in("degree"), metres_in("furlong"), metres_in("")], [None; 3]);
        assert_eq!((shares_in("Percent"), shares_in("m")), (Some(0.01), None));
    }
}
