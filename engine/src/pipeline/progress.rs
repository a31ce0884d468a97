//! What long work tells while it goes on.

/// Hears of stages and of the work done in them; the command line draws bars, tests listen in silence.
pub trait Progress: Sync {
    /// A stage begins; it will take `total` steps of `unit`.
    fn begin(&self, stage: &str, total: usize, unit: &str);
    /// Steps of the stage that are done, of a total that may have changed.
    fn at(&self, done: usize, total: usize);
    /// A line that the user should see.
    fn say(&self, line: &str);
}

/// Says nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _stage: &str, _total: usize, _unit: &str) {}
    fn at(&self, _done: usize, _total: usize) {}
    fn say(&self, _line: &str) {}
}
