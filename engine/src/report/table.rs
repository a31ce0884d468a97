//! Tables for people, spreadsheets and programs.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json, json};

/// A cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Value {
    Text(String),
    Number(f64),
    /// Not measured, or not measurable here.
    Missing,
}

/// Rows of cells under columns that carry their unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// A short name, part of the CSV file's name.
    pub name: &'static str,
    pub title: String,
    /// Name and unit; an empty unit for text.
    pub columns: Vec<(&'static str, &'static str)>,
    pub rows: Vec<Vec<Value>>,
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        if number.is_finite() { Self::Number(number) } else { Self::Missing }
    }
}

impl From<Option<f64>> for Value {
    fn from(number: Option<f64>) -> Self {
        number.map_or(Self::Missing, Self::from)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl Value {
    /// Four significant digits; `-` where there is no value.
    pub fn text(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(number) => significant(*number),
            Self::Missing => "-".into(),
        }
    }

    fn json(&self) -> Json {
        match self {
            Self::Text(text) => json!(text),
            Self::Number(number) => json!(number),
            Self::Missing => Json::Null,
        }
    }

    fn csv(&self) -> String {
        match self {
            Self::Text(text) if text.contains([',', '"']) => format!("\"{}\"", text.replace('"', "\"\"")),
            Self::Missing => String::new(),
            Self::Text(text) => text.clone(),
            Self::Number(number) => number.to_string(),
        }
    }
}

impl Table {
    pub fn new(name: &'static str, title: &str, columns: &[(&'static str, &'static str)]) -> Self {
        Self { name, title: title.into(), columns: columns.to_vec(), rows: Vec::new() }
    }

    /// Columns as wide as their widest cell, numbers flush right.
    pub fn text(&self) -> String {
        let head: Vec<_> = self.columns.iter().map(|(name, unit)| heading(name, unit)).collect();
        let body: Vec<Vec<_>> = self.rows.iter().map(|row| row.iter().map(Value::text).collect()).collect();
        let width = |column: usize| {
            let cells = body.iter().map(|row| row[column].chars().count());
            cells.chain([head[column].chars().count()]).max().unwrap_or(0)
        };
        let widths: Vec<_> = (0..head.len()).map(width).collect();
        let line = |cells: &[String]| {
            let padded = cells.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| {
                if self.is_text(column) { format!("{cell:width$}") } else { format!("{cell:>width$}") }
            });
            padded.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
        };
        let rule = "-".repeat(widths.iter().sum::<usize>() + 2 * widths.len().saturating_sub(1)) + "\n";
        body.iter().fold(format!("{}\n{}{rule}", self.title, line(&head)), |text, row| text + &line(row))
    }

    pub fn csv(&self) -> String {
        let head: Vec<_> = self.columns.iter().map(|(name, unit)| key(name, unit)).collect();
        let line = |row: &Vec<Value>| row.iter().map(Value::csv).collect::<Vec<_>>().join(",") + "\n";
        self.rows.iter().fold(head.join(",") + "\n", |text, row| text + &line(row))
    }

    /// Rows as objects.
    pub fn json(&self) -> Json {
        let row = |row: &Vec<Value>| {
            let cells = self.columns.iter().zip(row);
            Json::Object(cells.map(|((name, unit), value)| (key(name, unit), value.json())).collect::<Map<_, _>>())
        };
        json!({ "name": self.name, "title": self.title, "rows": self.rows.iter().map(row).collect::<Vec<_>>() })
    }

    pub fn is_text(&self, column: usize) -> bool {
        self.rows.iter().any(|row| matches!(row[column], Value::Text(_)))
    }
}

/// A column's name for people: `p95 [deg]`.
pub fn heading(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.into() } else { format!("{name} [{unit}]") }
}

/// A column's name for programs: `p95_deg`.
fn key(name: &str, unit: &str) -> String {
    let unit = unit.replace('%', "percent").replace("/s", "_s");
    let whole = if unit.is_empty() { name.to_owned() } else { format!("{name} {unit}") };
    whole.to_lowercase().replace([' ', '/', '-'], "_")
}

fn significant(number: f64) -> String {
    if number == 0.0 {
        return "0".into();
    }
    let size = number.abs().log10().floor() as i32;
    if !(-5..7).contains(&size) {
        return format!("{number:.3e}");
    }
    let text = format!("{number:.*}", (3 - size).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new("speed", "Speed", &[("scene", ""), ("rate", "M/s"), ("p95", "deg")]);
        table.rows = vec![
            vec!["a, b".into(), 41.23456.into(), 0.000_123_44.into()],
            vec!["c".into(), 1234.5.into(), f64::NAN.into()],
        ];
        table
    }

    #[test]
    fn numbers_keep_four_digits_and_missing_ones_are_dashes() {
        let expected = "Speed\nscene  rate [M/s]  p95 [deg]\n----------------------------\n\
                        a, b        41.23  0.0001234\nc            1234          -\n";
        assert_eq!(table().text(), expected);
    }

    #[test]
    fn spreadsheets_get_units_in_the_names_and_all_digits() {
        assert_eq!(table().csv(), "scene,rate_m_s,p95_deg\n\"a, b\",41.23456,0.00012344\nc,1234.5,\n");
    }

    #[test]
    fn programs_get_objects_with_null_for_what_is_missing() {
        let json = table().json();
        assert_eq!(json["rows"][1]["scene"], "c");
        assert_eq!(json["rows"][1]["p95_deg"], Json::Null);
    }
}
