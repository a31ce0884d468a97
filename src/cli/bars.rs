//! Progress on standard error: a bar where that is a terminal, nothing where it is not.

use std::sync::Mutex;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use perilune_engine::pipeline::Progress;

/// One bar after the other, a stage each.
#[derive(Debug)]
pub struct Bars {
    current: Mutex<ProgressBar>,
}

impl Bars {
    pub fn new() -> Self {
        Self { current: Mutex::new(ProgressBar::hidden()) }
    }

    pub fn clear(&self) {
        self.bar().finish_and_clear();
    }

    fn bar(&self) -> ProgressBar {
        self.current.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).clone()
    }
}

impl Progress for Bars {
    fn begin(&self, stage: &str, total: usize, unit: &str) {
        self.clear();
        let template = format!("{{msg:32}} {{bar:36}} {{pos}}/{{len}} {unit}, {{per_sec}}, {{eta}} left");
        let style = ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::new(total as u64).with_style(style).with_message(stage.to_owned());
        bar.enable_steady_tick(Duration::from_millis(250));
        *self.current.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = bar;
    }

    fn at(&self, done: usize, total: usize) {
        let bar = self.bar();
        bar.set_length(total as u64);
        bar.set_position(done as u64);
    }

    fn say(&self, line: &str) {
        self.bar().suspend(|| eprintln!("{line}"));
    }
}
