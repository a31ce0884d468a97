//! Horizons against closed forms, against other programs, and the fast ones against the believed ones.
mod bound;
mod closed_forms;
mod encodings;
mod exact;
mod gpu;
mod hostile;
mod programs;
pub mod scene;
mod sweep;
mod tile;
