// Radiance of the ground per irradiance of the ground. Twin of reflectance.rs and hapke.rs, whose documents have
// the equations.

// 0 Lambert, 1 Lommel-Seeliger, 2 lunar-Lambert, 3 Minnaert, 4 Hapke, 5 Akimov, 6 LROC 2019.
override REFLECTANCE_MODEL: u32;

struct ReflectanceParameters {
    // For Hapke's law and LROC's what multiplies it.
    normal_albedo: f32,
    // Minnaert's k, or Akimov's eta.
    exponent: f32,
    single_scattering_albedo: f32,
    asymmetry: f32,
    backscatter: f32,
    shadow_hiding_amplitude: f32,
    shadow_hiding_width: f32,
    coherent_amplitude: f32,
    coherent_width: f32,
    mean_slope_tan: f32,
    porosity_factor: f32,
    // The year of the function H: 1981 or 2002.
    multiple_scattering: f32,
    // Of the powers of the phase angle and of the two surges in ln f.
    phase_linear: f32,
    phase_square: f32,
    phase_cube: f32,
    phase_fourth: f32,
    phase_narrow_surge: f32,
    phase_wide_surge: f32,
}

const PI = 3.14159265358979;
const LEAST_COSINE = 1e-6;
const LEAST_SUPPLEMENT_RAD = 1e-3;
// Widths of the two surges of the phase function, and the phase angle beyond which it stays what it is.
const NARROW_SURGE_RAD = 0.070869792;
const WIDE_SURGE_RAD = 0.2248019;
const LAST_PHASE_RAD = 2.26892803;

// From the cosines of incidence, emission and phase angle.
fn brdf_sr(p: ReflectanceParameters, incidence_cosine: f32, emission_cosine: f32, phase_cosine: f32) -> f32 {
    let mu0 = clamp(incidence_cosine, LEAST_COSINE, 1.0);
    let mu = clamp(emission_cosine, LEAST_COSINE, 1.0);
    let phase = clamp(phase_cosine, -1.0, 1.0);
    switch REFLECTANCE_MODEL {
        case 4u: {
            return hapke_sr(p, mu0, mu, phase);
        }
        case 6u: {
            return p.normal_albedo / PI * lroc_nac_2019(mu0, mu, degrees(arc_cosine(phase)));
        }
        default: {
            return p.normal_albedo / PI * phase_function(p, arc_cosine(phase)) * disc_function(p, mu0, mu, phase);
        }
    }
}

// Share of the light at opposition that is left at a phase angle.
fn phase_function(p: ReflectanceParameters, phase_rad: f32) -> f32 {
    let g = min(phase_rad, LAST_PHASE_RAD);
    let powers = g * (p.phase_linear + g * (p.phase_square + g * (p.phase_cube + g * p.phase_fourth)));
    return exp(powers + p.phase_narrow_surge * (exp(-g / NARROW_SURGE_RAD) - 1.0)
        + p.phase_wide_surge * (exp(-g / WIDE_SURGE_RAD) - 1.0));
}

// Over the cosine of incidence.
fn disc_function(p: ReflectanceParameters, mu0: f32, mu: f32, phase_cosine: f32) -> f32 {
    switch REFLECTANCE_MODEL {
        case 1u: {
            return 2.0 / (mu0 + mu);
        }
        case 2u: {
            let weight = lunar_lambert_weight(degrees(arc_cosine(phase_cosine)));
            return 2.0 * weight / (mu0 + mu) + 1.0 - weight;
        }
        case 3u: {
            return pow(mu0 * mu, p.exponent - 1.0);
        }
        case 5u: {
            return akimov(p.exponent, mu0, mu, phase_cosine);
        }
        default: {
            return 1.0;
        }
    }
}

// Over the cosine of incidence.
fn lroc_nac_2019(mu0: f32, mu: f32, phase_deg: f32) -> f32 {
    let phase = phase_deg * (0.012964707 - 8.3528e-5 * phase_deg) - 0.237774774 * sqrt(phase_deg);
    let angles = 0.556075496 * mu + mu0 * (0.663671460 - 0.439918609 * mu0);
    return exp(-1.479654495 + phase + angles) / (mu0 + mu);
}

// The disc function over the cosine of incidence. Photometric latitude and longitude, counted from the middle between
// Sun and camera, as a vector (along, across).
fn akimov(smoothness: f32, mu0: f32, mu: f32, phase_cosine: f32) -> f32 {
    let phase_rad = min(arc_cosine(phase_cosine), PI - LEAST_SUPPLEMENT_RAD);
    let half_sine = sqrt(max(0.5 - 0.5 * phase_cosine, 0.0));
    let half_cosine = sqrt(max(0.5 + 0.5 * phase_cosine, 2.5e-7));
    let along = min((mu0 + mu) / (2.0 * half_cosine), 1.0);
    let reach = sqrt((1.0 - along) * (1.0 + along));
    let across = clamp((mu0 - mu) / max(2.0 * half_sine, 1e-12), -reach, reach);
    let latitude_cosine = max(sqrt(along * along + across * across), LEAST_COSINE);
    let supplement_rad = PI - phase_rad;
    // The longitude stretched until the terminator lies at a right angle: its cosine is the sine of what is left to there.
    let left_rad = 0.5 * PI - PI / supplement_rad * arc_cosine(min(along / latitude_cosine, 1.0));
    let towards_terminator = max(sin(left_rad), 0.0);
    return half_cosine * towards_terminator
        * pow(latitude_cosine, 1.0 + smoothness * phase_rad / supplement_rad) / (mu0 * mu);
}

fn lunar_lambert_weight(phase_deg: f32) -> f32 {
    return max(1.0 + phase_deg * (-0.019 + phase_deg * (0.242e-3 - 1.46e-6 * phase_deg)), 0.0);
}

fn hapke_sr(p: ReflectanceParameters, mu0: f32, mu: f32, phase_cosine: f32) -> f32 {
    let half_phase_tan = sqrt((1.0 - phase_cosine) / max(1.0 + phase_cosine, 1e-12));
    let rough = hapke_rough(p.mean_slope_tan, mu0, mu, phase_cosine);
    let single = hapke_phase(p, phase_cosine) * (1.0 + shadow_hiding(p, half_phase_tan));
    let multiple = hapke_h(p, rough.incidence_cosine / p.porosity_factor)
        * hapke_h(p, rough.emission_cosine / p.porosity_factor) - 1.0;
    return p.normal_albedo * p.porosity_factor * p.single_scattering_albedo / (4.0 * PI)
        * rough.share_per_cosine / (rough.incidence_cosine + rough.emission_cosine)
        * (single + multiple) * (1.0 + coherent_backscatter(p, half_phase_tan));
}

fn hapke_phase(p: ReflectanceParameters, phase_cosine: f32) -> f32 {
    return 0.5 * (1.0 + p.backscatter) * hapke_lobe(p.asymmetry, phase_cosine)
        + 0.5 * (1.0 - p.backscatter) * hapke_lobe(p.asymmetry, -phase_cosine);
}

fn hapke_lobe(b: f32, towards: f32) -> f32 {
    let square = 1.0 - 2.0 * b * towards + b * b;
    return (1.0 - b * b) / (square * sqrt(square));
}

fn shadow_hiding(p: ReflectanceParameters, half_phase_tan: f32) -> f32 {
    let width = p.shadow_hiding_width;
    return p.shadow_hiding_amplitude * width / max(width + half_phase_tan, 1e-12);
}

fn coherent_backscatter(p: ReflectanceParameters, half_phase_tan: f32) -> f32 {
    if p.coherent_width == 0.0 {
        return 0.0;
    }
    let y = half_phase_tan / p.coherent_width;
    var fading = 1.0 - 0.5 * y;
    if y > 1e-3 {
        fading = (1.0 - exp(-y)) / y;
    }
    return p.coherent_amplitude * (1.0 + fading) / (2.0 * (1.0 + y) * (1.0 + y));
}

fn hapke_h(p: ReflectanceParameters, x: f32) -> f32 {
    let w = p.single_scattering_albedo;
    let gamma = sqrt(1.0 - w);
    if p.multiple_scattering < 2000.0 {
        return (1.0 + 2.0 * x) / (1.0 + 2.0 * x * gamma);
    }
    let r0 = (1.0 - gamma) / (1.0 + gamma);
    return 1.0 / (1.0 - w * x * (r0 + (0.5 - r0 * x) * log((1.0 + x) / x)));
}

// Effective cosines of a rough surface, and the shadowed share of the ground per cosine of incidence.
struct HapkeRough {
    incidence_cosine: f32,
    emission_cosine: f32,
    share_per_cosine: f32,
}

// One ray against the mean slope.
struct HapkeTilt {
    cosine: f32,
    sine: f32,
    e1: f32,
    e2: f32,
    eta: f32,
}

fn hapke_tilt(cosine: f32, slope_tan: f32, chi: f32) -> HapkeTilt {
    let sine = sqrt((1.0 - cosine) * (1.0 + cosine));
    let cotangents = min(cosine / (slope_tan * max(sine, 1e-6)), 1e3);
    let e1 = exp(-2.0 / PI * cotangents);
    let e2 = exp(-cotangents * cotangents / PI);
    return HapkeTilt(cosine, sine, e1, e2, chi * (cosine + sine * slope_tan * e2 / (2.0 - e1)));
}

fn hapke_rough(slope_tan: f32, mu0: f32, mu: f32, phase_cosine: f32) -> HapkeRough {
    if slope_tan == 0.0 {
        return HapkeRough(mu0, mu, 1.0);
    }
    let chi = inverseSqrt(1.0 + PI * slope_tan * slope_tan);
    let swapped = mu0 < mu;
    let near = hapke_tilt(max(mu0, mu), slope_tan, chi);
    let far = hapke_tilt(min(mu0, mu), slope_tan, chi);

    // sin²(ψ/2), with ψ the azimuth between the rays; where one is vertical it does not matter.
    let sines = max(near.sine * far.sine, 1e-12);
    let s2 = clamp((near.sine * far.sine + mu0 * mu - phase_cosine) / (2.0 * sines), 0.0, 1.0);
    let azimuth_cosine = 1.0 - 2.0 * s2;
    let f = exp(-2.0 * sqrt(s2 / max(1.0 - s2, 1e-12)));

    let d = 2.0 - far.e1 - arc_cosine(azimuth_cosine) / PI * near.e1;
    let near_cosine = chi * (near.cosine + near.sine * slope_tan * (azimuth_cosine * far.e2 + s2 * near.e2) / d);
    let far_cosine = chi * (far.cosine + far.sine * slope_tan * (far.e2 - s2 * near.e2) / d);
    let visible = chi / (1.0 - f + f * chi * near.cosine / near.eta);
    let share_per_cosine = near_cosine * far_cosine / (near.eta * far.eta) * visible;
    return HapkeRough(
        select(near_cosine, far_cosine, swapped),
        select(far_cosine, near_cosine, swapped),
        share_per_cosine,
    );
}

// Abramowitz & Stegun 4.4.46, within 2e-8; WGSL promises only 7e-5 of its own.
fn arc_cosine(x: f32) -> f32 {
    let a = abs(x);
    let series = 1.5707963050 + a * (-0.2145988016 + a * (0.0889789874 + a * (-0.0501743046
        + a * (0.0308918810 + a * (-0.0170881256 + a * (0.0066700901 - a * 0.0012624911))))));
    let acute = series * sqrt(1.0 - min(a, 1.0));
    return select(acute, PI - acute, x < 0.0);
}
