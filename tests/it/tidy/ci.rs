//! What `.ci/run` says of itself: the limit of its time is one, and every path that it compares exists.

use std::fs;
use std::path::Path;

use regex::Regex;

fn read(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect(path)
}

/// Returns what a pattern's only group holds, at each place where it matches.
fn found<'a>(pattern: &str, text: &'a str) -> Vec<&'a str> {
    let pattern = Regex::new(pattern).expect("a pattern");
    pattern.captures_iter(text).map(|groups| groups.get(1).expect("a group").as_str()).collect()
}

#[test]
fn contributing_and_the_workflow_state_the_limit_of_the_script() {
    let script = read(".ci/run");
    let [limit_min] = found(r"(?m)^readonly LIMIT_MIN=(\d+)$", &script)[..] else { panic!("one limit") };
    let stated = format!("fails above {limit_min} minutes");
    assert!(read("CONTRIBUTING.md").contains(&stated), "CONTRIBUTING.md does not say: {stated}");
    let workflow = read(".github/workflows/ci.yml");
    let jobs = found(r"(?m)^    (runs-on): ", &workflow).len();
    assert_eq!(found(r"(?m)^    timeout-minutes: (\d+)$", &workflow), vec![limit_min; jobs]);
}

#[test]
fn every_path_that_the_script_compares_exists() {
    let script = read(".ci/run");
    // An argument that holds a variable is checked by the script itself.
    let compared = found(r#"\bif !? ?changed ([^;"]+);"#, &script);
    let proofs = found(r"(?m)^ *proof ([a-z-]+) \d+", &script);
    assert!(compared.len() > 3 && proofs.len() > 10, "{compared:?} {proofs:?}");
    let paths = compared.iter().flat_map(|paths| paths.split_whitespace()).map(str::to_owned);
    let paths = paths.chain(proofs.iter().map(|name| format!("proofs/{name}")));
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let missing: Vec<String> = paths.filter(|path| !root.join(path).exists()).collect();
    assert!(missing.is_empty(), "{missing:#?}");
}
