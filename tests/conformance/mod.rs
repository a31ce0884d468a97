//! Shaders against their references: layout, and function by function.
//!
//! A [`Comparison`] calls one WGSL function on many inputs and holds what it returns against `f64`. Without an
//! adapter these tests are skipped with the reason; `SIM_REQUIRE` with `gpu` in it turns that into a failure.

mod adapters;
mod directional;
mod horizon;
mod layout;
mod mipmaps;
mod multiscale;
mod photometry;
mod rays;
pub mod render;
pub mod scenarios;
mod session;
mod skylines;
mod starts;
mod vectors;
mod visibility;

use std::sync::OnceLock;

use perilune_engine::gpu::{Adapter, Gpu};

/// The one device of this binary, or `None` with the reason printed.
pub fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Result<Gpu, String>> = OnceLock::new();
    match GPU.get_or_init(|| Gpu::open(Adapter::Auto).map_err(|error| error.to_string())) {
        Ok(gpu) => Some(gpu),
        Err(reason) if crate::required("gpu") => panic!("{reason}"),
        Err(reason) => {
            println!("skipped: {reason}");
            None
        }
    }
}

type Reference = dyn Fn(&[f64]) -> Vec<f64>;

/// One function of a shader, what it is called with, and what it must return.
pub struct Comparison {
    pub function: &'static str,
    /// WGSL that reads `x[0]`, `x[1]`, … and writes `y[0]`, `y[1]`, ….
    pub call: &'static str,
    pub inputs: Vec<Vec<f32>>,
    /// The same from the inputs as the shader gets them, rounded to `f32`.
    pub reference: Box<Reference>,
    /// Largest error allowed, in the unit of the result, and its share of the result on top.
    pub absolute: f64,
    pub relative: f64,
}

/// A shader with all its functions: source, `override` values, and a table that they read.
pub struct Shader {
    pub source: String,
    pub constants: Vec<(&'static str, f64)>,
    /// The table's declaration, as in `disk_tables: array<f32>`, and its words.
    pub declared: &'static str,
    pub table: Vec<u32>,
}

impl Comparison {
    /// What the function returns on the device, one row per input.
    pub fn run(&self, gpu: &Gpu, shader: &Shader) -> Vec<Vec<f32>> {
        let (given, made) = (self.inputs[0].len(), (self.reference)(&self.input(0)).len());
        let table = shader.declared.split(':').next().unwrap_or_default();
        let source = format!(
            "{}
            @group(0) @binding(0) var<storage, read> {};
            @group(0) @binding(1) var<storage, read> given: array<array<f32, {given}>>;
            @group(0) @binding(2) var<storage, read_write> made: array<array<f32, {made}>>;
            @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {{
                if id.x >= arrayLength(&given) {{ return; }}
                let x = given[id.x];
                var y: array<f32, {made}>;
                y[0] = f32(arrayLength(&{table}));
                {}
                made[id.x] = y;
            }}",
            shader.source, shader.declared, self.call
        );
        let pipeline = gpu.compute(self.function, &source, "main", &shader.constants).unwrap();
        let table = gpu.storage("table", &shader.table);
        let given = gpu.storage("given", &self.inputs.concat());
        let output = gpu.output("made", (4 * made * self.inputs.len()) as u64);
        gpu.run(&pipeline, &[&table, &given, &output], [self.inputs.len().div_ceil(64) as u32, 1, 1]);
        let values: Vec<f32> = gpu.read(&output).unwrap();
        values.chunks(made).take(self.inputs.len()).map(<[f32]>::to_vec).collect()
    }

    fn input(&self, row: usize) -> Vec<f64> {
        self.inputs[row].iter().map(|&x| f64::from(x)).collect()
    }

    /// Quantiles of the error as a share of what is allowed, or the first row that exceeds it.
    pub fn check(&self, rows: &[Vec<f32>]) -> Result<String, String> {
        let mut shares = Vec::new();
        for (row, values) in rows.iter().enumerate() {
            let wanted = (self.reference)(&self.input(row));
            for (&got, &wanted) in values.iter().zip(&wanted) {
                let share = (f64::from(got) - wanted).abs() / (self.absolute + self.relative * wanted.abs());
                if share.is_nan() || share > 1.0 {
                    let Self { function, inputs, .. } = self;
                    return Err(format!("{function}({:?}) = {got}, not {wanted}: {share} of the bound", inputs[row]));
                }
                shares.push(share);
            }
        }
        shares.sort_by(f64::total_cmp);
        let quantile = |q: f64| shares[((shares.len() - 1) as f64 * q) as usize];
        let Self { function, absolute, relative, .. } = self;
        Ok(format!(
            "{function:>22}: q50 {:.3}, q99 {:.3}, max {:.3} of {absolute:e} + {relative:e} relative, {} values",
            quantile(0.5),
            quantile(0.99),
            quantile(1.0),
            shares.len()
        ))
    }
}

/// Names of the functions a shader declares.
pub fn functions(source: &str) -> Vec<String> {
    let module =
        naga::front::wgsl::parse_str(source).unwrap_or_else(|error| panic!("{}", error.emit_to_string(source)));
    module.functions.iter().filter_map(|(_, function)| function.name.clone()).collect()
}

/// Points that fill a box evenly: the additive sequence of the generalised golden ratio.
///
/// # References
/// Roberts (2018), The unreasonable effectiveness of quasirandom sequences.
pub fn spread(count: usize, ranges: &[(f32, f32)]) -> Vec<Vec<f32>> {
    let dimensions = ranges.len() as i32;
    let ratio = (0..40).fold(1.5f64, |x, _| (1.0 + x).powf(1.0 / f64::from(dimensions + 1)));
    (1..=count)
        .map(|i| {
            (1..)
                .zip(ranges)
                .map(|(k, &(low, high))| low + (high - low) * (0.5 + i as f64 * ratio.powi(-k)).fract() as f32)
                .collect()
        })
        .collect()
}
