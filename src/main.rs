//! The program `sim`: one match, one error chain, exit codes.

mod cli;

use std::error::Error;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use perilune::scenario::ScenarioError;

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
  sim inspect output/lunar_descent    what was made, and whether it is whole
  sim schema                          all that a scenario can say

Exit codes: 0 done, 1 an error, said in one line, 2 wrong arguments";

#[derive(Debug, Subcommand)]
enum Command {
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
        Err(error) if is_broken_pipe(error.as_ref()) => ExitCode::SUCCESS,
        Err(error) => {
            lines(error.as_ref()).iter().for_each(|line| eprintln!("error: {line}"));
            ExitCode::FAILURE
        }
    }
}

/// A line a problem where there may be several, else one.
fn lines(error: &(dyn Error + 'static)) -> Vec<String> {
    if error.is::<ScenarioError>() || error.is::<cli::Problems>() {
        return error.to_string().lines().map(String::from).collect();
    }
    vec![chain(error)]
}

/// The reader has seen enough, as in `sim schema | head`.
fn is_broken_pipe(error: &(dyn Error + 'static)) -> bool {
    error.downcast_ref::<std::io::Error>().is_some_and(|error| error.kind() == std::io::ErrorKind::BrokenPipe)
}

/// An error and its causes on one line; what an error quotes of its cause is not said again.
pub fn chain(error: &dyn Error) -> String {
    let causes = std::iter::successors(error.source(), |cause: &&dyn Error| (*cause).source());
    causes.fold(one_line(error), |line, cause| match one_line(cause) {
        cause if line.contains(&cause) => line,
        cause => format!("{line}: {cause}"),
    })
}

/// Other libraries break their messages.
fn one_line(error: &dyn Error) -> String {
    error.to_string().lines().map(str::trim).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Clone)]
    struct Said(&'static str, Option<Box<Said>>);

    impl std::fmt::Display for Said {
        fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
            f.write_str(self.0)
        }
    }

    impl Error for Said {
        fn source(&self) -> Option<&(dyn Error + 'static)> {
            self.1.as_ref().map(|cause| cause.as_ref() as _)
        }
    }

    #[test]
    fn no_cause_is_said_twice() {
        let full = || Box::new(Said("no space left", None));
        assert_eq!(chain(&Said("cannot write a", Some(full()))), "cannot write a: no space left");
        assert_eq!(chain(&Said("cannot write a: no space left", Some(full()))), "cannot write a: no space left");
        let middle = Box::new(Said("cannot write a", Some(full())));
        assert_eq!(chain(&Said("run", Some(middle.clone()))), "run: cannot write a: no space left");
        assert_eq!(chain(&Said("run: cannot write a", Some(middle))), "run: cannot write a: no space left");
    }

    #[test]
    fn an_error_is_one_line() {
        assert_eq!(chain(&Said("a\n  b", None)), "a b");
    }
}
