//! Keys, schema and what is read are the same.

use serde_json::Value;
use splinepost::tables::Key;
use splinepost::{front, machine};

/// A schema behind its reference, and without the `null` of an optional value.
fn resolved<'s>(root: &'s Value, schema: &'s Value) -> &'s Value {
    if let Some(reference) = schema["$ref"].as_str() {
        return resolved(root, &root["$defs"][reference.trim_start_matches("#/$defs/")]);
    }
    match schema["anyOf"].as_array() {
        Some(some) => resolved(root, some.iter().find(|one| one["type"] != "null").expect("a type")),
        None => schema,
    }
}

/// Compares the keys of the code with the properties of a schema, both ways, tables within tables included.
fn compare(root: &Value, schema: &Value, keys: &[Key], path: &str) {
    let schema = resolved(root, schema);
    assert_eq!(schema["additionalProperties"], false, "{path} allows anything");
    let properties = schema["properties"].as_object().unwrap_or_else(|| panic!("{path} has no properties"));
    let mut of_schema: Vec<&str> = properties.keys().map(String::as_str).collect();
    let mut of_code: Vec<&str> = keys.iter().map(|key| key.name).collect();
    of_schema.sort_unstable();
    of_code.sort_unstable();
    assert_eq!(of_schema, of_code, "{path}");
    for key in keys {
        let property = &properties[key.name];
        assert!(property["description"].is_string(), "{path}.{} has no description", key.name);
        if key.inner.is_empty() {
            continue;
        }
        let inner = resolved(root, property);
        let inner = match (key.each, key.list) {
            (true, _) => &inner["additionalProperties"],
            (_, true) => &inner["items"],
            (false, false) => inner,
        };
        compare(root, inner, key.inner, &format!("{path}.{}", key.name));
    }
}

#[test]
fn the_schemas_have_the_keys_of_the_code() {
    let cutter = serde_json::to_value(front::cutter::schema()).expect("JSON");
    compare(&cutter, &cutter, front::cutter::KEYS, "cutter");
    let job = serde_json::to_value(front::job::schema()).expect("JSON");
    compare(&job, &job, front::job::KEYS, "job");
    let machine = serde_json::to_value(machine::schema()).expect("JSON");
    compare(&machine, &machine, machine::KEYS, "machine");
}
