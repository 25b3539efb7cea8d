//! The documents: every path that they name is there.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use regex::Regex;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// The documents of this repository whose paths are all of its own; those of the clients name other programs' files, too.
fn documents() -> Vec<PathBuf> {
    let folders = ["", "docs", "proofs", "crates/core"].map(|folder| root().join(folder));
    let files = folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap());
    let paths = files.map(|entry| entry.unwrap().path());
    let is_one = |path: &PathBuf| {
        let told_of_the_past = path.ends_with("CHANGELOG.md");
        path.extension().is_some_and(|extension| extension == "md") && !told_of_the_past
    };
    paths.filter(is_one).collect()
}

/// The places from which a document may name a path: the root, the document's folder, the sources of any crate, or, where the path
/// begins with the name of a crate, its sources.
fn places(document: &Path, named: &str) -> Vec<PathBuf> {
    let (first, rest) = named.split_once('/').unwrap_or((named, ""));
    let beside = document.parent().unwrap().join(named);
    let crates = fs::read_dir(root().join("crates"))
        .unwrap()
        .map(|entry| entry.unwrap().path().join("src").join(named));
    let of_crate = root().join("crates").join(first).join("src").join(rest);
    [root().join(named), beside, root().join("src").join(named), of_crate].into_iter().chain(crates).collect()
}

#[test]
fn every_path_that_a_document_names_is_there() {
    let quoted = Regex::new(r"`([A-Za-z0-9_.-]+(?:/[A-Za-z0-9_.-]+)*/?)`").unwrap();
    let ours = ["rs", "py", "sql", "md", "toml", "yml", "yaml", "html", "js", "css", "hpp", "cpp"];
    let folders = fs::read_dir(root()).unwrap().map(|entry| entry.unwrap().file_name());
    let folders: BTreeSet<String> = folders.filter_map(|name| name.into_string().ok()).collect();
    let (mut looked_at, mut wrong) = (0, Vec::new());
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        for named in quoted.captures_iter(&text).map(|found| found[1].to_owned()) {
            let first = named.split('/').next().unwrap_or_default();
            let is_of_ours =
                Path::new(&named).extension().is_some_and(|extension| ours.iter().any(|of| extension == *of));
            // One whose name begins with a dot is the reader's to write.
            let is_the_readers = named.rsplit('/').next().is_some_and(|name| name.starts_with('.'));
            if is_the_readers || !named.contains('/') || !(is_of_ours || folders.contains(first)) {
                continue;
            }
            looked_at += 1;
            if !places(&document, &named).iter().any(|path| path.exists()) {
                wrong.push(format!("{}: {named}", document.display()));
            }
        }
    }
    assert!(looked_at > 200, "{looked_at} paths");
    assert!(wrong.is_empty(), "{wrong:#?}");
}
