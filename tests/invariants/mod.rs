//! What physics demands of any implementation.

mod photometry;
mod render;
