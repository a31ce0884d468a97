//! Which of the names that are allowed somebody meant.

/// What other programs and people call keys and variants, beginning with the name that is meant here.
const ALSO: [&[&str]; 25] = [
    &["range_au", "distance_au", "distance", "sun_distance_au"],
    &[
        "field_of_view_deg",
        "fov",
        "fov_deg",
        "fovx",
        "fovy",
        "hfov",
        "hfov_deg",
        "field_of_view",
        "view_angle",
        "angle_deg",
    ],
    &["focal_length_mm", "f", "focal", "focal_length", "focal_mm", "efl"],
    &["pixel_pitch_um", "pixel_size", "pixel_size_um", "pitch", "pitch_um"],
    &["columns", "width", "cols", "samples", "x", "resolution", "size", "image_size"],
    &["rows", "height", "lines", "y"],
    &["exposure_s", "exposure", "exposure_time", "exposure_time_s", "integration_time_s", "shutter_s", "exposure_ms"],
    &["latitude_deg", "lat", "latitude", "lat_deg"],
    &["longitude_deg", "lon", "lng", "longitude", "lon_deg", "long"],
    &["height_m", "altitude", "altitude_m", "alt", "alt_m", "elevation_m", "h", "height"],
    &["posting_m", "resolution", "resolution_m", "gsd", "gsd_m", "cell_size", "pixel_size_m", "spacing"],
    &["extent_m", "size_m", "width_m", "side_m"],
    &["planes", "channels", "layers", "bands", "outputs", "quantities"],
    &["towards", "target", "look_at", "lookat", "at", "direction", "pointing", "mode"],
    &["samples_per_pixel", "spp", "samples", "rays_per_pixel", "oversampling", "antialiasing"],
    &["photometry", "brdf", "reflectance", "law", "material", "model"],
    &["terrain", "dem", "dems", "dtm", "surface_model", "topography"],
    &["dems", "files", "models", "layers", "dem"],
    &["trajectory", "orbit", "path", "position", "ephemeris", "spacecraft"],
    &["kernels", "spice", "spice_kernels", "metakernel", "meta_kernel"],
    &["exposures", "epochs", "times", "time", "epoch", "frames", "images"],
    &["f_number", "fnumber", "aperture", "f_stop", "fstop"],
    &["quantum_efficiency", "qe", "efficiency"],
    &["full_well_e", "full_well", "well_depth", "saturation"],
    &["azimuth_deg", "azimuth", "az", "az_deg"],
];

/// The name that is nearest: by what it is also called, by its words, by its letters, in this order.
pub fn near(name: &str, allowed: &[String]) -> Option<String> {
    let lower = name.to_lowercase();
    let is_allowed = |meant: &&str| allowed.iter().any(|other| other == meant);
    let also = ALSO.iter().filter(|names| names[1..].contains(&lower.as_str())).map(|names| names[0]).find(is_allowed);
    let distance = |other: &String| edit_distance(&lower, &other.to_lowercase());
    let best = allowed.iter().min_by_key(|other| distance(other))?;
    let close = distance(best) <= name.chars().count().div_ceil(3);
    if close && distance(best) <= 1 {
        return Some(best.clone());
    }
    also.map(String::from).or_else(|| by_words(&lower, allowed)).or_else(|| close.then(|| best.clone()))
}

/// The only name that has all the words of another, or all of whose words it has: `sun_azimuth` for `sun_azimuth_deg`.
fn by_words(name: &str, allowed: &[String]) -> Option<String> {
    let words = |text: &str| text.to_lowercase().split('_').map(String::from).collect::<Vec<_>>();
    let own = words(name);
    let holds = |all: &[String], some: &[String]| some.iter().all(|word| all.contains(word));
    let mut found = allowed.iter().filter(|other| {
        let others = words(other);
        own.iter().any(|word| word.len() > 2) && (holds(&others, &own) || (others.len() > 1 && holds(&own, &others)))
    });
    let first = found.next()?;
    found.next().is_none().then(|| first.clone())
}

/// Levenshtein's distance: how many letters to insert, drop or change.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, char_a) in a.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, char_b) in b.iter().enumerate() {
            let change = diagonal + usize::from(char_a != *char_b);
            diagonal = row[j + 1];
            row[j + 1] = change.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meant(name: &str, allowed: &str) -> Option<String> {
        near(name, &allowed.split(' ').map(String::from).collect::<Vec<_>>())
    }

    const CAMERA: &str =
        "columns rows field_of_view_deg focal_length_mm pixel_pitch_um f_number exposure_s samples_per_pixel";

    #[test]
    fn other_peoples_names_lead_to_ours() {
        for (written, ours) in [
            ("fov_deg", "field_of_view_deg"),
            ("fov", "field_of_view_deg"),
            ("width", "columns"),
            ("spp", "samples_per_pixel"),
            ("exposure_time", "exposure_s"),
            ("focal_length", "focal_length_mm"),
            ("FOV_DEG", "field_of_view_deg"),
            ("colums", "columns"),
        ] {
            assert_eq!(meant(written, CAMERA).as_deref(), Some(ours), "{written}");
        }
        assert_eq!(meant("target", "roll_deg top towards").as_deref(), Some("towards"));
        assert_eq!(meant("sun_azimuth", "sun_azimuth_deg sun_elevation_deg").as_deref(), Some("sun_azimuth_deg"));
    }

    #[test]
    fn what_is_like_nothing_has_no_hint() {
        assert_eq!(meant("banana", CAMERA), None);
        assert_eq!(meant("lat", CAMERA), None);
    }
}
