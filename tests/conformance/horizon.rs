//! `series.wgsl` against the series in f64, function by function, on maps of random texels.

use std::f64::consts::TAU;

use glam::DVec2;
use perilune::horizon::pack::{pack, unpack};
use perilune::horizon::{Bounds, Encoding, HorizonMap, SERIES_WGSL, Texels, TileErrors};

use super::{Comparison, Shader, functions, gpu, spread};

const COLUMNS: usize = 37;
const ROWS: usize = 29;

/// Coefficients that fall with their order as those of real skylines do: 0.2 rad the mean, 0.01 rad the last.
fn map(encoding: Encoding) -> HorizonMap {
    let mut numbers = spread(40_000, &[(-1.0, 1.0)]).into_iter().map(|x| x[0]);
    let mut level = |group: usize, scale: usize| {
        let (columns, rows) = (COLUMNS.div_ceil(scale), ROWS.div_ceil(scale));
        let mut number = |slot: usize| 0.2 / (1.0 + (4 * group + slot) as f32) * numbers.next().unwrap();
        let texels = (0..columns * rows).map(|_| [0, 1, 2, 3].map(|slot| pack([number(slot), number(slot)])));
        Texels { columns, rows, texels: texels.collect() }
    };
    let levels = (0..).zip(encoding.scales()).map(|(group, scale)| level(group, scale)).collect();
    let (errors, bounds) = (TileErrors::default(), Bounds::unknown(COLUMNS, ROWS));
    HorizonMap { encoding, columns: COLUMNS, rows: ROWS, levels, errors, bounds }
}

fn shader(map: &HorizonMap) -> Shader {
    let texel = "fn horizon_texel(index: u32) -> vec4u { return horizon_texels[index]; }";
    let table = map.levels.iter().flat_map(|level| level.texels.as_flattened()).copied().collect();
    let declared = "horizon_texels: array<vec4u>";
    Shader { source: [SERIES_WGSL, texel].concat(), constants: Vec::new(), declared, table }
}

/// The map as WGSL.
fn grid(map: &HorizonMap) -> String {
    let halving = u32::from(map.encoding == Encoding::Fm16);
    let mut offset = 0;
    let offsets = map.levels.iter().map(|level| {
        offset += level.texels.len();
        format!("{}u", offset - level.texels.len())
    });
    let offsets: Vec<_> = offsets.collect();
    format!("HorizonGrid({COLUMNS}u, {ROWS}u, {halving}u, {})", offsets.join(", "))
}

/// Grid points inside, on the edges and beyond; azimuths all round, the cardinal ones among them.
fn places() -> Vec<Vec<f32>> {
    let inside = spread(4000, &[(-2.0, COLUMNS as f32 + 1.0), (-2.0, ROWS as f32 + 1.0), (0.0, TAU as f32)]);
    let (east, north) = ((COLUMNS - 1) as f32, (ROWS - 1) as f32);
    let edges = [0.0, 0.5, 7.0, east / 2.0, east]
        .into_iter()
        .flat_map(|x| [0.0, 3.5, north].map(|y| [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)].map(|d| (x, y, d))))
        .flatten()
        .map(|(x, y, (sin, cos))| vec![x, y, sin, cos]);
    inside.into_iter().map(|x| vec![x[0], x[1], x[2].sin(), x[2].cos()]).chain(edges).collect()
}

fn numbers(x: &[f64]) -> ([f64; 4], [f64; 4]) {
    ([x[0], x[1], x[2], x[3]], [x[4], x[5], x[6], x[7]])
}

/// Bounds: a rounding of f32 is 6e-8; sums have 32 terms of up to 0.2, slopes weigh them by up to 15; a shader may
/// place a point between texels to 1e-6 of the map.
fn comparisons(map: &HorizonMap) -> Vec<Comparison> {
    let grid = grid(map);
    let call = |text: String| -> &'static str { Box::leak(text.into_boxed_str()) };
    let comparison = |function, call, inputs, absolute, reference: Box<super::Reference>| Comparison {
        function,
        call,
        inputs,
        reference,
        absolute,
        relative: 1e-6,
    };
    // Numbers that half floats hold exactly.
    let halves =
        spread(1000, &[(-1.0, 1.0); 8]).into_iter().map(|x| x.into_iter().map(|x| unpack(pack([x, 0.0]))[0]).collect());
    let terms = spread(
        1000,
        &[
            (-0.2, 0.2),
            (-0.2, 0.2),
            (-0.2, 0.2),
            (-0.2, 0.2),
            (-0.2, 0.2),
            (-0.2, 0.2),
            (-0.2, 0.2),
            (-0.2, 0.2),
            (0.0, TAU as f32),
        ],
    );
    let eight = "HorizonCoefficients(vec4f(x[0], x[1], x[2], x[3]), vec4f(x[4], x[5], x[6], x[7]))";
    let wanted = |map: &HorizonMap| {
        let map = map.clone();
        move |x: &[f64]| map.horizon(DVec2::new(x[0], x[1])).evaluate_towards(DVec2::new(x[2], x[3]))
    };
    let (elevation, slope) = (wanted(map), wanted(map));
    let first = map.clone();
    vec![
        comparison(
            "horizon_unpack",
            "let c = horizon_unpack(vec4u(pack2x16float(vec2f(x[0], x[4])), pack2x16float(vec2f(x[1], x[5])), pack2x16float(vec2f(x[2], x[6])), pack2x16float(vec2f(x[3], x[7]))));
            for (var i = 0u; i < 4u; i++) { y[i] = c.re[i]; y[4u + i] = c.im[i]; }",
            halves.collect(),
            1e-9,
            Box::new(|x| x[..8].to_vec()),
        ),
        comparison(
            "horizon_mix",
            call(format!("let c = horizon_mix({eight}, HorizonCoefficients(vec4f(1.0), vec4f(2.0)), 0.25); y[0] = c.re.y; y[1] = c.im.z;")),
            spread(500, &[(-1.0, 1.0); 8]),
            1e-7,
            Box::new(|x| vec![0.75 * x[1] + 0.25, 0.75 * x[6] + 0.5]),
        ),
        comparison(
            "horizon_turn",
            "let c = horizon_turn(vec2f(x[0], x[1]), vec2f(x[2], x[3])); y[0] = c.x; y[1] = c.y;",
            spread(500, &[(-1.0, 1.0); 4]),
            2e-7,
            Box::new(|x| vec![x[0] * x[2] - x[1] * x[3], x[0] * x[3] + x[1] * x[2]]),
        ),
        comparison(
            "horizon_terms",
            call(format!("let step = vec2f(cos(0.0) * x[9], x[8]); let c = horizon_terms({eight}, 0.0, vec2f(1.0, 0.0), step); y[0] = c.x; y[1] = c.y;")),
            terms.into_iter().map(|x| [&x[..8], &[x[8].sin(), x[8].cos()]].concat()).collect(),
            2e-6,
            Box::new(|x| {
                let ((re, im), angle_rad) = (numbers(x), x[8].atan2(x[9]));
                let sum = |f: &dyn Fn(f64, usize) -> f64| (0..4).map(|k| f(k as f64 * angle_rad, k)).sum::<f64>();
                vec![
                    sum(&|a, k| re[k] * a.cos() - im[k] * a.sin()),
                    sum(&|a, k| -(k as f64) * (re[k] * a.sin() + im[k] * a.cos())),
                ]
            }),
        ),
        // A constant term alone: the mean, which is the first texel's first real part.
        comparison(
            "horizon_coefficients",
            call(format!("let g = {grid}; y[0] = horizon_coefficients(g, g.offset_0, 0u, vec2f(x[0], x[1])).re.x;")),
            places(),
            1e-6,
            Box::new(move |x| vec![first.horizon(DVec2::new(x[0], x[1])).mean_rad]),
        ),
        comparison(
            "horizon_elevation",
            call(format!("y[0] = horizon_elevation({grid}, vec2f(x[0], x[1]), vec2f(x[2], x[3])).x;")),
            places(),
            5e-6,
            Box::new(move |x| vec![elevation(x).0]),
        ),
        comparison(
            "horizon_elevation",
            call(format!("y[0] = horizon_elevation({grid}, vec2f(x[0], x[1]), vec2f(x[2], x[3])).y;")),
            places(),
            5e-5,
            Box::new(move |x| vec![slope(x).1]),
        ),
    ]
}

#[test]
fn skylines_on_the_device_are_those_of_the_series() {
    let Some(gpu) = gpu() else { return };
    for encoding in [Encoding::Fm16, Encoding::F16] {
        let map = map(encoding);
        for comparison in comparisons(&map) {
            let outcome = comparison.check(&comparison.run(gpu, &shader(&map)));
            println!("{encoding:?} {}", outcome.unwrap_or_else(|error| panic!("{encoding:?} {error}")));
        }
    }
}

#[test]
fn every_function_of_the_series_has_a_comparison() {
    let source =
        shader(&map(Encoding::F16)).source + "@group(0) @binding(0) var<storage, read> horizon_texels: array<vec4u>;";
    let map = map(Encoding::F16);
    let compared: Vec<_> = comparisons(&map).iter().map(|comparison| comparison.function).collect();
    let missing: Vec<_> = functions(&source)
        .into_iter()
        .filter(|name| name != "horizon_texel" && !compared.contains(&name.as_str()))
        .collect();
    assert!(missing.is_empty(), "without a comparison: {missing:?}");
}

/// The sign of the imaginary part, the half texel, the order in the slope.
#[test]
fn mistakes_in_the_series_are_noticed() {
    let Some(gpu) = gpu() else { return };
    let map = map(Encoding::Fm16);
    let mistakes = [
        ("dot(coefficients.re, cosines) - dot", "dot(coefficients.re, cosines) + dot"),
        ("(grid + 0.5) / scale - 0.5", "grid / scale"),
        ("let step = towards.yx", "let step = towards.xy"),
    ];
    for (right, wrong) in mistakes {
        let mut shader = shader(&map);
        assert!(shader.source.contains(right), "{right}");
        shader.source = shader.source.replace(right, wrong);
        let noticed =
            comparisons(&map).iter().any(|comparison| comparison.check(&comparison.run(gpu, &shader)).is_err());
        assert!(noticed, "{wrong} passed");
    }
}
