//! Process: memory and files of this process, as Linux reports them. Other systems report nothing.

use std::fs;

/// The resources of the process.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Process {
    /// Resident memory, in bytes.
    pub resident_bytes: u64,
    /// Open files and connections.
    pub open_fds: u64,
}

impl Process {
    /// Returns the current values.
    pub fn now() -> Self {
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        // The folder itself is open while it is read.
        let open_fds = fs::read_dir("/proc/self/fd").map_or(0, |open| open.count().saturating_sub(1) as u64);
        Self { resident_bytes: resident_bytes(&status).unwrap_or(0), open_fds }
    }
}

fn resident_bytes(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_memory_is_read_in_bytes() {
        assert_eq!(resident_bytes("Name:\trevisit\nVmRSS:\t    2048 kB\nThreads:\t3\n"), Some(2_097_152));
        assert_eq!(resident_bytes("Name:\trevisit\n"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_process_holds_something() {
        let now = Process::now();
        assert!(now.resident_bytes > 1 << 20 && now.open_fds >= 3, "{now:?}");
    }
}
