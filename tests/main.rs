//! All integration tests in one binary.

mod cli {
    mod terrain;
}
mod reference {
    mod raster;
}
