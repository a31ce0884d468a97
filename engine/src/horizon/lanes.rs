//! Numbers worked on side by side: one for each of some neighbouring receivers.

/// Receivers are computed this many at a time.
pub const LANES: usize = 32;

/// So many consecutive numbers of an array, from an offset to a place on.
#[inline(always)]
pub fn lanes(array: &[f32], at: usize, offset: isize) -> &[f32; LANES] {
    let start = at.wrapping_add_signed(offset);
    array[start..start + LANES].first_chunk().expect("a slice of LANES")
}

/// The larger of two numbers, the first where one of them is NaN; one instruction.
#[inline(always)]
pub fn larger(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

/// The largest of some numbers; those that are NaN do not count.
#[inline(always)]
pub fn largest(numbers: &[f32; LANES]) -> f32 {
    let mut half = [0.0; LANES / 2];
    for i in 0..LANES / 2 {
        half[i] = larger(larger(f32::NEG_INFINITY, numbers[i]), numbers[i + LANES / 2]);
    }
    let mut length = LANES / 4;
    while length > 0 {
        for i in 0..length {
            half[i] = larger(half[i], half[i + length]);
        }
        length /= 2;
    }
    half[0]
}
