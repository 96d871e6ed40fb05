//! The memory of the process, as Linux tells it.

use crate::study::MemoryMeter;

/// Linux's `VmHWM`, the most memory that the process has held since it was set back, over what it held at first.
pub(super) struct PeakMemory {
    /// MiB.
    before: f64,
}

impl PeakMemory {
    /// `None` where the system does not tell.
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

/// Sets `VmHWM` to what is held now; `true` if the system lets it.
fn set_back() -> bool {
    std::fs::write("/proc/self/clear_refs", "5").is_ok()
}

/// A size in `/proc/self/status`, MiB.
fn status_mib(key: &str) -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib / 1024.0)
}
