//! What the program says and writes.

mod bad_input;
<<<<<<< HEAD
mod ephemeris;
=======
mod inspect;
>>>>>>> scenario
mod scenario;
mod terrain;
