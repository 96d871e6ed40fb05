//! Memory of the process on Linux.

use crate::study::MemoryMeter;

/// Meter based on Linux's `VmHWM`, the peak memory since its last reset, minus the memory at the start.
pub(super) struct PeakMemory {
    /// Memory at the start, MiB.
    before: f64,
}

impl PeakMemory {
    /// Creates the meter; `None` if the system does not report memory.
    pub(super) fn watch() -> Option<Self> {
        let memory = Self { before: status_mib("VmRSS:")? };
        set_back().then_some(memory)
    }
}

impl MemoryMeter for PeakMemory {
    fn begin(&self) {
        set_back();
    }

    fn peak_mib(&self) -> Option<f64> {
        Some(status_mib("VmHWM:")? - self.before)
    }
}

/// Resets `VmHWM` to the current memory; returns `true` if the system allows it.
fn set_back() -> bool {
    std::fs::write("/proc/self/clear_refs", "5").is_ok()
}

/// Reads a size from `/proc/self/status`, MiB.
fn status_mib(key: &str) -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib / 1024.0)
}
