//! The widest registers the machine has.

/// Runs `call`, compiled for AVX-512, AVX2 or the plain target, whichever the machine has. No operation is fused or
/// reordered whatever the width, so that results are the same bytes on every machine.
pub fn wide<R>(call: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") {
            // SAFETY: the processor has the instructions.
            return unsafe { with_avx512(call) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has the instructions.
            return unsafe { with_avx2(call) };
        }
    }
    call()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn with_avx512<R>(call: impl FnOnce() -> R) -> R {
    call()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<R>(call: impl FnOnce() -> R) -> R {
    call()
}
