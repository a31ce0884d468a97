//! What the benchmarks say, held to cases where the answer is known.

mod horizons;
mod illumination;
mod radiometry;
mod shadows;
mod stability;
