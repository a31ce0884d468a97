//! The variables that text kernels leave behind, and what is made of them: constants of bodies, lunar frames.
//!
//! A body's rotation is `POLE_RA`, `POLE_DEC` and `PM`, polynomials of three coefficients at most (missing ones are 0), and
//! sines and cosines of the angles of its system. What `anise` would evaluate otherwise than SPICE does is left out with its
//! reason: another epoch or inertial frame of the constants, angles of a higher degree, terms without an angle.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use anise::naif::kpl::tpc::TPCItem;
use anise::naif::kpl::{KPLValue, Parameter};

use super::EphemerisError;
use super::text_kernel::{Assignment, Values};

/// J2000 as a Julian date.
const J2000_JD: f64 = 2_451_545.0;
/// SPICE's id of J2000.
const J2000_FRAME: f64 = 1.0;
/// Coefficients of a polynomial.
const COEFFICIENTS: usize = 3;
const ROTATION: [(&str, Parameter); 3] =
    [("POLE_RA", Parameter::PoleRa), ("POLE_DEC", Parameter::PoleDec), ("PM", Parameter::PrimeMeridian)];
const TERMS: [(&str, Parameter); 3] = [
    ("NUT_PREC_RA", Parameter::NutPrecRa),
    ("NUT_PREC_DEC", Parameter::NutPrecDec),
    ("NUT_PREC_PM", Parameter::NutPrecPm),
];
const ANGLES: &str = "NUT_PREC_ANGLES";
const DEGREE: &str = "MAX_PHASE_DEGREE";

/// A variable and where it was last given.
#[derive(Debug, Clone)]
struct Variable {
    values: Values,
    path: PathBuf,
    line: usize,
}

/// All variables.
#[derive(Debug, Default)]
pub(super) struct KernelPool(BTreeMap<String, Variable>);

/// Constants of bodies by id, and of those whose rotation is left out the reason.
pub(super) struct Constants {
    pub bodies: HashMap<i32, TPCItem>,
    pub left_out: HashMap<i32, String>,
}

/// The id of a body in a name of its constants, as in `BODY301_PM`.
fn body_of(name: &str) -> Option<i32> {
    name.strip_prefix("BODY")?.split_once('_')?.0.parse().ok()
}

/// The bodies whose constants are assigned.
pub(super) fn bodies(assignments: &[Assignment]) -> BTreeSet<i32> {
    assignments.iter().filter_map(|assignment| body_of(&assignment.name)).collect()
}

impl KernelPool {
    /// Takes a kernel's assignments over, in their order.
    pub fn assign(&mut self, path: &Path, assignments: Vec<Assignment>) -> Result<(), EphemerisError> {
        for Assignment { name, appends, values, line } in assignments {
            let variable = Variable { values, path: path.to_owned(), line };
            match self.0.get_mut(&name).filter(|_| appends) {
                None => drop(self.0.insert(name, variable)),
                Some(known) => {
                    match (&mut known.values, variable.values) {
                        (Values::Numbers(known), Values::Numbers(more)) => known.extend(more),
                        (Values::Texts(known), Values::Texts(more)) => known.extend(more),
                        (Values::Dates, Values::Dates | Values::Numbers(_)) => {}
                        (known @ Values::Numbers(_), Values::Dates) => *known = Values::Dates,
                        _ => {
                            let problem = format!("{name} += appends texts to numbers, or numbers to texts");
                            return Err(EphemerisError::Text { path: path.to_owned(), line, problem });
                        }
                    }
                    (known.path, known.line) = (variable.path, line);
                }
            }
        }
        Ok(())
    }

    pub fn has(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }

    /// Numbers of a variable, if it is there.
    pub fn numbers(&self, name: &str) -> Result<Option<&[f64]>, EphemerisError> {
        match self.0.get(name).map(|variable| &variable.values) {
            None => Ok(None),
            Some(Values::Numbers(numbers)) => Ok(Some(numbers)),
            Some(_) => Err(self.fault(name, "wants numbers")),
        }
    }

    /// The text of a variable, if it is there.
    pub fn text(&self, name: &str) -> Result<Option<&str>, EphemerisError> {
        match self.0.get(name).map(|variable| &variable.values) {
            None => Ok(None),
            Some(Values::Texts(texts)) if texts.len() == 1 => Ok(Some(texts[0].trim())),
            Some(_) => Err(self.fault(name, "wants one text in quotes")),
        }
    }

    /// An error at the place where a variable was last given.
    pub fn fault(&self, name: &str, problem: impl std::fmt::Display) -> EphemerisError {
        let at = self.0.get(name);
        EphemerisError::Text {
            path: at.map(|variable| variable.path.clone()).unwrap_or_default(),
            line: at.map_or(0, |variable| variable.line),
            problem: format!("{name} {problem}"),
        }
    }

    /// A body's numbers, of which there may be so many.
    fn of_body(&self, id: i32, item: &str, at_most: usize) -> Result<Option<&[f64]>, EphemerisError> {
        let name = format!("BODY{id}_{item}");
        match self.numbers(&name)? {
            Some(numbers) if numbers.len() > at_most => {
                Err(self.fault(&name, format_args!("has {} values; allowed are 1 to {at_most}", numbers.len())))
            }
            numbers => Ok(numbers),
        }
    }

    /// The constants of all bodies.
    pub fn constants(&self) -> Result<Constants, EphemerisError> {
        let ids: BTreeSet<i32> = self.0.keys().filter_map(|name| body_of(name)).collect();
        let mut constants = Constants { bodies: HashMap::new(), left_out: HashMap::new() };
        for &id in &ids {
            let mut data = HashMap::new();
            if let Some(gm) = self.of_body(id, "GM", 1)? {
                data.insert(Parameter::GravitationalParameter, KPLValue::Float(gm[0]));
            }
            if let Some(radii_km) = self.of_body(id, "RADII", 3)? {
                let radii_km = if radii_km.len() == 1 { vec![radii_km[0]; 3] } else { radii_km.to_vec() };
                data.insert(Parameter::Radii, KPLValue::Matrix(radii_km));
            }
            if let Some(angles_deg) = self.of_body(id, ANGLES, usize::MAX)? {
                data.insert(Parameter::NutPrecAngles, KPLValue::Matrix(angles_deg.to_vec()));
                if let Some(degree) = self.of_body(id, DEGREE, 1)? {
                    data.insert(Parameter::MaxPhaseDegree, KPLValue::Integer(degree[0] as i32));
                }
            }
            match self.rotation(id)? {
                Ok(rotation) => data.extend(rotation),
                Err(reason) => drop(constants.left_out.insert(id, reason)),
            }
            constants.bodies.insert(id, TPCItem { body_id: Some(id), data });
        }
        Ok(constants)
    }

    /// A body's rotation, or why it is not evaluated.
    fn rotation(&self, id: i32) -> Result<Result<Vec<(Parameter, KPLValue)>, String>, EphemerisError> {
        let mut rotation = Vec::new();
        for (item, parameter) in ROTATION {
            if let Some(numbers) = self.of_body(id, item, COEFFICIENTS)? {
                let mut numbers = numbers.to_vec();
                numbers.resize(COEFFICIENTS, 0.0);
                rotation.push((parameter, KPLValue::Matrix(numbers)));
            }
        }
        if rotation.is_empty() {
            return Ok(Ok(rotation));
        }
        if rotation.len() < ROTATION.len() {
            return Ok(Err("it needs POLE_RA, POLE_DEC and PM".into()));
        }
        for [long, short] in [["CONSTANTS_JED_EPOCH", "CONSTS_JED_EPOCH"], ["CONSTANTS_REF_FRAME", "CONSTS_REF_FRAME"]]
        {
            let usual = if long.ends_with("EPOCH") { J2000_JD } else { J2000_FRAME };
            let given = self.of_body(id, long, 1)?.or(self.of_body(id, short, 1)?);
            if let Some(got) = given.map(|given| given[0]).filter(|got| *got != usual) {
                return Ok(Err(format!("its {long} is {got}; allowed is {usual}")));
            }
        }
        for (item, parameter) in TERMS {
            let Some(terms) = self.of_body(id, item, usize::MAX)? else { continue };
            if let Some(reason) = self.without_angle(id, item, terms)? {
                return Ok(Err(reason));
            }
            rotation.push((parameter, KPLValue::Matrix(terms.to_vec())));
        }
        Ok(Ok(rotation))
    }

    /// Why the terms of a body cannot be evaluated, if one that counts has no angle of the first degree.
    fn without_angle(&self, id: i32, item: &str, terms: &[f64]) -> Result<Option<String>, EphemerisError> {
        let system = if id > 100 { id / 100 } else { id };
        let degree = self.of_body(system, DEGREE, 1)?.map_or(1.0, |degree| degree[0]);
        if degree.fract() != 0.0 || !(1.0..=8.0).contains(&degree) {
            return Err(self.fault(
                &format!("BODY{system}_{DEGREE}"),
                format_args!("= {degree} is not a whole number within [1, 8]"),
            ));
        }
        let angles: Vec<&[f64]> =
            self.of_body(system, ANGLES, usize::MAX)?.unwrap_or_default().chunks(degree as usize + 1).collect();
        let counts = terms.iter().enumerate().filter(|(_, term)| **term != 0.0);
        let reason = |(index, _): (usize, &f64)| match angles.get(index) {
            None => Some(format!("its {item} has more terms than BODY{system}_{ANGLES} has angles")),
            Some(angle) if angle.len() < 2 => {
                Some(format!("angle {} of BODY{system}_{ANGLES} is not whole", index + 1))
            }
            Some(angle) if angle[2..].iter().any(|coefficient| *coefficient != 0.0) => {
                Some(format!("its {item} takes an angle of degree {degree}; allowed is degree 1"))
            }
            Some(_) => None,
        };
        Ok(counts.filter_map(reason).next())
    }
}
