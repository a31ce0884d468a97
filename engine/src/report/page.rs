//! What a benchmark found, on the screen and on disk.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json};

use super::plot::{Plot, escaped};
use super::table::{Table, heading};
use super::{Error, Machine};
use crate::dataset::write_whole;

/// Tables, plots and images of one benchmark.
#[derive(Debug, Clone)]
pub struct Report {
    /// Beginning of the files' names.
    pub name: &'static str,
    pub title: String,
    pub machine: Machine,
    /// What a reader has to know, a line each.
    pub notes: Vec<String>,
    pub tables: Vec<Table>,
    pub plots: Vec<Plot>,
    pub figures: Vec<Figure>,
}

/// An image with what it shows.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Figure {
    /// Part of the file's name.
    pub name: String,
    pub caption: String,
    pub png: Vec<u8>,
}

impl Report {
    pub fn text(&self) -> String {
        let head = format!("{}\n{}\n", self.title, self.machine.line());
        let tables = self.tables.iter().map(Table::text).collect::<Vec<_>>().join("\n");
        self.notes.iter().fold(format!("{head}\n{tables}\n"), |text, note| text + "- " + note + "\n")
    }

    pub fn json(&self) -> Json {
        json!({
            "benchmark": self.name, "title": self.title, "machine": self.machine, "notes": self.notes,
            "tables": self.tables.iter().map(Table::json).collect::<Vec<_>>(),
        })
    }

    /// Writes `NAME.json`, `NAME.html`, a CSV file a table and a PNG a picture. Returns their paths.
    pub fn write(&self, directory: &Path) -> Result<Vec<PathBuf>, Error> {
        fs::create_dir_all(directory).map_err(|source| Error::Write { path: directory.into(), source })?;
        let json = serde_json::to_string_pretty(&self.json()).expect("text and numbers");
        let mut files = vec![("json".into(), json.into_bytes()), ("html".into(), self.html().into_bytes())];
        files.extend(self.tables.iter().map(|table| (format!("{}.csv", table.name), table.csv().into_bytes())));
        files.extend(self.figures.iter().map(|figure| (format!("{}.png", figure.name), figure.png.clone())));
        let mut paths = Vec::new();
        for (end, bytes) in files {
            let path = directory.join(format!("{}.{end}", self.name));
            write_whole(&path, &bytes)?;
            paths.push(path);
        }
        Ok(paths)
    }

    /// One page that needs no other file.
    pub fn html(&self) -> String {
        let mut body = format!("<h1>{}</h1>\n<p>{}</p>\n", escaped(&self.title), escaped(&self.machine.line()));
        body += "<ul>\n";
        self.notes.iter().for_each(|note| body += &format!("<li>{}</li>\n", escaped(note)));
        body += "</ul>\n";
        self.tables.iter().for_each(|table| body += &table_html(table));
        self.plots.iter().for_each(|plot| body += &format!("<figure>\n{}</figure>\n", plot.svg()));
        for Figure { caption, png, .. } in &self.figures {
            let source = base64(png);
            let caption = escaped(caption);
            body += &format!(
                "<figure><img alt='{caption}' src='data:image/png;base64,{source}'>\
                 <figcaption>{caption}</figcaption></figure>\n"
            );
        }
        format!(
            "<!doctype html>\n<html lang='en'><meta charset='utf-8'><title>{}</title>\n<style>{STYLE}</style>\n\
             <body>\n{body}</body></html>\n",
            escaped(&self.title)
        )
    }
}

pub(crate) const STYLE: &str = "body { font-family: sans-serif; max-width: 1100px; margin: 2em auto; } \
                     table { border-collapse: collapse; margin: 1em 0; } \
                     caption { text-align: left; font-weight: bold; padding: 0.3em 0; } \
                     th, td { padding: 0.2em 0.8em; border-bottom: 1px solid #ddd; text-align: right; } \
                     .text { text-align: left; } figure { margin: 1em 0; } img { max-width: 100%; }";

pub(crate) fn table_html(table: &Table) -> String {
    let class = |column: usize| if table.is_text(column) { " class='text'" } else { "" };
    let mut html = format!("<table><caption>{}</caption>\n<tr>", escaped(&table.title));
    for (column, (name, unit)) in table.columns.iter().enumerate() {
        html += &format!("<th{}>{}</th>", class(column), escaped(&heading(name, unit)));
    }
    for row in &table.rows {
        html += "</tr>\n<tr>";
        for (column, value) in row.iter().enumerate() {
            html += &format!("<td{}>{}</td>", class(column), escaped(&value.text()));
        }
    }
    html + "</tr>\n</table>\n"
}

/// RFC 4648, section 4.
pub(crate) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let word = (0..3).fold(0, |word, i| word << 8 | u32::from(group.get(i).copied().unwrap_or(0)));
        for letter in 0..4 {
            let padding = letter > group.len();
            let index = (word >> (18 - 6 * letter)) as usize & 63;
            text.push(if padding { '=' } else { char::from(LETTERS[index]) });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test vectors of RFC 4648, section 10.
    #[test]
    fn base64_gives_the_vectors_of_its_standard() {
        let vectors = [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg==")];
        for (plain, coded) in vectors {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn a_report_is_written_with_its_tables_and_pictures() {
        let folder = tempfile::TempDir::new().unwrap();
        let mut table = Table::new("speed", "Speed", &[("scene", ""), ("time", "s")]);
        table.rows.push(vec!["a & b".into(), 1.5.into()]);
        let report = Report {
            name: "trial",
            title: "Trial".into(),
            machine: Machine::here(),
            notes: vec!["one".into()],
            tables: vec![table],
            plots: Vec::new(),
            figures: vec![Figure { name: "map".into(), caption: "map".into(), png: b"foob".to_vec() }],
        };
        let names: Vec<_> = report.write(folder.path()).unwrap();
        let names: Vec<_> = names.iter().map(|path| path.file_name().unwrap().to_str().unwrap().to_owned()).collect();
        assert_eq!(names, ["trial.json", "trial.html", "trial.speed.csv", "trial.map.png"]);
        let page = fs::read_to_string(folder.path().join("trial.html")).unwrap();
        assert!(page.contains("a &amp; b") && page.contains("base64,Zm9vYg=="));
        let csv = fs::read_to_string(folder.path().join("trial.speed.csv")).unwrap();
        assert_eq!(csv, "scene,time_s\na & b,1.5\n");
    }
}
