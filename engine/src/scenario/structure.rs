//! Checks a tree against the scenario's JSON schema: keys, types, variants, counts, ranges.
//!
//! `ron` stops at the first fault and forgets the places of what it has read. This check finds all faults of a file
//! at once, and reads the allowed ranges from the schema, so that each stands only once, beside its field.

use std::collections::HashSet;

use schemars::Schema;
use serde_json::Value as Json;

use super::Spec;
use super::error::{Fault, Problem};
use super::hints::near;
use super::tree::{Node, StructField, TextPosition, Value};

/// The JSON schema of scenarios.
pub fn schema() -> Schema {
    schemars::schema_for!(Spec)
}

/// Problems that are told one by one.
const TOLD: usize = 100;

/// The first hundred faults of structure, and how many there are beyond.
pub fn check(tree: &Node) -> Vec<Problem> {
    let schema = schema();
    let root = schema.as_value();
    let mut check = Check { definitions: root.get("$defs"), problems: Vec::new(), more: None };
    check.node(root, tree, "");
    if let Some((place, count)) = check.more {
        check.problems.push(Problem { place, key: String::new(), fault: Fault::More { count } });
    }
    check.problems
}

/// The unit that ends a key's name, as in `focal_length_mm`.
pub fn unit(key: &str) -> &'static str {
    const UNITS: [(&str, &str); 15] = [
        ("_w_m2_sr", "W m-2 sr-1"),
        ("_w_m2", "W m-2"),
        ("_m3_s2", "m3 s-2"),
        ("_m_s", "m/s"),
        ("_e_per_dn", "electrons/DN"),
        ("_e_per_s", "electrons/s"),
        ("_deg", "deg"),
        ("_mm", "mm"),
        ("_um", "um"),
        ("_nm", "nm"),
        ("_au", "au"),
        ("_px", "px"),
        ("_m", "m"),
        ("_s", "s"),
        ("_e", "electrons"),
    ];
    let name = key.split('[').next().unwrap_or(key);
    UNITS.iter().find(|(suffix, _)| name.ends_with(suffix)).map_or("", |(_, unit)| unit)
}

struct Check<'a> {
    definitions: Option<&'a Json>,
    problems: Vec<Problem>,
    /// Where the first stands that is not told, and how many are not.
    more: Option<(TextPosition, usize)>,
}

impl<'a> Check<'a> {
    fn report(&mut self, place: TextPosition, key: &str, fault: Fault) {
        match &mut self.more {
            Some((_, count)) => *count += 1,
            None if self.problems.len() == TOLD => self.more = Some((place, 1)),
            None => self.problems.push(Problem { place, key: key.into(), fault }),
        }
    }

    fn node(&mut self, schema: &'a Json, node: &Node, key: &str) {
        let schema = self.followed(schema);
        if let Some(variants) = schema.get("oneOf").and_then(Json::as_array) {
            return self.variant(variants, node, key);
        }
        match kind(schema) {
            "object" => self.object(schema, node, key),
            "array" => self.array(schema, node, key),
            "number" | "integer" => self.number(schema, node, key),
            "boolean" if !matches!(node.value, Value::Bool(_)) => self.wrong_type(node, key, "true or false"),
            "string" if schema.get("enum").is_some() => self.variant(std::slice::from_ref(schema), node, key),
            "string" if !matches!(node.value, Value::Text(_)) => self.wrong_type(node, key, "text in quotes"),
            _ => {}
        }
    }

    /// The schema behind references and options.
    fn followed(&self, schema: &'a Json) -> &'a Json {
        followed(schema, self.definitions)
    }

    fn wrong_type(&mut self, node: &Node, key: &str, expected: &str) {
        self.report(node.place, key, Fault::WrongType { got: shown(node), expected: expected.into() });
    }

    fn variant(&mut self, variants: &'a [Json], node: &Node, key: &str) {
        let allowed: Vec<String> = variants.iter().filter(|variant| is_current(variant)).flat_map(names).collect();
        let Value::Named(name, inside) = &node.value else {
            return self.report(node.place, key, Fault::NotOneOf { got: shown(node), near: None, allowed });
        };
        let Some(variant) = variants.iter().find(|variant| names(variant).contains(name)) else {
            let near = near(name, &allowed);
            return self.report(node.place, key, Fault::NotOneOf { got: name.clone(), near, allowed });
        };
        match (variant.get("properties").and_then(|properties| properties.get(name)), inside) {
            (None, None) => {}
            (Some(content), Some(inside)) => self.content(content, inside, key),
            (Some(content), None) => {
                let expected = format!("{name}({})", required(self.followed(content)).collect::<Vec<_>>().join(", "));
                self.wrong_type(node, key, &expected);
            }
            (None, Some(_)) => self.wrong_type(node, key, &format!("{name} without parentheses")),
        }
    }

    /// What stands in the parentheses of a variant: a struct, or one value.
    fn content(&mut self, schema: &'a Json, inside: &Node, key: &str) {
        match &inside.value {
            Value::Tuple(items) if items.len() == 1 => self.node(schema, &items[0], key),
            _ => self.node(schema, inside, key),
        }
    }

    fn object(&mut self, schema: &'a Json, node: &Node, key: &str) {
        let Value::Struct(fields) = &node.unwrapped().value else {
            let needed: Vec<&str> = required(schema).collect();
            let keys: Vec<String> = needed.iter().map(|name| format!("{name}: …")).collect();
            let expected = match keys[..] {
                [] => "a group of keys, as in (key: …)".into(),
                _ => format!("a group of keys, as in ({})", keys.join(", ")),
            };
            return self.wrong_type(node, key, &expected);
        };
        let mut written = HashSet::new();
        for field in fields {
            if !written.insert(field.key.as_str()) {
                self.report(field.place, &join(key, &field.key), Fault::WrittenTwice);
            }
            self.field(schema, field, key);
        }
        for name in required(schema).filter(|name| !written.contains(name)) {
            self.report(node.place, &join(key, name), Fault::Missing);
        }
    }

    fn field(&mut self, schema: &'a Json, field: &StructField, parent: &str) {
        let Some(properties) = schema.get("properties").and_then(Json::as_object) else { return };
        let key = join(parent, &field.key);
        match properties.get(&field.key) {
            Some(property) => self.node(property, &field.node, &key),
            // Only counted: to look for a near name would take most of the time.
            None if self.more.is_some() => {
                self.report(field.place, &key, Fault::UnknownKey { near: None, allowed: Vec::new() });
            }
            None => {
                let allowed: Vec<String> = properties.keys().cloned().collect();
                let near = near(&field.key, &allowed);
                self.report(field.place, &key, Fault::UnknownKey { near, allowed });
            }
        }
    }

    /// A list (`items`) or a tuple (`prefixItems`).
    fn array(&mut self, schema: &'a Json, node: &Node, key: &str) {
        let tuple = schema.get("prefixItems").and_then(Json::as_array);
        let items = match (&node.value, tuple) {
            (Value::List(items), None) | (Value::Tuple(items), Some(_)) => items,
            (_, None) => return self.wrong_type(node, key, "a list in [ ]"),
            (_, Some(parts)) => {
                return self.wrong_type(node, key, &format!("{} numbers in ( )", parts.len()));
            }
        };
        let minimum = schema.get("minItems").and_then(Json::as_u64).unwrap_or(0);
        let maximum = schema.get("maxItems").and_then(Json::as_u64).unwrap_or(u64::MAX);
        if !(minimum..=maximum).contains(&(items.len() as u64)) {
            self.report(node.place, key, Fault::WrongCount { got: items.len(), minimum, maximum });
        }
        for (index, item) in items.iter().enumerate() {
            let part = tuple.map_or(schema.get("items"), |parts| parts.get(index));
            if let Some(part) = part {
                self.node(part, item, &format!("{key}[{index}]"));
            }
        }
    }

    fn number(&mut self, schema: &Json, node: &Node, key: &str) {
        let whole = kind(schema) == "integer";
        let expected = if whole { "a whole number" } else { "a number" };
        let Value::Number(got) = &node.value else { return self.wrong_type(node, key, expected) };
        let Some(number) = parse_number(got) else { return self.wrong_type(node, key, expected) };
        let got = got.clone();
        if whole && got.contains(['.', 'e', 'E', 'N', 'i']) && !got.starts_with("0x") {
            return self.wrong_type(node, key, expected);
        }
        if !number.is_finite() {
            return self.report(node.place, key, Fault::NotFinite { got });
        }
        let (minimum, maximum) = bounds(schema);
        if number < minimum || number > maximum {
            let unit = unit(key.rsplit('.').next().unwrap_or(key)).into();
            self.report(node.place, key, Fault::OutsideRange { got, minimum, maximum, unit });
        }
    }
}

/// Whether a variant is no older spelling.
pub(super) fn is_current(variant: &Json) -> bool {
    variant.get("deprecated").and_then(Json::as_bool) != Some(true)
}

/// The schema behind references and options.
pub(super) fn followed<'a>(schema: &'a Json, definitions: Option<&'a Json>) -> &'a Json {
    if let Some(reference) = schema.get("$ref").and_then(Json::as_str) {
        let name = reference.rsplit('/').next().unwrap_or_default();
        return definitions.and_then(|definitions| definitions.get(name)).unwrap_or(schema);
    }
    let options = schema.get("anyOf").and_then(Json::as_array);
    match options.and_then(|options| options.iter().find(|option| kind(option) != "null")) {
        Some(option) => followed(option, definitions),
        None => schema,
    }
}

/// The JSON type, leaving out the `null` of an option.
pub(super) fn kind(schema: &Json) -> &str {
    match schema.get("type") {
        Some(Json::String(kind)) => kind,
        Some(Json::Array(kinds)) => kinds.iter().filter_map(Json::as_str).find(|kind| *kind != "null").unwrap_or(""),
        _ => "",
    }
}

pub(super) fn bounds(schema: &Json) -> (f64, f64) {
    let end = |name, open| schema.get(name).and_then(Json::as_f64).unwrap_or(open);
    (end("minimum", f64::NEG_INFINITY), end("maximum", f64::INFINITY))
}

/// The names of enum variants that one alternative of a schema stands for.
pub(super) fn names(variant: &Json) -> Vec<String> {
    if let Some(name) = variant.get("const").and_then(Json::as_str) {
        return vec![name.into()];
    }
    match (variant.get("enum"), variant.get("properties")) {
        (Some(Json::Array(names)), _) => names.iter().filter_map(Json::as_str).map(String::from).collect(),
        (_, Some(Json::Object(properties))) => properties.keys().cloned().collect(),
        _ => Vec::new(),
    }
}

pub(super) fn required(schema: &Json) -> impl Iterator<Item = &str> {
    schema.get("required").and_then(Json::as_array).into_iter().flatten().filter_map(Json::as_str)
}

fn join(parent: &str, key: &str) -> String {
    if parent.is_empty() { key.into() } else { format!("{parent}.{key}") }
}

fn parse_number(text: &str) -> Option<f64> {
    let text = text.replace('_', "");
    match text.strip_prefix("0x") {
        Some(digits) => u64::from_str_radix(digits, 16).ok().map(|number| number as f64),
        None => text.parse().ok(),
    }
}

/// A value as a message quotes it.
fn shown(node: &Node) -> String {
    match &node.value {
        Value::Number(text) => text.clone(),
        Value::Text(text) => format!("{text:?}"),
        Value::Bool(value) => value.to_string(),
        Value::List(_) => "[…]".into(),
        Value::Tuple(items) if (1..=4).contains(&items.len()) => {
            format!("({})", items.iter().map(shown).collect::<Vec<_>>().join(", "))
        }
        Value::Tuple(_) | Value::Struct(_) => "(…)".into(),
        Value::Named(name, None) => name.clone(),
        Value::Named(name, Some(_)) => format!("{name}(…)"),
    }
}
