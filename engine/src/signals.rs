//! Ctrl-C as a word that the program asks for.

use std::sync::atomic::{AtomicBool, Ordering};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C (SIGINT) does not end the program but is told by [`interrupted`].
pub fn catch_interrupts() {
    // SAFETY: the handler stores into an atomic, which may be done at any moment.
    unsafe { libc::signal(libc::SIGINT, note as *const () as libc::sighandler_t) };
}

extern "C" fn note(_: libc::c_int) {
    INTERRUPTED.store(true, Ordering::Relaxed);
}

/// Whether there was one.
pub fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}
