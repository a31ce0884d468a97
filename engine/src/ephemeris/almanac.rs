//! Positions and orientations at an epoch, from SPICE kernels.
//!
//! Inside this file lengths are kilometres, as kernels state them; what it returns is in metres. Axes are ICRF
//! ("J2000" in the kernels of JPL). The observer's and the target's states are summed along the kernels'
//! chains of centres up to the solar system barycentre, in `f64`: 1 au is resolved to 0.03 mm.
//!
//! # Assumptions
//! Masses are optional: without them only two-body motion fails. The barycentre of a planet's system stands for
//! the planet where a kernel has only this (Mars: within 0.3 m). A triaxial body becomes the spheroid of its mean
//! equatorial radius. ANISE's own `.pca` may lack the terms that text kernels write with a Fortran exponent (0.42″
//! of the Moon's rotation in 2024); text kernels are read whole.
//!
//! # References
//! Acton (1996), Planet. Space Sci. 44, 65, doi:10.1016/0032-0633(95)00107-7.
//! Park et al. (2021), Astron. J. 161, 105, doi:10.3847/1538-3881/abd414, for DE440.

use std::collections::HashMap;

use anise::almanac::Almanac as Anise;
use anise::constants::orientations::J2000;
use anise::math::{Matrix3, Vector3};
use anise::prelude::Frame as AniseFrame;
use glam::{DMat3, DVec3};
use hifitime::Epoch;

use super::EphemerisError;
use super::daf::{Kind, Segment};
use super::epoch::{et_text, utc_text};
use super::kernel::Kernel;
use super::names::{LUNAR_FRAMES, MOON, body_id, body_name, frame_ids, frame_name};
use crate::geometry::{Body, BodyFixed, Icrf, Position, Rotation};

const M_PER_KM: f64 = 1000.0;
/// Longest chain of centres from an object to the solar system barycentre.
const CHAIN_AT_MOST: usize = 8;
const SOLAR_SYSTEM_BARYCENTER: i32 = 0;

/// Loaded kernels.
#[derive(Clone)]
pub struct Almanac {
    pub(super) anise: Anise,
    pub(super) kernels: Vec<Kernel>,
    /// Bodies whose rotation is given and not evaluated, and why.
    pub(super) left_out: HashMap<i32, String>,
}

impl std::fmt::Debug for Almanac {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Almanac").field("kernels", &self.kernels).finish_non_exhaustive()
    }
}

/// A body, its spheroid and the frame that turns with it.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyFrame {
    pub body: Body,
    pub frame_name: String,
    pub frame_id: i32,
}

/// Orientation of a body and how it changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orientation {
    pub body_from_icrf: Rotation<BodyFixed, Icrf>,
    /// Time derivative of the matrix of `body_from_icrf`.
    pub rate_per_s: DMat3,
}

/// Position and velocity against the solar system barycentre, ICRF.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    pub position_m: DVec3,
    pub velocity_m_s: DVec3,
}

impl Almanac {
    /// The kernels that come with the program, see [`default_kernels`](super::default_kernels).
    pub fn default_kernels() -> Result<Self, EphemerisError> {
        Self::load_sources(&super::default_kernels())
    }

    /// What was loaded, for manifests.
    pub fn kernels(&self) -> &[Kernel] {
        &self.kernels
    }

    fn loaded(&self) -> String {
        match self.kernels.iter().map(|kernel| kernel.name.as_str()).collect::<Vec<_>>().join(", ") {
            names if names.is_empty() => "none".to_owned(),
            names => names,
        }
    }

    /// Segments of a body or a frame with their kernels, the one that wins first.
    fn segments(&self, kind: Kind, id: i32) -> impl Iterator<Item = (&Kernel, &Segment)> {
        self.kernels
            .iter()
            .rev()
            .flat_map(|kernel| kernel.segments.iter().map(move |segment| (kernel, segment)))
            .filter(move |(_, segment)| segment.kind == kind && segment.target_id == id)
    }

    /// The segment that holds an id at an epoch; the error tells which epochs are covered and by what.
    fn covering(&self, kind: Kind, id: i32, epoch: Epoch) -> Result<&Segment, EphemerisError> {
        let et_s = epoch.to_et_seconds();
        if let Some((_, segment)) = self.segments(kind, id).find(|(_, segment)| segment.covers(et_s)) {
            return Ok(segment);
        }
        let what = match kind {
            Kind::Spk => format!("the position of {}", body_name(id)),
            Kind::Bpc => format!("the orientation of {}", frame_name(id)),
        };
        let coverage: Vec<String> = self
            .segments(kind, id)
            .map(|(kernel, s)| format!("{} to {} in {}", et_text(s.start_et_s), et_text(s.end_et_s), kernel.name))
            .collect();
        if coverage.is_empty() {
            return Err(EphemerisError::NotLoaded { what, loaded: self.loaded() });
        }
        Err(EphemerisError::OutsideCoverage { what, epoch_utc: utc_text(epoch), coverage: coverage.join("; ") })
    }

    /// An object's own id, or its system's barycentre where kernels have only this and the two all but coincide.
    fn object_in_kernels(&self, id: i32) -> i32 {
        let barycenter = id / 100;
        let stands_for = matches!(id, 199 | 299 | 499) && self.segments(Kind::Spk, id).next().is_none();
        if stands_for && self.segments(Kind::Spk, barycenter).next().is_some() { barycenter } else { id }
    }

    /// Sums the chain of centres from `object` up to `end`, or to the solar system barycentre.
    fn chain(&self, object: i32, end: i32, epoch: Epoch) -> Result<(State, i32), EphemerisError> {
        let mut id = self.object_in_kernels(object);
        let mut sum = State { position_m: DVec3::ZERO, velocity_m_s: DVec3::ZERO };
        for _ in 0..CHAIN_AT_MOST {
            if id == end || id == SOLAR_SYSTEM_BARYCENTER {
                break;
            }
            self.covering(Kind::Spk, id, epoch)?;
            let state = self.anise.translate_to_parent(AniseFrame::from_ephem_j2000(id), epoch).map_err(|source| {
                let what = format!("the position of {}", body_name(id));
                EphemerisError::Position { what, epoch_utc: utc_text(epoch), source: Box::new(source) }
            })?;
            sum.position_m += metres(state.radius_km);
            sum.velocity_m_s += metres(state.velocity_km_s);
            id = state.frame.ephemeris_id;
        }
        if sum.position_m.is_finite() && sum.velocity_m_s.is_finite() {
            return Ok((sum, id));
        }
        let what = format!("the position of {}", body_name(object));
        Err(EphemerisError::NotFinite { what, epoch_utc: utc_text(epoch) })
    }

    /// State of an object against the solar system barycentre.
    pub(super) fn barycentric(&self, object: i32, epoch: Epoch) -> Result<State, EphemerisError> {
        let (state, end) = self.chain(object, SOLAR_SYSTEM_BARYCENTER, epoch)?;
        if end == SOLAR_SYSTEM_BARYCENTER {
            return Ok(state);
        }
        let what = format!("a chain of centres from {} to the solar system barycenter", body_name(object));
        Err(EphemerisError::NotLoaded { what, loaded: self.loaded() })
    }

    /// Geometric position and velocity of any object against the body, in its frame, in m and m/s.
    pub fn state_of(
        &self,
        object: i32,
        frame: &BodyFrame,
        epoch: Epoch,
    ) -> Result<(Position<BodyFixed>, DVec3), EphemerisError> {
        let center = self.object_in_kernels(frame.body.naif_id);
        let (state, end) = self.chain(object, center, epoch)?;
        let state = if end == center { state } else { self.difference(object, center, epoch)? };
        Ok(self.orientation(frame, epoch)?.turn_state(state.position_m, state.velocity_m_s))
    }

    fn difference(&self, object: i32, center: i32, epoch: Epoch) -> Result<State, EphemerisError> {
        let (object, center) = (self.barycentric(object, epoch)?, self.barycentric(center, epoch)?);
        let position_m = object.position_m - center.position_m;
        Ok(State { position_m, velocity_m_s: object.velocity_m_s - center.velocity_m_s })
    }

    /// A body by its name or id, with the radii that the kernels state.
    pub fn body(&self, name: &str) -> Result<Body, EphemerisError> {
        let naif_id = body_id(name)?;
        if naif_id == MOON {
            return Ok(Body::moon());
        }
        let shape = self.anise.get_planetary_data_from_id(naif_id).ok().and_then(|constants| constants.shape);
        let shape = shape.ok_or_else(|| self.no_constant(naif_id, "radii"))?;
        let equatorial_radius_km =
            0.5 * (shape.semi_major_equatorial_radius_km + shape.semi_minor_equatorial_radius_km);
        Ok(Body {
            name: body_name(naif_id),
            naif_id,
            equatorial_radius_m: equatorial_radius_km * M_PER_KM,
            polar_radius_m: shape.polar_radius_km * M_PER_KM,
        })
    }

    /// Gravitational parameter of a body, in m³/s².
    pub fn gravitational_parameter_m3_s2(&self, body: &Body) -> Result<f64, EphemerisError> {
        let constants = self.anise.get_planetary_data_from_id(body.naif_id).ok();
        let mass = constants.map(|constants| constants.mu_km3_s2).filter(|mu_km3_s2| *mu_km3_s2 > 0.0);
        mass.map(|mu_km3_s2| mu_km3_s2 * M_PER_KM.powi(3))
            .ok_or_else(|| self.no_constant(body.naif_id, "gravitational parameter"))
    }

    fn no_constant(&self, id: i32, constant: &'static str) -> EphemerisError {
        EphemerisError::NoConstant { body: body_name(id), constant, loaded: self.loaded() }
    }

    /// A body with its frame: the named one, or the best that the kernels have.
    ///
    /// For the Moon that is the mean-Earth frame of a tabulated orientation, else `IAU_MOON`, which differs from
    /// it by up to 0.0051° (155 m).
    pub fn body_frame(&self, body: &str, frame: Option<&str>) -> Result<BodyFrame, EphemerisError> {
        let body = self.body(body)?;
        let candidates = match frame {
            Some(name) => frame_ids(name)?,
            None if body.naif_id == MOON => [frame_ids("MOON_ME")?, vec![MOON]].concat(),
            None => vec![body.naif_id],
        };
        let frame_id = candidates.iter().copied().find(|id| self.has_frame(*id)).ok_or_else(|| {
            // Of the defaults the last asks for least.
            let id = if frame.is_some() { candidates[0] } else { candidates[candidates.len() - 1] };
            if let Some(reason) = self.left_out.get(&id) {
                return EphemerisError::Rotation { frame: frame_name(id), reason: reason.clone() };
            }
            let lunar = LUNAR_FRAMES.iter().find(|frame| frame.id == id);
            let needed = lunar.map_or("a text PCK with the body's rotation (pck00011.tpc)", |frame| frame.kernels);
            let frame = frame.map_or_else(|| frame_name(id), str::to_owned);
            EphemerisError::FrameNotAvailable { frame, needed: needed.to_owned(), loaded: self.loaded() }
        })?;
        Ok(BodyFrame { body, frame_name: frame_name(frame_id), frame_id })
    }

    /// The same for some epochs. Where the tabulated orientation of the best frame does not reach all of them, it is the frame of
    /// the constants, and a line says so.
    pub fn body_frame_at(
        &self,
        body: &str,
        frame: Option<&str>,
        epochs: &[Epoch],
    ) -> Result<(BodyFrame, Option<String>), EphemerisError> {
        let best = self.body_frame(body, frame)?;
        let by_constants =
            BodyFrame { frame_id: best.body.naif_id, frame_name: frame_name(best.body.naif_id), ..best.clone() };
        let outside = epochs.iter().find_map(|epoch| self.orientation(&best, *epoch).err());
        let Some(why) = outside.filter(|_| frame.is_none() && best.frame_id != by_constants.frame_id) else {
            return Ok((best, None));
        };
        if !self.has_frame(by_constants.frame_id) {
            return Ok((best, None));
        }
        let note = format!("the frame is {}, up to 0.005° from {}: {why}", by_constants.frame_name, best.frame_name);
        Ok((by_constants, Some(note)))
    }

    fn has_frame(&self, id: i32) -> bool {
        let tabulated = |id| self.segments(Kind::Bpc, id).next().is_some();
        match LUNAR_FRAMES.iter().find(|frame| frame.id == id) {
            Some(frame) if frame.tabulated_id == id => tabulated(id),
            Some(frame) => {
                tabulated(frame.tabulated_id) && self.kernels.iter().any(|kernel| kernel.fixed_frames.contains(&id))
            }
            None => {
                let constants = self.anise.get_planetary_data_from_id(id);
                tabulated(id) || constants.is_ok_and(|constants| constants.prime_meridian.is_some())
            }
        }
    }

    /// Orientation of a body at an epoch.
    pub fn orientation(&self, frame: &BodyFrame, epoch: Epoch) -> Result<Orientation, EphemerisError> {
        let lunar = LUNAR_FRAMES.iter().find(|lunar| lunar.id == frame.frame_id);
        let tabulated_id = lunar.map_or(frame.frame_id, |lunar| lunar.tabulated_id);
        if self.segments(Kind::Bpc, tabulated_id).next().is_some() {
            self.covering(Kind::Bpc, tabulated_id, epoch)?;
        }
        let from = AniseFrame::from_orient_ssb(J2000);
        let to = AniseFrame::from_orient_ssb(frame.frame_id);
        let dcm = self.anise.rotate(from, to, epoch).map_err(|source| EphemerisError::Orientation {
            frame: frame.frame_name.clone(),
            epoch_utc: utc_text(epoch),
            source: Box::new(source),
        })?;
        let (rotation, rate_per_s) = (matrix(dcm.rot_mat), dcm.rot_mat_dt.map_or(DMat3::ZERO, matrix));
        if rotation.is_finite() && rate_per_s.is_finite() {
            return Ok(Orientation { body_from_icrf: Rotation::from_matrix(rotation), rate_per_s });
        }
        let what = format!("the orientation of {}", frame.frame_name);
        Err(EphemerisError::NotFinite { what, epoch_utc: utc_text(epoch) })
    }

    /// Rotation into the body's frame at an epoch.
    pub fn body_from_icrf(&self, frame: &BodyFrame, epoch: Epoch) -> Result<Rotation<BodyFixed, Icrf>, EphemerisError> {
        Ok(self.orientation(frame, epoch)?.body_from_icrf)
    }
}

impl Orientation {
    /// Turns a position and velocity from ICRF into the turning frame.
    pub fn turn_state(&self, position_m: DVec3, velocity_m_s: DVec3) -> (Position<BodyFixed>, DVec3) {
        let velocity_m_s = self.body_from_icrf.turn(velocity_m_s) + self.rate_per_s * position_m;
        (Position::from_m(self.body_from_icrf.turn(position_m)), velocity_m_s)
    }

    /// Turns a position and velocity from the turning frame into ICRF.
    pub fn turn_state_back(&self, position: Position<BodyFixed>, velocity_m_s: DVec3) -> (DVec3, DVec3) {
        let icrf_from_body = self.body_from_icrf.inverse();
        let turned_m_s = icrf_from_body.turn(velocity_m_s) + self.rate_per_s.transpose() * position.vector_m();
        (icrf_from_body.turn(position.vector_m()), turned_m_s)
    }
}

fn metres(vector_km: Vector3) -> DVec3 {
    DVec3::new(vector_km.x, vector_km.y, vector_km.z) * M_PER_KM
}

fn matrix(matrix: Matrix3) -> DMat3 {
    // Both store columns one after the other.
    DMat3::from_cols_slice(matrix.as_slice())
}
