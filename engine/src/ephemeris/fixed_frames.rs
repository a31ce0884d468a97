//! Lunar frames that a text kernel fixes to a tabulated one, by angles, a matrix or a quaternion.
//!
//! ```text
//! v_relative = [angle 1]_axis 1 [angle 2]_axis 2 [angle 3]_axis 3 v_frame      [a]_i turns the axes about axis i by a
//! ```
//!
//! `UNITS` are those of SPICE's `CONVRT`, in any case; radians where none are given.
//!
//! # References
//! NAIF, *Frames Required Reading*, toolkit N0067, chapter *TK frames*.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use anise::math::Matrix3;
use anise::math::rotation::{DCM, r1, r2, r3};
use anise::structure::EulerParameterDataSet;
use anise::structure::dataset::DataSetType;
use anise::structure::metadata::Metadata;

use super::EphemerisError;
use super::kernel_pool::KernelPool;
use super::names::{LUNAR_FRAMES, LunarFrame};
use super::text_kernel::{Assignment, Values};

/// Units of angles and their size in radians.
const UNITS: [(&str, f64); 7] = [
    ("RADIANS", 1.0),
    ("DEGREES", PI / 180.0),
    ("ARCMINUTES", PI / 10_800.0),
    ("ARCSECONDS", PI / 648_000.0),
    ("HOURANGLE", PI / 12.0),
    ("MINUTEANGLE", PI / 720.0),
    ("SECONDANGLE", PI / 43_200.0),
];
/// How far a matrix may be from a rotation, as SPICE's own frames have it.
const ROTATION_TOLERANCE: f64 = 1e-6;

/// The ids of the frames that are described, by their ids or their names.
pub(super) fn frames(assignments: &[Assignment]) -> BTreeSet<i32> {
    let number = |assignment: &Assignment| match &assignment.values {
        Values::Numbers(numbers) if numbers.len() == 1 => Some(numbers[0] as i32),
        _ => None,
    };
    let described = |name: &str| -> Option<i32> {
        let rest = name.strip_prefix("TKFRAME_").or(name.strip_prefix("FRAME_"))?;
        let by_id = || rest.split_once('_')?.0.parse().ok();
        by_id().or_else(|| {
            let is_named = |known: &&Assignment| {
                let frame = known.name.strip_prefix("FRAME_");
                frame.is_some_and(|frame| rest.strip_prefix(frame).is_some_and(|item| item.starts_with('_')))
            };
            assignments.iter().filter(is_named).find_map(number)
        })
    };
    assignments.iter().filter_map(|assignment| described(&assignment.name)).collect()
}

impl KernelPool {
    /// The lunar frames that are described, for `anise`; `None` where there are none.
    pub fn lunar_frames(&self) -> Result<Option<EulerParameterDataSet>, EphemerisError> {
        let mut set = EulerParameterDataSet::default();
        for frame in LUNAR_FRAMES.iter().filter(|frame| frame.id != frame.tabulated_id) {
            let Some(rot_mat) = self.relative_from(frame)? else { continue };
            let turned = DCM { rot_mat, from: frame.id, to: frame.tabulated_id, rot_mat_dt: None };
            let named = Some(frame.name);
            set.push(turned.into(), Some(frame.id), named)
                .map_err(|error| self.fault(&self.key(frame, "SPEC"), error))?;
        }
        if set.is_empty() {
            return Ok(None);
        }
        set.set_crc32();
        set.metadata = Metadata { dataset_type: DataSetType::EulerParameterData, ..Metadata::default() };
        Ok(Some(set))
    }

    /// A key of a frame, which its id or its name may begin.
    fn key(&self, frame: &LunarFrame, item: &str) -> String {
        let by_name = format!("TKFRAME_{}_{item}", frame.name);
        if self.has(&by_name) { by_name } else { format!("TKFRAME_{}_{item}", frame.id) }
    }

    /// From a frame into the tabulated one; `None` where it is not described.
    fn relative_from(&self, frame: &LunarFrame) -> Result<Option<Matrix3>, EphemerisError> {
        let spec = self.key(frame, "SPEC");
        let Some(kind) = self.text(&spec)? else { return Ok(None) };
        self.check_relative(frame)?;
        let (name, count) = match kind.to_ascii_uppercase().as_str() {
            "ANGLES" => return self.by_angles(frame).map(Some),
            "MATRIX" => ("MATRIX", 9),
            "QUATERNION" => ("Q", 4),
            other => {
                return Err(self.fault(&spec, format_args!("= '{other}'; allowed are ANGLES, MATRIX and QUATERNION")));
            }
        };
        let key = self.key(frame, name);
        let numbers = self.exactly(&key, count)?;
        let matrix = match *numbers {
            [w, x, y, z] => from_quaternion([w, x, y, z]),
            // Column by column.
            _ => Matrix3::from_column_slice(numbers),
        };
        let is_rotation = (matrix * matrix.transpose() - Matrix3::identity()).amax() < ROTATION_TOLERANCE;
        if is_rotation && matrix.determinant() > 0.0 {
            Ok(Some(matrix))
        } else {
            Err(self.fault(&key, "is no rotation"))
        }
    }

    /// Refuses what is not fixed to the frame that the kernels tabulate.
    fn check_relative(&self, frame: &LunarFrame) -> Result<(), EphemerisError> {
        let key = self.key(frame, "RELATIVE");
        let tabulated = LUNAR_FRAMES.iter().find(|other| other.id == frame.tabulated_id).map_or("", |other| other.name);
        let got = self.text(&key)?.unwrap_or_default().to_ascii_uppercase();
        let id = self.numbers(&format!("FRAME_{got}"))?.map(|id| id[0]);
        if got == tabulated || id == Some(f64::from(frame.tabulated_id)) {
            return Ok(());
        }
        if got.is_empty() {
            return Err(self.fault(&self.key(frame, "SPEC"), format_args!("needs {key}")));
        }
        Err(self.fault(&key, format_args!("= '{got}'; allowed is {tabulated}")))
    }

    fn by_angles(&self, frame: &LunarFrame) -> Result<Matrix3, EphemerisError> {
        let (key, unit_key) = (self.key(frame, "AXES"), self.key(frame, "UNITS"));
        let angles = self.exactly(&self.key(frame, "ANGLES"), 3)?;
        let axes = self.exactly(&key, 3)?;
        let unit = self.text(&unit_key)?.unwrap_or("RADIANS");
        let unit_rad = UNITS.iter().find(|(name, _)| name.eq_ignore_ascii_case(unit)).map(|(_, unit_rad)| unit_rad);
        let unit_rad = unit_rad.ok_or_else(|| {
            self.fault(&unit_key, format_args!("= '{unit}'; allowed are {}", UNITS.map(|(name, _)| name).join(", ")))
        })?;
        let mut matrix = Matrix3::identity();
        for (angle, axis) in angles.iter().zip(axes) {
            matrix *= match axis {
                1.0 => r1(angle * unit_rad),
                2.0 => r2(angle * unit_rad),
                3.0 => r3(angle * unit_rad),
                _ => return Err(self.fault(&key, format_args!("holds {axis}; allowed are 1, 2 and 3"))),
            };
        }
        Ok(matrix)
    }

    fn exactly(&self, key: &str, count: usize) -> Result<&[f64], EphemerisError> {
        let numbers = self.numbers(key)?.unwrap_or_default();
        if numbers.len() == count {
            Ok(numbers)
        } else {
            Err(self.fault(key, format_args!("has {} values; wanted are {count}", numbers.len())))
        }
    }
}

/// SPICE's `Q2M`, of a quaternion of any length; zeros where it has none.
fn from_quaternion(wxyz: [f64; 4]) -> Matrix3 {
    let length = wxyz.iter().map(|part| part * part).sum::<f64>().sqrt();
    if length == 0.0 {
        return Matrix3::zeros();
    }
    let [w, x, y, z] = wxyz.map(|part| part / length);
    Matrix3::new(
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        1.0 - 2.0 * (x * x + y * y),
    )
}
