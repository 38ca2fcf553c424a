//! What Mesa's CPU driver (llvmpipe) is told before it is loaded, by environment variables; no other driver reads them.

use std::sync::{Mutex, Once, PoisonError};

/// LLVM's part in the driver: a list of flags, which are also part of the key of the driver's cache on disk.
const PERFORMANCE: &str = "GALLIVM_PERF";
/// Bits of the vectors that kernels are compiled for. The driver takes at most 256 by itself.
const VECTOR_WIDTH: &str = "LP_NATIVE_VECTOR_WIDTH";
/// The width that the driver takes by itself where the processor has AVX.
const DRIVERS_WIDTH: u32 = 256;

/// What this process has set, as `NAME=VALUE`.
static WAS_SET: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Has the driver compile kernels without LLVM's optimisations. It takes about half as long to start, the bits stay, and kernels take 1.2 to 2
/// times as long for each sample (docs/building.md): right for a rendering of few samples. A value that the user has set stays. To be called before the first
/// [`super::Instance`] is made: the driver asks once.
pub fn compile_quickly() {
    if std::env::var_os(PERFORMANCE).is_none() {
        set(PERFORMANCE, "nopt");
    }
}

/// Has the driver use vectors of 512 bits where the processor has them, unless the user has set a width; kernels are 1.2 to 1.8 times as fast
/// (docs/lavapipe.md). To be called before the Vulkan loader is loaded; calls after the first one do nothing.
///
/// The driver's cache on disk does not tell widths apart: a kernel that was compiled for one would be run for another, at that one's
/// speed. So every width but the driver's own gets flags of the cache's key that change nothing here: they are about samplers of images, and no
/// kernel has one.
pub(super) fn widen() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let asked = std::env::var(VECTOR_WIDTH).ok();
        let width = match &asked {
            Some(text) => text.trim().parse().unwrap_or(DRIVERS_WIDTH),
            None if has_512_bits() => 512,
            None => DRIVERS_WIDTH,
        };
        if asked.is_none() && width != DRIVERS_WIDTH {
            set(VECTOR_WIDTH, &width.to_string());
        }
        if let Some(key) = cache_key(width) {
            let flags = std::env::var(PERFORMANCE).unwrap_or_default();
            let separator = if flags.is_empty() { "" } else { "," };
            set(PERFORMANCE, &format!("{flags}{separator}{key}"));
        }
    });
}

/// The environment variables that this process has set for llvmpipe, as `NAME=VALUE`.
pub(super) fn was_set() -> Vec<String> {
    WAS_SET.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Whether the processor has all kinds of instructions that the driver uses at 512 bits.
fn has_512_bits() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
    }
    #[cfg(not(target_arch = "x86_64"))]
    false
}

/// Flags that keep a width's kernels apart in the driver's cache; nothing for its own width.
fn cache_key(width: u32) -> Option<&'static str> {
    match width {
        DRIVERS_WIDTH => None,
        512 => Some("no_quad_lod"),
        128 => Some("no_aos_sampling"),
        _ => Some("no_quad_lod,no_aos_sampling"),
    }
}

fn set(name: &str, value: &str) {
    // SAFETY: changing the environment is unsafe where another thread may read it through libc at that time. No driver is loaded yet, and the
    // threads that load scenes do not touch the environment once they wait for work.
    unsafe { std::env::set_var(name, value) };
    let mut was_set = WAS_SET.lock().unwrap_or_else(PoisonError::into_inner);
    was_set.retain(|earlier| !earlier.starts_with(&format!("{name}=")));
    was_set.push(format!("{name}={value}"));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two widths with one key would run each other's kernels.
    #[test]
    fn every_width_has_a_key_of_its_own() {
        let keys: std::collections::BTreeSet<_> = [64, 128, DRIVERS_WIDTH, 512].map(cache_key).into();
        assert_eq!(keys.len(), 4);
    }
}
