//! Where things are: points and directions that carry their frame in the type, and bodies.

mod body;
mod frame;
mod motion;

pub use body::{Body, Geodetic, distance_to_spheroid_m};
pub use frame::{BodyFixed, Camera, Direction, Frame, Icrf, Local, Map, Position, Rotation};
pub use motion::contradicted_step;
