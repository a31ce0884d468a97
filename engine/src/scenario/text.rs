//! RON as scenarios are written in.

use super::error::{Fault, Problem};
use super::spec::{Shadows, Spec};
use super::tree::TextPosition;

/// Reads a scenario.
pub fn parse(text: &str) -> Result<Spec, Problem> {
    read(text).map_err(|error| Problem {
        place: TextPosition { line: error.span.start.line, column: error.span.start.col },
        key: String::new(),
        fault: Fault::Syntax(first_letter_lower(&error.code.to_string()) + hint(&error.code)),
    })
}

/// Reads a value with the extensions that make files plain.
pub fn read<T: serde::de::DeserializeOwned>(text: &str) -> Result<T, ron::error::SpannedError> {
    use ron::extensions::Extensions;
    let extensions = Extensions::IMPLICIT_SOME | Extensions::UNWRAP_NEWTYPES | Extensions::UNWRAP_VARIANT_NEWTYPES;
    ron::Options::default().with_default_extension(extensions).from_str(text)
}

/// What to write instead, where what stands there is likely meant so.
fn hint(error: &ron::Error) -> &'static str {
    match error {
        ron::Error::InvalidEscape(_) => "; paths are written with /, or as r\"…\"",
        _ => "",
    }
}

/// Shadows as scenarios write them, as in `TowardsSun(by: Swath())`.
pub fn parse_shadows(text: &str) -> Option<Shadows> {
    read(text).ok()
}

fn first_letter_lower(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map(|first| first.to_lowercase().collect::<String>() + chars.as_str()).unwrap_or_default()
}

/// A choice as it is written in scenarios.
pub fn name(choice: &impl serde::Serialize) -> String {
    ron::to_string(choice).unwrap_or_default()
}
