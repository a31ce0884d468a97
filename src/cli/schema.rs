//! `sim schema`.

use std::io::Write;

use perilune_engine::scenario;

use super::Outcome;

/// Print the scenario reference: every key with its type, range, unit, default and meaning.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: sim schema | less")]
pub struct Args {
    /// Print the JSON schema instead
    #[arg(long)]
    json: bool,
}

pub fn run(args: Args) -> Outcome {
    let text = if args.json { format!("{:#}\n", scenario::schema().as_value()) } else { scenario::reference::text() };
    // `print!` would panic when the reader goes away, as in `sim schema | head`.
    std::io::stdout().write_all(text.as_bytes())?;
    Ok(())
}
