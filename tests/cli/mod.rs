//! What the program says and writes.

mod bad_input;
mod scenario;
