//! The API document: committed, complete, and made for generators that know no unions.

use std::collections::BTreeSet;

use revisit::http::document;
use serde_json::Value;

const COMMITTED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/openapi/openapi.yaml");

fn json() -> Value {
    serde_json::to_value(document()).expect("JSON")
}

/// Every operation, as `GET /path` and itself.
fn operations(document: &Value) -> Vec<(String, &Value)> {
    let paths = document["paths"].as_object().expect("paths");
    let operations = paths.iter().flat_map(|(path, item)| {
        let item = item.as_object().expect("a path item");
        item.iter().map(move |(method, operation)| (format!("{} {path}", method.to_uppercase()), operation))
    });
    operations.filter(|(_, operation)| operation.get("responses").is_some()).collect()
}

#[test]
fn the_committed_document_is_the_one_the_code_makes() {
    let committed = std::fs::read_to_string(COMMITTED).unwrap_or_default();
    let made = document().to_yaml().expect("YAML");
    assert!(
        committed == made,
        "openapi/openapi.yaml is not what the code makes; look at the difference, and if it is meant:\n    \
         cargo run -- openapi > openapi/openapi.yaml"
    );
}

#[test]
fn there_is_no_union_in_it() {
    fn check(place: &str, value: &Value) {
        match value {
            Value::Object(members) => {
                for (name, value) in members {
                    let union = ["oneOf", "anyOf", "allOf"].contains(&name.as_str());
                    assert!(!union, "{place} has {name}, on which generators for C++ break");
                    check(&format!("{place}/{name}"), value);
                }
            }
            Value::Array(items) => items.iter().for_each(|item| check(place, item)),
            _ => {}
        }
    }
    check("", &json());
}

#[test]
fn every_reference_leads_somewhere() {
    fn check(document: &Value, value: &Value) {
        match value {
            Value::Object(members) => {
                if let Some(Value::String(reference)) = members.get("$ref") {
                    let pointer = reference.strip_prefix('#').expect("a reference into this document");
                    assert!(document.pointer(pointer).is_some(), "{reference}");
                }
                members.values().for_each(|value| check(document, value));
            }
            Value::Array(items) => items.iter().for_each(|item| check(document, item)),
            _ => {}
        }
    }
    let document = json();
    check(&document, &document);
}

#[test]
fn every_operation_has_a_summary_an_example_and_its_error_answers() {
    let document = json();
    let operations = operations(&document);
    assert!(operations.len() > 25, "{operations:#?}");
    for (name, operation) in operations {
        assert!(operation["summary"].is_string(), "{name} has no summary");
        assert!(operation["tags"].as_array().is_some_and(|tags| tags.len() == 1), "{name} has not one tag");
        let responses = operation["responses"].as_object().expect("responses");
        assert!(responses.contains_key("default"), "{name} has no answer for other failures");
        let body = operation["requestBody"]["content"].as_object();
        if let Some(media) = body {
            assert!(
                media.values().all(|media| media.get("example").is_some()),
                "{name}: a body without an example"
            );
            assert!(responses.contains_key("400") && responses.contains_key("422"), "{name} refuses no body");
        }
        let success = responses.iter().filter(|(status, _)| status.starts_with('2'));
        for (status, response) in success {
            let media = response["content"].as_object().into_iter().flat_map(|content| content.values());
            assert!(
                { media }.all(|media| media.get("example").is_some()),
                "{name}: {status} without an example"
            );
        }
        if name.contains("{map}") {
            assert!(responses.contains_key("404"), "{name} finds everything");
        }
    }
}

#[test]
fn every_refusal_is_a_problem_with_an_example() {
    let document = json();
    for (name, response) in document["components"]["responses"].as_object().expect("responses") {
        let media = &response["content"]["application/problem+json"];
        assert_eq!(media["schema"]["$ref"], "#/components/schemas/Problem", "{name}");
        assert!(media["example"]["code"].is_string(), "{name}");
    }
}

#[test]
fn operation_ids_are_unique_and_parameters_bounded() {
    let document = json();
    let mut ids = BTreeSet::new();
    for (name, operation) in operations(&document) {
        let id = operation["operationId"].as_str().expect("an operationId");
        assert!(ids.insert(id), "{name}: {id} is taken");
        for parameter in operation["parameters"].as_array().into_iter().flatten() {
            let schema = &parameter["schema"];
            let bounded =
                ["maxLength", "minimum", "enum", "pattern"].iter().any(|bound| schema.get(bound).is_some());
            let header = parameter["in"] == "header";
            assert!(bounded || header || schema["type"] == "boolean", "{name}: {parameter}");
        }
    }
}

#[test]
fn it_lists_the_numbers_that_decide_and_are_no_settings() {
    let document = json();
    let constants = document["x-constants"].as_array().expect("a list");
    let value = |name: &str| {
        let found = constants.iter().find(|constant| constant["name"] == name);
        found.unwrap_or_else(|| panic!("no {name}"))["value"].as_f64()
    };
    assert_eq!(value("odds.same_spot_m"), Some(0.75));
    assert_eq!(value("similarity.max_chi_square"), Some(9.21));
    assert_eq!(value("numbering.values"), Some(10.0));
    for constant in constants {
        let text = |field: &str| constant[field].as_str().is_some_and(|text| !text.is_empty());
        assert!(text("unit") && text("description"), "{constant}");
    }
}
