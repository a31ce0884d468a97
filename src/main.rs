//! The program `sim`: one match, one error chain, exit codes.

mod cli;

use std::error::Error;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Calibrated images of airless terrain for landing navigation.
#[derive(Debug, Parser)]
#[command(name = "sim", version, about)]
struct Sim {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Bench(cli::bench::Args),
    Check(cli::check::Args),
    Horizon(cli::horizon::Args),
    Inspect(cli::inspect::Args),
    Kernels(cli::kernels::Args),
    Run(cli::run::Args),
    Schema(cli::schema::Args),
    Sun(cli::sun::Args),
    Terrain(cli::terrain::Args),
}

fn main() -> ExitCode {
    // Keeps Mesa's device-select layer from printing on machines without a display.
    // SAFETY: no other thread runs yet.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    let outcome = match Sim::parse().command {
        Command::Bench(args) => cli::bench::run(args),
        Command::Check(args) => cli::check::run(args),
        Command::Horizon(args) => cli::horizon::run(args),
        Command::Inspect(args) => cli::inspect::run(args),
        Command::Kernels(args) => cli::kernels::run(args),
        Command::Run(args) => cli::run::run(args),
        Command::Schema(args) => cli::schema::run(args),
        Command::Sun(args) => cli::sun::run(args),
        Command::Terrain(args) => cli::terrain::run(args),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", chain(error.as_ref()));
            ExitCode::FAILURE
        }
    }
}

/// An error and its causes on one line; a cause that the error quotes is not said again.
fn chain(error: &dyn Error) -> String {
    let text = error.to_string();
    match error.source().map(chain) {
        Some(cause) if !text.contains(&cause) => format!("{text}: {cause}"),
        _ => text,
    }
}
