//! A RON text as a tree in which every value knows its line and column.
//!
//! `ron` decides what is a scenario; its values, however, have forgotten where they stood. This reader keeps the
//! places, so that a problem found later still names its line. It knows the part of RON that scenarios use: structs,
//! tuples, lists, enum variants, strings, numbers, booleans, comments. Whatever else it meets, it gives up with
//! `None`, and `ron`'s own message is shown.

use std::iter::Peekable;
use std::str::Chars;

/// As deep as `ron` goes; deeper nesting could overflow the stack.
const DEEPEST: usize = 128;

/// Line and column, both from 1, the column in characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct TextPosition {
    pub line: usize,
    pub column: usize,
}

/// A value and where it begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    pub place: TextPosition,
    pub value: Value,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// As written, as in `-1e3`, `0x1f`, `NaN`.
    Number(String),
    Text(String),
    Bool(bool),
    List(Vec<Node>),
    Tuple(Vec<Node>),
    Struct(Vec<StructField>),
    /// `Name`, `Name(…)`: an enum variant, or a struct with its name in front.
    Named(String, Option<Box<Node>>),
}

#[derive(Debug, Clone, PartialEq)]
pub struct StructField {
    pub key: String,
    pub place: TextPosition,
    pub node: Node,
}

/// The tree of a text, or `None` where the text is not plain RON.
pub fn parse(text: &str) -> Option<Node> {
    let mut reader = Reader { chars: text.chars().peekable(), place: TextPosition { line: 1, column: 1 }, depth: 0 };
    reader.skip_attributes()?;
    let node = reader.node()?;
    reader.skip_space()?;
    reader.peek().is_none().then_some(node)
}

impl Node {
    /// The place of `key`, as in `trajectory.points[2].t_s`, or of the nearest value around it that exists.
    pub fn locate(&self, key: &str) -> TextPosition {
        let (mut node, mut place) = (self.unwrapped(), self.place);
        for step in key.split(['.', '[']).filter(|step| !step.is_empty()) {
            let Some(next) = node.child(step.trim_end_matches(']')) else { break };
            place = next.place;
            node = next.unwrapped();
        }
        place
    }

    /// What stands inside enum variants and struct names.
    pub fn unwrapped(&self) -> &Node {
        match &self.value {
            Value::Named(_, Some(inside)) => match &inside.value {
                Value::Tuple(items) if items.len() == 1 => items[0].unwrapped(),
                _ => inside,
            },
            _ => self,
        }
    }

    fn child(&self, step: &str) -> Option<&Node> {
        match &self.value {
            Value::Struct(fields) => fields.iter().find(|field| field.key == step).map(|field| &field.node),
            Value::List(items) | Value::Tuple(items) => items.get(step.parse::<usize>().ok()?),
            _ => None,
        }
    }
}

struct Reader<'a> {
    chars: Peekable<Chars<'a>>,
    place: TextPosition,
    depth: usize,
}

impl Reader<'_> {
    fn peek(&mut self) -> Option<char> {
        self.chars.peek().copied()
    }

    fn next(&mut self) -> Option<char> {
        let char = self.chars.next()?;
        if char == '\n' {
            self.place = TextPosition { line: self.place.line + 1, column: 1 };
        } else {
            self.place.column += 1;
        }
        Some(char)
    }

    fn take(&mut self, wanted: char) -> Option<()> {
        (self.next()? == wanted).then_some(())
    }

    fn take_while(&mut self, wanted: impl Fn(char) -> bool) -> String {
        let mut taken = String::new();
        while let Some(char) = self.peek().filter(|&char| wanted(char)) {
            taken.push(char);
            self.next();
        }
        taken
    }

    /// Skips white space and comments; `None` where a comment does not end.
    fn skip_space(&mut self) -> Option<()> {
        loop {
            match self.peek() {
                Some(char) if char.is_whitespace() => drop(self.next()),
                Some('/') => self.skip_comment()?,
                _ => return Some(()),
            }
        }
    }

    fn skip_comment(&mut self) -> Option<()> {
        self.take('/')?;
        match self.next()? {
            '/' => {
                self.take_while(|char| char != '\n');
                Some(())
            }
            '*' => self.skip_block_comment(),
            _ => None,
        }
    }

    /// Block comments nest.
    fn skip_block_comment(&mut self) -> Option<()> {
        let mut depth = 1;
        while depth > 0 {
            match (self.next()?, self.peek()) {
                ('*', Some('/')) => {
                    self.next();
                    depth -= 1;
                }
                ('/', Some('*')) => {
                    self.next();
                    depth += 1;
                }
                _ => {}
            }
        }
        Some(())
    }

    /// `#![enable(implicit_some)]` and the like, at the top of a file.
    fn skip_attributes(&mut self) -> Option<()> {
        self.skip_space()?;
        while self.peek() == Some('#') {
            self.take_while(|char| char != ']');
            self.take(']')?;
            self.skip_space()?;
        }
        Some(())
    }

    fn node(&mut self) -> Option<Node> {
        self.skip_space()?;
        self.depth += 1;
        if self.depth > DEEPEST {
            return None;
        }
        let place = self.place;
        let value = match self.peek()? {
            '"' => Value::Text(self.text()?),
            '[' => {
                self.next();
                Value::List(self.items(']')?)
            }
            '(' => self.parentheses()?,
            '-' | '+' | '.' | '0'..='9' => Value::Number(self.take_while(is_number)),
            _ => self.named()?,
        };
        self.depth -= 1;
        Some(inside_some(Node { place, value }))
    }

    fn named(&mut self) -> Option<Value> {
        let name = self.take_while(is_identifier);
        match name.as_str() {
            "" => return None,
            "true" | "false" => return Some(Value::Bool(name == "true")),
            "NaN" | "inf" => return Some(Value::Number(name)),
            _ => {}
        }
        self.skip_space()?;
        if self.peek() != Some('(') {
            return Some(Value::Named(name, None));
        }
        let place = self.place;
        let inside = Node { place, value: self.parentheses()? };
        Some(Value::Named(name, Some(Box::new(inside))))
    }

    /// A struct where the first thing inside is `key:`, else a tuple. Empty ones are structs.
    fn parentheses(&mut self) -> Option<Value> {
        self.take('(')?;
        self.skip_space()?;
        if self.peek()? == ')' || self.sees_key() {
            return Some(Value::Struct(self.fields()?));
        }
        Some(Value::Tuple(self.items(')')?))
    }

    /// Whether `key:` comes next; reads nothing.
    fn sees_key(&self) -> bool {
        let mut ahead = Reader { chars: self.chars.clone(), place: self.place, depth: 0 };
        ahead.key().is_some()
    }

    fn key(&mut self) -> Option<String> {
        let name = self.take_while(is_identifier);
        self.skip_space()?;
        self.take(':')?;
        (!name.is_empty()).then_some(name)
    }

    fn fields(&mut self) -> Option<Vec<StructField>> {
        let mut fields = Vec::new();
        loop {
            self.skip_space()?;
            if self.peek()? == ')' {
                self.next();
                return Some(fields);
            }
            let place = self.place;
            let key = self.key()?;
            fields.push(StructField { key, place, node: self.node()? });
            self.skip_space()?;
            if self.peek()? != ')' {
                self.take(',')?;
            }
        }
    }

    fn items(&mut self, end: char) -> Option<Vec<Node>> {
        let mut items = Vec::new();
        loop {
            self.skip_space()?;
            if self.peek()? == end {
                self.next();
                return Some(items);
            }
            items.push(self.node()?);
            self.skip_space()?;
            if self.peek()? != end {
                self.take(',')?;
            }
        }
    }

    /// A quoted string; of the escapes only those of one character.
    fn text(&mut self) -> Option<String> {
        self.take('"')?;
        let mut text = String::new();
        loop {
            match self.next()? {
                '"' => return Some(text),
                '\\' => text.push(match self.next()? {
                    'n' => '\n',
                    't' => '\t',
                    char @ ('"' | '\\' | '\'') => char,
                    _ => return None,
                }),
                char => text.push(char),
            }
        }
    }
}

/// `Some(x)` is `x`: options may be written without it.
fn inside_some(node: Node) -> Node {
    match node.value {
        Value::Named(name, Some(inside)) if name == "Some" => match inside.value {
            Value::Tuple(mut items) if items.len() == 1 => items.remove(0),
            value => Node { place: inside.place, value },
        },
        value => Node { place: node.place, value },
    }
}

fn is_identifier(char: char) -> bool {
    char.is_alphanumeric() || char == '_'
}

/// Digits, signs, exponents, `0x`, `_`; `-inf` and `-NaN`.
fn is_number(char: char) -> bool {
    char.is_ascii_alphanumeric() || matches!(char, '.' | '-' | '+' | '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"#![enable(implicit_some)]
// a comment with ( and "
(
    title: "a \"quoted\" (name", /* block /* nested */ , */
    camera: Camera(columns: 4, principal_point: Some((column: 1.5, row: 2))),
    trajectory: Waypoints(points: [
        (t_s: 0),
        (t_s: -1e-3, latitude_deg: NaN),
    ]),
    albedo: Constant(0.12), band: (400, 700),
)"#;

    fn place_of(key: &str) -> (usize, usize) {
        let place = parse(TEXT).unwrap().locate(key);
        (place.line, place.column)
    }

    #[test]
    fn values_are_found_through_comments_strings_variants_and_lists() {
        assert_eq!(place_of("title"), (4, 12));
        assert_eq!(place_of("camera.columns"), (5, 29));
        assert_eq!(place_of("camera.principal_point.row"), (5, 73));
        assert_eq!(place_of("trajectory"), (6, 17));
        assert_eq!(place_of("trajectory.points[1].t_s"), (8, 15));
        assert_eq!(place_of("trajectory.points[1].latitude_deg"), (8, 36));
        assert_eq!(place_of("albedo"), (10, 13));
        assert_eq!(place_of("band[1]"), (10, 41));
    }

    #[test]
    fn a_key_that_is_not_written_is_placed_at_the_struct_around_it() {
        assert_eq!(place_of("camera.rows"), place_of("camera"));
        assert_eq!(place_of("horizon.azimuths"), (3, 1));
        assert_eq!(place_of("trajectory.points[7].t_s"), place_of("trajectory.points"));
    }

    #[test]
    fn columns_count_characters_not_bytes() {
        let node = parse("(a: \"ä–ö\", b: 1)").unwrap();
        assert_eq!(node.locate("b"), TextPosition { line: 1, column: 15 });
    }

    #[test]
    fn endless_nesting_does_not_overflow_the_stack() {
        assert!(parse(&"(a: ".repeat(1_000_000)).is_none());
        assert!(parse(&"[".repeat(1_000_000)).is_none());
    }

    #[test]
    fn broken_text_has_no_tree() {
        for text in ["", "(", "(a: 1", "(a 1)", "[1 2]", "(a: \"x)", "/* ", "(a: 1) b", "(a: r\"x\")"] {
            assert!(parse(text).is_none(), "{text}");
        }
    }
}
