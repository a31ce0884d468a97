//! How often the Sun and the Earth are seen: maps over a level and series of areas and places.
//!
//! ```text
//! swept skylines, or a tile's --per block--> skyline by azimuth and node ┐
//! ephemeris ----Track----> directions by step ───────────────────────────┴--> lit?, share of the disc --> Maps, Series
//! traced skyline of a place ────────────────────────────────────────────────────────────────────────-> Place
//! ```
//!
//! At a step the Sun's centre stands `x` solar radii above the skyline at its azimuth, `x = (a − h(A))/r`. The share of
//! its light that is seen is `V(−x)` of the limb-darkened disc above a level line ([`DiscShare`]); whether that counts
//! as *lit* is the user's to say ([`Lit`]): published percentages differ by 1 to 3 % for that alone.
//!
//! # Assumptions
//! - The skyline is level across the disc, straight between the azimuths that were swept, and as high as the sweep found
//!   it; [`check`] tells what that costs, against traced skylines.
//! - Within a block of [`blocks::BLOCK`]² nodes the Sun's map azimuth is that at the block's centre and its elevation
//!   linear: at 240 m and 2° high they differ by up to 0.003° and 1e-5°.
//! - The Sun and the Earth are seen from the middle of the map: at 184 km from it, the Earth is 0.03° off.
//!
//! # References
//! Mazarico et al. (2011), Icarus 211, 1066. Gläser et al. (2014), Icarus 243, 78.

pub mod area;
pub mod best_places;
pub mod blocks;
pub mod check;
pub mod geotiff;
mod kernel;
pub mod lit;
pub mod maps;
pub mod place;
pub mod report;
mod series;
pub mod skylines;
pub mod track;

pub use area::{Area, AreaSummary};
pub use best_places::best_places;
pub use check::{Check, Traced};
pub use lit::{DiscShare, Lit};
pub use maps::{Maps, Study};
pub use place::Place;
pub use series::Series;
pub use skylines::{Skylines, Swept};
pub use track::{Seen, Track};
