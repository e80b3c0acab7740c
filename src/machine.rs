//! Resources of the machine, or those that a container grants.

use std::fs;

/// Where the system does not report its memory, it has this much, in MB.
const USUAL_MB: u64 = 4096;

/// The memory that the process may have, in MB.
pub(crate) fn memory_mb() -> u64 {
    let read = |path: &str| fs::read_to_string(path).unwrap_or_default();
    of(
        &read("/proc/meminfo"),
        &[
            read("/sys/fs/cgroup/memory.max"),
            read("/sys/fs/cgroup/memory/memory.limit_in_bytes"),
        ],
    )
}

/// The value of the system, or a lower limit.
fn of(system: &str, limits: &[String]) -> u64 {
    let total = system
        .lines()
        .find_map(|line| line.strip_prefix("MemTotal:"))
        .and_then(|rest| rest.split_whitespace().next()?.parse::<u64>().ok())
        .map_or(USUAL_MB, |kilobytes| kilobytes >> 10);
    let limits = limits
        .iter()
        .filter_map(|limit| limit.trim().parse::<u64>().ok())
        .map(|bytes| bytes >> 20);
    limits.fold(total, u64::min)
}

/// The memory that the process occupies, in bytes, where the system tells.
pub(crate) fn occupied_bytes() -> Option<u64> {
    occupied(&fs::read_to_string("/proc/self/status").ok()?)
}

fn occupied(status: &str) -> Option<u64> {
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes << 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_memory_of_the_process_is_what_the_system_says() {
        assert_eq!(occupied("Name:\tx\nVmRSS:\t    2048 kB\n"), Some(2 << 20));
        assert_eq!(occupied("Name:\tx\n"), None);
    }

    #[test]
    fn the_lower_of_what_the_machine_has_and_the_container_leaves_counts() {
        let system = "MemTotal:       24585184 kB\nMemFree:        20000000 kB\n";
        let limits = |text: &str| vec![text.to_owned(), String::new()];
        assert_eq!(of(system, &limits("max\n")), 24_008);
        assert_eq!(of(system, &limits("536870912\n")), 512);
        // The largest number stands for none.
        assert_eq!(of(system, &limits("9223372036854771712\n")), 24_008);
        assert_eq!(of("", &[]), USUAL_MB);
    }
}
