//! What the program says and writes.

mod bad_input;
mod inspect;
mod scenario;
