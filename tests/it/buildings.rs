//! `revisit eval buildings`: small buildings of many kinds, played and recorded.

use std::process::{Command, Output};

fn eval(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_revisit"));
    command.args(["eval", "buildings"]).args(arguments).output().unwrap()
}

fn printed(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

#[test]
fn a_world_plays_alike_each_time_and_finds_returns() {
    let arguments = ["--worlds", "1", "--kinds", "wings,bare"];
    let first = printed(&eval(&arguments));
    assert_eq!(first, printed(&eval(&[&arguments[..], &["--jobs", "1"]].concat())));
    for kind in ["wings", "bare", "all"] {
        let row =
            first.lines().find(|line| line.starts_with(kind)).unwrap_or_else(|| panic!("{kind}: {first}"));
        let figures: Vec<f64> = row.split_whitespace().skip(1).filter_map(|cell| cell.parse().ok()).collect();
        let [_, queries, right, ..] = figures[..] else { panic!("{row}") };
        assert!(queries >= 150.0 && right >= 10.0, "{row}");
    }
    assert!(first.contains("where am I?"), "{first}");
}

#[test]
fn worlds_are_recorded_for_replay_and_kinds_for_reporting_are_not_played_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    printed(&eval(&["--worlds", "1", "--kinds", "lift", "--record", path]));
    let mut replay = Command::new(env!("CARGO_BIN_EXE_revisit"));
    let replayed =
        replay.arg("replay").arg("--json").arg(folder.path().join("lift-0.ndjson")).output().unwrap();
    let report: serde_json::Value = serde_json::from_str(&printed(&replayed)).unwrap();
    assert!(report["keyframes"].as_u64().is_some_and(|keyframes| keyframes >= 150), "{report}");
    assert!(report["correct"].as_u64().is_some_and(|correct| correct > 0), "{report}");
    for kind in ["railings", "castles"] {
        let refused = eval(&["--kinds", kind]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&refused.stderr).contains("wings, notices"));
    }
}
