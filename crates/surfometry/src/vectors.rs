//! Which vector instructions hot loops use: the widest that the processor has. Results do not depend on it.

use fearless_simd::{Level, Simd};
use std::sync::OnceLock;

/// The variable of the environment that names narrower ones, to show that results do not depend on them.
const NARROWER: &str = "SURFOMETRY_VECTORS";

/// The level of every loop.
pub(crate) fn level() -> Level {
    static LEVEL: OnceLock<Level> = OnceLock::new();
    *LEVEL.get_or_init(|| {
        let widest = Level::new();
        std::env::var(NARROWER).ok().and_then(|name| named(widest, &name)).unwrap_or(widest)
    })
}

/// Its name.
#[cfg(feature = "io")]
pub(crate) fn name() -> String {
    let level = format!("{:?}", level());
    level.split('(').next().unwrap_or_default().to_lowercase()
}

/// A level by its name, where the processor has it.
#[cfg(target_arch = "x86_64")]
fn named(widest: Level, name: &str) -> Option<Level> {
    match name {
        "sse2" => widest.as_sse2().map(Simd::level),
        "sse4_2" => widest.as_sse4_2().map(Simd::level),
        "avx2" => widest.as_avx2().map(Simd::level),
        _ => None,
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn named(_: Level, _: &str) -> Option<Level> {
    None
}
