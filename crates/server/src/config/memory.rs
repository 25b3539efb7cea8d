//! Memory: the budget of loaded maps.

use std::fs;
use std::path::Path;

use clap::Args;

const MIB: u64 = 1 << 20;

/// The budget where neither the operator nor the system states one, in bytes.
const UNKNOWN_MACHINE: u64 = 1 << 30;

/// The memory budget of loaded maps.
#[derive(Args, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[command(next_help_heading = "Limits")]
pub struct MemoryArgs {
    /// Memory for loaded maps, in MiB. Above it, idle maps are evicted, least recently used first, and reloaded on
    /// demand; a map larger than this is loaded alone [default: half of the memory of the machine or the container]
    #[arg(long, env = "REVISIT_MAP_MEMORY", value_name = "MIB", value_parser = clap::value_parser!(u64).range(1..=1 << 30))]
    pub map_memory: Option<u64>,
}

impl MemoryArgs {
    /// Returns the budget of the maps, in bytes.
    pub fn map_memory_bytes(self) -> u64 {
        match self.map_memory {
            Some(mebibytes) => mebibytes.saturating_mul(MIB),
            None => machine_bytes(Path::new("/")).map_or(UNKNOWN_MACHINE, |bytes| (bytes / 2).max(MIB)),
        }
    }
}

/// Returns the memory available to this process, in bytes: the machine's, or less if a control group limits it.
fn machine_bytes(root: &Path) -> Option<u64> {
    let read = |path: &str| fs::read_to_string(root.join(path)).ok();
    let machine = read("proc/meminfo").and_then(|text| total(&text));
    let groups = read("proc/self/cgroup").unwrap_or_default();
    let of_groups = groups.lines().flat_map(limit_files).filter_map(|path| read(&path)?.trim().parse().ok());
    of_groups.chain(machine).min()
}

/// Returns the machine's total memory by `/proc/meminfo`, in bytes.
fn total(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

/// Returns the files that limit a group of `/proc/self/cgroup`: its own, and those of its parents. A container often
/// sees its own group as the root, whatever its path.
fn limit_files(line: &str) -> Vec<String> {
    let mut parts = line.splitn(3, ':');
    let (_, controllers, path) = (parts.next(), parts.next().unwrap_or(""), parts.next().unwrap_or("/"));
    let (folder, file) = match controllers {
        "" => ("sys/fs/cgroup", "memory.max"),
        _ if controllers.split(',').any(|name| name == "memory") => {
            ("sys/fs/cgroup/memory", "memory.limit_in_bytes")
        }
        _ => return Vec::new(),
    };
    let groups = Path::new(path.trim_start_matches('/')).ancestors();
    groups.map(|group| Path::new(folder).join(group).join(file).display().to_string()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a root folder with these files.
    fn machine(files: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for (path, text) in files {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        root
    }

    #[test]
    fn a_container_gets_what_its_groups_allow_and_no_more_than_the_machine_has() {
        type Files<'f> = &'f [(&'f str, &'f str)];
        const MEMINFO: (&str, &str) = ("proc/meminfo", "MemTotal:    4096 kB\nMemFree:  1 kB\n");
        let cases: [(Files<'_>, Option<u64>); 6] = [
            (&[], None),
            (&[MEMINFO], Some(4 << 20)),
            (
                &[MEMINFO, ("proc/self/cgroup", "0::/a/b\n"), ("sys/fs/cgroup/a/b/memory.max", "max\n")],
                Some(4 << 20),
            ),
            (
                &[MEMINFO, ("proc/self/cgroup", "0::/a/b\n"), ("sys/fs/cgroup/a/memory.max", "1048576\n")],
                Some(1 << 20),
            ),
            (
                &[MEMINFO, ("proc/self/cgroup", "0::/x\n"), ("sys/fs/cgroup/memory.max", "2097152\n")],
                Some(2 << 20),
            ),
            (
                &[
                    MEMINFO,
                    ("proc/self/cgroup", "5:cpu:/a\n4:memory:/a\n"),
                    ("sys/fs/cgroup/memory/a/memory.limit_in_bytes", "524288\n"),
                ],
                Some(1 << 19),
            ),
        ];
        for (files, expected) in cases {
            assert_eq!(machine_bytes(machine(files).path()), expected, "{files:?}");
        }
    }
}
