//! Hard numerical cases, each a small scene with a closed form or an independent reference, for every shadow method.
//!
//! Numbers are those of the project's list of 52 hard cases; those that a shadow can fail are here, [`elsewhere`] says where the
//! others are. A [`Case`] says
//! what its error is and how large it may be, the same for all methods: where a method's own assumptions cost more, that
//! is a failure and is shown as one. Each method runs in the reference renderer, `f64`, and on the device, `f32`.
//!
//! ```text
//! pass: error ≤ limit     FAIL: error > limit     NaN: a share outside [0, 1] or no number     outside: not its domain
//! ```
//!
//! # Assumptions
//! A method's domain is its own word ([`perilune_engine::shadow::Domain`]). Truth of
//! cases without a closed form is the tracer's, which is checked by those with one.

pub mod case;
pub mod cases;
pub mod elsewhere;
pub mod methods;
pub mod scenes;

use std::path::Path;

use super::{Error, Machine, Report, Table, Value};
pub use case::{Case, Outcome};
use methods::MethodFactory;
use perilune_engine::gpu::{Adapter, Gpu};
use perilune_engine::pipeline::Progress;
use perilune_engine::shadow::registry;

/// Outcomes of a case: a row a method, the reference renderer's and the device's.
type Outcomes = Vec<[Option<Outcome>; 2]>;

/// All cases with all methods.
pub fn run(cache: &Path, progress: &dyn Progress) -> Result<Report, Error> {
    let machine = Machine::here();
    let gpu = Gpu::open(Adapter::Auto).map_err(|error| progress.say(&format!("no device: {error}"))).ok();
    let mut cases = cases::all();
    let mut outcomes = Vec::new();
    let count = cases.len();
    progress.begin("hard cases", count, "cases");
    for (done, case) in cases.iter_mut().enumerate() {
        outcomes.push(judge(case, gpu.as_ref(), cache)?);
        progress.at(done + 1, count);
    }
    Ok(Report {
        name: "stability",
        title: format!("{} hard cases, {} shadow methods", cases.len(), registry::hard_case_names().count()),
        machine,
        notes: vec![
            "Numbers are errors over the case's limit: above 1 the method fails. f64: reference renderer, f32: device."
                .into(),
            "Limits are the same for all methods: a posting for an edge, 5 % of full Sun in a penumbra.".into(),
            "Horizon maps of 16 coefficients fail where a skyline is narrower than their azimuths tell apart: a cone's tip (11), a \
             peak's own flank (9), needles (19), a cliff that ends to the left and right (4, 33). Bytes of all nodes buy no more: \
             fourier-f16 fails there too."
                .into(),
        ],
        tables: vec![summary(&outcomes), matrix(&cases, &outcomes), list(&cases, &outcomes), elsewhere::table()],
        plots: Vec::new(),
        figures: Vec::new(),
    })
}

/// What becomes of one case under all methods.
pub fn judge(case: &mut Case, gpu: Option<&Gpu>, cache: &Path) -> Result<Outcomes, Error> {
    let factory = MethodFactory::new(&case.scene.surface, cache)?;
    let mut outcomes = Vec::new();
    for method in registry::hard_case_names() {
        let reference = methods::outcome(case, method, None, &factory)?;
        let device = match gpu.filter(|_| registry::named(method).is_some_and(|options| options.runs_on_device())) {
            Some(gpu) => Some(methods::outcome(case, method, Some(gpu), &factory)?),
            None => None,
        };
        outcomes.push([Some(reference), device]);
    }
    Ok(outcomes)
}

/// How many cases each method passes.
fn summary(outcomes: &[Outcomes]) -> Table {
    let columns = [("method", ""), ("numbers", ""), ("pass", ""), ("fail", ""), ("NaN", ""), ("outside", "")];
    let mut table = Table::new("methods", "How many cases each method passes", &columns);
    for (index, method) in registry::hard_case_names().enumerate() {
        for (renderer, numbers) in ["f64", "f32"].into_iter().enumerate() {
            let found: Vec<_> = outcomes.iter().filter_map(|methods| methods[index][renderer]).collect();
            if found.is_empty() {
                continue;
            }
            let count = |kind: fn(&Outcome) -> bool| Value::from(found.iter().filter(|one| kind(one)).count() as f64);
            table.rows.push(vec![
                method.into(),
                numbers.into(),
                count(|one| matches!(one, Outcome::Pass(_))),
                count(|one| matches!(one, Outcome::Fail(_))),
                count(|one| matches!(one, Outcome::NotANumber)),
                count(|one| matches!(one, Outcome::Outside)),
            ]);
        }
    }
    table
}

/// Cases down, methods across.
fn matrix(cases: &[Case], outcomes: &[Outcomes]) -> Table {
    let mut columns = vec![("case", ""), ("numbers", "")];
    columns.extend(registry::hard_case_names().map(|method| (method, "")));
    let mut table = Table::new("matrix", "Error over limit", &columns);
    for (case, methods) in cases.iter().zip(outcomes) {
        for (renderer, numbers) in ["f64", "f32"].into_iter().enumerate() {
            let cell = |pair: &[Option<Outcome>; 2]| {
                pair[renderer].map_or(Value::Missing, |outcome| Value::Text(outcome.text(case.limit)))
            };
            let mut row = vec![Value::Text(format!("{} {}", case.number, case.name)), numbers.into()];
            row.extend(methods.iter().map(cell));
            table.rows.push(row);
        }
    }
    table
}

/// A row a case, a method and a renderer.
fn list(cases: &[Case], outcomes: &[Outcomes]) -> Table {
    let columns = [
        ("hard case", ""),
        ("scene", ""),
        ("method", ""),
        ("numbers", ""),
        ("result", ""),
        ("error", ""),
        ("limit", ""),
        ("of", ""),
    ];
    let mut table = Table::new("cases", "All errors and limits", &columns);
    for (case, methods) in cases.iter().zip(outcomes) {
        for (method, pair) in registry::hard_case_names().zip(methods) {
            for (numbers, outcome) in ["f64", "f32"].into_iter().zip(pair) {
                let Some(outcome) = outcome else { continue };
                table.rows.push(vec![
                    f64::from(case.number).into(),
                    case.name.into(),
                    method.into(),
                    numbers.into(),
                    outcome.word().into(),
                    outcome.error().into(),
                    case.limit.into(),
                    case.error_of.into(),
                ]);
            }
        }
    }
    table
}
