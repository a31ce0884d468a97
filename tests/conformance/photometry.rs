//! `solar_disk.wgsl` and `reflectance.wgsl`, function by function.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3};
use perilune_engine::photometry::{
    DiscFunction, DiskLight, Facet, Hapke, HorizonLine, LimbDarkening, MultipleScattering, REFLECTANCE_WGSL,
    Reflectance, SOLAR_DISK_WGSL, SolarDisk,
};

use super::{Comparison, Shader, functions, gpu, spread};

const ALPHA: f64 = 0.507_909;

fn disk(alpha: f64) -> SolarDisk {
    SolarDisk::new(LimbDarkening::Power { alpha }).unwrap()
}

fn source() -> String {
    [SOLAR_DISK_WGSL, REFLECTANCE_WGSL].concat()
}

fn shader(alpha: f64, law: &Reflectance) -> Shader {
    shader_of(&disk(alpha), law)
}

fn shader_of(disk: &SolarDisk, law: &Reflectance) -> Shader {
    let constants = disk.constants().into_iter().chain([law.constant()]).collect();
    let table = disk.tables().into_iter().map(f32::to_bits).collect();
    Shader { source: source(), constants, declared: "disk_tables: array<f32>", table }
}

/// A law's parameters as WGSL.
fn parameters(law: &Reflectance) -> String {
    let fields: [f32; 18] = bytemuck::cast(law.parameters());
    format!("ReflectanceParameters({})", fields.map(|field| format!("f32({field:e})")).join(", "))
}

fn moon() -> Reflectance {
    Reflectance::Hapke(Hapke { coherent_amplitude: 0.4, coherent_width: 0.05, filling_factor: 0.2, ..Hapke::moon() })
}

fn lunar() -> Reflectance {
    Reflectance::lunar(0.19, DiscFunction::LunarLambert).unwrap()
}

fn laws() -> [Reflectance; 16] {
    [
        Reflectance::lambert(0.12),
        Reflectance::empirical(0.12, DiscFunction::LommelSeeliger),
        Reflectance::empirical(0.12, DiscFunction::LunarLambert),
        Reflectance::empirical(0.12, DiscFunction::Minnaert { exponent: 0.7 }),
        Reflectance::empirical(0.12, DiscFunction::Akimov { smoothness: 1.0 }),
        Reflectance::empirical(0.12, DiscFunction::Akimov { smoothness: 0.34 }),
        lunar(),
        Reflectance::lunar(0.19, DiscFunction::Minnaert { exponent: 0.7 }).unwrap(),
        Reflectance::LrocNac2019 { scale: 1.1 },
        Reflectance::Hapke(Hapke::moon()),
        Reflectance::Hapke(Hapke::mars()),
        Reflectance::Hapke(Hapke::mercury()),
        moon(),
        Reflectance::Hapke(Hapke { mean_slope_rad: 0.0, ..Hapke::moon() }),
        Reflectance::Hapke(Hapke { shadow_hiding_width: 0.0, coherent_width: 0.0, ..Hapke::moon() }),
        Reflectance::Hapke(Hapke { multiple_scattering: MultipleScattering::Hapke1981, ..Hapke::moon() }),
    ]
}

/// Horizons and facets near and across the disc, with their edges.
fn disk_inputs() -> Vec<Vec<f32>> {
    let mut inputs = spread(4000, &[(-1.3, 1.3), (-3.0, 3.0), (-1.3, 1.3), (-1.0, 1.0), (-1.0, 1.0)]);
    inputs.extend(spread(1000, &[(-1.1, 1.1), (-0.3, 0.3), (-1.1, 1.1), (-0.01, 0.01), (-1.0, 1.0)]));
    let heights = [-1e6, -1.000_000_1, -1.0, -0.999_999, -0.5, 0.0, 1e-7, 0.5, 0.999_999, 1.0, 1e6];
    for height in heights {
        for facet in [[215.0, 0.0, 0.0], [-215.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [height, 0.0, 1.0]] {
            for slope in [0.0, 1.0, -1e5] {
                inputs.push([&[height, slope], &facet[..]].concat());
            }
        }
        // The facet's edge lies on the horizon, on its mirror image, or against it.
        inputs.push(vec![height, 0.5, -height, -0.5, 1.0]);
        inputs.push(vec![height, 0.5, height, 0.5, -1.0]);
        inputs.push(vec![height, 0.5, -height, 0.5, 1.0]);
    }
    inputs
}

fn disk_light(disk: &SolarDisk, x: &[f64]) -> Vec<f64> {
    let facet = Facet { height: x[2], slope: DVec2::new(x[3], x[4]) };
    let DiskLight { fraction, moment } = disk.light_by_quadrature(HorizonLine { height: x[0], slope: x[1] }, facet);
    vec![fraction, moment.x, moment.y]
}

/// Two lines as half-planes by the direction of their normals and their heights; the first opens upwards.
fn two_lines(disk: &SolarDisk, x: &[f64]) -> Vec<f64> {
    let (first, second) = (DVec2::from_angle(x[0]), DVec2::from_angle(x[2]));
    disk_light(disk, &[x[1] / first.y, -first.x / first.y, -x[3], second.x, second.y])
}

fn lines_cross(x: &[f64]) -> bool {
    let (first, second) = (DVec2::from_angle(x[0]), DVec2::from_angle(x[2]));
    let q = (x[3] * first - x[1] * second).perp() / first.perp_dot(second);
    q.length_squared() < 1.0
}

const TWO_LINES: &str = "let a = HalfPlane(vec2f(x[4], x[5]), x[1]); let b = HalfPlane(vec2f(x[6], x[7]), x[3]);
    let s = a.normal.x * b.normal.y - a.normal.y * b.normal.x; let c = dot(a.normal, b.normal); ";

/// Directions of the normals and heights, then the normals themselves, since WGSL's cosine is too coarse.
fn line_inputs() -> Vec<Vec<f32>> {
    let ranges = [(0.1, 3.04), (-0.99, 0.99), (0.0, 6.2), (-0.99, 0.99)];
    let mut inputs = spread(3000, &ranges);
    for x in &mut inputs {
        let ([a_sin, a_cos], [b_sin, b_cos]) = ([x[0].sin(), x[0].cos()], [x[2].sin(), x[2].cos()]);
        x.extend([a_cos, a_sin, b_cos, b_sin]);
    }
    inputs
}

/// Incidence, emission and azimuth between them, as cosines: on grids with their ends, and all over.
fn directions(count: usize) -> Vec<Vec<f32>> {
    let mut angles: Vec<[f64; 3]> = spread(count, &[(0.0, 1.57), (0.0, 1.57), (0.0, 3.1)])
        .iter()
        .map(|x| [f64::from(x[0]), f64::from(x[1]), f64::from(x[2])])
        .collect();
    let edges = [0.0, 1e-4, 0.1, 0.7, 1.5, FRAC_PI_2 - 1e-4];
    for incidence in edges {
        for emission in edges {
            angles.extend([0.0, 1e-3, FRAC_PI_2, PI - 1e-3, PI].map(|azimuth| [incidence, emission, azimuth]));
        }
    }
    angles
        .into_iter()
        .map(|[incidence, emission, azimuth]| {
            let towards =
                |angle: f64, turn: f64| DVec3::new(angle.sin() * turn.cos(), angle.sin() * turn.sin(), angle.cos());
            let phase = towards(incidence, 0.0).dot(towards(emission, azimuth));
            vec![incidence.cos() as f32, emission.cos() as f32, phase as f32]
        })
        .collect()
}

/// Roughness as printed in Hapke (1984), with angles: effective cosines, and `μ0e S/μ0`.
fn rough(slope_tan: f64, mu0: f64, mu: f64, phase_cosine: f64) -> Vec<f64> {
    let (i, e) = (mu0.acos(), mu.acos());
    let psi = if i.sin() * e.sin() > 1e-9 {
        ((phase_cosine - mu * mu0) / (i.sin() * e.sin())).clamp(-1.0, 1.0).acos()
    } else {
        0.0
    };
    let cot = 1.0 / slope_tan;
    let cotangent = |x: f64| x.cos() / x.sin().max(1e-10);
    let e1 = |x: f64| (-2.0 / PI * cot * cotangent(x)).exp();
    let e2 = |x: f64| (-(cot * cotangent(x)).powi(2) / PI).exp();
    let chi = 1.0 / (1.0 + PI * slope_tan.powi(2)).sqrt();
    let eta = |x: f64| chi * (x.cos() + x.sin() * slope_tan * e2(x) / (2.0 - e1(x)));
    let f = if psi < PI { (-2.0 * (psi / 2.0).tan()).exp() } else { 0.0 };
    let half = (psi / 2.0).sin().powi(2);
    let (mu0e, mue, s) = if i <= e {
        let d = 2.0 - e1(e) - psi / PI * e1(i);
        let mu0e = chi * (mu0 + i.sin() * slope_tan * (psi.cos() * e2(e) + half * e2(i)) / d);
        let mue = chi * (mu + e.sin() * slope_tan * (e2(e) - half * e2(i)) / d);
        (mu0e, mue, mue / eta(e) * mu0 / eta(i) * chi / (1.0 - f + f * chi * mu0 / eta(i)))
    } else {
        let d = 2.0 - e1(i) - psi / PI * e1(e);
        let mu0e = chi * (mu0 + i.sin() * slope_tan * (e2(i) - half * e2(e)) / d);
        let mue = chi * (mu + e.sin() * slope_tan * (psi.cos() * e2(i) + half * e2(e)) / d);
        (mu0e, mue, mue / eta(e) * mu0 / eta(i) * chi / (1.0 - f + f * chi * mu / eta(e)))
    };
    vec![mu0e, mue, mu0e * s / mu0]
}

fn h_2002(w: f64, x: f64) -> f64 {
    let gamma = (1.0 - w).sqrt();
    let r0 = (1.0 - gamma) / (1.0 + gamma);
    1.0 / (1.0 - w * x * (r0 + (1.0 - 2.0 * r0 * x) / 2.0 * ((1.0 + x) / x).ln()))
}

fn comparison(
    function: &'static str,
    call: &str,
    inputs: Vec<Vec<f32>>,
    (absolute, relative): (f64, f64),
    reference: impl Fn(&[f64]) -> Vec<f64> + 'static,
) -> Comparison {
    // A test's few dozen calls live as long as the test.
    let call: &'static str = Box::leak(call.to_string().into_boxed_str());
    Comparison { function, call, inputs, reference: Box::new(reference), absolute, relative }
}

/// Bounds: a rounding of `f32` is 6e-8, and a few follow one another; tables are linear over 1/256 radius.
fn solar_disk_comparisons(alpha: f64) -> Vec<Comparison> {
    let quarter = spread(1000, &[(-1.57, 1.57)]);
    let line = [spread(1000, &[(-1.2, 1.2)]), vec![vec![-1.0], vec![1.0], vec![0.0], vec![-1e6], vec![1e6]]].concat();
    let disks = [(); 9].map(|()| disk(alpha));
    let [d0, d1, d2, d3, d4, d5, d6, d7, d8] = disks;
    let crossing: Vec<Vec<f32>> = line_inputs()
        .into_iter()
        .filter(|x| lines_cross(&x.iter().map(|&x| f64::from(x)).collect::<Vec<_>>()))
        .collect();
    let clear = line_inputs()
        .into_iter()
        .filter(|x| {
            let x: Vec<f64> = x.iter().map(|&x| f64::from(x)).collect();
            let nudged = |by: f64| lines_cross(&[x[0], x[1] + by, x[2], x[3]]);
            nudged(-1e-4) == nudged(1e-4)
        })
        .collect();
    let radius = 0.00465f32;
    let horizons =
        spread(3000, &[(-1.5, 1.5), (-4.0, 4.0), (-0.02, 1.562)])
            .into_iter()
            .chain([-0.017, 0.0, 0.026, 0.5, 1.0, 1.48, 1.562].into_iter().flat_map(|sun: f32| {
                [-1.0, -0.3, 0.0, 1e-4, 0.9].map(|above: f32| vec![sun + above * radius, 0.3, sun])
            }))
            .map(|x| vec![x[0], x[1], x[2].sin(), x[2].cos(), radius])
            .collect();
    vec![
        comparison("small_sine", "y[0] = small_sine(x[0]);", quarter.clone(), (3e-7, 0.0), |x| vec![x[0].sin()]),
        comparison("small_cosine", "y[0] = small_cosine(x[0]);", quarter, (3e-7, 0.0), |x| vec![x[0].cos()]),
        // The height in radii: 4.6e-7 rad of the difference of two angles, over the radius. Far horizons only have to be far.
        comparison(
            "horizon_line",
            "let line = horizon_line(x[0], x[1], x[2], x[3], x[4]); y[0] = line.x; y[1] = line.y;",
            horizons,
            (1e-4, 3e-6),
            |x| {
                let line = HorizonLine::new(x[0], x[1], x[2].atan2(x[3]), x[4]);
                vec![line.height, line.slope]
            },
        ),
        comparison(
            "half_plane",
            "let h = half_plane(x[0], vec2f(x[1], x[2])); y[0] = h.normal.x; y[1] = h.normal.y; y[2] = h.height;",
            spread(1000, &[(-2.0, 2.0), (-3.0, 3.0), (0.1, 1.0)]),
            (1e-6, 1e-6),
            |x| {
                let length = x[1].hypot(x[2]);
                vec![x[1] / length, x[2] / length, -x[0] / length]
            },
        ),
        comparison("share_above", "y[0] = share_above(x[0]);", line.clone(), (3e-6, 3e-5), move |x| {
            vec![d0.visible_above(x[0])]
        }),
        comparison("moment_above", "y[0] = moment_above(x[0]);", line.clone(), (1e-6, 0.0), move |x| {
            vec![d1.moment_above(x[0])]
        }),
        comparison("power_of_rest", "y[0] = power_of_rest(x[0], 1.3);", line.clone(), (2e-6, 0.0), |x| {
            vec![(1.0 - x[0] * x[0]).max(0.0).powf(1.3)]
        }),
        // The whole table of V, so that this one stands for the interpolation itself.
        comparison("disk_table", "y[0] = disk_table(4u, x[0]);", line, (3e-6, 3e-5), move |x| {
            vec![d2.visible_above(x[0])]
        }),
        comparison(
            "light_above",
            "let l = light_above(HalfPlane(vec2f(x[1], x[2]), x[0])); y[0] = l.fraction; y[1] = l.moment.x; y[2] = l.moment.y;",
            spread(1000, &[(-1.0, 1.0), (-1.0, 1.0), (-1.0, 1.0)]),
            (3e-6, 3e-5),
            move |x| {
                let moment = d3.moment_above(x[0]) * DVec2::new(x[1], x[2]);
                vec![d3.visible_above(x[0]), moment.x, moment.y]
            },
        ),
        comparison(
            "lines_cross",
            &[TWO_LINES, "y[0] = f32(lines_cross(a.height, b.height, s, c));"].concat(),
            clear,
            (0.5, 0.0),
            |x| vec![f64::from(u8::from(lines_cross(x)))],
        ),
        comparison(
            "light_in_wedge",
            &[
                TWO_LINES,
                "let l = light_in_wedge(a, b, s, c); y[0] = l.fraction; y[1] = l.moment.x; y[2] = l.moment.y;",
            ]
            .concat(),
            crossing.into_iter().filter(|x| x[1] >= x[3]).collect(),
            (1e-4, 0.0),
            move |x| two_lines(&d4, x),
        ),
        comparison(
            "light_between",
            "let l = light_between(HalfPlane(vec2f(0.6, 0.8), x[0]), HalfPlane(vec2f(-0.6, -0.8), x[1]));
            y[0] = l.fraction; y[1] = l.moment.x; y[2] = l.moment.y;",
            spread(1000, &[(-1.0, 1.0), (-1.0, 1.0)]),
            (1e-5, 0.0),
            move |x| {
                let far = d7.visible_above(x[0]) + d7.visible_above(x[1]) - 1.0;
                let moment = d7.moment_above(x[0]) - d7.moment_above(x[1]);
                if far > 0.0 { vec![far, 0.6 * moment, 0.8 * moment] } else { vec![0.0; 3] }
            },
        ),
        comparison(
            "light_above_both",
            &[TWO_LINES, "let l = light_above_both(a, b); y[0] = l.fraction; y[1] = l.moment.x; y[2] = l.moment.y;"]
                .concat(),
            line_inputs(),
            (1e-4, 0.0),
            move |x| two_lines(&d5, x),
        ),
        comparison(
            "disk_light",
            "let l = disk_light(x[0], x[1], vec3f(x[2], x[3], x[4])); y[0] = l.fraction; y[1] = l.moment.x; y[2] = l.moment.y;",
            disk_inputs(),
            (5e-5, 0.0),
            move |x| disk_light(&d6, x),
        ),
        comparison(
            "part_light",
            "let a = half_plane(-x[0], vec2f(-x[1], 1.0)); let b = half_plane(x[2], vec2f(x[3], x[4]));
            let l = part_light(a, b); y[0] = l.fraction; y[1] = l.moment.x; y[2] = l.moment.y;",
            spread(1000, &[(-0.9, 0.9), (-0.3, 0.3), (-0.9, 0.9), (-1.0, 1.0), (0.1, 1.0)])
                .into_iter()
                .filter(|x| x[2].abs() < 0.99 * x[3].hypot(x[4]))
                .collect(),
            (5e-5, 0.0),
            move |x| disk_light(&d8, x),
        ),
        comparison(
            "irradiance_factor",
            "y[0] = irradiance_factor(DiskLight(x[0], vec2f(x[1], x[2])), vec3f(x[3], x[4], x[5]), 0.00465);",
            spread(1000, &[(0.0, 1.0), (-0.2, 0.2), (-0.2, 0.2), (-1.0, 215.0), (-1.0, 1.0), (-1.0, 1.0)]),
            (1e-7, 1e-6),
            |x| {
                let facet = Facet { height: x[3], slope: DVec2::new(x[4], x[5]) };
                vec![
                    DiskLight { fraction: x[0], moment: DVec2::new(x[1], x[2]) }
                        .irradiance_factor(facet, f64::from(0.00465f32)),
                ]
            },
        ),
    ]
}

fn reflectance_comparisons() -> Vec<Comparison> {
    let p = format!("let p = {}; ", parameters(&moon()));
    let Reflectance::Hapke(hapke) = moon() else { unreachable!("moon() is Hapke's") };
    let half_tangents =
        [spread(500, &[(0.0, 0.2)]), spread(500, &[(0.0, 20.0)]), vec![vec![0.0], vec![1e-6], vec![1e12]]].concat();
    let slope_tan = hapke.mean_slope_rad.tan();
    let chi = 1.0 / (1.0 + PI * slope_tan * slope_tan).sqrt();
    let (b, c, w) = (hapke.asymmetry, hapke.backscatter, hapke.single_scattering_albedo);
    let lobe = move |towards: f64| (1.0 - b * b) / (1.0 - 2.0 * b * towards + b * b).powf(1.5);
    // Clear of grazing, where f32 cosines no longer tell the azimuth.
    let usual: Vec<_> = directions(4000).into_iter().filter(|x| x[0].min(x[1]) > 0.01).collect();
    vec![
        comparison(
            "arc_cosine",
            "y[0] = arc_cosine(x[0]);",
            [spread(1000, &[(-1.0, 1.0)]), vec![vec![-1.0], vec![1.0], vec![0.0]]].concat(),
            (1e-6, 0.0),
            |x| vec![x[0].acos()],
        ),
        comparison(
            "phase_function",
            &format!("y[0] = phase_function({}, x[0]);", parameters(&lunar())),
            [spread(1000, &[(0.0, 3.15)]), spread(200, &[(0.0, 0.1)])].concat(),
            (0.0, 2e-5),
            |x| {
                let (p, g) = (lunar().parameters(), x[0].min(130f64.to_radians()));
                let powers = [p.phase_linear, p.phase_square, p.phase_cube, p.phase_fourth].map(f64::from);
                let sum: f64 = powers.iter().zip(1..).map(|(factor, power)| factor * g.powi(power)).sum();
                let surge =
                    |factor: f32, width_deg: f64| f64::from(factor) * ((-g / width_deg.to_radians()).exp() - 1.0);
                let surges = surge(p.phase_narrow_surge, 4.06054) + surge(p.phase_wide_surge, 12.8802);
                vec![(sum + surges).exp()]
            },
        ),
        comparison(
            "lroc_nac_2019",
            "y[0] = lroc_nac_2019(x[0], x[1], x[2]);",
            spread(1000, &[(0.01, 1.0), (0.01, 1.0), (0.0, 180.0)]),
            (0.0, 2e-5),
            |x| {
                let exponent = -1.479654495 - 8.3528e-5 * x[2] * x[2] + 0.012964707 * x[2] - 0.237774774 * x[2].sqrt()
                    + 0.556075496 * x[1]
                    + 0.663671460 * x[0]
                    - 0.439918609 * x[0] * x[0];
                vec![exponent.exp() / (x[0] + x[1])]
            },
        ),
        // Of a law that is none of the empirical ones; theirs are compared with the laws as a whole.
        comparison(
            "disc_function",
            &[&p, "y[0] = disc_function(p, x[0], x[1], x[2]);"].concat(),
            directions(100),
            (1e-6, 0.0),
            |_| vec![1.0],
        ),
        comparison(
            "lunar_lambert_weight",
            "y[0] = lunar_lambert_weight(x[0]);",
            spread(500, &[(0.0, 180.0)]),
            (2e-6, 0.0),
            |x| vec![(1.0 - 0.019 * x[0] + 0.242e-3 * x[0].powi(2) - 1.46e-6 * x[0].powi(3)).max(0.0)],
        ),
        comparison(
            "akimov",
            "y[0] = akimov(x[3], x[0], x[1], x[2]);",
            usual.iter().enumerate().map(|(i, x)| [&x[..], &[0.3 + 0.1 * (i % 8) as f32]].concat()).collect(),
            (1e-3, 1e-3),
            |x| {
                // With the longitude c from the point below the camera, as printed.
                let g = x[2].clamp(-1.0, 1.0).acos();
                if g < 1e-3 {
                    return vec![1.0 / x[0]];
                }
                let c = ((x[0] / x[1] - g.cos()) / g.sin()).atan();
                let (b, supplement) = (x[1] / c.cos(), std::f64::consts::PI - g);
                let towards = (PI / supplement * (c - g / 2.0)).cos().max(0.0);
                vec![(g / 2.0).cos() * towards * b.powf(x[3] * g / supplement) / c.cos() / x[0]]
            },
        ),
        comparison(
            "hapke_lobe",
            "y[0] = hapke_lobe(x[0], x[1]);",
            spread(1000, &[(0.0, 0.9), (-1.0, 1.0)]),
            (0.0, 1e-5),
            |x| vec![(1.0 - x[0] * x[0]) / (1.0 - 2.0 * x[0] * x[1] + x[0] * x[0]).powf(1.5)],
        ),
        comparison(
            "hapke_phase",
            &[&p, "y[0] = hapke_phase(p, x[0]);"].concat(),
            spread(1000, &[(-1.0, 1.0)]),
            (0.0, 2e-6),
            move |x| vec![(1.0 + c) / 2.0 * lobe(x[0]) + (1.0 - c) / 2.0 * lobe(-x[0])],
        ),
        comparison(
            "shadow_hiding",
            &[&p, "y[0] = shadow_hiding(p, x[0]);"].concat(),
            half_tangents.clone(),
            (1e-6, 0.0),
            move |x| vec![hapke.shadow_hiding_amplitude / (1.0 + x[0] / hapke.shadow_hiding_width)],
        ),
        comparison(
            "coherent_backscatter",
            &[&p, "y[0] = coherent_backscatter(p, x[0]);"].concat(),
            half_tangents,
            (3e-6, 0.0),
            move |x| {
                let y = x[0] / hapke.coherent_width;
                let fading = if y == 0.0 { 1.0 } else { -(-y).exp_m1() / y };
                vec![hapke.coherent_amplitude * (1.0 + fading) / (2.0 * (1.0 + y).powi(2))]
            },
        ),
        comparison(
            "hapke_h",
            &[&p, "y[0] = hapke_h(p, x[0]);"].concat(),
            [spread(1000, &[(1e-6, 1.1)]), vec![vec![1e-6]]].concat(),
            (0.0, 2e-6),
            move |x| vec![h_2002(w, x[0])],
        ),
        comparison(
            "hapke_tilt",
            &format!(
                "let t = hapke_tilt(x[0], f32({slope_tan:e}), f32({chi:e})); y[0] = t.sine; y[1] = t.e1; y[2] = t.e2; y[3] = t.eta;"
            ),
            [spread(1000, &[(1e-6, 1.0)]), vec![vec![1e-6], vec![1.0]]].concat(),
            (2e-6, 0.0),
            move |x| {
                let sine = (1.0 - x[0] * x[0]).sqrt();
                let both = x[0] / sine.max(1e-10) / slope_tan;
                let (e1, e2) = ((-2.0 / PI * both).exp(), (-both * both / PI).exp());
                vec![sine, e1, e2, chi * (x[0] + sine * slope_tan * e2 / (2.0 - e1))]
            },
        ),
        comparison(
            "hapke_rough",
            &format!(
                "let r = hapke_rough(f32({slope_tan:e}), x[0], x[1], x[2]); y[0] = r.incidence_cosine; y[1] = r.emission_cosine; y[2] = r.share_per_cosine;"
            ),
            usual.clone(),
            (0.0, 1e-3),
            move |x| rough(slope_tan, x[0], x[1], x[2]),
        ),
        comparison(
            "hapke_sr",
            &[&p, "y[0] = hapke_sr(p, x[0], x[1], x[2]);"].concat(),
            usual.clone(),
            (0.0, 1e-3),
            move |x| {
                // The whole model as printed, over the porosity factor's own formula.
                let packed = 1.209 * hapke.filling_factor.powf(2.0 / 3.0);
                let k = -(1.0 - packed).ln() / packed;
                let r = rough(slope_tan, x[0], x[1], x[2]);
                let half = (x[2].clamp(-1.0, 1.0).acos() / 2.0).tan();
                let y = half / hapke.coherent_width;
                let fading = if y == 0.0 { 1.0 } else { -(-y).exp_m1() / y };
                let phase = (1.0 + c) / 2.0 * lobe(x[2]) + (1.0 - c) / 2.0 * lobe(-x[2]);
                let surge = 1.0 + hapke.shadow_hiding_amplitude / (1.0 + half / hapke.shadow_hiding_width);
                let coherent = 1.0 + hapke.coherent_amplitude * (1.0 + fading) / (2.0 * (1.0 + y).powi(2));
                let scattered = phase * surge + h_2002(w, r[0] / k) * h_2002(w, r[1] / k) - 1.0;
                vec![k * w / (4.0 * PI) * r[2] / (r[0] + r[1]) * scattered * coherent]
            },
        ),
        comparison("brdf_sr", &[&p, "y[0] = brdf_sr(p, x[0], x[1], x[2]);"].concat(), usual, (0.0, 1e-3), |x| {
            vec![moon().brdf_sr(x[0], x[1], x[2])]
        }),
    ]
}

fn comparisons() -> Vec<Comparison> {
    solar_disk_comparisons(ALPHA).into_iter().chain(reflectance_comparisons()).collect()
}

#[test]
fn every_function_returns_what_its_reference_returns() {
    let Some(gpu) = gpu() else { return };
    let shader = shader(ALPHA, &moon());
    let failures: Vec<_> = comparisons()
        .iter()
        .filter_map(|comparison| {
            comparison.check(&comparison.run(gpu, &shader)).inspect(|line| println!("{line}")).err()
        })
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn the_disc_agrees_for_other_exponents_too() {
    let Some(gpu) = gpu() else { return };
    for alpha in [0.0, 0.269, 0.8668] {
        let shader = shader(alpha, &moon());
        for comparison in solar_disk_comparisons(alpha).iter().filter(|c| c.function.contains("light")) {
            let outcome = comparison.check(&comparison.run(gpu, &shader));
            println!("alpha {alpha} {}", outcome.unwrap_or_else(|error| panic!("alpha {alpha}: {error}")));
        }
    }
}

/// A polynomial in the cosine has six parts, whose weights sum to 3.6 in magnitude: so much wider is the bound.
#[test]
fn a_disc_of_several_parts_agrees_too() {
    let Some(gpu) = gpu() else { return };
    for wavelength_nm in [330.0, 579.88, 1000.0] {
        let disk = SolarDisk::new(LimbDarkening::neckel_labs(wavelength_nm).unwrap()).unwrap();
        let shader = shader_of(&disk, &moon());
        let call = "let l = disk_light(x[0], x[1], vec3f(x[2], x[3], x[4])); y[0] = l.fraction; y[1] = l.moment.x; y[2] = l.moment.y;";
        let one_part = SolarDisk::new(LimbDarkening::hestroffer_magnan(550.0).unwrap()).unwrap();
        let right = comparison("disk_light", call, disk_inputs(), (1.8e-4, 0.0), move |x| disk_light(&disk, x));
        let rows = right.run(gpu, &shader);
        println!(
            "{wavelength_nm} nm {}",
            right.check(&rows).unwrap_or_else(|error| panic!("{wavelength_nm}: {error}"))
        );
        let wrong = comparison("disk_light", call, disk_inputs(), (1.8e-4, 0.0), move |x| disk_light(&one_part, x));
        assert!(wrong.check(&rows).is_err(), "another law passes");
    }
}

#[test]
fn every_law_agrees_with_its_reference() {
    let Some(gpu) = gpu() else { return };
    for law in laws() {
        let call = format!("y[0] = brdf_sr({}, x[0], x[1], x[2]);", parameters(&law));
        let inputs = directions(4000).into_iter().filter(|x| x[0].min(x[1]) > 0.01).collect();
        let comparison =
            comparison("brdf_sr", &call, inputs, (0.0, 1e-3), move |x| vec![law.brdf_sr(x[0], x[1], x[2])]);
        let outcome = comparison.check(&comparison.run(gpu, &shader(ALPHA, &law)));
        println!("{law:?}\n{}", outcome.unwrap_or_else(|error| panic!("{law:?}: {error}")));
    }
}

#[test]
fn every_function_of_the_shaders_has_a_comparison() {
    let source = source() + "@group(0) @binding(0) var<storage, read> disk_tables: array<f32>;";
    let compared: Vec<_> = comparisons().iter().map(|comparison| comparison.function).collect();
    let missing: Vec<_> = functions(&source).into_iter().filter(|name| !compared.contains(&name.as_str())).collect();
    assert!(missing.is_empty(), "without a comparison: {missing:?}");
}

/// Every bound is seen to bite: results off by twice what is allowed, and results that are no numbers.
#[test]
fn every_comparison_notices_a_wrong_result() {
    let Some(gpu) = gpu() else { return };
    let shader = shader(ALPHA, &moon());
    for comparison in comparisons() {
        let rows = comparison.run(gpu, &shader);
        let mut off = rows.clone();
        let last = off.len() / 2;
        off[last][0] += 3.0 * (comparison.absolute + comparison.relative * f64::from(off[last][0].abs())) as f32 + 1e-6;
        assert!(comparison.check(&off).is_err(), "{}", comparison.function);
        let mut nan = rows;
        nan[last][0] = f32::NAN;
        assert!(comparison.check(&nan).is_err(), "{}", comparison.function);
    }
}

/// A shader with a factor forgotten is rejected: the 2 of McEwen's first term, the tail of the wedge.
#[test]
fn mistakes_in_the_shaders_are_noticed() {
    let Some(gpu) = gpu() else { return };
    for (right, wrong, function) in [
        ("if cosine >= b.height {", "if false {", "light_in_wedge"),
        ("- z / 39916800.0", "", "small_sine"),
        ("(0.5 - r0 * x)", "(1.0 - r0 * x)", "hapke_sr"),
        ("half_cosine * towards_terminator", "towards_terminator", "akimov"),
        ("select(near_cosine, far_cosine, swapped)", "near_cosine", "hapke_rough"),
    ] {
        let mut shader = shader(ALPHA, &moon());
        assert!(shader.source.contains(right), "{right}");
        shader.source = shader.source.replace(right, wrong);
        let all = comparisons();
        let comparison = all.iter().find(|comparison| comparison.function == function).unwrap();
        assert!(comparison.check(&comparison.run(gpu, &shader)).is_err(), "{wrong} passed");
    }
}

/// A million directions, exact 0° and 90° among them, on the device and in `f64`.
#[test]
fn reflectance_is_finite_and_not_negative_in_a_million_directions() {
    let Some(gpu) = gpu() else { return };
    let mut inputs = spread(1_000_000, &[(0.0, 1.0), (0.0, 1.0), (-1.0, 1.0)]);
    for (i, mu0) in [0.0, 1e-30, 1e-7, 0.5, 1.0].into_iter().enumerate() {
        for (j, mu) in [0.0, 1e-30, 1e-7, 0.5, 1.0].into_iter().enumerate() {
            for (k, phase) in [-1.0, -0.999_999_94, 0.0, 0.5, 0.999_999_94, 1.0].into_iter().enumerate() {
                inputs[30 * i + 6 * j + k] = vec![mu0, mu, phase];
            }
        }
    }
    for law in laws() {
        let call = format!("y[0] = brdf_sr({}, x[0], x[1], x[2]);", parameters(&law));
        let comparison = comparison("brdf_sr", &call, inputs.clone(), (0.0, 0.0), |_| vec![0.0]);
        for (input, value) in inputs.iter().zip(comparison.run(gpu, &shader(ALPHA, &law))) {
            assert!(value[0].is_finite() && value[0] >= 0.0, "{law:?} {input:?}: {value:?}");
            let wide = law.brdf_sr(f64::from(input[0]), f64::from(input[1]), f64::from(input[2]));
            assert!(wide.is_finite() && wide >= 0.0, "{law:?} {input:?}: {wide}");
        }
    }
}
