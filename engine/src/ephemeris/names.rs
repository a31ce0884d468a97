//! Names and SPICE ids of bodies and body-fixed frames.
//!
//! # References
//! NAIF, *NAIF Integer ID codes* and *Frames Required Reading*, toolkit N0067; the lunar frames from
//! `moon_080317.tf` and `moon_de440_220930.tf`.

use super::EphemerisError;

/// One frame to CCSDS messages, as in SPICE (EME2000 is 0.02″ off).
pub(super) const INERTIAL_FRAMES: [&str; 3] = ["ICRF", "EME2000", "J2000"];

pub const SUN: i32 = 10;
pub const EARTH: i32 = 399;
pub const MOON: i32 = 301;

const BODIES: [(&str, i32); 23] = [
    ("sun", SUN),
    ("mercury", 199),
    ("venus", 299),
    ("earth", EARTH),
    ("moon", MOON),
    ("mars", 499),
    ("phobos", 401),
    ("deimos", 402),
    ("jupiter", 599),
    ("io", 501),
    ("europa", 502),
    ("ganymede", 503),
    ("callisto", 504),
    ("saturn", 699),
    ("enceladus", 602),
    ("titan", 606),
    ("uranus", 799),
    ("neptune", 899),
    ("triton", 801),
    ("pluto", 999),
    ("charon", 901),
    ("ceres", 2_000_001),
    ("vesta", 2_000_004),
];

/// Centres of mass, of which the kernels' segments speak.
const BARYCENTERS: [(&str, i32); 10] = [
    ("solar system barycenter", 0),
    ("mercury barycenter", 1),
    ("venus barycenter", 2),
    ("earth-moon barycenter", 3),
    ("mars barycenter", 4),
    ("jupiter barycenter", 5),
    ("saturn barycenter", 6),
    ("uranus barycenter", 7),
    ("neptune barycenter", 8),
    ("pluto barycenter", 9),
];

/// A lunar frame of the high-accuracy orientation, and where it comes from.
pub(super) struct LunarFrame {
    pub name: &'static str,
    pub id: i32,
    /// The principal-axis frame that a binary PCK tabulates.
    pub tabulated_id: i32,
    pub kernels: &'static str,
}

/// In order of preference where only `MOON_ME` or `MOON_PA` is asked for.
pub(super) const LUNAR_FRAMES: [LunarFrame; 4] = [
    LunarFrame {
        name: "MOON_ME_DE440_ME421",
        id: 31009,
        tabulated_id: 31008,
        kernels: "moon_pa_de440_200625.bpc and moon_de440_220930.tf (or moon_fk_de440.epa)",
    },
    LunarFrame {
        name: "MOON_ME_DE421",
        id: 31007,
        tabulated_id: 31006,
        kernels: "moon_pa_de421_1900-2050.bpc and moon_080317.tf (or moon_fk_de421.epa)",
    },
    LunarFrame { name: "MOON_PA_DE440", id: 31008, tabulated_id: 31008, kernels: "moon_pa_de440_200625.bpc" },
    LunarFrame { name: "MOON_PA_DE421", id: 31006, tabulated_id: 31006, kernels: "moon_pa_de421_1900-2050.bpc" },
];

/// Id of a body by its name, in any case, or by its id in digits.
pub fn body_id(name: &str) -> Result<i32, EphemerisError> {
    if let Ok(id) = name.parse() {
        return Ok(id);
    }
    let found = BODIES.iter().chain(&BARYCENTERS).find(|(known, _)| known.eq_ignore_ascii_case(name));
    found.map(|(_, id)| *id).ok_or_else(|| EphemerisError::UnknownBody {
        name: name.to_owned(),
        allowed: BODIES.map(|(known, _)| known).join(", "),
    })
}

/// Name of a body, or its id in digits.
pub fn body_name(id: i32) -> String {
    let found = BODIES.iter().chain(&BARYCENTERS).find(|(_, known)| *known == id);
    found.map_or_else(|| id.to_string(), |(name, _)| (*name).to_owned())
}

/// Name of a frame: inertial, `IAU_<BODY>`, lunar, or its id in digits.
pub fn frame_name(id: i32) -> String {
    if let Some(frame) = LUNAR_FRAMES.iter().find(|frame| frame.id == id) {
        return frame.name.to_owned();
    }
    match id {
        1 => "ICRF".to_owned(),
        17 => "ECLIPJ2000".to_owned(),
        _ => match BODIES.iter().find(|(_, known)| *known == id) {
            Some((name, _)) => format!("IAU_{}", name.to_uppercase()),
            None => id.to_string(),
        },
    }
}

/// The ids that a frame's name may mean, the preferred one first.
pub(super) fn frame_ids(name: &str) -> Result<Vec<i32>, EphemerisError> {
    let upper = name.to_uppercase();
    if let Ok(id) = name.parse() {
        return Ok(vec![id]);
    }
    let lunar = || LUNAR_FRAMES.iter();
    let ids: Vec<i32> = match upper.as_str() {
        "MOON_ME" | "MOON_PA" => lunar().filter(|frame| frame.name.starts_with(&upper)).map(|frame| frame.id).collect(),
        _ => match upper.strip_prefix("IAU_") {
            Some(body) => body_id(body).into_iter().collect(),
            None => lunar().filter(|frame| frame.name == upper).map(|frame| frame.id).collect(),
        },
    };
    if ids.is_empty() {
        let allowed = lunar().map(|frame| frame.name).collect::<Vec<_>>().join(", ") + ", MOON_ME, MOON_PA";
        return Err(EphemerisError::UnknownFrame { name: name.to_owned(), allowed });
    }
    Ok(ids)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_ids_name_each_other() {
        for (name, id) in BODIES.into_iter().chain(BARYCENTERS) {
            assert_eq!(body_id(name).unwrap(), id);
            assert_eq!(body_name(id), name);
        }
        assert_eq!(body_id("MARS").unwrap(), 499);
        assert_eq!(body_id("-85").unwrap(), -85);
        assert_eq!(frame_ids("iau_mars").unwrap(), [499]);
        assert_eq!(frame_ids("MOON_ME").unwrap(), [31009, 31007]);
        assert_eq!(frame_name(301), "IAU_MOON");
        assert!(body_id("vulcan").unwrap_err().to_string().contains("allowed are sun, mercury"));
        assert!(frame_ids("IAU_VULCAN").is_err());
    }
}
