//! Where two trees of settings differ, in the words of their keys.

use serde_json::Value as Json;

/// More than these are counted only.
const TOLD: usize = 6;
/// Longer values are cut.
const LONGEST: usize = 60;

/// One line: `camera.exposure_s was 0.02, is 0.05; …`. Empty where nothing differs.
pub fn told(old: &Json, new: &Json, root: &str) -> String {
    let mut found = Vec::new();
    collect(old, new, root, &mut found);
    let more = found.len().saturating_sub(TOLD);
    found.truncate(TOLD);
    if more > 0 {
        found.push(format!("and {more} more"));
    }
    found.join("; ")
}

fn collect(old: &Json, new: &Json, path: &str, found: &mut Vec<String>) {
    let below = |key: &str| match path {
        "" => key.to_owned(),
        _ => format!("{path}.{key}"),
    };
    match (old, new) {
        _ if old == new => {}
        (Json::Object(a), Json::Object(b)) => {
            let only_new = b.keys().filter(|key| !a.contains_key(*key));
            for key in a.keys().chain(only_new) {
                let [old, new] = [a, b].map(|map| map.get(key).unwrap_or(&Json::Null));
                collect(old, new, &below(key), found);
            }
        }
        (Json::Array(a), Json::Array(b)) if a.len() == b.len() => {
            for (index, (old, new)) in a.iter().zip(b).enumerate() {
                collect(old, new, &format!("{path}[{index}]"), found);
            }
        }
        _ => found.push(format!("{path} was {}, is {}", short(old), short(new))),
    }
}

fn short(value: &Json) -> String {
    let text = match value {
        Json::Null => "none".into(),
        Json::String(text) => text.clone(),
        value => value.to_string(),
    };
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn differences_are_named_by_their_keys() {
        let old = json!({ "camera": { "exposure_s": 0.02, "rows": 4 }, "dems": [{ "seed": 1 }], "sun": null });
        let new = json!({ "camera": { "exposure_s": 0.05, "rows": 4 }, "dems": [{ "seed": 2 }], "sun": "fixed" });
        let expected = "camera.exposure_s was 0.02, is 0.05; dems[0].seed was 1, is 2; sun was none, is fixed";
        assert_eq!(told(&old, &new, ""), expected);
        assert_eq!(told(&old, &old, ""), "");
        assert_eq!(told(&json!(1), &json!(2), "exposures[3]"), "exposures[3] was 1, is 2");
    }

    #[test]
    fn many_differences_are_counted() {
        let list = |offset: usize| json!((0..9).map(|index| index + offset).collect::<Vec<_>>());
        assert!(told(&list(0), &list(1), "a").ends_with("a[5] was 5, is 6; and 3 more"));
    }
}
