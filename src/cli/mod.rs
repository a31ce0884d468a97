//! The program's subcommands, one file each: arguments in, text and exit code out.

pub mod check;
pub mod horizon;
pub mod inspect;
pub mod kernels;
pub mod schema;
pub mod sun;
pub mod terrain;

/// What a subcommand returns: any error, printed by `main` as one line.
pub type Outcome = Result<(), Box<dyn std::error::Error>>;
