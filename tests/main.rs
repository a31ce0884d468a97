//! All integration tests in one binary.

mod architecture;
mod bench;
mod cli;
mod compare;
mod conformance;
mod docs;
mod examples;
mod face;
mod fixtures;
mod fuzz;
mod invariants;
mod lengths;
mod readers;
mod reference;
mod scenes;

/// Whether `SIM_REQUIRE`, names joined by commas, names what a test would otherwise do without.
fn required(what: &str) -> bool {
    std::env::var("SIM_REQUIRE").is_ok_and(|wanted| wanted.split(',').any(|name| name == what))
}
