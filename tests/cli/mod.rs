//! What the program says and writes.

mod bad_input;
mod ephemeris;
mod inspect;
mod scenario;
mod terrain;
