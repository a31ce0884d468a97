//! The machine that measured, as far as a figure depends on it.

use std::fs;

use serde::Serialize;

use crate::dataset::commit;
use crate::ephemeris::utc_text;

/// Where and with what a benchmark ran.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Machine {
    pub cpu: String,
    pub cores: usize,
    pub system: String,
    /// Runnable threads over the last minute, before the benchmark began: other people's work.
    pub load: Option<f64>,
    pub version: String,
    pub commit: Option<String>,
    pub date: String,
}

impl Machine {
    /// The one this program runs on, now.
    pub fn here() -> Self {
        let load = fs::read_to_string("/proc/loadavg").ok();
        let date = hifitime::Epoch::now().map_or_else(|_| "unknown".into(), utc_text);
        Self {
            cpu: cpu().unwrap_or_else(|| "unknown".into()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            load: load.and_then(|text| text.split(' ').next()?.parse().ok()),
            version: env!("CARGO_PKG_VERSION").into(),
            commit: commit(),
            date,
        }
    }

    /// One line for people.
    pub fn line(&self) -> String {
        let Self { cpu, cores, system, load, version, commit, date } = self;
        let load = load.map_or(String::new(), |load| format!(", load {load} at the start"));
        let commit = commit.as_ref().map_or(String::new(), |commit| format!(" ({commit})"));
        format!("{cpu}, {cores} cores, {system}{load}; perilune {version}{commit}; {date}")
    }
}

fn cpu() -> Option<String> {
    let text = fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// Seconds that this thread has spent on a core, where the system can tell: other programs do not count.
pub fn thread_seconds() -> Option<f64> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(text.split(' ').next()?.parse::<u64>().ok()? as f64 * 1e-9)
}

/// Seconds that all threads of this program have spent on all cores, ended ones too, where the system can tell: to 0.01 s.
pub fn process_seconds() -> Option<f64> {
    let text = fs::read_to_string("/proc/self/stat").ok()?;
    // After the program's name, which may hold blanks: user and system time are fields 14 and 15, in ticks of 10 ms.
    let mut fields = text.rsplit_once(')')?.1.split_whitespace().skip(11).map(str::parse::<f64>);
    Some((fields.next()?.ok()? + fields.next()?.ok()?) / 100.0)
}

/// The most memory that the process has held since [`forget_peak_memory`], in MiB, where the system can tell.
pub fn peak_memory_mib() -> Option<f64> {
    peak_memory_mib_of(std::process::id())
}

/// The most memory that a process has held, in MiB; `None` where the system cannot tell, or it is gone.
pub fn peak_memory_mib_of(process: u32) -> Option<f64> {
    let text = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = text.lines().find(|line| line.starts_with("VmHWM"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

/// Memory that this process may still take: what the system has left, within the limits on the process and on its control group.
/// `None`: the system does not say.
pub fn available_memory_bytes() -> Option<f64> {
    let free = kib("/proc/meminfo", "MemAvailable:");
    let number = |file: &str| fs::read_to_string(file).ok()?.trim().parse::<f64>().ok();
    let of_group = number("/sys/fs/cgroup/memory.max")
        .zip(number("/sys/fs/cgroup/memory.current"))
        .map(|(most, taken)| most - taken);
    [free, address_space_left_bytes(), of_group].into_iter().flatten().reduce(f64::min)
}

/// What the limit on its address space (`ulimit -v`) leaves to this process; `None`: there is no limit.
pub fn address_space_left_bytes() -> Option<f64> {
    Some(address_space_bytes()? - kib("/proc/self/status", "VmSize:")?)
}

/// A number of KiB from a line of one of the system's files, in bytes.
fn kib(file: &str, key: &str) -> Option<f64> {
    let text = fs::read_to_string(file).ok()?;
    let line = text.lines().find(|line| line.starts_with(key))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? * 1024.0)
}

/// The limit on the process's address space (`ulimit -v`).
fn address_space_bytes() -> Option<f64> {
    let text = fs::read_to_string("/proc/self/limits").ok()?;
    let line = text.lines().find(|line| line.starts_with("Max address space"))?;
    line.split_whitespace().nth(3)?.parse().ok()
}

/// Begins a new measurement of the peak; what is held now stays in it.
pub fn forget_peak_memory() {
    // Where the system does not know it the peak goes on from the start of the process.
    let _ = fs::write("/proc/self/clear_refs", "5");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_that_was_held_shows_in_the_peak() {
        let held = std::hint::black_box(vec![1u8; 200 << 20]);
        drop(held);
        assert!(peak_memory_mib().is_none_or(|mib| mib > 200.0));
    }

    #[test]
    fn a_thread_that_works_spends_time() {
        let Some(before) = thread_seconds() else { return };
        let start = std::time::Instant::now();
        while start.elapsed().as_secs_f64() < 0.05 {
            std::hint::black_box((0..1000).sum::<u64>());
        }
        assert!(thread_seconds().unwrap() > before);
        // Of the process at least as much; ticks are shorter than what was worked.
        assert!(process_seconds().unwrap() > 0.0);
    }
}
