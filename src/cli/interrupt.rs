//! Ctrl-C: what is kept, and how to go on. Files are whole or absent at any moment, so that there is nothing to tidy up.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use perilune_engine::signals;

/// The shell's own: 128 and the number of the signal.
const EXIT_CODE: i32 = 130;

const LOOK_EVERY: Duration = Duration::from_millis(50);

type Message = Box<dyn Fn() -> String + Send>;

static MESSAGE: Mutex<Option<Message>> = Mutex::new(None);

/// Listens from now on.
pub fn listen() {
    signals::catch_interrupts();
    std::thread::spawn(|| {
        while !signals::interrupted() {
            std::thread::sleep(LOOK_EVERY);
        }
        let message = MESSAGE.lock().unwrap_or_else(PoisonError::into_inner);
        let said = message.as_ref().map_or_else(usual, |message| message());
        // A line of its own, after the terminal's ^C.
        eprintln!("\ninterrupted: {said}");
        std::process::exit(EXIT_CODE);
    });
}

fn usual() -> String {
    format!("what is finished is kept, horizons that are half made too; go on with: {}", command(None, ""))
}

/// What to say from now on.
pub fn explain(message: impl Fn() -> String + Send + 'static) {
    *MESSAGE.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(message));
}

/// The command as it was given, with a flag that it may have already and without another.
pub fn command(with: Option<&str>, without: &str) -> String {
    let mut words: Vec<String> = std::env::args().skip(1).filter(|word| word != without).map(quoted).collect();
    words.extend(with.filter(|flag| !words.iter().any(|word| word == flag)).map(String::from));
    format!("sim {}", words.join(" "))
}

/// For a shell.
fn quoted(word: String) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "-_./,:=+@%".contains(letter);
    if !word.is_empty() && word.chars().all(is_plain) { word } else { format!("'{}'", word.replace('\'', r"'\''")) }
}
