//! Planes as one FITS file: an image extension of 32-bit floats each.
//!
//! The primary unit holds no pixels but what holds for all of them: `DATE-OBS` and `DATE-AVG` (UTC, start and middle of the
//! exposure), `EXPTIME` in seconds, `OBJECT`, camera, pose, Sun and kernels. Every extension is named after its channel (`EXTNAME`) and states its
//! unit (`BUNIT`, absent for pure numbers).
//!
//! # Conventions
//! Row 1 of the file is the *top* row of the image (`ROWORDER = 'TOP-DOWN'`), so that arrays index as in every other format
//! here; viewers that know nothing of the keyword show the image upside down. Pixel coordinates count from 0 as elsewhere
//! here, not from FITS's 1. Text is ASCII: other letters become `?`.
//!
//! # References
//! FITS Standard 4.0 (IAU FITS Working Group 2018), chapters 3, 4 and 7; long strings: 4.2.1.2.

use hifitime::Unit;

use super::record::ExposureMetadata;
use crate::ephemeris::{parse_epoch, utc_text};
use crate::render::{Image, Plane};

const BLOCK_BYTES: usize = 2880;
const CARD_BYTES: usize = 80;
/// Letters of a string in one card, without the quotes and the `&` that continues it.
const TEXT_LETTERS: usize = 67;

/// The bytes of a file with the planes of `image`; the header tells `facts` and the key of the run.
pub fn encode(image: &Image, facts: &ExposureMetadata, run_key: &str) -> Vec<u8> {
    let mut bytes = primary(facts, run_key).finish();
    for plane in &image.planes {
        bytes.extend(extension(image, plane).finish());
        bytes.extend(plane.values.iter().flat_map(|value| value.to_be_bytes()));
        bytes.resize(bytes.len().next_multiple_of(BLOCK_BYTES), 0);
    }
    bytes
}

fn primary(facts: &ExposureMetadata, run_key: &str) -> Header {
    let ExposureMetadata { epoch, body, camera, pose, sun, sensor, software, inputs, .. } = facts;
    let mut header = Header::default();
    header.truth("SIMPLE", true);
    header.integers(&[("BITPIX", 8), ("NAXIS", 0)]);
    header.truth("EXTEND", true);
    header.text("ORIGIN", &format!("perilune {}", software.version), "");
    header.text("FRAMEID", &facts.frame_id, "");
    header.text("RUNKEY", run_key, "SHA-256 of all that shapes the run");
    header.text("OBJECT", &body.name, "");
    header.text("DATE-OBS", start_utc(&epoch.utc, sensor.exposure_s).trim_end_matches('Z'), "start of the exposure");
    header.text("DATE-AVG", epoch.utc.trim_end_matches('Z'), "middle of the exposure");
    header.text("TIMESYS", "UTC", "");
    header.number("TDB-J2K", epoch.tdb_s_past_j2000, "[s] TDB past J2000, middle of the exposure");
    header.number("EXPTIME", sensor.exposure_s, "[s]");
    header.text("BODYFRAM", &body.frame, "body-fixed frame of all vectors");
    header.text("INSTRUME", &camera.model, "");
    let [[fx, _, cx], [_, fy, cy], _] = camera.k;
    for (key, value, comment) in [
        ("FOCAL-X", fx, "[pix]"),
        ("FOCAL-Y", fy, "[pix]"),
        ("CENTRE-X", cx, "[pix] centre of the top left pixel is (0, 0)"),
        ("CENTRE-Y", cy, "[pix]"),
    ] {
        header.number(key, value, comment);
    }
    for (index, value) in (1..).zip(&camera.dist_coeffs) {
        header.number(&format!("DIST{index}"), *value, &camera.dist_model);
    }
    for (axis, index) in ["X", "Y", "Z"].into_iter().zip(0..) {
        header.number(&format!("POS-{axis}"), pose.r_body_fixed_m[index], "[m] camera from the body's centre");
        header.number(&format!("SUN-{axis}"), sun.direction_body_fixed[index], "unit vector to the Sun");
    }
    for (axis, value) in ["W", "X", "Y", "Z"].into_iter().zip(pose.q_wxyz) {
        header.number(&format!("QUAT-{axis}"), value, "camera from body, Hamilton");
    }
    header.number("SUNDIST", sun.distance_m, "[m]");
    for (index, kernel) in (1..).zip(&inputs.kernels) {
        header.text(&format!("KERNEL{index}"), kernel, "");
    }
    header
}

/// When an exposure begins whose middle is told.
fn start_utc(middle_utc: &str, exposure_s: f64) -> String {
    match parse_epoch(middle_utc) {
        Ok(middle) if exposure_s.is_finite() => utc_text(middle - 0.5 * exposure_s * Unit::Second),
        _ => middle_utc.to_owned(),
    }
}

fn extension(image: &Image, plane: &Plane) -> Header {
    let mut header = Header::default();
    header.text("XTENSION", "IMAGE", "");
    let (columns, rows) = (image.columns as i64, image.rows as i64);
    let sizes = [("BITPIX", -32), ("NAXIS", 2), ("NAXIS1", columns), ("NAXIS2", rows), ("PCOUNT", 0), ("GCOUNT", 1)];
    header.integers(&sizes);
    header.text("EXTNAME", plane.name, "");
    match plane.quantity.unit() {
        "1" => {}
        // What the standard calls digital numbers.
        "DN" => header.text("BUNIT", "adu", ""),
        unit => header.text("BUNIT", unit, ""),
    }
    header.text("ROWORDER", "TOP-DOWN", "row 1 is the top of the image");
    header
}

/// Cards of 80 letters.
#[derive(Default)]
struct Header(String);

impl Header {
    fn card(&mut self, key: &str, value: &str, comment: &str) {
        let comment = if comment.is_empty() { String::new() } else { format!(" / {comment}") };
        let card: String = format!("{key:<8}= {value}{comment}").chars().take(CARD_BYTES).collect();
        self.0.push_str(&format!("{card:<CARD_BYTES$}"));
    }

    fn truth(&mut self, key: &str, value: bool) {
        self.card(key, &format!("{:>20}", if value { "T" } else { "F" }), "");
    }

    fn integers(&mut self, values: &[(&str, i64)]) {
        values.iter().for_each(|(key, value)| self.card(key, &format!("{value:>20}"), ""));
    }

    /// With all its digits. A value that is not finite has no place in FITS: the key is left without one.
    fn number(&mut self, key: &str, value: f64, comment: &str) {
        let text = if value.is_finite() { format!("{value:?}").to_uppercase() } else { String::new() };
        self.card(key, &format!("{text:>20}"), comment);
    }

    /// Quoted, continued over several cards where it is long; only then the comment is dropped.
    fn text(&mut self, key: &str, text: &str, comment: &str) {
        let letters = text.chars().map(|letter| if (' '..='~').contains(&letter) { letter } else { '?' });
        let pieces = pieces(letters);
        let quoted = |index: usize| {
            let more = if index + 1 < pieces.len() { "&" } else { "" };
            format!("'{:<8}'", format!("{}{more}", pieces[index]))
        };
        self.card(key, &quoted(0), if pieces.len() == 1 { comment } else { "" });
        for index in 1..pieces.len() {
            self.0.push_str(&format!("{:<CARD_BYTES$}", format!("CONTINUE  {}", quoted(index))));
        }
    }

    /// The cards, the end and the filling.
    fn finish(mut self) -> Vec<u8> {
        self.0.push_str(&format!("{:<CARD_BYTES$}", "END"));
        let mut bytes = self.0.into_bytes();
        bytes.resize(bytes.len().next_multiple_of(BLOCK_BYTES), b' ');
        bytes
    }
}

/// Text with its quotes doubled, cut so that each piece fits a card and no doubled quote is torn.
fn pieces(letters: impl Iterator<Item = char>) -> Vec<String> {
    let mut pieces = vec![String::new()];
    for letter in letters {
        let written = if letter == '\'' { "''".into() } else { letter.to_string() };
        if pieces.last().map_or(0, String::len) + written.len() > TEXT_LETTERS {
            pieces.push(String::new());
        }
        pieces.last_mut().expect("there is always one").push_str(&written);
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cards(header: Header) -> Vec<String> {
        let bytes = header.finish();
        assert_eq!(bytes.len() % BLOCK_BYTES, 0);
        let text = String::from_utf8(bytes).unwrap();
        let cards = text.as_bytes().chunks(CARD_BYTES).map(|card| String::from_utf8_lossy(card).trim_end().to_owned());
        cards.take_while(|card| card != "END").collect()
    }

    /// The examples of FITS Standard 4.0, sections 4.2.1 to 4.2.4, in fixed format.
    #[test]
    fn cards_are_written_as_in_the_standard() {
        let mut header = Header::default();
        header.truth("SIMPLE", true);
        header.integers(&[("NAXIS", 2)]);
        header.text("AUTHOR", "O'HARA", "");
        header.number("EXPTIME", 0.002, "[s]");
        header.number("BIG", 149_597_870_700.0, "");
        header.number("SMALL", -1.25e-9, "");
        header.number("NONE", f64::NAN, "");
        assert_eq!(
            cards(header),
            [
                "SIMPLE  =                    T",
                "NAXIS   =                    2",
                "AUTHOR  = 'O''HARA '",
                "EXPTIME =                0.002 / [s]",
                "BIG     =       149597870700.0",
                "SMALL   =             -1.25E-9",
                "NONE    =",
            ]
        );
    }

    #[test]
    fn an_exposure_begins_half_its_time_before_its_middle() {
        assert_eq!(start_utc("2026-08-01T00:00:00Z", 60.0), "2026-07-31T23:59:30Z");
        // Across the leap second at the end of 2016.
        assert_eq!(start_utc("2017-01-01T00:00:00Z", 4.0), "2016-12-31T23:59:59Z");
        assert_eq!(start_utc("2026-08-01T00:00:00Z", 0.0), "2026-08-01T00:00:00Z");
    }

    #[test]
    fn long_text_goes_on_in_the_next_card_and_no_quote_is_torn() {
        let mut header = Header::default();
        header.text("TITLE", &format!("{}'{}", "a".repeat(66), "b".repeat(80)), "dropped");
        let cards = cards(header);
        assert_eq!(cards[0], format!("TITLE   = '{}&'", "a".repeat(66)));
        assert_eq!(cards[1], format!("CONTINUE  '''{}&'", "b".repeat(65)));
        assert_eq!(cards[2], format!("CONTINUE  '{}'", "b".repeat(15)));
    }
}
