//! The program `sim`: one match, one error chain, exit codes.

mod cli;

use std::error::Error;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Calibrated images of airless terrain for landing navigation.
///
/// A scenario names terrain, camera, trajectory and epochs; `sim run` makes the images, with shadows from
/// Fourier-compressed horizon maps, and the poses, the Sun and the inputs beside them.
#[derive(Debug, Parser)]
#[command(name = "sim", version, arg_required_else_help = true, after_help = FIRST_STEPS)]
struct Sim {
    #[command(subcommand)]
    command: Command,
}

const FIRST_STEPS: &str = "\
First steps:
  sim run lunar_descent.ron           24 images of a descent, into output/lunar_descent
  sim check mine.ron                  all that is wrong with a scenario, without running it
  sim inspect output/lunar_descent    what was made, and whether it is whole
  sim scenarios                       what comes with the program
  sim scenarios lunar_descent > mine.ron   a copy to change
  sim schema                          all that a scenario can say

Exit codes: 0 done, 1 an error, 2 wrong arguments, 130 interrupted; with --json errors are JSON too";

#[derive(Debug, Subcommand)]
enum Command {
    Bench(cli::bench::Args),
    Cache(cli::cache::Args),
    Check(cli::check::Args),
    Compare(cli::compare::Args),
    Horizon(Box<cli::horizon::Args>),
    Illuminate(Box<cli::illuminate::Args>),
    Inspect(cli::inspect::Args),
    Kernels(cli::kernels::Args),
    Run(cli::run::Args),
    Scenarios(cli::scenarios::Args),
    Schema(cli::schema::Args),
    Sun(cli::sun::Args),
    Terrain(cli::terrain::Args),
}

impl Command {
    /// What must be there before work begins.
    fn prepare(&self) -> Result<(), String> {
        let is_light = matches!(
            self,
            Self::Cache(_) | Self::Inspect(_) | Self::Kernels(_) | Self::Scenarios(_) | Self::Schema(_) | Self::Sun(_)
        );
        if !is_light {
            cli::limits::check_memory()?;
        }
        cli::limits::start_threads()
    }
}

fn main() -> ExitCode {
    // Keeps Mesa's device-select layer from printing on machines without a display.
    // SAFETY: no other thread runs yet.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    perilune_engine::horizon::memory::keep();
    let as_json = std::env::args().any(|argument| argument == "--json");
    let command = match Sim::try_parse() {
        Ok(sim) => sim.command,
        Err(error) if as_json && error.use_stderr() => {
            cli::failure::report_arguments(&error.to_string());
            return ExitCode::from(2);
        }
        Err(error) => error.exit(),
    };
    if let Err(error) = command.prepare() {
        eprintln!("error: {error}");
        return ExitCode::FAILURE;
    }
    cli::interrupt::listen();
    let outcome = match command {
        Command::Bench(args) => cli::bench::run(args),
        Command::Cache(args) => cli::cache::run(args),
        Command::Check(args) => cli::check::run(args),
        Command::Compare(args) => cli::compare::run(args),
        Command::Horizon(args) => cli::horizon::run(*args),
        Command::Illuminate(args) => cli::illuminate::run(*args),
        Command::Inspect(args) => cli::inspect::run(args),
        Command::Kernels(args) => cli::kernels::run(args),
        Command::Run(args) => cli::run::run(args),
        Command::Scenarios(args) => cli::scenarios::run(args),
        Command::Schema(args) => cli::schema::run(args),
        Command::Sun(args) => cli::sun::run(args),
        Command::Terrain(args) => cli::terrain::run(args),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if is_broken_pipe(error.as_ref()) => ExitCode::SUCCESS,
        Err(error) => {
            cli::failure::report(error.as_ref(), as_json);
            ExitCode::FAILURE
        }
    }
}

/// The reader has seen enough, as in `sim schema | head`.
fn is_broken_pipe(error: &(dyn Error + 'static)) -> bool {
    error.downcast_ref::<std::io::Error>().is_some_and(|error| error.kind() == std::io::ErrorKind::BrokenPipe)
}
