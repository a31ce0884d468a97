//! Numbers as arguments: each has a range, which its error says, before any work.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// What takes a number in a range, both ends included, of a unit.
pub fn number<T>(range: RangeInclusive<T>, unit: &'static str) -> impl Fn(&str) -> Result<T, String> + Clone
where
    T: FromStr + PartialOrd + Display + Clone,
{
    move |text| {
        let wanted = || {
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            format!("want {} to {}{unit}", range.start(), range.end())
        };
        // NaN is in no range.
        text.trim().parse().ok().filter(|number| range.contains(number)).ok_or_else(wanted)
    }
}

/// Distance of nodes or pixels.
pub fn posting(text: &str) -> Result<f64, String> {
    number(0.001..=100_000.0, "m")(text)
}

/// A side, a reach, a size on the ground.
pub fn metres(text: &str) -> Result<f64, String> {
    number(0.001..=10_000_000.0, "m")(text)
}

/// Of an observer above the ground.
pub fn height(text: &str) -> Result<f64, String> {
    number(0.0..=100_000.0, "m")(text)
}

/// Radius of a body.
pub fn radius(text: &str) -> Result<f64, String> {
    number(100.0..=100_000_000.0, "m")(text)
}

/// Azimuths of horizons.
pub fn azimuths(text: &str) -> Result<usize, String> {
    number(4..=3600, "")(text)
}

/// Memory in MiB.
pub fn memory(text: &str) -> Result<usize, String> {
    number(64..=16_777_216, "MiB")(text)
}

/// Places that are compared or chosen.
pub fn places(text: &str) -> Result<usize, String> {
    number(0..=100_000, "")(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_out_of_range_is_refused_with_the_range() {
        for text in ["-1", "0", "1e9", "NaN", "inf", "", "3,5", "0x10"] {
            let error = posting(text).unwrap_err();
            assert_eq!(error, "want 0.001 to 100000 m", "{text}");
        }
        assert_eq!(posting(" 2.5 "), Ok(2.5));
        assert_eq!(azimuths("1000000000").unwrap_err(), "want 4 to 3600");
        assert_eq!((memory("0").is_err(), memory("64")), (true, Ok(64)));
    }
}
