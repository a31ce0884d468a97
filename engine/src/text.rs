//! Text files, read in one way whatever wrote them.
//!
//! Text is UTF-8, with or without a byte-order mark; lines end in LF, CR LF or CR. A [`Table`] is lines of fields parted by
//! commas, semicolons, tabs or blanks, whichever the first line has, with quotes after RFC 4180. Its first line is a heading
//! if there is no digit in its first field; what the names mean is for the reader of the table to say, and a name that it
//! does not know is to be refused.
//!
//! # References
//! Shafranovich (2005), RFC 4180, *Common Format and MIME Type for CSV Files*.
#![warn(missing_docs)]

use std::borrow::Cow;
use std::io;
use std::path::Path;

const BYTE_ORDER_MARK: char = '\u{feff}';

/// What is wrong with a table, and in which line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {problem}")]
pub struct TableError {
    /// From 1.
    pub line: usize,
    /// In words.
    pub problem: String,
}

/// Lines of fields.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// The names of the columns, where the first line has some.
    pub heading: Option<Row>,
    /// The other lines that are not empty.
    pub rows: Vec<Row>,
}

/// One line of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// Where it begins, from 1.
    pub line: usize,
    /// Without quotes and the blanks around them.
    pub fields: Vec<String>,
}

/// Whether a table's first line is a heading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Heading {
    /// Always.
    Needed,
    /// If its first field has no digit.
    Optional,
}

/// Reads a text file; what is no UTF-8 is an error of kind [`io::ErrorKind::InvalidData`] that names the line.
pub fn read(path: &Path) -> io::Result<String> {
    decode(&std::fs::read(path)?).map_err(|problem| io::Error::new(io::ErrorKind::InvalidData, problem))
}

/// The text that bytes are, with lines that end in LF.
pub fn decode(bytes: &[u8]) -> Result<String, String> {
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err("it is UTF-16; allowed is UTF-8".into());
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(plain(text).into_owned()),
        Err(error) => {
            let line = 1 + bytes[..error.valid_up_to()].iter().filter(|byte| **byte == b'\n').count();
            Err(format!("line {line} is not UTF-8"))
        }
    }
}

/// A text without byte-order mark, with lines that end in LF.
pub fn plain(text: &str) -> Cow<'_, str> {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    if text.contains('\r') { text.replace("\r\n", "\n").replace('\r', "\n").into() } else { text.into() }
}

impl Table {
    /// The table of a text; lines that begin with `comment` are passed over.
    pub fn parse(text: &str, heading: Heading, comment: Option<char>) -> Result<Self, TableError> {
        let text = plain(text);
        let is_comment = |line: &str| comment.is_some_and(|comment| line.trim_start().starts_with(comment));
        let first = text.lines().find(|line| !line.trim().is_empty() && !is_comment(line)).unwrap_or_default();
        let mut rows = match separator(first) {
            Some(separator) => parted(&text, separator, &is_comment)?,
            None => {
                let lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty() && !is_comment(line));
                lines
                    .map(|(line, text)| Row { line, fields: text.split_whitespace().map(String::from).collect() })
                    .collect()
            }
        };
        let has_heading = rows.first().is_some_and(|row| heading == Heading::Needed || row.is_heading());
        let heading = has_heading.then(|| rows.remove(0));
        if let Some(Row { line, fields }) = &heading {
            let is_twice = |(index, name): (usize, &String)| {
                !name.is_empty() && fields[..index].iter().any(|earlier| earlier.eq_ignore_ascii_case(name))
            };
            if let Some(index) = (0..fields.len()).find(|&index| is_twice((index, &fields[index]))) {
                return Err(TableError { line: *line, problem: format!("has two columns {}", fields[index]) });
            }
        }
        Ok(Self { heading, rows })
    }
}

impl Row {
    fn is_heading(&self) -> bool {
        self.fields.first().is_some_and(|first| {
            let is_number = first.parse::<f64>().is_ok();
            !first.is_empty() && !is_number && !first.chars().any(char::is_numeric)
        })
    }
}

/// A name of a column in small letters, its words parted by one `_`: `Latitude (deg)` is `latitude_deg`.
pub fn column_name(written: &str) -> String {
    let words = written.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("_").to_lowercase()
}

/// What parts the fields of a line; `None`: blanks.
fn separator(line: &str) -> Option<char> {
    let mut in_quotes = false;
    let outside: Vec<char> = line
        .chars()
        .filter(|letter| {
            in_quotes ^= *letter == '"';
            !in_quotes
        })
        .collect();
    [';', ',', '\t'].into_iter().find(|separator| outside.contains(separator))
}

/// The lines of a text with such a separator. An own reader: the crate `csv` takes a quote that nobody closes for a field that
/// reaches to the end of the file.
fn parted(text: &str, separator: char, is_comment: &dyn Fn(&str) -> bool) -> Result<Vec<Row>, TableError> {
    let (mut rows, mut rest, mut line) = (Vec::new(), text, 1);
    while let Some(first) = rest.split_inclusive('\n').next() {
        if first.trim().is_empty() || is_comment(first) {
            (rest, line) = (&rest[first.len()..], line + 1);
            continue;
        }
        let mut row = Row { line, fields: Vec::new() };
        loop {
            let (field, behind) = field(rest, separator).map_err(|problem| TableError { line, problem })?;
            line += rest[..rest.len() - behind.len()].matches('\n').count();
            row.fields.push(field);
            rest = behind.strip_prefix(separator).unwrap_or(behind);
            if rest.len() == behind.len() {
                break;
            }
        }
        (rest, line) = (rest.strip_prefix('\n').unwrap_or(rest), line + 1);
        if row.fields.iter().any(|field| !field.is_empty()) {
            rows.push(row);
        }
    }
    Ok(rows)
}

/// A field without its quotes and the blanks around it, and the text that begins with the separator or line end after it.
fn field(text: &str, separator: char) -> Result<(String, &str), String> {
    let is_blank = |letter: char| letter != '\n' && letter != separator && letter.is_whitespace();
    let text = text.trim_start_matches(is_blank);
    let Some(inside) = text.strip_prefix('"') else {
        let (field, behind) = text.split_at(text.find(['\n', separator]).unwrap_or(text.len()));
        return Ok((field.trim().to_owned(), behind));
    };
    let mut end = 0;
    loop {
        end += inside[end..].find('"').ok_or("a quote that begins here does not end")?;
        // Two stand for one.
        if !inside[end + 1..].starts_with('"') {
            break;
        }
        end += 2;
    }
    let behind = inside[end + 1..].trim_start_matches(is_blank);
    if !(behind.is_empty() || behind.starts_with(['\n', separator])) {
        return Err("text follows a quote that ends".into());
    }
    Ok((inside[..end].trim().replace("\"\"", "\""), behind))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(text: &str) -> Vec<Vec<String>> {
        let table = Table::parse(text, Heading::Optional, Some('#')).unwrap();
        assert_eq!(table.heading, None, "{text:?}");
        table.rows.into_iter().map(|row| row.fields).collect()
    }

    #[test]
    fn a_table_is_the_same_whatever_wrote_it() {
        let expected = [["500", "0.6"], ["510", "0.2"]];
        for text in [
            "500,0.6\n510,0.2\n",
            "\u{feff}500,0.6\r\n510,0.2",
            "500 , 0.6\r510,0.2\r",
            "500;0.6\n510;0.2",
            "500\t0.6\n510\t0.2",
            "  500   0.6\n\n# a, comment\n510 0.2",
            "\"500\",\"0.6\"\n 510,0.2",
        ] {
            assert_eq!(fields(text), expected, "{text:?}");
        }
    }

    #[test]
    fn a_heading_has_no_digit_in_its_first_field() {
        let names = |text: &str| Table::parse(text, Heading::Optional, None).unwrap().heading.map(|row| row.fields);
        assert_eq!(names("lon,lat\n1,2\n"), Some(vec!["lon".into(), "lat".into()]));
        assert_eq!(names("50O,0.6\n510,0.2\n"), None);
        assert_eq!((names("nan,1\n"), names(",1\n"), names("")), (None, None, None));
        let twice = Table::parse("lat,lon,LAT\n", Heading::Needed, None).unwrap_err();
        assert_eq!(twice.to_string(), "line 1: has two columns LAT");
        assert_eq!(column_name(" Latitude [deg] "), "latitude_deg");
    }

    /// The examples of RFC 4180, section 2.
    #[test]
    fn quotes_are_those_of_rfc_4180() {
        let table = Table::parse("name,d\n\"a, \"\"b\"\"\",1\n\"c\nd\",2\n3,e\n", Heading::Needed, None).unwrap();
        let expected = [(2, ["a, \"b\"", "1"]), (3, ["c\nd", "2"]), (5, ["3", "e"])];
        assert_eq!(table.rows.len(), expected.len());
        for (row, (line, fields)) in table.rows.iter().zip(expected) {
            assert_eq!((row.line, &row.fields[..]), (line, &fields.map(String::from)[..]));
        }
        let open = Table::parse("name,d\n\"a,1\nb,2\n", Heading::Needed, None).unwrap_err();
        assert_eq!(open.to_string(), "line 2: a quote that begins here does not end");
    }

    #[test]
    fn what_is_no_utf_8_is_told_by_its_line() {
        assert_eq!(decode(b"a\nb\xe9\n").unwrap_err(), "line 2 is not UTF-8");
        assert_eq!(decode(b"\xff\xfea\0").unwrap_err(), "it is UTF-16; allowed is UTF-8");
        assert_eq!(decode("\u{feff}a\rb\r\nc".as_bytes()).unwrap(), "a\nb\nc");
    }
}
