//! Perilune renders calibrated images of airless terrain for landing navigation.
