//! What the program says and writes.

mod alone;
mod attacks;
mod bad_input;
mod cache;
mod camera;
mod ephemeris;
mod facts;
mod horizon;
mod hostile;
mod illuminate;
mod inputs;
mod inspect;
mod labels;
mod light;
mod methods;
mod progress;
pub mod run;
mod run_input;
mod scenario;
mod shadows;
mod sweep;
mod terrain;
mod text_input;
mod titles;
