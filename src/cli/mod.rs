//! The program's subcommands, one file each: arguments in, text and exit code out.

use std::io::Write as _;

pub mod bars;
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

/// Several problems at once, a line each.
#[derive(Debug)]
pub struct Problems(pub Vec<String>);

impl std::fmt::Display for Problems {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(&self.0.join("\n"))
    }
}

impl std::error::Error for Problems {}

/// Prints a line. `println!` would panic when the reader goes away, as in `sim sun … | head`; `main` ends quietly.
pub fn say(line: impl std::fmt::Display) -> std::io::Result<()> {
    writeln!(std::io::stdout(), "{line}")
}

/// What a file is and where it can be had, for the error that misses it.
pub fn about(name: &str) -> Option<String> {
    let file = perilune::ephemeris::known_file(name)?;
    let checksum = file.sha256.as_ref().map_or(String::new(), |sha256| format!(", SHA-256 {sha256}"));
    Some(format!("{}, from {}{checksum}", file.what, file.source))
}
