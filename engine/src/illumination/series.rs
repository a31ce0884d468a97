//! The light of areas, step by step.

/// The light of an area, step by step, each the mean over its nodes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Share of the area that is lit.
    pub lit_share: Vec<f64>,
    /// Share of the Sun's light that is seen.
    pub disc_share: Vec<f64>,
    /// Share of the area that sees the Earth's centre.
    pub earth_share: Vec<f64>,
}

/// Sums over an area's nodes, step by step: lit, share of the disc, Earth in sight.
#[derive(Debug, Clone)]
pub struct Totals(pub [Vec<f64>; 3]);

impl Totals {
    pub fn new(steps: usize) -> Self {
        Self([(); 3].map(|()| vec![0.0; steps]))
    }

    /// Means of the totals of all strips.
    pub fn series<'a>(strips: impl Iterator<Item = &'a Self>, steps: usize, count: f64) -> Series {
        let mut all = Self::new(steps);
        for strip in strips {
            for (sums, more) in all.0.iter_mut().zip(&strip.0) {
                sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
            }
        }
        let [lit_share, disc_share, earth_share] = all.0.map(|sums| sums.iter().map(|sum| sum / count).collect());
        Series { lit_share, disc_share, earth_share }
    }
}
