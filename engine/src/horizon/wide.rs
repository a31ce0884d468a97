//! The widest registers the machine has.

/// What a stretch of code is compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Registers {
    #[cfg(target_arch = "x86_64")]
    Avx512,
    Any,
}

/// Runs `call`, compiled for AVX-512, AVX2 or the plain target, whichever the machine has. Nothing is reordered and
/// nothing fused but what says so (`mul_add`), whatever the width: results are the same bytes on every machine.
pub fn wide<R>(call: impl FnOnce() -> R) -> R {
    widest(
        #[inline(always)]
        |_| call(),
    )
}

/// [`wide`] for code that wants to know.
pub fn widest<R>(call: impl FnOnce(Registers) -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    {
        let common = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("popcnt");
        if common && is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq") {
            // SAFETY: the processor has the instructions.
            return unsafe { with_avx512(call) };
        }
        if common {
            // SAFETY: the processor has the instructions.
            return unsafe { with_avx2(call) };
        }
    }
    call(Registers::Any)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma,bmi2,popcnt")]
fn with_avx512<R>(call: impl FnOnce(Registers) -> R) -> R {
    call(Registers::Avx512)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi2,popcnt")]
fn with_avx2<R>(call: impl FnOnce(Registers) -> R) -> R {
    call(Registers::Any)
}

/// Fetches what lies at an index, if anything does, for later.
#[inline(always)]
pub fn prefetch<T>(array: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(item) = array.get(index) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a hint, to an address that exists.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(item).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (array, index);
}

/// How many of 16 lines `h = c + s x` pass at or above a point.
#[inline(always)]
pub fn lines_above(registers: Registers, c: &[f32; 16], s: &[f32; 16], x: f32, height: f32) -> u32 {
    match registers {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `widest` says so only where the processor has the instructions.
        Registers::Avx512 => unsafe { lines_above_avx512(c, s, x, height) },
        Registers::Any => (0..16).map(|i| u32::from(s[i].mul_add(x, c[i]) >= height)).sum(),
    }
}

/// The compiler does not find that a comparison of 16 numbers is a word of 16 bits.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma,bmi2,popcnt")]
#[inline]
fn lines_above_avx512(c: &[f32; 16], s: &[f32; 16], x: f32, height: f32) -> u32 {
    use std::arch::x86_64::{_CMP_GE_OQ, _mm512_cmp_ps_mask, _mm512_fmadd_ps, _mm512_loadu_ps, _mm512_set1_ps};
    // SAFETY: 16 numbers are there to be read.
    let (c, s) = unsafe { (_mm512_loadu_ps(c.as_ptr()), _mm512_loadu_ps(s.as_ptr())) };
    let heights = _mm512_fmadd_ps(s, _mm512_set1_ps(x), c);
    u32::from(_mm512_cmp_ps_mask::<_CMP_GE_OQ>(heights, _mm512_set1_ps(height)).count_ones() as u16)
}

/// A bit for each of 32 numbers that is larger than another one.
#[inline(always)]
pub fn larger_of(registers: Registers, numbers: &[f32; 32], others: &[f32; 32]) -> u32 {
    match registers {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `widest` says so only where the processor has the instructions.
        Registers::Avx512 => unsafe { larger_of_avx512(numbers, others) },
        Registers::Any => (0..32).fold(0, |bits, i| bits | u32::from(numbers[i] > others[i]) << i),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma,bmi2,popcnt")]
#[inline]
fn larger_of_avx512(numbers: &[f32; 32], others: &[f32; 32]) -> u32 {
    use std::arch::x86_64::{_CMP_GT_OQ, _mm512_cmp_ps_mask, _mm512_loadu_ps};
    let half = |start: usize| {
        // SAFETY: 16 numbers are there to be read from either start.
        let (a, b) = unsafe { (_mm512_loadu_ps(numbers[start..].as_ptr()), _mm512_loadu_ps(others[start..].as_ptr())) };
        u32::from(_mm512_cmp_ps_mask::<_CMP_GT_OQ>(a, b))
    };
    half(0) | half(16) << 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::horizon::lanes::LANES;
    use crate::horizon::sweep::angle::{ReceiverRow, elevations_rad};

    #[test]
    fn wide_registers_do_not_change_a_bit() {
        let row = ReceiverRow { major: -0.013, minor: 0.02, spacing: 1.1e-5, direction: [0.8, -0.6], end: [0.1, -0.1] };
        for step in -50..50_i16 {
            let slopes: [f32; LANES] = std::array::from_fn(|i| 0.037 * f32::from(step) + 0.0013 * i as f32);
            let heights: [f32; LANES] = std::array::from_fn(|i| 1e-4 * f32::from(step) + 3e-6 * i as f32);
            let plain = elevations_rad(&row, &heights, &slopes);
            let wide = wide(
                #[inline(always)]
                || elevations_rad(&row, &heights, &slopes),
            );
            assert_eq!(plain.map(f32::to_bits), wide.map(f32::to_bits));
        }
    }

    #[test]
    fn lines_are_counted_alike_in_all_registers() {
        let c: [f32; 16] = std::array::from_fn(|i| 100.0 - 3.0 * i as f32);
        let s: [f32; 16] = std::array::from_fn(|i| 0.01 * i as f32 - 0.05);
        for x in [-900.0, 0.0, 77.0, 1e4] {
            for height in [-40.0, 55.0, 88.0, 100.0, 101.0] {
                let expected = (0..16).filter(|i| s[*i].mul_add(x, c[*i]) >= height).count() as u32;
                let count = |registers| lines_above(registers, &c, &s, x, height);
                assert_eq!((count(Registers::Any), widest(count)), (expected, expected));
            }
        }
    }
}
