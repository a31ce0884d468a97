//! The program's subcommands, one file each: arguments in, text and exit code out.

pub mod bars;
pub mod bench;
pub mod check;
pub mod horizon;
pub mod inspect;
pub mod kernels;
pub mod run;
pub mod schema;
pub mod sun;
pub mod terrain;

/// What a subcommand returns: any error, printed by `main` as one line.
pub type Outcome = Result<(), Box<dyn std::error::Error>>;

/// What a file is and where it can be had, for the error that misses it.
pub fn about(name: &str) -> Option<String> {
    let file = perilune::ephemeris::known_file(name)?;
    let checksum = file.sha256.as_ref().map_or(String::new(), |sha256| format!(", SHA-256 {sha256}"));
    Some(format!("{}, from {}{checksum}", file.what, file.source))
}
