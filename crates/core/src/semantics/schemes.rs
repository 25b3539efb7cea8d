//! Golden tables: ways in which real buildings number their doors, each with its source.

use super::{Text, conflict, similarity};

/// The schemes with their pairs; its head explains the marks.
const SCHEMES: &str = include_str!("schemes.txt");

/// Fewer pairs mean that the table was not read.
const PAIRS_MIN: usize = 600;

#[test]
fn names_of_every_scheme_are_compared_part_by_part() {
    let (mut source, mut pairs, mut failures) = ("", 0, Vec::new());
    for line in SCHEMES.lines().skip_while(|line| !line.starts_with("# ")) {
        if let Some(scheme) = line.strip_prefix("# ") {
            source = scheme;
            continue;
        }
        let Some((mark, pair)) = line.split_once(' ') else { continue };
        let (a, b) = pair.split_once(" | ").expect("a pair");
        pairs += 1;
        for (a, b) in [(a, b), (b, a)] {
            let (a, b) = (Text::parse(a), Text::parse(b));
            let (judged, excludes) = (similarity(&a, &b), conflict(&a, &b).is_some());
            let holds = match mark {
                "=" => judged.level >= 4 && !excludes,
                "!" => judged.level == 1 && excludes,
                "?" => judged.level <= 3 && !excludes,
                _ => false,
            };
            if !holds {
                failures.push(format!("{line}: level {}, {} ({source})", judged.level, judged.reason));
            }
        }
    }
    assert!(pairs >= PAIRS_MIN, "{pairs} pairs");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
