//! How often the Sun and the Earth are seen: maps over a level and series at places.
//!
//! ```text
//! horizon map --per block--> skyline by azimuth and node ┐
//! ephemeris ----Track----> directions by step ───────────┴--> lit?, share of the disc --> Maps
//! traced skyline of a place ─────────────────────────────────────────────────────────-> Place
//! ```
//!
//! At a step the Sun's centre stands `x` solar radii above the skyline at its azimuth, `x = (a − h(A))/r`. The share of
//! its light that is seen is `V(−x)` of the limb-darkened disc above a level line ([`DiscShare`]); whether that counts
//! as *lit* is the user's to say ([`Lit`]): published percentages differ by 1 to 3 % for that alone.
//!
//! # Assumptions
//! - The skyline is level across the disc and its elevation that of the tile, whose header states its error.
//! - Within a block of [`maps::BLOCK`]² nodes the Sun's map azimuth is that at the block's centre and its elevation
//!   linear: at 240 m and 2° high they differ by up to 0.003° and 1e-5°.
//! - The Earth is seen from the middle of the map: at 184 km from it, 0.03° off.
//!
//! # References
//! Mazarico et al. (2011), Icarus 211, 1066. Gläser et al. (2014), Icarus 243, 78.

pub mod geotiff;
pub mod lit;
pub mod maps;
pub mod place;
pub mod track;

pub use lit::{DiscShare, Lit};
pub use maps::{Maps, maps};
pub use place::Place;
pub use track::{Seen, Track};
