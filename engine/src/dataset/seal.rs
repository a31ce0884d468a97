//! JSON files that end with the SHA-256 of all that stands before it, so that a change is noticed in the file itself.

use serde::Serialize;

use crate::digest::sha256_hex;

/// Begins the last field.
const SEAL: &str = "  \"sha256\": \"";

/// The text of a value whose last field is an empty `sha256`, which is filled in.
pub fn sealed(value: &impl Serialize) -> String {
    let text = serde_json::to_string_pretty(value).expect("plain values become JSON");
    let (before, after) = text.rsplit_once(SEAL).expect("the hash is the last field");
    format!("{before}{SEAL}{}{after}\n", sha256_hex(before.as_bytes()))
}

/// Whether a text is as it was when it was given `stated`. Earlier versions stated nothing.
pub fn check(text: &str, stated: &str) -> Result<(), String> {
    let before = text.rsplit_once(SEAL).map_or("", |(before, _)| before);
    match stated.is_empty() || stated == sha256_hex(before.as_bytes()) {
        true => Ok(()),
        false => Err("it has not the SHA-256 that it states".into()),
    }
}
