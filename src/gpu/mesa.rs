//! What Mesa's CPU driver (llvmpipe) is told before it is loaded, by environment variables; no other driver reads them.

/// Has the driver compile kernels without LLVM's optimisations. It takes about half as long to start, the bits stay, and kernels take 1.2 to 2
/// times as long for each sample (docs/building.md): right for a rendering of few samples. A value that the user has set stays. To be called before the first
/// [`super::Instance`] is made: the driver asks once.
pub fn compile_quickly() {
    const PERFORMANCE: &str = "GALLIVM_PERF";
    if std::env::var_os(PERFORMANCE).is_none() {
        // SAFETY: changing the environment is unsafe where another thread may read it through libc at that time. No driver is loaded yet, and
        // the threads that load scenes do not touch the environment once they wait for work.
        unsafe { std::env::set_var(PERFORMANCE, "nopt") };
    }
}
