//! Memory that a run may take: limits of the user, the machine and the process.
//!
//! Limits are read from files, where the system has them (Linux); elsewhere there are none.

use crate::text_format::bytes;
use faying::problem::Forecast;
use std::path::{Path, PathBuf};

/// Share of the memory of a machine or of a control group that a run may be predicted to need: the rest is the system's.
const SHARE: f64 = 0.9;
/// Share of the address space that may go to stacks and heaps of threads: 1 / 4.
const FOR_THREADS: u64 = 4;
/// Address space that a thread takes: its stack, and the heap that the system's library keeps for it.
const PER_THREAD: u64 = (64 + 2) << 20;

/// The most restrictive of all memory limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryLimit {
    /// Bytes that a run may be predicted to need.
    pub bytes: u64,
    /// The limit itself.
    limit: u64,
    whose: Whose,
}

/// Origin of a memory limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Whose {
    User,
    Machine,
    /// `ulimit -v`.
    AddressSpace,
    /// `ulimit -d`.
    Data,
    ControlGroup,
}

impl MemoryLimit {
    /// Returns the least limit: `asked` (in place of the machine's memory), control groups, and limits of the process less what it has
    /// taken; `None` if there are none.
    pub fn least(asked: Option<u64>) -> Option<Self> {
        let own = |limit: u64, whose| Self { bytes: limit, limit, whose };
        let share = |limit: u64, whose| Self { bytes: (SHARE * limit as f64) as u64, limit, whose };
        let of_process = |name, taken, whose| {
            let limit = process_limit(&read("/proc/self/limits")?, name)?;
            // the program is part of the forecast, and is taken already
            let left = limit.saturating_sub(status(&read("/proc/self/status")?, taken)?) + Forecast::PROGRAM;
            Some(Self { bytes: left.min(limit), limit, whose })
        };
        let asked = match asked {
            Some(limit) => Some(own(limit, Whose::User)),
            None => physical_memory().map(|all| share(all, Whose::Machine)),
        };
        let group = read("/proc/self/cgroup").and_then(|groups| group_limit(&groups, Path::new("/sys/fs/cgroup")));
        let all = [
            asked,
            of_process("Max address space", "VmSize", Whose::AddressSpace),
            of_process("Max data size", "VmData", Whose::Data),
            group.map(|limit| share(limit, Whose::ControlGroup)),
        ];
        all.into_iter().flatten().min_by_key(|room| room.bytes)
    }

    /// Reason for which a larger run is refused: the limit and its origin.
    pub fn why(&self) -> String {
        let limit = bytes(self.limit);
        match self.whose {
            Whose::User => format!("the limit is {limit}"),
            Whose::Machine => format!("this machine has {limit}"),
            Whose::AddressSpace => format!("the process may map {limit} (ulimit -v), {} are left", bytes(self.bytes)),
            Whose::Data => format!("the process may hold {limit} of data (ulimit -d), {} are left", bytes(self.bytes)),
            Whose::ControlGroup => format!("the control group of the process has {limit}"),
        }
    }

    /// Advice to raise the limit.
    pub fn raise(&self) -> &'static str {
        match self.whose {
            Whose::User | Whose::Machine => "raise --max-memory",
            Whose::AddressSpace => "raise `ulimit -v`, or take fewer --threads",
            Whose::Data => "raise `ulimit -d`",
            Whose::ControlGroup => "raise the memory of the control group (of the container, the job)",
        }
    }
}

/// Largest number of bytes that reading a geometry file may take.
pub fn memory_for_files(limit: Option<u64>) -> Option<u64> {
    MemoryLimit::least(limit).map(|room| room.bytes)
}

/// Largest number of threads whose stacks and heaps leave a run most of the address space; results do not depend on it.
pub fn most_threads() -> usize {
    let left = || {
        let limit = process_limit(&read("/proc/self/limits")?, "Max address space")?;
        Some(limit.saturating_sub(status(&read("/proc/self/status")?, "VmSize")?))
    };
    left().map_or(usize::MAX, |left| usize::try_from(left / (FOR_THREADS * PER_THREAD)).unwrap_or(usize::MAX).max(1))
}

fn read(path: &str) -> Option<String> {
    std::fs::read_to_string(path).ok()
}

/// Returns the soft limit of this name, in bytes; `None` if it is "unlimited".
fn process_limit(limits: &str, name: &str) -> Option<u64> {
    limits.lines().find_map(|line| line.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
}

/// Returns an entry of a status or of the machine's memory, in bytes.
fn status(text: &str, name: &str) -> Option<u64> {
    let entry = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))?;
    entry.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}

/// Bytes of the machine's memory.
fn physical_memory() -> Option<u64> {
    status(&read("/proc/meminfo")?, "MemTotal")
}

/// Returns the least limit of the control groups in `groups` (/proc/self/cgroup) and of their parents, of version 2 and 1.
///
/// A container may see its own group as the root: a group that does not exist is skipped.
fn group_limit(groups: &str, root: &Path) -> Option<u64> {
    let limits = groups.lines().flat_map(|line| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next().unwrap_or(""), parts.next().unwrap_or(""));
        let (folder, file) = match controllers {
            "" => (root.to_owned(), "memory.max"),
            list if list.split(',').any(|name| name == "memory") => (root.join("memory"), "memory.limit_in_bytes"),
            _ => return Vec::new(),
        };
        let own = folder.join(path.trim_start_matches('/'));
        let around = own.ancestors().take_while(|group| group.starts_with(&folder)).map(PathBuf::from);
        around.filter_map(|group| std::fs::read_to_string(group.join(file)).ok()?.trim().parse::<u64>().ok()).collect()
    });
    // version 1 writes the largest number of pages for no limit
    limits.filter(|&limit| limit < u64::MAX >> 2).min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_of_the_process_are_read_and_unlimited_is_none() {
        let text = "Limit                     Soft Limit           Hard Limit           Units     \n\
                    Max data size             unlimited            unlimited            bytes     \n\
                    Max address space         314572800            unlimited            bytes     \n";
        assert_eq!(process_limit(text, "Max address space"), Some(314_572_800));
        assert_eq!(process_limit(text, "Max data size"), None);
        assert_eq!(status("VmPeak:\t 9 kB\nVmSize:\t    3060 kB\n", "VmSize"), Some(3060 * 1024));
    }

    #[test]
    fn the_least_limit_of_all_control_groups_around_counts() {
        let root = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            let file = root.path().join(path);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, text).unwrap();
        };
        let limit = |groups: &str| group_limit(groups, root.path());
        assert_eq!(limit("0::/job/step\n"), None);
        write("job/step/memory.max", "max\n");
        write("job/memory.max", "500000000\n");
        assert_eq!(limit("0::/job/step\n"), Some(500_000_000));
        write("job/step/memory.max", "200000000\n");
        assert_eq!(limit("0::/job/step\n"), Some(200_000_000));
        // a container in version 1: its group is mounted as the root, and the path does not exist
        write("memory/memory.limit_in_bytes", "300000000\n");
        assert_eq!(limit("5:cpu,cpuacct:/x\n4:memory:/docker/12ab\n"), Some(300_000_000));
        write("memory/memory.limit_in_bytes", "9223372036854771712\n");
        assert_eq!(limit("4:memory:/docker/12ab\n"), None);
    }

    #[test]
    fn the_limit_of_the_user_stands_in_place_of_the_machine() {
        let room = MemoryLimit::least(Some(1000)).unwrap();
        assert_eq!((room.bytes, room.why().as_str(), room.raise()), (1000, "the limit is 1 kB", "raise --max-memory"));
        assert!(memory_for_files(Some(77)) == Some(77) && most_threads() >= 1);
    }
}
