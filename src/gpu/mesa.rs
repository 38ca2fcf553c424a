//! What Mesa's CPU driver (llvmpipe) is told before it is loaded, by environment variables; no other driver reads them.

use std::ffi::OsString;
use std::process::Command;
use std::sync::{Mutex, Once, PoisonError};

/// LLVM's part in the driver: a list of flags, which are also part of the key of the driver's cache on disk.
const PERFORMANCE: &str = "GALLIVM_PERF";
/// Bits of the vectors that kernels are compiled for. The driver takes at most 256 by itself.
const VECTOR_WIDTH: &str = "LP_NATIVE_VECTOR_WIDTH";

/// A variable that this process has set.
#[derive(Clone, Debug)]
struct Set {
    name: &'static str,
    value: String,
    /// What the user had set it to.
    before: Option<OsString>,
}

/// Whether the width of vectors is decided.
static DECIDED: Once = Once::new();

static WAS_SET: Mutex<Vec<Set>> = Mutex::new(Vec::new());

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
/// speed. So every width but that which the driver takes by itself gets flags of the cache's key that change nothing here: they are about samplers of
/// images, and no kernel has one.
pub(super) fn widen() {
    DECIDED.call_once(|| {
        let asked = std::env::var(VECTOR_WIDTH).ok();
        let key = match &asked {
            Some(text) => cache_key(width(text)),
            None if has_512_bits() => {
                set(VECTOR_WIDTH, "512");
                cache_key(512)
            }
            None => return,
        };
        let flags = std::env::var(PERFORMANCE).unwrap_or_default();
        let separator = if flags.is_empty() { "" } else { "," };
        set(PERFORMANCE, &format!("{flags}{separator}{key}"));
    });
}

/// Has the driver use vectors of 256 bits at most, in this process: it draws triangles with no wider ones, and ends the process where it is to.
/// To be called before the first [`super::Instance`] is made.
#[cfg(feature = "view")]
pub fn draw_triangles() {
    DECIDED.call_once(|| {
        let asked = std::env::var(VECTOR_WIDTH).ok();
        if asked.is_some_and(|text| width(&text) > 256) {
            set(VECTOR_WIDTH, "256");
        }
    });
}

/// The environment variables that this process has set for llvmpipe, as `NAME=VALUE`.
pub(super) fn was_set() -> Vec<String> {
    let all = WAS_SET.lock().unwrap_or_else(PoisonError::into_inner);
    all.iter().map(|set| format!("{}={}", set.name, set.value)).collect()
}

/// Gives another program the user's environment, without what this process has set for its own driver.
pub fn with_the_users_environment(command: &mut Command) -> &mut Command {
    for set in WAS_SET.lock().unwrap_or_else(PoisonError::into_inner).iter() {
        match &set.before {
            Some(value) => command.env(set.name, value),
            None => command.env_remove(set.name),
        };
    }
    command
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

/// The number that a text means to the driver: decimal, hexadecimal behind `0x`, octal behind `0`; 0 where it is none.
fn width(text: &str) -> u32 {
    let text = text.trim();
    let number = match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(digits) => u32::from_str_radix(digits, 16),
        None if text.starts_with('0') => u32::from_str_radix(text, 8),
        None => text.parse(),
    };
    number.unwrap_or(0)
}

/// Flags that keep the kernels of a width that was asked for apart in the driver's cache, from those of the width that it takes by itself
/// as well, which differs from processor to processor.
fn cache_key(width: u32) -> &'static str {
    match width {
        512 => "no_quad_lod",
        256 => "no_quad_lod,no_aos_sampling",
        _ => "no_aos_sampling",
    }
}

fn set(name: &'static str, value: &str) {
    let before = std::env::var_os(name);
    // SAFETY: changing the environment is unsafe where another thread may read it through libc at that time. No driver is loaded yet, and the
    // threads that load scenes do not touch the environment once they wait for work.
    unsafe { std::env::set_var(name, value) };
    let mut all = WAS_SET.lock().unwrap_or_else(PoisonError::into_inner);
    match all.iter_mut().find(|set| set.name == name) {
        Some(set) => value.clone_into(&mut set.value),
        None => all.push(Set { name, value: value.to_owned(), before }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two widths with one key would run each other's kernels.
    #[test]
    fn every_width_has_a_key_of_its_own() {
        let keys: std::collections::BTreeSet<_> = [128, 256, 512].map(cache_key).into();
        assert_eq!(keys.len(), 3);
        assert_eq!(["512", " 0x200", "01000", "wide"].map(width), [512, 512, 512, 0]);
    }
}
