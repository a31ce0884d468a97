//! The scenario reference as text: every key with its type, range, unit, default and meaning.

use serde_json::Value as Json;

use super::error::range_end;
use super::structure::{bounds, followed, is_current, kind, names, required, schema, unit};

const TEXT_COLUMNS: usize = 100;

/// The reference that `sim schema` prints.
pub fn text() -> String {
    let schema = schema();
    let root = schema.as_value();
    let mut writer = Writer { definitions: root.get("$defs"), text: String::new() };
    writer.paragraph(0, description(root).unwrap_or_default());
    writer.line(0, "Keys marked * must be given; the others have defaults.\n");
    writer.keys(root, 0);
    writer.text
}

struct Writer<'a> {
    definitions: Option<&'a Json>,
    text: String,
}

impl<'a> Writer<'a> {
    fn line(&mut self, depth: usize, line: &str) {
        self.text.push_str(&"    ".repeat(depth));
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn paragraph(&mut self, depth: usize, paragraph: &str) {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            if 4 * depth + line.chars().count() + word.chars().count() >= TEXT_COLUMNS {
                self.line(depth, &std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
        if !line.is_empty() {
            self.line(depth, &line);
        }
    }

    /// Keys of a struct: those that must be given in their order, then the others.
    fn keys(&mut self, schema: &'a Json, depth: usize) {
        let Some(properties) = schema.get("properties").and_then(Json::as_object) else { return };
        let needed: Vec<&str> = required(schema).collect();
        let optional = properties.keys().map(String::as_str).filter(|key| !needed.contains(key));
        for key in needed.iter().copied().chain(optional) {
            self.key(key, &properties[key], needed.contains(&key), depth);
        }
    }

    fn key(&mut self, key: &str, written: &'a Json, needed: bool, depth: usize) {
        let schema = followed(written, self.definitions);
        let mut line = format!("{key}{}: {}", if needed { "*" } else { "" }, self.type_of(schema, unit(key)));
        if let Some(default) = written.get("default").and_then(ron_text) {
            line.push_str(&format!(" = {default}"));
        }
        self.line(depth, &line);
        self.paragraph(depth + 1, description(written).or(description(schema)).unwrap_or_default());
        self.inside(schema, depth + 1);
        if depth == 0 {
            self.text.push('\n');
        }
    }

    /// What a value is made of: keys of a struct, variants of an enum, items of a list.
    fn inside(&mut self, schema: &'a Json, depth: usize) {
        if let Some(variants) = schema.get("oneOf").and_then(Json::as_array) {
            variants.iter().filter(|variant| is_current(variant)).for_each(|variant| self.variant(variant, depth));
        } else if let Some(items) = schema.get("items") {
            self.inside(followed(items, self.definitions), depth);
        } else {
            self.keys(schema, depth);
        }
    }

    fn variant(&mut self, variant: &'a Json, depth: usize) {
        let meaning = description(variant).map(|text| format!(": {text}")).unwrap_or_default();
        for name in names(variant) {
            let content = variant.get("properties").and_then(|properties| properties.get(&name));
            let content = content.map(|content| followed(content, self.definitions));
            let shown = match content {
                None => String::new(),
                Some(content) if kind(content) == "object" => "(…)".into(),
                Some(content) => format!("({})", self.type_of(content, "")),
            };
            self.paragraph(depth, &format!("- {name}{shown}{meaning}"));
            if let Some(content) = content {
                self.inside(content, depth + 1);
            }
        }
    }

    fn type_of(&self, schema: &Json, unit: &str) -> String {
        let spaced_unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        if schema.get("oneOf").is_some() {
            return "one of".into();
        }
        match kind(schema) {
            "object" => "(…)".into(),
            "string" => "text".into(),
            "boolean" => "true or false".into(),
            "array" => match schema.get("prefixItems").and_then(Json::as_array) {
                Some(parts) => format!("({}){spaced_unit}", vec!["number"; parts.len()].join(", ")),
                None => {
                    let items = schema.get("items").map(|items| followed(items, self.definitions));
                    format!("list of {}", items.map(|items| self.type_of(items, "")).unwrap_or_default())
                }
            },
            number => {
                let (minimum, maximum) = bounds(schema);
                let name = if number == "integer" { "whole number" } else { "number" };
                match (minimum.is_finite(), maximum.is_finite()) {
                    (true, true) => {
                        format!("{name} in [{}, {}]{spaced_unit}", range_end(minimum), range_end(maximum))
                    }
                    (true, false) => format!("{name} from {}{spaced_unit}", range_end(minimum)),
                    _ => format!("{name}{spaced_unit}"),
                }
            }
        }
    }
}

fn description(schema: &Json) -> Option<&str> {
    schema.get("description").and_then(Json::as_str)
}

/// A default as it would be written; structs and options without one are explained by their document.
fn ron_text(default: &Json) -> Option<String> {
    match default {
        Json::Number(number) => Some(number.as_f64().map_or(number.to_string(), range_end)),
        Json::Bool(value) => Some(value.to_string()),
        Json::String(variant) => Some(variant.clone()),
        // A variant with all its options at their defaults.
        Json::Object(variant) if variant.len() == 1 => {
            variant.keys().next().filter(|name| name.starts_with(char::is_uppercase)).map(|name| format!("{name}()"))
        }
        Json::Array(items) => Some(format!("[{}]", items.iter().filter_map(ron_text).collect::<Vec<_>>().join(", "))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_shows_type_range_unit_and_meaning() {
        let text = text();
        for line in [
            "title*: text",
            "    focal_length_mm: number in [1, 10000] mm",
            "    columns: whole number in [1, 16384]",
            "- HorizonMaps(…): From Fourier-compressed horizon maps, made once for all Suns.",
            "shadows: one of = Auto()",
            "        posting_m*: number in [0.01, 100000] m",
        ] {
            assert!(text.contains(line), "no line {line:?} in\n{text}");
        }
    }

    /// A number without bounds is one that nobody thought about. Ids and seeds may be any.
    #[test]
    fn every_number_of_the_schema_is_bounded() {
        fn walk(key: &str, schema: &Json, unbounded: &mut Vec<String>) {
            let free = bounds(schema).0.is_infinite() || bounds(schema).1.is_infinite();
            if matches!(kind(schema), "number" | "integer") && free {
                unbounded.push(key.into());
            }
            for (inner, value) in schema.as_object().into_iter().flatten() {
                let is_name = matches!(inner.as_str(), "properties" | "items" | "oneOf" | "anyOf" | "$defs");
                walk(if is_name { key } else { inner }, value, unbounded);
            }
            schema.as_array().into_iter().flatten().for_each(|value| walk(key, value, unbounded));
        }
        let mut unbounded = Vec::new();
        walk("", schema().as_value(), &mut unbounded);
        unbounded.retain(|key| !matches!(key.as_str(), "naif_id" | "seed" | "prefixItems"));
        assert!(unbounded.is_empty(), "{unbounded:?}");
    }
}
