//! How much memory a build takes, and what it does with it.
//!
//! ```text
//! budget = program + terrain + prepared heights + sums and their fit (or a piece of the sums) + planes
//! ```
//!
//! Program, terrain and heights are what they are; if the rest holds the sums and what their fit takes they stay in memory, else
//! it goes to planes. A build never fails for its budget: one plane is the least, and the fit of a pyramid of fields, whose
//! coarse means are in memory, takes what it takes.

use std::sync::atomic::{AtomicBool, Ordering};

use super::calibration;
use super::fit::Accumulator;
use super::pack::{Encoding, Family};
use super::request::Request;

const MIB: usize = 1 << 20;

/// The program with its libraries (47 MiB with a full GDAL), what these keep (18 MiB), buffers of files.
const PROGRAM: usize = 70 * MIB;

/// Most planes of a thread in a block where the sums are those of fields, many more than a plane's numbers. Where they are fewer
/// one does: planes that fit into a core's cache are worth as much.
const PLANES_EACH: usize = 4;
/// For planes that would otherwise be swept twice: those of a tile of 512² nodes.
const PROBES: usize = 64 * MIB;

/// Memory that the process may take while it builds a tile, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory(pub usize);

impl Default for Memory {
    fn default() -> Self {
        Self::mib(2048)
    }
}

/// What a budget allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Allowance {
    pub sums_fit: bool,
    /// Azimuths that are swept before they are added.
    pub planes: usize,
    /// Whether those that the bounds are found from are kept until then.
    pub probes_fit: bool,
}

impl Memory {
    pub const fn mib(mib: usize) -> Self {
        Self(mib * MIB)
    }

    /// How many tiles of `side²` nodes, a margin around each, may be made side by side: at least one.
    pub fn tiles(self, encoding: Encoding, side: usize, margin: usize, azimuths: usize) -> usize {
        let sums = sums(encoding, side, side, azimuths);
        // A level and half a dozen coarser ones around it, as they are read and as they are swept.
        let terrain = 6 * (5 + 8) * (side + 2 * margin).pow(2);
        (self.0.saturating_sub(PROGRAM) / (sums + terrain)).max(1)
    }

    /// What each of `tiles` that are made side by side may take, the program counted with each.
    pub fn shared_by(self, tiles: usize) -> Self {
        Self(PROGRAM + self.0.saturating_sub(PROGRAM) / tiles)
    }

    pub fn allowance(self, request: &Request) -> Allowance {
        let threads = rayon::current_num_threads();
        let nodes = request.nodes();
        let [columns, rows] = nodes.seen_size();
        let plane = 4 * columns.next_multiple_of(32) * rows.next_multiple_of(32);
        let all = |bytes: usize| request.face.levels.iter().map(|level| bytes * level.heights_m.len()).sum::<usize>();
        // Heights and gaps; then heights and twists as they are swept.
        let terrain = all(5);
        let prepared = all(4) + 4 * nodes.heights_m.len() + plane;
        let left = self.0.saturating_sub(PROGRAM + terrain + prepared);
        let sums = sums(request.encoding, columns, rows, request.settings.azimuths);
        // A plane of a block, and its compressed copy if it has one.
        let swept = plane * if request.encoding.growth().is_some() { 2 } else { 1 };
        if sums + threads * swept <= left {
            let probes = calibration::probed(request.settings.azimuths).count() * plane;
            let probes_fit = probes <= PROBES.min(left - sums - threads * swept);
            let kept = sums + if probes_fit { probes } else { 0 };
            // Sums are read and written once for all planes of a block.
            let most = if request.encoding.family() == Family::Quantised { PLANES_EACH } else { 1 };
            let each = ((left - kept) / swept / threads).min(most);
            return Allowance { sums_fit: true, planes: each * threads, probes_fit };
        }
        // A whole number for each thread, so that none waits, if there is one.
        let planes = (left / swept).max(1);
        let planes = if planes > threads { planes / threads * threads } else { planes };
        Allowance { sums_fit: false, planes, probes_fit: false }
    }
}

/// Bytes of a tile's sums in memory, and of what their fit takes.
fn sums(encoding: Encoding, columns: usize, rows: usize, azimuths: usize) -> usize {
    let accumulator = Accumulator::on_disk(encoding, columns, rows, azimuths);
    accumulator.bytes() + accumulator.fit_bytes()
}

/// Whether the program has given its allocator into the hands of builds: a library leaves its host's alone.
static MANAGED: AtomicBool = AtomicBool::new(false);

/// For the program, at its start: lets the C library keep buffers that were freed for the next azimuth's, and builds that
/// are short of memory give them back. By itself it returns the end of a thread's heap to the
/// system, whose pages are then made anew for every plane: a third of the time of exact horizons.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub fn keep() {
    MANAGED.store(true, Ordering::Relaxed);
    // SAFETY: may be called at any time by any thread.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, 32 << 20);
        libc::mallopt(libc::M_TRIM_THRESHOLD, 1 << 30);
    }
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn keep() {
    MANAGED.store(true, Ordering::Relaxed);
}

/// Lets the C library give buffers back to the system as soon as they are free, in a program that has called [`keep`]. By itself it raises the size from which it does
/// (`M_MMAP_THRESHOLD`) to that of the largest buffer that was freed, and keeps some 20 MiB of a tile of 1024² nodes.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub fn give_back() {
    if !MANAGED.load(Ordering::Relaxed) {
        return;
    }
    // SAFETY: all may be called at any time by any thread.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, 128 << 10);
        libc::mallopt(libc::M_TRIM_THRESHOLD, 128 << 10);
        libc::malloc_trim(0);
    }
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn give_back() {}
