//! What the benchmarks say, held to cases where the answer is known.

mod horizons;
mod illumination;
mod shadows;
mod stability;
