// The elevation that belongs to a tangent.

// Abramowitz & Stegun 4.4.49, to 1e-7 rad; `atan` is allowed 4096 units in the last place.
fn arc_tangent(tangent: f32) -> f32 {
    let steep = abs(tangent) > 1.0;
    let z = select(abs(tangent), 1.0 / max(abs(tangent), 1.0), steep);
    let s = z * z;
    var sum = 0.0028662257;
    sum = sum * s - 0.016165737;
    sum = sum * s + 0.042909614;
    sum = sum * s - 0.07528964;
    sum = sum * s + 0.10656264;
    sum = sum * s - 0.142089;
    sum = sum * s + 0.19993551;
    sum = sum * s - 0.33333145;
    let angle = z + z * s * sum;
    return sign(tangent) * select(angle, 1.5707964 - angle, steep);
}
