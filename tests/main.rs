//! All integration tests in one binary.

mod architecture;
mod conformance;
mod invariants;
mod reference;
