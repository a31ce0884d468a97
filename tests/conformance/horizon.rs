//! The shaders of all encodings against their decoders in f64, function by function, on maps of random words.

use std::f64::consts::TAU;

use glam::DVec2;
use perilune_engine::horizon::pack::{BitField, Family, pack, unpack};
use perilune_engine::horizon::{Bounds, Encoding, Horizon, HorizonMap, Texels, TileErrors};
use perilune_engine::terrain::AZIMUTH_RATIO_WGSL;

use super::{Comparison, Shader, functions, gpu, spread};

const COLUMNS: usize = 37;
const ROWS: usize = 29;

/// Coefficients that fall with their order as those of real skylines do: 0.2 rad the mean, 0.01 rad the last.
fn map(encoding: Encoding) -> HorizonMap {
    let mut numbers = spread(40_000, &[(-1.0, 1.0)]).into_iter().cycle().map(|x| x[0]);
    let pages = encoding.pages();
    let fields: Vec<_> = match encoding.family() {
        Family::Quantised => pages.iter().map(|page| fields(page.words, 2 * (encoding.harmonics() + 1))).collect(),
        Family::Fourier | Family::Sampled => Vec::new(),
    };
    let mut levels = Vec::new();
    for (index, page) in pages.into_iter().enumerate() {
        let mut level = Texels::empty(COLUMNS, ROWS, page);
        for texel in level.words.chunks_mut(page.words) {
            for (slot, word) in texel.iter_mut().enumerate() {
                let mut number = || numbers.next().unwrap();
                *word = match encoding.family() {
                    Family::Fourier => pack([0, 1].map(|_| 0.2 / (1.0 + (4 * index + slot) as f32) * number())),
                    Family::Sampled => pack([0, 1].map(|_| 0.2 * number())),
                    Family::Quantised => number().to_bits().wrapping_mul(2_654_435_761),
                };
            }
        }
        levels.push(level);
    }
    let (errors, bounds) = (TileErrors::default(), Bounds::unknown(COLUMNS, ROWS));
    HorizonMap { encoding, columns: COLUMNS, rows: ROWS, levels, fields, errors, bounds }
}

/// Fields of one to nine bits that fill the words, of falling steps.
fn fields(words: usize, reals: usize) -> Vec<BitField> {
    let mut fields = Vec::new();
    for word in 0..words {
        let mut shift = 0;
        for width in [9, 1, 4, 8, 2, 3, 5] {
            let order = fields.len() as f32 / 2.0;
            let step_rad = 0.1 / (1.0 + order) / (1 << width) as f32;
            let real = fields.len() * (reals - 1) / (7 * words - 1);
            fields.push(BitField { real, word, shift, width, step_rad, offset_rad: 0.1 * step_rad, bias: 0.5 });
            shift += width;
        }
    }
    fields
}

fn shader(map: &HorizonMap) -> Shader {
    let texel = "fn horizon_texel(index: u32) -> vec4u { return horizon_texels[index]; }";
    let mut texels = Vec::new();
    map.append_to(&mut texels);
    let table = texels.as_flattened().to_vec();
    let declared = "horizon_texels: array<vec4u>";
    Shader {
        source: [&map.encoding.wgsl(), AZIMUTH_RATIO_WGSL, texel].concat(),
        constants: map.encoding.constants(),
        declared,
        table,
    }
}

/// The map as WGSL.
fn grid(map: &HorizonMap) -> String {
    let grid = map.append_to(&mut Vec::new());
    let numbers = [grid.columns, grid.rows, grid.table, grid.offset_0, grid.offset_1, grid.offset_2, grid.offset_3];
    format!("HorizonGrid({})", numbers.map(|number| format!("{number}u")).join(", "))
}

/// Grid points inside, on the edges and beyond; azimuths all round, the cardinal ones among them.
fn places(cardinal: bool) -> Vec<Vec<f32>> {
    let inside = spread(4000, &[(-2.0, COLUMNS as f32 + 1.0), (-2.0, ROWS as f32 + 1.0), (0.0, TAU as f32)]);
    let (east, north) = ((COLUMNS - 1) as f32, (ROWS - 1) as f32);
    let edges = [0.0, 0.5, 7.0, east / 2.0, east]
        .into_iter()
        .flat_map(|x| [0.0, 3.5, north].map(|y| [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)].map(|d| (x, y, d))))
        .flatten()
        .filter(|_| cardinal)
        .map(|(x, y, (sin, cos))| vec![x, y, sin, cos]);
    inside.into_iter().map(|x| vec![x[0], x[1], x[2].sin(), x[2].cos()]).chain(edges).collect()
}

fn call(text: String) -> &'static str {
    Box::leak(text.into_boxed_str())
}

fn comparison(
    function: &'static str,
    call: &'static str,
    inputs: Vec<Vec<f32>>,
    absolute: f64,
    reference: Box<super::Reference>,
) -> Comparison {
    Comparison { function, call, inputs, reference, absolute, relative: 1e-6 }
}

/// Elevation and slope as a whole. Bounds: a rounding of f32 is 6e-8; sums have 64 terms of up to 0.2, slopes weigh them by
/// up to 31; a shader may place a point between texels to 1e-6 of the map.
fn whole(map: &HorizonMap) -> Vec<Comparison> {
    let grid = grid(map);
    let wanted = |map: &HorizonMap| {
        let map = map.clone();
        move |x: &[f64]| map.horizon(DVec2::new(x[0], x[1])).evaluate_towards(DVec2::new(x[2], x[3]))
    };
    let (elevation, slope, of_profile) = (wanted(map), wanted(map), wanted(map));
    let samples = map.encoding.family() == Family::Sampled;
    // Within rounding of a sampled azimuth either piece's slope is right.
    let near_a_sample = |x: &Vec<f32>| {
        let sector = f64::from(x[2]).atan2(f64::from(x[3])) / TAU * map.encoding.samples() as f64;
        samples && (sector - sector.round()).abs() < 1e-5
    };
    let off_samples: Vec<_> = places(!samples).into_iter().filter(|x| !near_a_sample(x)).collect();
    // A profile is fetched once and asked in many directions.
    let asked =
        call(format!("y[0] = horizon_towards(horizon_profile({grid}, vec2f(x[0], x[1])), vec2f(x[2], x[3])).x;"));
    let profile = move |x: &[f64]| vec![of_profile(x).0];
    vec![
        comparison("horizon_profile", asked, places(true), 6e-6, Box::new(profile.clone())),
        comparison("horizon_towards", asked, places(true), 6e-6, Box::new(profile)),
        comparison(
            "horizon_elevation",
            call(format!("y[0] = horizon_elevation({grid}, vec2f(x[0], x[1]), vec2f(x[2], x[3])).x;")),
            places(true),
            6e-6,
            Box::new(move |x| vec![elevation(x).0]),
        ),
        comparison(
            "horizon_elevation",
            call(format!("y[0] = horizon_elevation({grid}, vec2f(x[0], x[1]), vec2f(x[2], x[3])).y;")),
            off_samples,
            6e-5,
            Box::new(move |x| vec![slope(x).1]),
        ),
    ]
}

/// What all families share.
fn shared(map: &HorizonMap) -> Vec<Comparison> {
    let grid = grid(map);
    let scale = if map.encoding.pages().last().unwrap().scale > 1 { 4.0 } else { 1.0 };
    vec![
        comparison(
            "horizon_turn",
            "let c = horizon_turn(vec2f(x[0], x[1]), vec2f(x[2], x[3])); y[0] = c.x; y[1] = c.y;",
            spread(500, &[(-1.0, 1.0); 4]),
            2e-7,
            Box::new(|x| vec![x[0] * x[2] - x[1] * x[3], x[0] * x[3] + x[1] * x[2]]),
        ),
        // `ψ` on the ground of `φ` on the map, from the radius: tan ψ = tan φ / cos c.
        comparison(
            "azimuth_ratio",
            "y[0] = azimuth_ratio(vec2f(x[0], 0.0), 1.7374e6, vec2f(cos(x[1]), sin(x[1])));",
            spread(500, &[(0.0, 1.5e6), (0.0, TAU as f32)]),
            // Sines of f32.
            5e-6,
            Box::new(|x| {
                let (cos_c, (sin, cos)) = ((x[0] / 1.7374e6).atan().cos(), x[1].sin_cos());
                vec![(cos * cos * cos_c * cos_c + sin * sin) / cos_c]
            }),
        ),
        // The place that the four corners and shares stand for, in texels of the third page.
        comparison(
            "horizon_cell",
            call(format!(
                "let c = horizon_cell({grid}, 2u, vec2f(x[0], x[1])); let columns = {columns}u;
                let low = vec2f(f32(c.texels.x % columns), f32(c.texels.x / columns));
                let high = vec2f(f32(c.texels.w % columns), f32(c.texels.w / columns));
                let at = mix(low, high, c.share); y[0] = at.x; y[1] = at.y;
                y[2] = f32(c.texels.y) - f32(c.texels.x) - (f32(c.texels.w) - f32(c.texels.z));",
                columns = COLUMNS.div_ceil(scale as usize)
            )),
            places(true),
            // Of a coordinate of 37.
            1e-5,
            Box::new(move |x| {
                let at = |grid: f64, nodes: usize| {
                    let last = (nodes as f64 / scale).ceil() - 1.0;
                    ((grid + 0.5) / scale - 0.5).clamp(0.0, last)
                };
                vec![at(x[0], COLUMNS), at(x[1], ROWS), 0.0]
            }),
        ),
    ]
}

fn halves(map: &HorizonMap) -> Vec<Comparison> {
    let grid = grid(map);
    let numbers = |x: &[f64]| ([x[0], x[1], x[2], x[3]], [x[4], x[5], x[6], x[7]]);
    // Numbers that half floats hold exactly.
    let exact =
        spread(1000, &[(-1.0, 1.0); 8]).into_iter().map(|x| x.into_iter().map(|x| unpack(pack([x, 0.0]))[0]).collect());
    let mut ranges = [(-0.2, 0.2); 9];
    ranges[8] = (0.0, TAU as f32);
    let terms = spread(1000, &ranges);
    let eight = "HorizonCoefficients(vec4f(x[0], x[1], x[2], x[3]), vec4f(x[4], x[5], x[6], x[7]))";
    let first = map.clone();
    vec![
        comparison(
            "horizon_unpack",
            "let c = horizon_unpack(vec4u(pack2x16float(vec2f(x[0], x[4])), pack2x16float(vec2f(x[1], x[5])), pack2x16float(vec2f(x[2], x[6])), pack2x16float(vec2f(x[3], x[7]))));
            for (var i = 0u; i < 4u; i++) { y[i] = c.re[i]; y[4u + i] = c.im[i]; }",
            exact.collect(),
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
            "horizon_terms",
            call(format!("let step = vec2f(cos(0.0) * x[9], x[8]); let c = horizon_terms({eight}, 0.0, vec2f(1.0, 0.0), step); y[0] = c.x; y[1] = c.y;")),
            terms.into_iter().map(|x| [&x[..8], &[x[8].sin(), x[8].cos()]].concat()).collect(),
            2e-6,
            Box::new(move |x| {
                let ((re, im), angle_rad) = (numbers(x), x[8].atan2(x[9]));
                let sum = |f: &dyn Fn(f64, usize) -> f64| (0..4).map(|k| f(k as f64 * angle_rad, k)).sum::<f64>();
                vec![
                    sum(&|a, k| re[k] * a.cos() - im[k] * a.sin()),
                    sum(&|a, k| -(k as f64) * (re[k] * a.sin() + im[k] * a.cos())),
                ]
            }),
        ),
        // The sum of the first texel's real parts: its four terms at azimuth 0.
        comparison(
            "horizon_coefficients",
            call(format!("let g = {grid}; y[0] = dot(horizon_coefficients(g, g.offset_0, 0u, vec2f(x[0], x[1])).re, vec4f(1.0));")),
            places(true),
            2e-6,
            Box::new(move |x| {
                let mut map = first.clone();
                map.levels.truncate(1);
                map.encoding = Encoding::F4;
                vec![map.horizon(DVec2::new(x[0], x[1])).evaluate_towards(DVec2::Y).0]
            }),
        ),
    ]
}

fn samples(map: &HorizonMap) -> Vec<Comparison> {
    let count = map.encoding.samples();
    let sector_rad = TAU / count as f64;
    let texel = |map: &HorizonMap, index: usize| {
        let words = map.levels[0].texel(index % COLUMNS, index / COLUMNS).to_vec();
        move |sample: usize| f64::from(unpack(words[sample / 2])[sample % 2])
    };
    let numbers: Vec<Vec<f32>> =
        (0..COLUMNS * ROWS).flat_map(|i| (0..count).map(move |sample| vec![i as f32, sample as f32])).collect();
    let (one, four) = (map.clone(), map.clone());
    vec![
        comparison(
            "horizon_place",
            "let p = horizon_place(vec2f(x[0], x[1])); y[0] = p.x + p.y;",
            spread(3000, &[(1e-4, TAU as f32 - 1e-4)]).into_iter().map(|x| vec![x[0].cos(), x[0].sin()]).collect(),
            4e-6,
            Box::new(move |x| vec![x[1].atan2(x[0]).rem_euclid(TAU) / sector_rad]),
        ),
        comparison(
            "horizon_sample",
            "y[0] = horizon_sample(0u, u32(x[0]), u32(x[1]));",
            numbers.clone(),
            1e-9,
            Box::new(move |x| vec![texel(&one, x[0] as usize)(x[1] as usize)]),
        ),
        // Of four texels in a row, the first and the last half as far from the point as the others.
        comparison(
            "horizon_sampled",
            "let i = min(u32(x[0]), 1000u); y[0] = horizon_sampled(0u, HorizonCell(vec4u(i, i + 1u, i + 2u, i + 3u), vec2f(0.5, 0.25)), u32(x[1]));",
            numbers,
            1e-7,
            Box::new(move |x| {
                let index = (x[0] as usize).min(1000);
                let shares = [0.375, 0.375, 0.125, 0.125];
                vec![(0..4).map(|i| shares[i] * texel(&four, index + i)(x[1] as usize)).sum()]
            }),
        ),
    ]
}

fn water(map: &HorizonMap) -> Vec<Comparison> {
    let grid = grid(map);
    let words = map.levels[0].words_per_texel;
    // A word as two halves, which f32 holds exactly.
    let texels: Vec<Vec<f32>> = (0..COLUMNS * ROWS).map(|i| vec![i as f32]).collect();
    let halves_of = |map: &HorizonMap| {
        let map = map.clone();
        move |x: &[f64]| {
            let index = x[0] as usize;
            let texel = map.levels[0].texel(index % COLUMNS, index / COLUMNS);
            texel.iter().flat_map(|word| [f64::from(word & 0xffff), f64::from(word >> 16)]).collect::<Vec<_>>()
        }
    };
    let one = map.clone();
    let codes = (0..COLUMNS * ROWS).flat_map(|i| (0..7 * words).map(move |field| vec![i as f32, field as f32]));
    let (gained, coded, first) = (map.clone(), map.clone(), map.clone());
    // The second page, where there is one, and its part of the table's entries, the first of which says so itself.
    let page = 1.min(map.fields.len() - 1);
    let start = 1 + map.fields[..page].iter().map(Vec::len).sum::<usize>();
    let end = start + map.fields[page].len();
    vec![
        comparison(
            "horizon_words",
            call(format!(
                "let all = horizon_words(0u, u32(x[0])); let w = array<vec4u, 2>(all.low, all.high); for (var i = 0u; i < {words}u; i++) {{ let word = w[i / 4u][i % 4u]; y[2u * i] = f32(word & 0xffffu); y[2u * i + 1u] = f32(word >> 16u); }}"
            )),
            texels,
            1e-9,
            Box::new(halves_of(&one)),
        ),
        comparison(
            "horizon_gain",
            call("y[0] = horizon_gain(horizon_words(0u, u32(x[0])));".into()),
            (0..COLUMNS * ROWS).map(|i| vec![i as f32]).collect(),
            1e-9,
            Box::new(move |x| {
                let index = x[0] as usize;
                let word = gained.levels[0].texel(index % COLUMNS, index / COLUMNS)[0];
                vec![2.0_f64.powi((word % (1 << gained.encoding.gain_bits())) as i32)]
            }),
        ),
        comparison(
            "horizon_code",
            call(format!(
                "let g = {grid}; y[0] = horizon_code(horizon_words(0u, u32(x[0])), horizon_texel(g.table + 1u + u32(x[1])).x);"
            )),
            codes.collect(),
            1e-9,
            Box::new(move |x| {
                let (index, field) = (x[0] as usize, coded.fields[0][x[1] as usize]);
                let word = coded.levels[0].texel(index % COLUMNS, index / COLUMNS)[field.word];
                let bits = (word >> field.shift) & ((1 << field.width) - 1);
                // Two's complement, as the definition says it.
                vec![f64::from(bits) - if bits >> (field.width - 1) == 1 { f64::from(1 << field.width) } else { 0.0 }]
            }),
        ),
        comparison(
            "horizon_page",
            call(format!(
                "let g = {grid}; y[0] = horizon_page(g, {page}u, g.offset_{page}, vec2u({start}u, {end}u), vec2f(x[0], x[1]), vec2f(x[3], x[2])).x;"
            )),
            places(true),
            3e-6,
            Box::new(move |x| {
                let mut map = first.clone();
                let others = (0..map.fields.len()).filter(|other| *other != page);
                others.for_each(|other| map.fields[other].clear());
                let horizon = map.horizon(DVec2::new(x[0], x[1]));
                // A page is a part of what the series says before it is expanded.
                let (Horizon::Series(series) | Horizon::Companded(series, _)) = horizon else { panic!("a series") };
                vec![series.evaluate_towards(DVec2::new(x[2], x[3])).0]
            }),
        ),
    ]
}

fn comparisons(map: &HorizonMap) -> Vec<Comparison> {
    let own = match map.encoding.family() {
        Family::Fourier => halves(map),
        Family::Sampled => samples(map),
        Family::Quantised => water(map),
    };
    shared(map).into_iter().chain(own).chain(whole(map)).collect()
}

#[test]
fn skylines_on_the_device_are_those_of_the_decoders() {
    let Some(gpu) = gpu() else { return };
    for encoding in Encoding::ALL {
        let map = map(encoding);
        for comparison in comparisons(&map) {
            let outcome = comparison.check(&comparison.run(gpu, &shader(&map)));
            println!("{encoding} {}", outcome.unwrap_or_else(|error| panic!("{encoding} {error}")));
        }
    }
}

#[test]
fn every_function_of_the_decoders_has_a_comparison() {
    for encoding in [Encoding::F16, Encoding::Raw12, Encoding::W16] {
        let map = map(encoding);
        let source = shader(&map).source + "@group(0) @binding(0) var<storage, read> horizon_texels: array<vec4u>;";
        let compared: Vec<_> = comparisons(&map).iter().map(|comparison| comparison.function).collect();
        let missing: Vec<_> = functions(&source)
            .into_iter()
            .filter(|name| name != "horizon_texel" && !compared.contains(&name.as_str()))
            .collect();
        assert!(missing.is_empty(), "{encoding} without a comparison: {missing:?}");
    }
}

/// Signs, the half texel, the order in the slope, neighbours in a word.
#[test]
fn mistakes_in_the_decoders_are_noticed() {
    let Some(gpu) = gpu() else { return };
    let mistakes = [
        (Encoding::Fm16, "dot(coefficients.re, cosines) - dot", "dot(coefficients.re, cosines) + dot"),
        (Encoding::Fm16, "(grid + 0.5) / scale - 0.5", "grid / scale"),
        (Encoding::Fm16, "let step = towards.yx", "let step = towards.xy"),
        (Encoding::Raw12, "index % 2u == 1u", "index % 2u == 0u"),
        (Encoding::Raw16, "(index + 1u) % HORIZON_SAMPLES", "index + 1u"),
        (Encoding::W21, "-f32(order) * wave.y", "-wave.y"),
        (Encoding::W21, "vec2f(turned.y, -turned.x)", "vec2f(turned.y, turned.x)"),
        (Encoding::W16, "vec4u(low.zw, high.xy)", "vec4u(low.zw, low.xy)"),
        (Encoding::W11, "f32(i32(word <<", "f32((word <<"),
        (Encoding::W21, "vec2f(1.0 + bent, 1.0 + 3.0 * bent)", "vec2f(1.0 + bent)"),
        (
            Encoding::W16,
            "horizon_gain(north_west), horizon_gain(north_east)",
            "horizon_gain(north_east), horizon_gain(north_west)",
        ),
        (Encoding::Q, "(1u << HORIZON_GAIN_BITS) - 1u", "3u"),
        (Encoding::Q, "word = words.high", "word = words.low"),
    ];
    for (encoding, right, wrong) in mistakes {
        let map = map(encoding);
        let mut shader = shader(&map);
        assert!(shader.source.contains(right), "{right}");
        shader.source = shader.source.replace(right, wrong);
        let noticed =
            comparisons(&map).iter().any(|comparison| comparison.check(&comparison.run(gpu, &shader)).is_err());
        assert!(noticed, "{wrong} passed");
    }
}
