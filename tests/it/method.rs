//! The choices of `docs/method.md`: cited by numbers that it has, with settings, files and tests that there are.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use regex::Regex;
use revisit::domain::settings::{SettingSource, SettingValue, Settings};

const METHOD: &str = "docs/method.md";

/// An entry of the page.
struct Choice {
    /// Its number, as `M7`.
    number: String,
    title: String,
    /// What stands in backticks behind "Settings", "Code" and "Tests".
    settings: Vec<String>,
    code: Vec<String>,
    tests: Vec<String>,
}

fn read(path: &str) -> Option<String> {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).ok()
}

fn choices() -> Vec<Choice> {
    let page = read(METHOD).expect("the page");
    let entries = page.split("\n### ").skip(1);
    let choice = |entry: &str| {
        let (number, title) = entry.lines().next()?.split_once(' ')?;
        let quoted = |list: &str| -> Option<Vec<String>> {
            let line = entry.lines().find_map(|line| line.strip_prefix(&format!("- {list}: ")))?;
            Some(line.split('`').skip(1).step_by(2).map(str::to_owned).collect())
        };
        let [settings, code, tests] = ["Settings", "Code", "Tests"].map(quoted);
        let (settings, code, tests) = (settings?, code?, tests?);
        Some(Choice { number: number.to_owned(), title: title.to_owned(), settings, code, tests })
    };
    entries.map(|entry| choice(entry).unwrap_or_else(|| panic!("not an entry: {entry}"))).collect()
}

/// The text files of the repository with their contents; none where git does not know them.
fn tracked() -> Vec<(String, String)> {
    let git = Command::new("git").args(["-C", env!("CARGO_MANIFEST_DIR"), "ls-files"]).output();
    let listed = git.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    if listed.is_empty() {
        eprintln!("skipped: there is no git, or no checkout");
    }
    listed.lines().filter_map(|path| Some((path.to_owned(), read(path)?))).collect()
}

/// Whether a default is written so; numbers may be rounded.
fn is_written_as(value: &SettingValue, written: &str) -> bool {
    match value {
        SettingValue::Number(number) => written.parse().is_ok_and(|read: f64| (read - number).abs() < 1e-3),
        SettingValue::Count(count) => written == count.to_string(),
        SettingValue::Switch(switch) => written == switch.to_string(),
        SettingValue::Choice(name) => written == *name,
        SettingValue::Patterns(patterns) => written == format!("{:?}", patterns.texts()),
    }
}

#[test]
fn entries_name_settings_files_and_tests_that_there_are() {
    let mut wrong = Vec::new();
    for Choice { number, settings, code, tests, .. } in choices() {
        for setting in settings {
            let (name, default) = setting.split_once(" = ").unwrap_or((&setting, ""));
            if !Settings::default().get(name).is_some_and(|value| is_written_as(&value, default)) {
                wrong.push(format!("{number}: there is no setting {setting}"));
            }
        }
        for path in code.iter().filter(|path| read(path).is_none()) {
            wrong.push(format!("{number}: there is no file {path}"));
        }
        let mut file = None;
        for name in &tests {
            if name.contains('/') {
                file = read(name);
            } else if !file.as_ref().is_some_and(|text| text.contains(&format!("fn {name}("))) {
                wrong.push(format!("{number}: there is no test {name} in the file named before it"));
            }
        }
        if code.is_empty() || tests.is_empty() {
            wrong.push(format!("{number}: it names no code, or no test"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn every_setting_of_ours_belongs_to_an_entry_and_the_table_of_contents_lists_all() {
    let (page, choices) = (read(METHOD).expect("the page"), choices());
    let name =
        |setting: &String| setting.split_once(" = ").map_or(setting.clone(), |(name, _)| name.to_owned());
    let named: BTreeSet<String> =
        choices.iter().flat_map(|choice| choice.settings.iter().map(name)).collect();
    for row in Settings::TABLE.iter().filter(|row| row.source == SettingSource::Ours) {
        assert!(named.contains(row.name), "no entry names {}", row.name);
    }
    for (at, Choice { number, title, settings, .. }) in choices.iter().enumerate() {
        assert_eq!(*number, format!("M{}", at + 1), "the numbers follow each other");
        let settings: Vec<String> = settings.iter().map(|setting| format!("`{}`", name(setting))).collect();
        let settings = if settings.is_empty() { "none".to_owned() } else { settings.join(", ") };
        let anchor = format!("{number} {title}").to_lowercase().replace(' ', "-").replace('\'', "");
        let row = format!("\n| [{number}](#{anchor}) | {title} | {settings} |\n");
        assert!(page.contains(&row), "the table of contents lacks {row}");
    }
}

#[test]
fn every_citation_is_in_the_repository() {
    let defined: BTreeSet<String> = choices().into_iter().map(|choice| choice.number).collect();
    // Elsewhere, as in drawings, an M with digits is no citation.
    let may_cite = ["rs", "md", "py", "sql", "toml", "yaml"];
    let citation = Regex::new(r"\bM[1-9][0-9]*\b").expect("a pattern");
    // Not in the repository, and so in two parts.
    let absent = concat!("contract", ".md");
    let mut wrong = Vec::new();
    for (path, text) in tracked() {
        let extension = Path::new(&path).extension().unwrap_or_default().to_string_lossy().into_owned();
        for (line, words) in (1..).zip(text.lines()) {
            if words.contains(absent) {
                wrong.push(format!("{path}:{line} cites {absent}"));
            }
            let cited = citation.find_iter(words).map(|found| found.as_str());
            for number in cited.filter(|number| may_cite.contains(&&*extension) && !defined.contains(*number))
            {
                wrong.push(format!("{path}:{line} cites {number}, which {METHOD} does not define"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
