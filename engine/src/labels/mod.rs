//! What there is to learn from an image: craters as ellipses and conics, with what is known of each.
//!
//! A [`Crater`] is an entry of a list: the synthetic terrain's own, or a catalogue's ([`catalogue`]). Its [`Rim`] is an
//! ellipse in space, in the plane that fits the ground around it. A [`Landmark`] is that rim in one image: a [`Conic`], the
//! same as an [`Ellipse`], and flags (truncated, occluded, in shadow) each with the share that it was decided by.
//!
//! ```text
//! lists -> Crater -> Rim (once a scene) -> Landmark (once a view) -> exposure_0007.landmarks.json
//! ```
//!
//! Other labels are planes ([`planes()`]): where the ground is in the next exposure ([`Flow`]), what a lander would stand on
//! ([`Hazards`]), which shadows moved ([`shadow_change`]).
//!
//! [`Landmark`] is the record that other formats are written from; `Vec<Landmark>` belongs to an exposure.

pub mod catalogue;
mod change;
mod conic;
mod crater;
mod flow;
mod hazard;
mod landmark;
mod planes;
mod rim;
mod synthetic_detail;

pub use change::{moved, shadow_change};
pub use conic::{Conic, Ellipse};
pub use crater::{Crater, Origin, without_repeats};
pub use flow::Flow;
pub use hazard::{Footprint, Hazards, Limits, footprint, footprint_in_space};
pub use landmark::{Landmark, Wanted, landmarks};
pub use planes::{Sequence, need_light, planes};
pub use rim::Rim;
pub use synthetic_detail::{SyntheticDetail, synthetic_detail, synthetic_detail_height_m};
