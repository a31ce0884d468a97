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

#[cfg(test)]
mod tests {
    use super::super::angle::{Place, elevations_rad};
    use super::super::grid::LANES;
    use super::*;

    #[test]
    fn wide_registers_do_not_change_a_bit() {
        let place = Place { major: -0.013, minor: 0.02, spacing: 1.1e-5, direction: [0.8, -0.6], end: [0.1, -0.1] };
        for step in -50..50_i16 {
            let slopes: [f32; LANES] = std::array::from_fn(|i| 0.037 * f32::from(step) + 0.0013 * i as f32);
            let heights: [f32; LANES] = std::array::from_fn(|i| 1e-4 * f32::from(step) + 3e-6 * i as f32);
            let plain = elevations_rad(&place, &heights, &slopes);
            let wide = wide(
                #[inline(always)]
                || elevations_rad(&place, &heights, &slopes),
            );
            assert_eq!(plain.map(f32::to_bits), wide.map(f32::to_bits));
        }
    }
}
