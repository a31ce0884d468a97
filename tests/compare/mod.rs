//! Comparisons with photographs whose answer is known, and with real ones.

mod apollo;
mod archives;
mod cameras;
mod itself;
mod registration;
pub mod scene;
