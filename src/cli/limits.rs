//! Threads and memory that work needs, settled before it begins: a thread that cannot start later ends the process.

use perilune_engine::report::machine;

/// More threads for each core only wait for each other.
const THREADS_PER_CORE: usize = 4;

/// With less address space a device, the stacks of threads and the libraries' heaps have no room.
const LEAST_MIB: f64 = 1024.0;

/// Starts the threads that share all work: one a core, or as many as `RAYON_NUM_THREADS` says, within reason.
pub fn start_threads() -> Result<(), String> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let asked = std::env::var("RAYON_NUM_THREADS").ok().and_then(|text| text.trim().parse().ok());
    let threads = threads(asked, cores);
    if let Some(asked) = asked.filter(|asked| *asked > threads) {
        eprintln!("RAYON_NUM_THREADS = {asked}: {threads} threads are started on {cores} cores");
    }
    let started = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    started.map_err(|error| format!("cannot start {threads} threads, for want of memory or by a limit: {error}"))
}

fn threads(asked: Option<usize>, cores: usize) -> usize {
    match asked {
        None | Some(0) => cores,
        Some(asked) => asked.min(THREADS_PER_CORE * cores),
    }
}

/// Refuses to work where the process may not take the least memory.
pub fn check_memory() -> Result<(), String> {
    match machine::address_space_left_bytes().map(|bytes| bytes / f64::from(1 << 20)) {
        Some(left) if left < LEAST_MIB => Err(format!(
            "memory: the process may take {left:.0} MiB of address space more, {LEAST_MIB} MiB are needed at least; raise the limit \
             (ulimit -v)"
        )),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_as_many_as_asked_for_within_reason() {
        assert_eq!([None, Some(0), Some(3), Some(100_000)].map(|asked| threads(asked, 2)), [2, 2, 3, 8]);
    }
}
