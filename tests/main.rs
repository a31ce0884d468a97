//! All integration tests in one binary.

mod architecture;
mod cli;
mod compare;
mod conformance;
mod evaluate;
mod invariants;
mod readers;
mod reference;
mod scenes;
