//! What the program says and writes.

mod bad_input;
mod ephemeris;
mod scenario;
mod terrain;
