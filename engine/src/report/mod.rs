//! What was measured, for people and for programs: tables, plots and pages beside the machine that measured.

pub mod error;
pub mod machine;
pub mod page;
pub mod plot;
pub mod table;

pub use error::Error;
pub use machine::Machine;
pub use page::{Figure, Report};
pub use table::{Table, Value};
