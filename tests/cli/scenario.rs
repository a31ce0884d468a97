//! The scenarios that ship, and the words of `sim check` and `sim schema`.
