//! All integration tests in one binary.

mod cli {
    mod ephemeris;
}

mod reference {
    mod default_kernels;
    mod ephemeris;
    mod trajectory;
}
