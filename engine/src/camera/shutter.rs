//! When each row of an image is exposed.
//!
//! Times count from the image's middle, rows and framelets from the image's top:
//!
//! ```text
//! global       all rows at 0
//! rolling      row r at (r − (rows − 1)/2) τ          each row of the focal plane in its turn
//! line scan    line r at the same                     the focal plane's one row, again and again
//! push frame   framelet k at (k − (count − 1)/2) T    the focal plane's few rows, again and again
//! ```
//!
//! Upwards, the last row is the first in time. Rows that share a pose ([`Shutter::Rolling`]'s `rows_per_pose`) are exposed
//! together in the middle of their times.

use super::{CameraError, check};

/// How an image is put together from exposures.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Shutter {
    #[default]
    Global,
    Rolling {
        line_time_s: f64,
        rows_per_pose: u32,
        upwards: bool,
    },
    LineScan {
        line_time_s: f64,
        upwards: bool,
    },
    PushFrame {
        interval_s: f64,
        framelet_rows: u32,
        upwards: bool,
    },
}

/// Rows of an image that are exposed together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExposedRows {
    /// The first of them, in the optics of one exposure.
    pub first_row: i64,
    pub rows: u32,
    /// From the middle of the image's time to the middle of theirs.
    pub time_s: f64,
}

impl Shutter {
    /// Refuses rows that do not make whole framelets.
    pub fn check(&self, rows: u32) -> Result<(), CameraError> {
        match *self {
            Self::Global => Ok(()),
            Self::Rolling { line_time_s, rows_per_pose, .. } => {
                check("shutter line time", line_time_s, 0.0..=10.0, "[0, 10] s")?;
                check("shutter rows per pose", f64::from(rows_per_pose), 1.0..=65536.0, "[1, 65536]")
            }
            Self::LineScan { line_time_s, .. } => check("shutter line time", line_time_s, 0.0..=10.0, "[0, 10] s"),
            Self::PushFrame { interval_s, framelet_rows, .. } => {
                check("shutter interval", interval_s, 0.0..=1e4, "[0, 1e4] s")?;
                let whole = framelet_rows > 0 && rows.is_multiple_of(framelet_rows);
                if whole { Ok(()) } else { Err(CameraError::Framelets { rows, framelet_rows }) }
            }
        }
    }

    /// Rows of the focal plane that one exposure uses, of an image of `rows`.
    pub fn exposed_rows(&self, rows: u32) -> u32 {
        match *self {
            Self::Global | Self::Rolling { .. } => rows,
            Self::LineScan { .. } => 1,
            Self::PushFrame { framelet_rows, .. } => framelet_rows,
        }
    }

    /// An image's bands, its top first, in pieces within which neighbouring rows see neighbouring ground.
    pub fn pieces(&self, rows: u32) -> Vec<Vec<ExposedRows>> {
        let all = f64::from(rows) - 1.0;
        match *self {
            Self::Global => vec![vec![ExposedRows { first_row: 0, rows, time_s: 0.0 }]],
            Self::Rolling { line_time_s, rows_per_pose, upwards } => {
                let band = |first: u32| {
                    let count = rows_per_pose.min(rows - first);
                    let middle = f64::from(first) + 0.5 * (f64::from(count) - 1.0);
                    let time_s = signed(upwards, (middle - 0.5 * all) * line_time_s);
                    ExposedRows { first_row: i64::from(first), rows: count, time_s }
                };
                vec![(0..rows).step_by(rows_per_pose as usize).map(band).collect()]
            }
            Self::LineScan { line_time_s, upwards } => {
                let time_s = |row: u32| signed(upwards, (f64::from(row) - 0.5 * all) * line_time_s);
                vec![(0..rows).map(|row| ExposedRows { first_row: 0, rows: 1, time_s: time_s(row) }).collect()]
            }
            Self::PushFrame { interval_s, framelet_rows, upwards } => {
                let count = rows / framelet_rows;
                let time_s = |k: u32| signed(upwards, (f64::from(k) - 0.5 * (f64::from(count) - 1.0)) * interval_s);
                let piece = |k: u32| vec![ExposedRows { first_row: 0, rows: framelet_rows, time_s: time_s(k) }];
                (0..count).map(piece).collect()
            }
        }
    }

    /// What one pose for several rows leaves out at most, from the middle of their times.
    pub fn block_time_s(&self) -> f64 {
        match *self {
            Self::Rolling { line_time_s, rows_per_pose, .. } => 0.5 * f64::from(rows_per_pose - 1) * line_time_s,
            _ => 0.0,
        }
    }
}

fn signed(upwards: bool, time_s: f64) -> f64 {
    if upwards { -time_s } else { time_s }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rolling_shutter_goes_through_the_focal_plane_and_a_scanner_stays() {
        let rolling = Shutter::Rolling { line_time_s: 0.1, rows_per_pose: 2, upwards: false }.pieces(5);
        let rows: Vec<_> = rolling[0].iter().map(|band| (band.first_row, band.rows)).collect();
        assert_eq!((rolling.len(), rows), (1, vec![(0, 2), (2, 2), (4, 1)]));
        let times: Vec<f64> = rolling[0].iter().map(|band| band.time_s).collect();
        assert!(times.iter().zip([-0.15, 0.05, 0.2]).all(|(a, b)| (a - b).abs() < 1e-12), "{times:?}");
        let lines = &Shutter::LineScan { line_time_s: 0.1, upwards: true }.pieces(3)[0];
        assert_eq!(
            lines.iter().map(|band| (band.first_row, band.time_s)).collect::<Vec<_>>(),
            [(0, 0.1), (0, -0.0), (0, -0.1)]
        );
        let framelets = Shutter::PushFrame { interval_s: 2.0, framelet_rows: 4, upwards: false };
        assert_eq!(framelets.pieces(12).iter().map(|piece| piece[0].time_s).collect::<Vec<_>>(), [-2.0, 0.0, 2.0]);
        assert_eq!(
            framelets.check(10).unwrap_err().to_string(),
            "an image of 10 rows is no whole number of framelets of 4"
        );
    }
}
