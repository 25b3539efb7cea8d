//! Codes of verdicts: what the tables of the model say, the API document, the pages, Python and `docs/reasons.md` say too.

use std::fs;
use std::path::Path;

use regex::Regex;
use revisit::domain::location::{Assumption, LocationVerdict, PoseSource};
use revisit::domain::loop_warning::LoopWarningCode;
use revisit::domain::reason::{ReasonCheck, ReasonClass, ReasonCode};
use revisit::http::document;
use revisit::named::Named;
use serde_json::{Value, json};

fn read(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn schemas() -> Value {
    serde_json::to_value(document()).expect("JSON")["components"]["schemas"].clone()
}

fn table(head: &str, rows: impl Iterator<Item = String>) -> String {
    let rule = "| --- ".repeat(head.matches(" | ").count() + 1);
    format!("{head}\n{rule}|\n{}\n", rows.collect::<Vec<_>>().join("\n"))
}

/// The table of an enum that has names and meanings only.
fn meanings<T: Named>(head: &str) -> String {
    table(head, T::VALUES.iter().map(|value| format!("| `{}` | {} |", value.name(), value.meaning())))
}

#[test]
fn the_page_of_reasons_has_the_tables_of_the_model() {
    let reasons = ReasonCode::VALUES.iter().map(|code| {
        let (words, explanation) = (code.words(), code.explanation());
        let (class, check) = (words.class.as_str(), words.check.as_str());
        format!("| `{}` | {} | {class} | {check} | {explanation} |", code.as_str(), words.title)
    });
    let page = read("docs/reasons.md");
    for table in [
        table("| code | title | class | check | meaning |", reasons),
        meanings::<ReasonClass>("| class | meaning |"),
        meanings::<ReasonCheck>("| check | meaning |"),
        meanings::<LoopWarningCode>("| code | meaning |"),
    ] {
        assert!(page.contains(&table), "docs/reasons.md lacks this table; put it there:\n{table}");
    }
}

#[test]
fn the_api_document_has_every_code_with_its_meaning() {
    fn check<T: Named>(schemas: &Value, schema: &str) {
        let schema = &schemas[schema];
        assert_eq!(schema["enum"], json!(T::NAMES), "{schema}");
        let meanings = schema["x-enum-descriptions"].as_array().expect("meanings");
        assert!(meanings.len() == T::NAMES.len() && meanings.iter().all(|one| one != ""), "{schema}");
        let description = schema["description"].as_str().expect("a description");
        assert!(
            T::NAMES.iter().all(|name| description.contains(&format!("\n- `{name}`: "))),
            "{description}"
        );
    }
    let schemas = schemas();
    check::<ReasonCode>(&schemas, "ReasonCode");
    check::<LoopWarningCode>(&schemas, "LoopWarningCode");
    let code = &schemas["Reason"]["properties"]["code"];
    assert_eq!(code["$ref"], "#/components/schemas/ReasonCode");
}

#[test]
fn the_python_package_has_every_code() {
    let models = read("clients/python/revisit_slam/models.py");
    let class =
        models.split("class ReasonCode(OpenEnum):").nth(1).and_then(|rest| rest.split("\n\n\n").next());
    let class = class.expect("an enumeration of reason codes");
    for name in ReasonCode::NAMES {
        assert!(class.contains(&format!(" = \"{name}\"\n")), "{name}: run clients/python/tools/generate.py");
    }
}

#[test]
fn the_viewer_speaks_of_no_code_that_there_is_not() {
    let spoken = Regex::new(r#"reason\?\.code [!=]== "(\w+)""#).expect("a pattern");
    let script = read("crates/server/assets/viewer_verdict.js");
    let spoken: Vec<&str> =
        spoken.captures_iter(&script).filter_map(|found| Some(found.get(1)?.as_str())).collect();
    assert!(!spoken.is_empty());
    for code in spoken {
        assert!(ReasonCode::from_name(code).is_some(), "{code}");
    }
}

#[test]
fn the_viewer_has_words_for_every_name_in_a_place() {
    let script = read("crates/server/assets/viewer_place.js");
    let names =
        [("TONES", LocationVerdict::NAMES), ("SOURCES", PoseSource::NAMES), ("ASSUMED", Assumption::NAMES)];
    for (table, names) in names {
        let head = format!("const {table} = {{ ");
        let words = script.split(&head).nth(1).and_then(|rest| rest.split('}').next());
        let words = words.expect("a table");
        for name in names {
            assert!(words.contains(&format!("{name}: \"")), "{table} of viewer_place.js lacks {name}");
        }
    }
}
