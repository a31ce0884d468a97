//! SPICE's text kernels: assignments of numbers and texts to names.
//!
//! ```text
//! \begindata                      what follows is data, up to \begintext
//! NAME  = value
//! NAME  = ( value, value … )      over any number of lines; commas and blanks part values alike
//! NAME += value                   appends to what NAME has, also in a kernel that was loaded before
//! ```
//!
//! A value is a number with an exponent of C or Fortran (`1.4E-12`, `-1.4D-12`), a text in quotes in which `''` is one quote,
//! or a date after `@`. Lines end in LF, CR LF or CR. Names are case-sensitive.
//!
//! # References
//! NAIF, *Kernel Required Reading*, toolkit N0067.

use std::fmt;

/// Values of a variable, texts or numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
    /// With dates among them, as leap seconds have: nothing here asks for these.
    Dates,
}

/// One assignment.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Assignment {
    pub name: String,
    /// `+=`
    pub appends: bool,
    pub values: Values,
    pub line: usize,
}

/// What is wrong, and where.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    pub line: usize,
    pub problem: String,
}

/// Whether bytes are those of a text kernel.
pub(super) fn is_text_kernel(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    bytes.starts_with(b"KPL/") || bytes.windows(BEGIN_DATA.len()).any(|window| window == BEGIN_DATA.as_bytes())
}

const BEGIN_DATA: &str = "\\begindata";
const BEGIN_TEXT: &str = "\\begintext";

/// All assignments of a kernel in their order.
pub(super) fn parse(text: &str) -> Result<Vec<Assignment>, Fault> {
    let mut tokens = Vec::new();
    let (mut is_data, mut has_data) = (false, false);
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    for (line, content) in (1..).zip(text.lines()) {
        let fault = |problem: String| Fault { line, problem };
        match content.trim() {
            BEGIN_DATA => (is_data, has_data) = (true, true),
            BEGIN_TEXT => is_data = false,
            // Comments speak of the token; one with an assignment behind it was meant as data.
            word if is_data || (word.starts_with(BEGIN_DATA) && word.contains('=')) => {
                if word.starts_with('\\') {
                    return Err(fault(format!("`{}` does not stand alone on its line", shortened(word))));
                }
                tokenise(content, line, &mut tokens).map_err(fault)?;
            }
            _ => {}
        }
    }
    if !has_data {
        return Err(Fault { line: 1, problem: format!("it has no line {BEGIN_DATA}: nothing in it is data") });
    }
    assignments(tokens)
}

#[derive(Debug, PartialEq)]
enum Token {
    Word(String),
    Text(String),
    Open,
    Close,
    Equals,
    PlusEquals,
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Word(word) => write!(f, "`{}`", shortened(word)),
            Self::Text(text) => write!(f, "'{}'", shortened(text)),
            Self::Open => f.write_str("`(`"),
            Self::Close => f.write_str("`)`"),
            Self::Equals => f.write_str("`=`"),
            Self::PlusEquals => f.write_str("`+=`"),
        }
    }
}

/// As much of a text as a message needs.
fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

fn tokenise(content: &str, line: usize, tokens: &mut Vec<(usize, Token)>) -> Result<(), String> {
    let mut chars = content.chars().peekable();
    while let Some(first) = chars.next() {
        let token = match first {
            ',' => continue,
            space if space.is_whitespace() => continue,
            '(' => Token::Open,
            ')' => Token::Close,
            '=' => Token::Equals,
            '+' if chars.peek() == Some(&'=') => {
                chars.next();
                Token::PlusEquals
            }
            '\'' => {
                let mut text = String::new();
                loop {
                    match chars.next() {
                        Some('\'') if chars.peek() == Some(&'\'') => text.extend(chars.next()),
                        Some('\'') => break Token::Text(text),
                        Some(letter) => text.push(letter),
                        None => return Err(format!("the text '{} has no end on its line", shortened(&text))),
                    }
                }
            }
            letter => {
                let mut word = String::from(letter);
                while let Some(&next) = chars.peek() {
                    let mut after = chars.clone();
                    after.next();
                    let ends =
                        next.is_whitespace() || "=,()'".contains(next) || (next == '+' && after.peek() == Some(&'='));
                    if ends {
                        break;
                    }
                    word.push(next);
                    chars.next();
                }
                Token::Word(word)
            }
        };
        tokens.push((line, token));
    }
    Ok(())
}

fn assignments(tokens: Vec<(usize, Token)>) -> Result<Vec<Assignment>, Fault> {
    let mut assignments = Vec::new();
    let mut tokens = tokens.into_iter().peekable();
    while let Some((line, token)) = tokens.next() {
        let fault = |problem: String| Fault { line, problem };
        let Token::Word(name) = token else { return Err(fault(format!("want NAME = value, got {token}"))) };
        let appends = match tokens.next() {
            Some((_, Token::Equals)) => false,
            Some((_, Token::PlusEquals)) => true,
            _ => return Err(fault(format!("want = or += after {}", shortened(&name)))),
        };
        let nothing = || fault(format!("{} has no value", shortened(&name)));
        let mut values = Vec::new();
        match tokens.next() {
            Some((_, Token::Open)) => loop {
                match tokens.next() {
                    Some((_, Token::Close)) => break,
                    Some((_, token @ (Token::Word(_) | Token::Text(_)))) => values.push(token),
                    Some((line, token)) => {
                        return Err(Fault {
                            line,
                            problem: format!("want a value or `)` for {}, got {token}", shortened(&name)),
                        });
                    }
                    None => return Err(fault(format!("the values of {} have no `)`", shortened(&name)))),
                }
            },
            Some((last, token @ (Token::Word(_) | Token::Text(_)))) => {
                values.push(token);
                if let Some((_, next)) = tokens.next_if(|(next, _)| *next == last) {
                    return Err(fault(format!("{} has more than one value without ( ): {next}", shortened(&name))));
                }
            }
            _ => return Err(nothing()),
        }
        let values = values_of(values).map_err(|problem| fault(format!("{}: {problem}", shortened(&name))))?;
        assignments.push(Assignment { values: values.ok_or_else(nothing)?, name, appends, line });
    }
    Ok(assignments)
}

/// `None` where there are none.
fn values_of(tokens: Vec<Token>) -> Result<Option<Values>, String> {
    let (mut numbers, mut texts, mut has_dates) = (Vec::new(), Vec::new(), false);
    for token in tokens {
        match token {
            Token::Text(text) => texts.push(text),
            Token::Word(word) if word.starts_with('@') => has_dates = true,
            Token::Word(word) => numbers.push(number(&word).ok_or(format!("`{}` is not a number", shortened(&word)))?),
            _ => {}
        }
    }
    match (numbers.is_empty() && !has_dates, texts.is_empty()) {
        (true, true) => Ok(None),
        (false, false) => Err("texts and numbers stand in one list".into()),
        (true, false) => Ok(Some(Values::Texts(texts))),
        (false, true) => Ok(Some(if has_dates { Values::Dates } else { Values::Numbers(numbers) })),
    }
}

/// A number with an exponent of C or Fortran.
fn number(word: &str) -> Option<f64> {
    let is_plain = word.chars().all(|letter| letter.is_ascii_digit() || "+-.DdEe".contains(letter));
    let number: f64 = word.replace(['D', 'd'], "E").parse().ok()?;
    (is_plain && number.is_finite()).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn data(text: &str) -> Result<Vec<Assignment>, Fault> {
        parse(&format!("KPL/PCK\n{BEGIN_DATA}\n{text}\n{BEGIN_TEXT}\nNOT = data\n"))
    }

    fn only(text: &str) -> Assignment {
        let all = data(text).unwrap();
        assert_eq!(all.len(), 1, "{text}");
        all[0].clone()
    }

    /// The forms of *Kernel Required Reading*, chapter *Text Kernel Specifications*.
    #[test]
    fn every_form_of_an_assignment_is_read() {
        let three = Values::Numbers(vec![38.25, 13.0, -1.4e-12]);
        for text in [
            "A = ( 38.25 13 -1.4D-12 )",
            "A=(38.25,13.,-1.4e-12)",
            "  A =\t( 3.825E1 , +13 ,-.14d-11)",
            "A = (\n38.25\n\n13\n-1.4D-12\n)",
            "A\n=\n( 38.25 13 -1.4D-12 )",
        ] {
            assert_eq!((only(text).values, only(text).appends), (three.clone(), false), "{text}");
        }
        assert_eq!(only("A=5").values, Values::Numbers(vec![5.0]));
        assert_eq!(only("A = ( 5 )").values, Values::Numbers(vec![5.0]));
        assert!(only("A += 5").appends && only("A+=( 5 )").appends);
        assert_eq!(only("A = ( 'it''s', '(1=2)' )").values, Values::Texts(vec!["it's".into(), "(1=2)".into()]));
        assert_eq!(only("DELTET/DELTA_AT = ( 10, @1972-JAN-1 )").values, Values::Dates);
        let crs = parse(&format!("{BEGIN_DATA}\rA = 1\rB += 2\r\nC = 3")).unwrap();
        assert_eq!(crs.iter().map(|a| (a.name.as_str(), a.line)).collect::<Vec<_>>(), [("A", 2), ("B", 3), ("C", 4)]);
    }

    #[test]
    fn what_is_no_assignment_is_told_with_its_line() {
        for (text, expected) in [
            ("A = ( 1 2", "the values of A have no `)`"),
            ("A = ( 1 ( 2 ) )", "want a value or `)` for A, got `(`"),
            ("A = 1 2", "more than one value without ( )"),
            ("A = ( )", "A has no value"),
            ("A =", "A has no value"),
            ("A 1", "want = or += after A"),
            ("'A' = 1", "want NAME = value, got 'A'"),
            ("A = ( 1 'x' )", "texts and numbers"),
            ("A = 1x", "A: `1x` is not a number"),
            ("A = inf", "`inf` is not a number"),
            ("A = 1E999", "`1E999` is not a number"),
            ("A = 'x", "the text 'x has no end on its line"),
            ("\\begindata A = 1", "does not stand alone"),
        ] {
            let fault = data(text).unwrap_err();
            assert!(fault.line == 3 && fault.problem.contains(expected), "{text}: {fault:?}");
        }
        let spoken_of = "KPL/PCK\n\\begindata token. It must stand alone.\n\\begindata\nA = 1\n";
        assert_eq!(parse(spoken_of).unwrap().len(), 1);
        assert!(parse("KPL/PCK\nA = 1\n").unwrap_err().problem.contains("no line \\begindata"));
    }
}
