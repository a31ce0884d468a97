//! Which exposures of a sequence a run renders: `0,12,20`, `0..24`, `0..200..10`.
#![warn(missing_docs)]

use std::fmt;
use std::str::FromStr;

use super::Error;

/// Every `step`-th exposure of `from..until`, counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stride {
    /// The first.
    pub from: usize,
    /// The one before which they end.
    pub until: usize,
    /// From one to the next.
    pub step: usize,
}

/// Some exposures of a sequence; all by default.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Frames(Vec<Stride>);

impl Frames {
    /// Their indices in a sequence of `count` exposures, in order, each once.
    ///
    /// # Errors
    /// A part that is empty or reaches beyond the sequence.
    pub fn indices(&self, count: usize) -> Result<Vec<usize>, Error> {
        let is_outside = |stride: &&Stride| stride.from >= stride.until || stride.until > count;
        if let Some(outside) = self.0.iter().find(is_outside) {
            return Err(Error::NoSuchExposures { frames: outside.to_string(), count });
        }
        let mut indices: Vec<usize> = match self.0.is_empty() {
            true => (0..count).collect(),
            false => self.0.iter().flat_map(|stride| (stride.from..stride.until).step_by(stride.step)).collect(),
        };
        indices.sort_unstable();
        indices.dedup();
        Ok(indices)
    }
}

impl From<std::ops::Range<usize>> for Frames {
    fn from(range: std::ops::Range<usize>) -> Self {
        Self(vec![Stride { from: range.start, until: range.end, step: 1 }])
    }
}

impl fmt::Display for Stride {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { from, until, step } = self;
        match step {
            1 if from + 1 == *until => write!(f, "{from}"),
            1 => write!(f, "{from}..{until}"),
            _ => write!(f, "{from}..{until}..{step}"),
        }
    }
}

impl FromStr for Frames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let want = || format!("want exposures as in 0,12,20 or 0..24 or 0..200..10 (first, end, step), got {text}");
        let number = |part: &str| part.trim().parse::<usize>().map_err(|_| want());
        let stride = |part: &str| match part.split("..").collect::<Vec<_>>()[..] {
            [alone] => {
                let from = number(alone)?;
                Ok(Stride { from, until: from.saturating_add(1), step: 1 })
            }
            [from, until] => Ok(Stride { from: number(from)?, until: number(until)?, step: 1 }),
            [from, until, step] => {
                let step = number(step)?;
                if step == 0 { Err(want()) } else { Ok(Stride { from: number(from)?, until: number(until)?, step }) }
            }
            _ => Err(want()),
        };
        text.split(',').map(stride).collect::<Result<_, _>>().map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(text: &str) -> Vec<usize> {
        text.parse::<Frames>().unwrap().indices(30).unwrap()
    }

    #[test]
    fn lists_ranges_and_strides_may_be_mixed() {
        assert_eq!(chosen("20,0, 12"), [0, 12, 20]);
        assert_eq!(chosen("3..6"), [3, 4, 5]);
        assert_eq!(chosen("0..20..5,10..12"), [0, 5, 10, 11, 15]);
        assert_eq!(Frames::default().indices(3).unwrap(), [0, 1, 2]);
    }

    #[test]
    fn what_is_no_choice_is_refused_and_what_is_outside_named() {
        for text in ["", "a", "1..2..0", "1..2..3..4", "-1", "1..", "1,,2"] {
            assert!(text.parse::<Frames>().is_err(), "{text}");
        }
        for (text, named) in [("5..31", "5..31"), ("3..3", "3..3"), ("1,30", "30"), ("9..4..2", "9..4..2")] {
            let error = text.parse::<Frames>().unwrap().indices(30).unwrap_err().to_string();
            assert_eq!(error, format!("{named} names no exposure; the scenario has 30, counted from 0"));
        }
        let far = "18446744073709551615".parse::<Frames>().unwrap();
        assert!(far.indices(30).is_err());
    }
}
