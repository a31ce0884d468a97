//! Ratios to the baseline, averaged, and beside the figures to reach.

use super::super::shadows::SUN_ELEVATIONS_DEG;
use super::{BASELINE, Tables};
use crate::{Table, Value};
use perilune_engine::horizon::Encoding;
use perilune_engine::report::plot::{Axis, Curve, Plot};

/// Columns of the ratios in the table of shadows: of pixel error rates, of the RMS in penumbras, and of that everywhere.
const RATIOS: [usize; 3] = [4, 6, 8];

/// The table of the figures to reach.
pub fn figures() -> Table {
    let columns = [
        ("figure", ""),
        ("must", ""),
        ("aim", ""),
        ("pixel error rate", "of fm16"),
        ("penumbra RMS", "of fm16"),
        ("RMS everywhere", "of fm16"),
        ("on disk", "B/pixel"),
    ];
    Table::new("encodings_figures", "Encodings: figures to reach, and what was reached", &columns)
}

pub fn ratios() -> Table {
    let columns = [
        ("encoding", ""),
        ("in memory", "B/pixel"),
        ("pixel error rate, mean", "of fm16"),
        ("worst", "of fm16"),
        ("worst scene", ""),
        ("penumbra RMS, mean", "of fm16"),
        ("worst ", "of fm16"),
        ("worst scene ", ""),
        ("RMS everywhere, mean", "of fm16"),
        ("worst  ", "of fm16"),
        ("worst scene  ", ""),
    ];
    Table::new("encodings_ratios", "Encodings: mean over the Sun's elevations and all scenes", &columns)
}

pub fn scenes() -> Table {
    let columns = [
        ("scene", ""),
        ("encoding", ""),
        ("in memory", "B/pixel"),
        ("pixel errors at 1.5 deg", "of fm16"),
        ("3 deg", "of fm16"),
        ("6 deg", "of fm16"),
        ("15 deg", "of fm16"),
        ("mean", "of fm16"),
        ("penumbra RMS at 1.5 deg", "of fm16"),
        ("3 deg ", "of fm16"),
        ("6 deg ", "of fm16"),
        ("15 deg ", "of fm16"),
        ("mean ", "of fm16"),
        ("RMS everywhere at 1.5 deg", "of fm16"),
        ("3 deg  ", "of fm16"),
        ("6 deg  ", "of fm16"),
        ("15 deg  ", "of fm16"),
        ("mean  ", "of fm16"),
    ];
    Table::new("encodings_scenes", "Encodings: shadows by scene", &columns)
}

pub fn files() -> Table {
    let columns = [
        ("scene", ""),
        ("encoding", ""),
        ("in memory", "B/pixel"),
        ("on disk", "B/pixel"),
        ("pixel error rate, mean", "of fm16"),
        ("penumbra RMS, mean", "of fm16"),
        ("RMS everywhere, mean", "of fm16"),
    ];
    Table::new("encodings_files", "Encodings: files of large patches, bounds included", &columns)
}

/// Fills in the ratios to the baseline at the same elevation of the Sun; where that errs nowhere there is none.
pub fn compare(rows: &mut [Vec<Value>]) {
    let baseline: Vec<_> = rows.iter().filter(|row| row[1].text() == BASELINE).cloned().collect();
    for row in rows {
        let Some(base) = baseline.iter().find(|base| base[2] == row[2]) else { continue };
        for column in RATIOS {
            row[column] = (number(&row[column - 1]) / number(&base[column - 1])).into();
        }
    }
}

fn number(value: &Value) -> f64 {
    match value {
        Value::Number(number) => *number,
        Value::Text(_) | Value::Missing => f64::NAN,
    }
}

/// Mean of those that are known.
fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let known: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
    known.iter().sum::<f64>() / known.len() as f64
}

/// Makes the tables of the rows measured so far: ratios by scene, averaged over the elevations, and over scenes.
pub fn summarise(tables: &mut Tables) {
    let rows = &tables.shadows.rows;
    let mut names: Vec<[String; 2]> = Vec::new();
    for row in rows {
        let name = [row[0].text(), row[1].text()];
        if !names.contains(&name) {
            names.push(name);
        }
    }
    tables.scenes.rows = names.iter().map(|[scene, label]| scene_row(rows, scene, label)).collect();
    let mut labels: Vec<&String> = Vec::new();
    for [_, label] in &names {
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    tables.ratios.rows = labels.into_iter().map(|label| ratio_row(&tables.scenes, label)).collect();
    tables.figures.rows = figure_rows(&tables.ratios);
    tables.figures.rows.extend(file_rows(&tables.files));
}

pub fn scene_row(rows: &[Vec<Value>], scene: &str, label: &str) -> Vec<Value> {
    let at = |deg: f64, column: usize| {
        let row = rows.iter().find(|row| row[0].text() == scene && row[1].text() == label && row[2] == deg.into());
        row.map_or(f64::NAN, |row| number(&row[column]))
    };
    let name = label.split(',').next().unwrap_or_default();
    let bytes = name.parse::<Encoding>().map_or(f64::NAN, Encoding::bytes_per_pixel);
    let mut row = vec![scene.into(), label.into(), bytes.into()];
    for column in RATIOS {
        let ratios = SUN_ELEVATIONS_DEG.map(|deg| at(deg, column));
        row.extend(ratios.into_iter().chain([mean(ratios)]).map(Value::from));
    }
    row
}

/// Columns of the means in the table of scenes.
pub const MEANS: [usize; 3] = [7, 12, 17];

fn ratio_row(scenes: &Table, label: &str) -> Vec<Value> {
    let of_label: Vec<_> = scenes.rows.iter().filter(|row| row[1].text() == label).collect();
    let mut row = vec![label.into(), of_label[0][2].clone()];
    for column in MEANS {
        let ratio = |row: &&Vec<Value>| number(&row[column]);
        let known = || of_label.iter().copied().filter(|row| ratio(row).is_finite());
        let worst = known().max_by(|a, b| ratio(a).total_cmp(&ratio(b)));
        row.push(mean(known().map(|row| ratio(&row))).into());
        row.extend([worst.map(|row| ratio(&row)).into(), worst.map_or(Value::Missing, |row| row[0].clone())]);
    }
    row
}

/// What is to be reached by which row and which column of the ratios after the mean.
fn figure_rows(ratios: &Table) -> Vec<Vec<Value>> {
    let figures = [
        ("21.25 B/pixel: mean", "w21", 0, 0.7, Some(0.5)),
        ("21.25 B/pixel: worst scene", "w21", 1, 0.85, None),
        ("21.25 B/pixel with the Sun's band: mean", "w21, band", 0, 0.5, Some(0.33)),
        ("16 B/pixel: mean", "w16", 0, 0.6, None),
    ];
    let row = |(text, label, which, must, aim): (&str, &str, usize, f64, Option<f64>)| {
        let found = ratios.rows.iter().find(|row| row[0].text() == label);
        let reached = |column: usize| found.map_or(Value::Missing, |row| row[column + which].clone());
        vec![text.into(), must.into(), aim.into(), reached(2), reached(5), reached(8), Value::Missing]
    };
    figures.into_iter().map(row).collect()
}

/// Bytes and errors of the files of `q`, the worst of each.
fn file_rows(files: &Table) -> Vec<Vec<Value>> {
    let of_files =
        |column: usize| files.rows.iter().filter(|row| row[1].text() == "q").map(move |row| number(&row[column]));
    let worst = |column: usize| Value::from(of_files(column).reduce(f64::max));
    vec![
        ["q's files: worst error".into(), 1.0.into(), Value::Missing, worst(4), worst(5), worst(6), Value::Missing]
            .to_vec(),
        ["q's files: largest".into(), 8.0.into(), 4.0.into(), Value::Missing, Value::Missing, Value::Missing, worst(3)]
            .to_vec(),
    ]
}

/// Ratio of the pixel error rates over bytes in memory.
pub fn plot(tables: &Tables) -> Plot {
    let mut curves: Vec<Curve> = Vec::new();
    for row in &tables.ratios.rows {
        let name: String = row[0].text().chars().filter(|c| !c.is_ascii_digit()).collect();
        if curves.last().is_none_or(|curve| curve.name != name) {
            curves.push(Curve { name, points: Vec::new(), joined: true });
        }
        let point = [number(&row[1]), number(&row[2])];
        curves.last_mut().expect("pushed above").points.push(point);
    }
    Plot {
        title: "Pixel error rate of encodings, mean over scenes and Sun elevations".into(),
        x: Axis::linear("bytes per pixel"),
        y: Axis::logarithmic("ratio to fm16"),
        curves,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_are_to_the_baseline_at_the_same_elevation() {
        let row = |label: &str, sun: f64, wrong: f64| {
            let error = || [wrong.into(), Value::Missing];
            [["a".into(), label.into(), sun.into()].to_vec(), [error(), error(), error()].concat()].concat()
        };
        let mut tables = Tables::new();
        tables.shadows.rows = vec![
            row("fm16", 3.0, 2.0),
            row("fm16", 6.0, 4.0),
            row("fm16", 15.0, 0.0),
            row("w21", 3.0, 1.0),
            row("w21", 6.0, 1.0),
            row("w21", 15.0, 0.0),
        ];
        compare(&mut tables.shadows.rows);
        summarise(&mut tables);
        assert_eq!(tables.ratios.rows[0][2], Value::Number(1.0));
        // No ratio where nothing errs.
        let scene = &tables.scenes.rows[1];
        assert_eq!(scene[3..8], [Value::Missing, 0.5.into(), 0.25.into(), Value::Missing, 0.375.into()]);
        assert_eq!(tables.ratios.rows[1][1..5], [21.25.into(), 0.375.into(), 0.375.into(), "a".into()]);
        assert_eq!(tables.figures.rows[0][3], 0.375.into());
        assert_eq!(tables.figures.rows[2][3], Value::Missing);
    }
}
