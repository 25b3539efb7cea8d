//! Settings of maps: what the table of the model says, the API document, Python and `docs/settings.md` say too.

use std::fs;
use std::path::Path;

use revisit::domain::settings::{Setting, SettingKind, SettingValue, Settings};
use revisit::http::document;

fn read(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn shown(value: &SettingValue) -> String {
    match value {
        SettingValue::Number(number) => ((number * 1e4).round() / 1e4).to_string(),
        SettingValue::Count(count) => count.to_string(),
        SettingValue::Switch(switch) => switch.to_string(),
        SettingValue::Choice(name) => (*name).to_owned(),
        SettingValue::Patterns(patterns) => format!("{:?}", patterns.texts()),
    }
}

/// The settings as `docs/settings.md` lists them.
fn table() -> String {
    let row = |row: &Setting| {
        let values = match row.kind {
            SettingKind::Number { min, max, .. } => format!("{min} to {max}"),
            SettingKind::Count { min, max, .. } => format!("{min} to {max}"),
            SettingKind::Switch => "true, false".to_owned(),
            SettingKind::Choice { names, .. } => names.join(", "),
            SettingKind::Patterns => "regular expressions".to_owned(),
        };
        let default = Settings::default().get(row.name).as_ref().map(shown).expect("a setting");
        let paper = row.paper.as_ref().map(shown).unwrap_or_default();
        let (unit, source) = (row.unit.unwrap_or_default(), row.source.as_str());
        format!("| `{}` | {unit} | {default} | {paper} | {values} | {source} | {} |", row.name, row.doc)
    };
    let rows: Vec<String> = Settings::TABLE.iter().map(row).collect();
    let head = "| setting | unit | default | paper | values | source | meaning |";
    format!("{head}\n{}|\n{}\n", "| --- ".repeat(7), rows.join("\n"))
}

#[test]
fn the_page_of_settings_has_the_table_of_the_model() {
    let table = table();
    assert!(
        read("docs/settings.md").contains(&table),
        "docs/settings.md lacks this table; put it there:\n{table}"
    );
}

#[test]
fn the_api_document_and_the_python_package_have_every_setting_and_its_words() {
    let document = serde_json::to_value(document()).expect("JSON");
    let schema = &document["components"]["schemas"]["Settings"]["properties"];
    let models = read("clients/python/revisit_slam/models.py");
    let class = models.split("class Settings(").nth(1).and_then(|rest| rest.split("\n\n\n").next());
    let class = class.expect("a class of settings");
    for row in Settings::TABLE {
        let property = &schema[row.name];
        assert_eq!(property["description"], row.description(), "{}", row.name);
        assert_eq!(property["x-unit"].as_str(), row.unit, "{}", row.name);
        assert!(property.get("default").is_some(), "{}", row.name);
        assert!(
            class.contains(&format!("\n    {}: ", row.name)),
            "{}: run clients/python/tools/generate.py",
            row.name
        );
    }
}
