//! All integration tests in one binary.

mod architecture;
mod cli;
mod conformance;
mod invariants;
mod reference;
mod scenes;
