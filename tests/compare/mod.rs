//! Comparisons with photographs whose answer is known, and with real ones.

mod apollo;
mod cameras;
mod itself;
mod registration;
mod scene;
