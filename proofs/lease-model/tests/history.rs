//! Windows that one map could have had are linearizable, and others are not.

use revisit_lease_model::history::{Window, read};

fn one(lines: &str) -> Window {
    read(lines).expect("a window").pop().expect("one")
}

#[test]
fn a_window_is_linearizable_if_and_only_if_one_map_could_have_had_it() {
    let cases = [
        ("w 0 1 5\nw 2 3 6\nr 4 5 6", true),
        // Both are under way at once: either may be first, and a read between them sees one of them.
        ("w 0 9 6\nw 0 9 5\nr 3 4 5", true),
        ("w 0 9 6\nw 0 9 5\nr 3 4 6\nr 5 6 6", true),
        // They touch.
        ("w 0 1 6\nw 1 2 5", true),
        // A read that is older than one before it, than a write before it, or newer than a write after it.
        ("w 0 9 5\nr 1 2 5\nr 3 4 4", false),
        ("w 0 1 5\nr 2 3 4", false),
        ("r 0 1 5\nw 2 3 5", false),
        // Twice the same, a gap, and the wrong order.
        ("w 0 9 5\nw 0 9 5", false),
        ("w 0 1 6", false),
        ("w 0 1 6\nw 2 3 5", false),
    ];
    for (operations, is_linearizable) in cases {
        assert_eq!(
            one(&format!("window m 4\n{operations}")).is_linearizable(),
            is_linearizable,
            "{operations}"
        );
    }
}

#[test]
fn lines_that_are_no_window_are_named() {
    for (lines, line) in
        [("w 0 1 5", 1), ("window m 4\nw 1 0 5", 2), ("window m x", 1), ("window m 4\n\nw 0 1", 2)]
    {
        let error = read(lines).expect_err(lines);
        assert!(error.starts_with(&format!("line {line}:")), "{error}");
    }
}
