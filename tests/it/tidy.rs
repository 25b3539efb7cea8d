//! The house keeps its own rules: layers, file sizes, first lines.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use imports::{circles, import_graph};

mod ci;
mod imports;
mod tokens;

/// The rooms from the top down; a room imports only from rows below its own. Rooms of one row do not
/// know each other.
const LAYERS: &[&[&str]] = &[
    &["main"],
    &["cli"],
    &["buildings"],
    &["hotel"],
    &["http", "client"],
    &["engine", "api"],
    &["llm", "integrity"],
    &["store"],
    &["recognition"],
    &["vocabulary"],
    &["domain"],
    &["geometry", "semantics", "config"],
    &["named"],
];

/// A file above this is two concepts.
const LINES_MAX: usize = 450;

/// And the usual file is far below it.
const MEDIAN_LINES_MAX: usize = 160;

/// The sources that have rooms: those of the program, and of the crates that hold several.
const WITH_ROOMS: [&str; 4] = ["src", "crates/core/src", "crates/server/src", "crates/sim/src"];

/// Returns the sources of every crate: the program's, and those below `crates`.
fn roots() -> Vec<String> {
    let crates = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("crates")).unwrap();
    let names = crates.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut roots: Vec<String> = names.map(|name| format!("crates/{name}/src")).collect();
    roots.push("src".to_owned());
    roots.sort();
    assert!(WITH_ROOMS.iter().all(|root| roots.iter().any(|other| other == root)), "{roots:?}");
    roots
}

fn sources() -> Vec<(PathBuf, String)> {
    roots().iter().flat_map(|root| sources_of(root)).collect()
}

/// The sources below a root, by their paths from there.
fn sources_of(root: &str) -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(root);
    let mut found = Vec::new();
    let mut open = vec![root.clone()];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = fs::read_to_string(&path).unwrap();
                found.push((path.strip_prefix(&root).unwrap().to_owned(), text));
            }
        }
    }
    found
}

fn room(path: &Path) -> String {
    let first = path.components().next().unwrap().as_os_str().to_string_lossy();
    first.trim_end_matches(".rs").to_owned()
}

fn is_test(path: &Path) -> bool {
    let name = path.file_stem().unwrap().to_string_lossy();
    matches!(
        &*name,
        "tests" | "test_database" | "rebuild_equals_live" | "slices_equal_direct_writes" | "laws" | "golden"
    ) || path
        .components()
        .any(|part| part.as_os_str() == "tests" || part.as_os_str() == "rebuild_equals_live")
}

#[test]
fn a_room_imports_only_from_rooms_below_it() {
    let level: BTreeMap<&str, usize> = LAYERS
        .iter()
        .enumerate()
        .flat_map(|(depth, rooms)| rooms.iter().map(move |room| (*room, depth)))
        .collect();
    let mut wrong = Vec::new();
    for (path, text) in WITH_ROOMS.into_iter().flat_map(sources_of) {
        if is_test(&path) {
            continue;
        }
        let from = room(&path);
        let Some(from_level) = level.get(from.as_str()) else {
            assert_eq!(from, "lib", "{} is in no layer: add it to LAYERS", path.display());
            continue;
        };
        for name in
            ["crate::", "revisit::", "revisit_core::"].iter().flat_map(|prefix| text.split(prefix).skip(1))
        {
            let to: String = name.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
            if to != from && level.get(to.as_str()).is_some_and(|to_level| to_level <= from_level) {
                wrong.push(format!("{}: {from} imports {to}", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn files_are_small_and_their_first_line_names_the_concept() {
    let mut lines: Vec<usize> = Vec::new();
    for (path, text) in sources() {
        let count = text.lines().count();
        assert!(
            count <= LINES_MAX || is_test(&path),
            "{} has {count} lines: it is two concepts",
            path.display()
        );
        assert!(text.starts_with("//!"), "{} does not say what it is", path.display());
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        assert!(!["util", "utils", "helpers", "common", "misc"].contains(&&*name), "{}", path.display());
        lines.push(count);
    }
    lines.sort_unstable();
    let median = lines[lines.len() / 2];
    assert!(median <= MEDIAN_LINES_MAX, "the median file has {median} lines");
}

#[test]
fn contributing_states_these_sizes() {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("CONTRIBUTING.md")).unwrap();
    let stated =
        format!("at most {LINES_MAX} lines, tests apart, and the median file at most {MEDIAN_LINES_MAX}");
    assert!(text.contains(&stated), "CONTRIBUTING.md does not say: {stated}");
}

#[test]
fn the_core_does_no_io_and_knows_no_clock_no_json_and_no_async() {
    for (path, text) in sources_of("crates/core/src") {
        // A vocabulary is read from a file.
        if room(&path) == "vocabulary" || is_test(&path) {
            continue;
        }
        for forbidden in [
            "std::fs",
            "std::net",
            "std::time",
            "std::env",
            "tokio",
            "serde_json",
            "rmp_serde",
            "sqlx",
            "reqwest",
            "axum",
            "async ",
        ] {
            assert!(!text.contains(forbidden), "{} uses {forbidden}", path.display());
        }
    }
}

#[test]
fn no_files_of_a_room_import_each_other_in_a_circle() {
    let mut wrong = Vec::new();
    for root in roots() {
        let files = sources_of(&root);
        let code = files.iter().filter(|(path, _)| !is_test(path));
        let graph = import_graph(code.map(|(path, text)| (path.as_path(), text.as_str())));
        for circle in circles(&graph) {
            let inside = circle.iter().map(|file| {
                let imported = graph[file].iter().filter(|other| circle.contains(other));
                format!("{root}/{file} -> {}", imported.cloned().collect::<Vec<_>>().join(", "))
            });
            wrong.push(inside.collect::<Vec<_>>());
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
