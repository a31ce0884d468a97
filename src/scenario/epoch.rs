//! Instants as text, always with their scale.

use hifitime::Epoch;

/// The epoch of `2026-08-01T00:00:00 UTC`, `2026-08-01T00:00:00Z` or `2026-08-01T00:00:00.5 TDB`.
///
/// Without a scale there is no epoch: UTC and TDB are 69 s apart.
pub fn parse(text: &str) -> Option<Epoch> {
    let text = text.trim();
    let (instant, scale) = match text.strip_suffix('Z') {
        Some(instant) => (instant, "UTC"),
        None => text.rsplit_once(char::is_whitespace)?,
    };
    let (instant, scale) = (instant.trim_end(), scale.trim());
    if !matches!(scale, "UTC" | "TDB") || !is_date_and_time(instant) {
        return None;
    }
    format!("{instant} {scale}").parse().ok()
}

/// `YYYY-MM-DDThh:mm:ss` with any fraction of a second.
fn is_date_and_time(text: &str) -> bool {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, "0"));
    let pattern = b"0000-00-00T00:00:00";
    whole.len() == pattern.len()
        && whole.bytes().zip(pattern).all(
            |(got, &wanted)| {
                if wanted == b'0' { got.is_ascii_digit() } else { got == wanted }
            },
        )
        && !fraction.is_empty()
        && fraction.bytes().all(|byte| byte.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// TT − UTC = 37 s + 32.184 s since 2017; TDB − TT stays under 2 ms.
    #[test]
    fn utc_and_tdb_are_sixty_nine_seconds_apart() {
        let utc = parse("2026-08-01T00:00:00 UTC").unwrap();
        let tdb = parse("2026-08-01T00:00:00 TDB").unwrap();
        assert!(((utc - tdb).to_seconds() - 69.184).abs() < 2e-3);
        assert_eq!(parse("2026-08-01T00:00:00Z").unwrap(), utc);
    }

    #[test]
    fn an_instant_without_a_scale_or_off_the_calendar_is_refused() {
        for text in [
            "2026-08-01T00:00:00",
            "2026-08-01 00:00:00 UTC",
            "2026-08-01 UTC",
            "2026-02-30T00:00:00 UTC",
            "2026-13-01T00:00:00 UTC",
            "2026-08-01T25:00:00 UTC",
            "2026-08-01T00:00:00 GPS",
            "2026-08-01T00:00:00. UTC",
            "tomorrow UTC",
            "",
        ] {
            assert!(parse(text).is_none(), "{text}");
        }
    }
}
