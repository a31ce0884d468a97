//! Instants as text.
//!
//! An `Epoch` read here counts SI seconds (it is kept in TAI), so that adding a duration crosses a leap second
//! rightly and `23:59:60` is an instant of its own. `hifitime` alone makes it the second before, and skips a
//! second when a duration is added to an epoch kept in UTC.
//!
//! From 1961 to 1971 UTC ran at rates of its own, with steps of parts of a second, and `TAI − UTC` is that of the IERS as
//! in SOFA's `iauDat`; `hifitime` takes UTC for TAI then, 1.4 to 9.9 s off. Before 1961 there is no UTC.
#![warn(missing_docs)]

use hifitime::{Duration, Epoch, TimeScale, Unit};

use super::EphemerisError;

/// Reads a date of the calendar or of the year (`2026-251T…`) with its scale, as `2026-09-08T00:00:00 UTC`,
/// `2026-09-08T00:00:00Z` or `2026-09-08T00:00:00.5 TDB`. Without a scale there is no epoch: UTC and TDB are 69 s apart.
pub fn parse_epoch(text: &str) -> Result<Epoch, EphemerisError> {
    let (date_time, scale) = split_scale(text.trim());
    let problem = |problem| EphemerisError::Epoch { text: text.to_owned(), problem };
    parse_in_scale(date_time, scale.ok_or(problem("the time scale is missing or unknown"))?).map_err(problem)
}

/// Reads a date and time in a scale that stands elsewhere.
pub(super) fn parse_in_scale(date_time: &str, scale: TimeScale) -> Result<Epoch, &'static str> {
    let (date, time) = date_time.split_once(['T', ' ']).unwrap_or((date_time, "00:00:00"));
    let (year, month, day) = parse_date(date)?;
    let (hour, minute, second, nanos) = parse_time(time)?;
    if scale == TimeScale::UTC && year < FIRST_LEAP_SECONDS {
        let offset_s = early_utc_offset_s(year, month, day, [hour, minute, second])?;
        let as_tai = Epoch::maybe_from_gregorian(year, month, day, hour, minute, second, nanos, TimeScale::TAI);
        return Ok(as_tai.map_err(|_| NO_SUCH)? + offset_s * Unit::Second);
    }
    let epoch = Epoch::maybe_from_gregorian(year, month, day, hour, minute, second, nanos, scale)
        .map_err(|_| NO_SUCH)?
        .to_time_scale(TimeScale::TAI);
    Ok(if second == 60 { epoch + 1.0 * Unit::Second } else { epoch })
}

const NO_SUCH: &str = "there is no such date or time";

/// From this year on UTC and TAI are whole seconds apart.
const FIRST_LEAP_SECONDS: i32 = 1972;

/// `TAI − UTC` before there were leap seconds, to the microsecond.
fn early_utc_offset_s(year: i32, month: u8, day: u8, [hour, minute, second]: [u8; 3]) -> Result<f64, &'static str> {
    if year < 1961 {
        return Err("UTC begins in 1961; give an earlier epoch in TT, TAI or TDB");
    }
    let day_share = (f64::from(hour) * 3600.0 + f64::from(minute) * 60.0 + f64::from(second)) / 86400.0;
    sofars::ts::dat(year, month.into(), day.into(), day_share).map_err(|_| NO_SUCH)
}

/// The text before a scale, and the scale.
fn split_scale(text: &str) -> (&str, Option<TimeScale>) {
    let scales = [
        ("Z", TimeScale::UTC),
        (" UTC", TimeScale::UTC),
        (" TDB", TimeScale::TDB),
        (" ET", TimeScale::ET),
        (" TT", TimeScale::TT),
        (" TAI", TimeScale::TAI),
    ];
    let cut = |(suffix, scale)| Some((text.strip_suffix(suffix)?.trim_end(), Some(scale)));
    scales.into_iter().find_map(cut).unwrap_or((text, None))
}

fn parse_date(date: &str) -> Result<(i32, u8, u8), &'static str> {
    let parts: Vec<&str> = date.split('-').collect();
    let number = |part: &str, digits: usize| -> Result<u16, &'static str> {
        let digits = digits_only(part).filter(|part| part.len() == digits);
        digits.and_then(|digits| digits.parse().ok()).ok_or("the date is not YYYY-MM-DD")
    };
    match parts[..] {
        [year, month, day] => Ok((number(year, 4)?.into(), number(month, 2)? as u8, number(day, 2)? as u8)),
        [year, day] => calendar_date(number(year, 4)?.into(), number(day, 3)?),
        _ => Err("the date is not YYYY-MM-DD"),
    }
}

/// Month and day of a day of the year.
fn calendar_date(year: i32, day_of_year: u16) -> Result<(i32, u8, u8), &'static str> {
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let lengths = [31, if leap { 29 } else { 28 }, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut day = day_of_year;
    for (month, length) in (1..).zip(lengths) {
        if (1..=length).contains(&day) {
            return Ok((year, month, day as u8));
        }
        day = day.saturating_sub(length);
    }
    Err("there is no such day of the year")
}

fn parse_time(time: &str) -> Result<(u8, u8, u8, u32), &'static str> {
    const PROBLEM: &str = "the time is not HH:MM:SS";
    let (whole, fraction) = time.split_once('.').unwrap_or((time, ""));
    let fields: Vec<u8> = whole
        .split(':')
        .map(|part| digits_only(part).filter(|part| part.len() == 2).and_then(|part| part.parse().ok()).ok_or(PROBLEM))
        .collect::<Result<_, _>>()?;
    let nanos = match fraction {
        "" => 0,
        _ => format!("{:0<9.9}", digits_only(fraction).ok_or(PROBLEM)?).parse().map_err(|_| PROBLEM)?,
    };
    match fields[..] {
        [hour, minute] if nanos == 0 => Ok((hour, minute, 0, 0)),
        [hour, minute, second] => Ok((hour, minute, second, nanos)),
        _ => Err(PROBLEM),
    }
}

fn digits_only(text: &str) -> Option<&str> {
    (!text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())).then_some(text)
}

/// An instant as `2026-09-08T00:00:00Z`, rounded to milliseconds and with these only where they are not zero.
pub fn utc_text(epoch: Epoch) -> String {
    let (utc, in_leap_second) = utc(epoch.to_time_scale(TimeScale::TAI).round(Duration::from_milliseconds(1.0)));
    let (year, month, day, hour, minute, second, nanos) = utc.to_gregorian_utc();
    let second = if in_leap_second { 60 } else { second };
    let fraction = if nanos == 0 { String::new() } else { format!(".{:03}", nanos / 1_000_000) };
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}{fraction}Z")
}

/// An instant in UTC, and whether it lies in a leap second (then in UTC one second early).
///
/// `hifitime` turns UTC into TAI rightly, but TAI into UTC one second early in the half minute before a leap second.
fn utc(tai: Epoch) -> (Epoch, bool) {
    let utc = tai.to_time_scale(TimeScale::UTC);
    if let Some(offset_s) = early_offset_of_tai_s(tai) {
        return ((utc - offset_s * Unit::Second).round(Duration::from_milliseconds(1.0)), false);
    }
    let late = |utc: Epoch| (tai - utc.to_time_scale(TimeScale::TAI)).to_seconds().round();
    if late(utc) == 0.0 {
        return (utc, false);
    }
    let next = utc + 1.0 * Unit::Second;
    if late(next) == 0.0 { (next, false) } else { (utc, true) }
}

/// `TAI − UTC` at an instant before there were leap seconds, where the two differ by a drift of 3 ms a day.
fn early_offset_of_tai_s(tai: Epoch) -> Option<f64> {
    let offset_s = |as_utc: Epoch| {
        let (year, month, day, hour, minute, second, _) = as_utc.to_gregorian(TimeScale::TAI);
        let early = (1961..FIRST_LEAP_SECONDS).contains(&year);
        early.then(|| early_utc_offset_s(year, month, day, [hour, minute, second]).ok()).flatten()
    };
    // The first guess is off by the offset itself, which is worth 0.3 µs of drift.
    offset_s(tai - offset_s(tai)? * Unit::Second)
}

/// TDB seconds past J2000 as text in UTC, for coverage.
pub(super) fn et_text(et_s: f64) -> String {
    utc_text(Epoch::from_et_seconds(et_s))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hard case 37. The pair of UTC and TDB is from the calendar: TAI - UTC was 31 s, TT - TAI is 32.184 s.
    #[test]
    fn a_leap_second_is_an_instant_of_its_own() {
        let before = parse_epoch("1998-12-31T23:59:59Z").unwrap();
        let leap = parse_epoch("1998-12-31T23:59:60Z").unwrap();
        let after = parse_epoch("1999-01-01T00:00:00Z").unwrap();
        assert_eq!((leap - before).to_seconds(), 1.0);
        assert_eq!((after - leap).to_seconds(), 1.0);
        assert_eq!((after - before).to_seconds(), 2.0);
        let tt = parse_epoch("1999-01-01T00:01:03.184 TT").unwrap();
        assert_eq!((leap - tt).to_seconds(), 0.0);
        for text in ["1998-12-31T23:59:59Z", "1998-12-31T23:59:60Z", "1998-12-31T23:59:60.250Z", "1999-01-01T00:00:00Z"]
        {
            assert_eq!(utc_text(parse_epoch(text).unwrap()), text);
        }
        assert_eq!(utc_text(before + 1.0 * Unit::Second), "1998-12-31T23:59:60Z");
    }

    #[test]
    fn utc_and_tdb_differ_by_69_seconds_since_2017() {
        let difference_s = (parse_epoch("2026-01-01T00:00:00 UTC").unwrap()
            - parse_epoch("2026-01-01T00:00:00 TDB").unwrap())
        .to_seconds();
        // 37 s + 32.184 s, and TDB - TT is at most 1.7 ms.
        assert!((difference_s - 69.184).abs() < 2e-3, "{difference_s} s");
    }

    /// IERS `tai-utc.dat`: from 1968-02-01 `4.2131700 s + (MJD − 39126) 0.002592 s`, from 1961-01-01
    /// `1.4228180 s + (MJD − 37300) 0.001296 s`; MJD 40422 is 1969-07-20. The last minute of 1971 had 0.107758 s more.
    #[test]
    fn utc_before_1972_runs_at_its_own_rate() {
        let offset_s = |text: &str| {
            (parse_epoch(&format!("{text} UTC")).unwrap() - parse_epoch(&format!("{text} TAI")).unwrap()).to_seconds()
        };
        let apollo_11 = 4.213_17 + (40_422.0 + 20.0 / 24.0 - 39_126.0) * 0.002_592;
        assert!((offset_s("1969-07-20T20:00:00") - apollo_11).abs() < 2e-6);
        assert!((offset_s("1961-01-02T00:00:00") - (1.422_818 + 0.001_296)).abs() < 2e-6);
        assert!((offset_s("1972-01-01T00:00:00") - 10.0).abs() < 1e-9);
        for text in ["1969-07-20T20:17:40Z", "1961-03-01T00:00:00Z", "1971-12-31T12:00:00Z", "1966-01-01T00:00:01Z"] {
            assert_eq!(utc_text(parse_epoch(text).unwrap()), text);
        }
        let said = parse_epoch("1959-01-01Z").unwrap_err().to_string();
        assert!(said.contains("UTC begins in 1961"), "{said}");
        assert!(parse_epoch("1959-01-01 TT").is_ok());
    }

    #[test]
    fn a_day_of_the_year_is_a_date() {
        let pairs = [
            ("2024-060T12:00:00Z", "2024-02-29T12:00:00 UTC"),
            ("2025-365Z", "2025-12-31Z"),
            ("2000-001T00:00Z", "2000-01-01Z"),
        ];
        for (ordinal, calendar) in pairs {
            assert_eq!(parse_epoch(ordinal).unwrap(), parse_epoch(calendar).unwrap());
        }
    }

    #[test]
    fn what_is_no_epoch_is_refused() {
        for text in [
            "",
            "nowZ",
            "2026Z",
            "2026-13-01Z",
            "2026-02-30Z",
            "2025-366Z",
            "2026-01-01T25:00:00Z",
            "2026-01-01T00:00:60Z",
            "2026-01-01T0:00:00Z",
            "2026-01-01T00:00:00 XYZ",
            "2026-1-1-1Z",
            "2026-01-01T12:30.5Z",
            "+026-01-01Z",
            "1998-12-31T23:59:61Z",
            "2026-001-01Z",
        ] {
            assert!(parse_epoch(text).is_err(), "{text}");
        }
    }

    /// A scale that is not written is not guessed.
    #[test]
    fn an_epoch_without_its_scale_is_refused() {
        for text in ["2026-01-01T00:00:00", "2026-01-01", "2026-01-01T00:00:00 GPS", "2026-01-01T00:00:00UTC"] {
            let said = parse_epoch(text).unwrap_err().to_string();
            assert!(said.contains("the time scale is missing or unknown"), "{said}");
        }
    }
}
