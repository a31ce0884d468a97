//! Progress on standard error: a bar where that is a terminal; else a line when rendering begins, or another stage takes long,
//! and one every half minute.

use std::io::IsTerminal as _;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressState, ProgressStyle};
use perilune_engine::pipeline::Progress;

/// A stage that is over sooner is not worth a line.
const WORTH_A_LINE: Duration = Duration::from_secs(10);
/// What the user waits for is told at once.
const AWAITED: &str = "rendering";
const EVERY: Duration = Duration::from_secs(30);
const TICK: Duration = Duration::from_millis(250);

/// One stage after the other.
#[derive(Debug)]
pub struct Bars {
    current: Mutex<ProgressBar>,
    /// `None` on a terminal.
    lines: Option<Arc<Mutex<Option<Stage>>>>,
}

/// What is going on, for lines.
#[derive(Debug)]
struct Stage {
    name: String,
    unit: String,
    done: usize,
    total: usize,
    began: Instant,
    told: Option<Instant>,
}

impl Stage {
    /// `rendering: 12 of 200 exposures after 90 s, 24 min left`
    fn line(&self) -> String {
        let Self { name, unit, done, total, began, .. } = self;
        let seconds = began.elapsed().as_secs();
        let count = match (*done, *total) {
            (_, 0) => String::new(),
            (0, 1) => format!(": 1 {}", unit.trim_end_matches('s')),
            (0, total) => format!(": {total} {unit}"),
            (done, total) => format!(": {done} of {total} {unit}"),
        };
        let after = if self.told.is_some() { format!(" after {}", duration(seconds)) } else { String::new() };
        let left = match (*done, *total) {
            (0, _) => String::new(),
            (done, total) if done < total && seconds > 5 => {
                format!(", {} left", duration(seconds * (total - done) as u64 / done as u64))
            }
            _ => String::new(),
        };
        format!("{name}{count}{after}{left}")
    }

    /// Says where the stage is, where that is due.
    fn tell(&mut self) {
        let due = self.told.map_or(self.began.elapsed() >= WORTH_A_LINE, |told| told.elapsed() >= EVERY);
        if due {
            eprintln!("{}", self.line());
            self.told = Some(Instant::now());
        }
    }
}

fn duration(seconds: u64) -> String {
    match seconds {
        0..120 => format!("{seconds} s"),
        120..7200 => format!("{} min", seconds / 60),
        _ => format!("{:.1} h", seconds as f64 / 3600.0),
    }
}

impl Bars {
    pub fn new() -> Self {
        let lines = (!std::io::stderr().is_terminal()).then(Arc::default);
        if let Some(lines) = &lines {
            let lines = Arc::downgrade(lines);
            std::thread::spawn(move || tell_while_alive(&lines));
        }
        Self { current: Mutex::new(ProgressBar::hidden()), lines }
    }

    pub fn clear(&self) {
        self.bar().finish_and_clear();
        if let Some(lines) = &self.lines {
            *locked(lines) = None;
        }
    }

    fn bar(&self) -> ProgressBar {
        locked(&self.current).clone()
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn tell_while_alive(lines: &Weak<Mutex<Option<Stage>>>) {
    while let Some(lines) = lines.upgrade() {
        if let Some(stage) = locked(&lines).as_mut() {
            stage.tell();
        }
        drop(lines);
        std::thread::sleep(TICK);
    }
}

/// Nothing is known before the first step, and after the last there is something left to do.
fn left(state: &ProgressState, text: &mut dyn std::fmt::Write) {
    let seconds = state.eta().as_secs();
    let _ = match (state.pos(), state.len()) {
        (0, _) => Ok(()),
        (done, Some(all)) if done >= all => text.write_str("finishing"),
        _ => write!(text, "{} left", duration(seconds)),
    };
}

impl Progress for Bars {
    fn begin(&self, stage: &str, total: usize, unit: &str) {
        self.clear();
        if let Some(lines) = &self.lines {
            let (name, unit) = (stage.to_owned(), unit.to_owned());
            let mut stage = Stage { name, unit, done: 0, total, began: Instant::now(), told: None };
            if stage.name == AWAITED {
                eprintln!("{}", stage.line());
                stage.told = Some(Instant::now());
            }
            *locked(lines) = Some(stage);
            return;
        }
        let template = format!("{{msg:36}} {{bar:32}} {{pos}} of {{len}} {unit}  {{left}}");
        let style = ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar =
            ProgressBar::new(total as u64).with_style(style.with_key("left", left)).with_message(stage.to_owned());
        bar.enable_steady_tick(TICK);
        *locked(&self.current) = bar;
    }

    fn at(&self, done: usize, total: usize) {
        let bar = self.bar();
        bar.set_length(total as u64);
        bar.set_position(done as u64);
        let mut line = self.lines.as_ref().map(|lines| locked(lines));
        if let Some(stage) = line.as_mut().and_then(|line| line.as_mut()) {
            (stage.done, stage.total) = (done, total);
        }
    }

    fn say(&self, line: &str) {
        self.bar().suspend(|| eprintln!("{line}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_say_what_is_done_of_what() {
        let began = Instant::now() - Duration::from_secs(100);
        let stage = |done: usize, told: Option<Instant>| {
            Stage { name: "rendering".into(), unit: "exposures".into(), done, total: 200, began, told }.line()
        };
        assert_eq!(stage(0, None), "rendering: 200 exposures");
        let (name, unit) = ("rendering".into(), "exposures".into());
        let one = Stage { name, unit, done: 0, total: 1, began, told: None };
        assert_eq!(one.line(), "rendering: 1 exposure");
        assert_eq!(stage(50, Some(began)), "rendering: 50 of 200 exposures after 100 s, 5 min left");
        assert_eq!(stage(200, Some(began)), "rendering: 200 of 200 exposures after 100 s");
    }
}
