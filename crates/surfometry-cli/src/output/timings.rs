//! Where the time of an input went.

use surfometry::measurement::StageSeconds;
use surfometry::runs::InputRecords;

/// Seconds by stage: the file's on the clock, the others summed over threads.
pub(crate) fn timings_text(input: &str, found: &InputRecords) -> String {
    let sum = |stage: fn(&StageSeconds) -> f64| -> f64 {
        found.records.iter().map(|record| stage(&record.measured.timings)).sum()
    };
    let stages = [
        ("read", found.read_seconds),
        ("decode", found.decode_seconds),
        ("embed", sum(|t| t.embed)),
        ("derive", sum(|t| t.derive)),
        ("integrate", sum(|t| t.integrate)),
        ("topology", sum(|t| t.topology)),
        ("surface", sum(|t| t.surface)),
        ("read again", found.read_again_seconds),
        ("explain", sum(|t| t.explain)),
    ];
    let stages = stages.map(|(name, seconds)| format!("{name} {seconds:.3}"));
    format!("{input}: seconds: {}", stages.join(", "))
}

/// The most memory that the program held so far (Linux tells it).
pub(crate) fn memory_text(input: &str) -> String {
    peak_memory().map_or_else(
        || format!("{input}: peak memory unknown on this system"),
        |mib| format!("{input}: peak memory so far {mib:.0} MiB"),
    )
}

fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib / 1024.0)
}
