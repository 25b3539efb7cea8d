//! Recordings are read in every compression, and faults are reported with their line.

use std::io::{Cursor, Write as _};

use serde_json::json;

use super::*;

const THREE_LINES: &str = r#"{"op":"map","id":"tower","body":{"metric":true}}
{"op":"keyframe","id":"kf-1","body":{"stamp":{"sec":1,"nanosec":0}},"note":"passed over"}

{"op":"query","keyframe":"kf-1","truth":[],"ignore":["kf-0"]}
"#;

fn read(bytes: impl Into<Vec<u8>>) -> Vec<Result<Line, String>> {
    let recording = Recording::new(Cursor::new(bytes.into()), 1000).expect("a reader");
    recording.map(|line| line.map_err(|error| error.to_string())).collect()
}

fn three_lines() -> Vec<Result<Line, String>> {
    let body = |value: Value| value.as_object().expect("an object").clone();
    let line = |number, op| Ok(Line { number, map: "tower".to_owned(), op });
    vec![
        line(1, Op::Map { id: "tower".to_owned(), body: body(json!({"metric": true})) }),
        line(
            2,
            Op::Keyframe { id: "kf-1".to_owned(), body: body(json!({"stamp": {"sec": 1, "nanosec": 0}})) },
        ),
        line(
            4,
            Op::Query {
                keyframe: "kf-1".to_owned(),
                body: Body::new(),
                truth: Some(vec![]),
                ignore: vec!["kf-0".to_owned()],
            },
        ),
    ]
}

fn gzip(text: &str) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(text.as_bytes()).expect("memory");
    encoder.finish().expect("memory")
}

#[test]
fn plain_gzip_and_zstd_are_told_apart_by_their_first_bytes() {
    assert_eq!(read(THREE_LINES), three_lines());
    assert_eq!(read(gzip(THREE_LINES)), three_lines());
    let zstd = zstd::encode_all(THREE_LINES.as_bytes(), 1).expect("memory");
    assert_eq!(read(zstd), three_lines());
}

#[test]
fn a_gzip_file_of_several_members_is_read_to_its_end() {
    let (head, tail) = THREE_LINES.split_at(60);
    assert_eq!(read([gzip(head), gzip(tail)].concat()), three_lines());
}

#[test]
fn the_last_line_may_lack_its_newline_and_an_empty_file_has_no_line() {
    assert_eq!(read(THREE_LINES.trim_end()), three_lines());
    assert_eq!(read(""), []);
    assert_eq!(read("\n \r\n"), []);
}

#[test]
fn a_line_belongs_to_the_map_it_names_or_else_to_the_last_map_line() {
    let lines = read(
        r#"{"op":"loop","map":"early","body":{}}
{"op":"map","id":"a"}
{"op":"map","id":"b"}
{"op":"loop","body":{}}
{"op":"poses","map":"a","body":{}}
{"op":"loop","body":{}}"#,
    );
    let maps: Vec<_> = lines.into_iter().map(|line| line.expect("an operation").map).collect();
    assert_eq!(maps, ["early", "a", "b", "b", "a", "b"]);
}

#[test]
fn a_fault_names_its_line_and_ends_the_recording() {
    let check = |text: &str, expected: &str| {
        let lines =
            read(format!("{{\"op\":\"map\",\"id\":\"m\"}}\n{text}\n{{\"op\":\"map\",\"id\":\"n\"}}\n"));
        assert_eq!(lines.len(), 2, "{text}");
        let error = lines[1].as_ref().expect_err(text);
        assert!(error.starts_with("line 2: "), "{error}");
        assert!(error.contains(expected), "{text}: {error}");
    };
    check("{\"op\":", "EOF while parsing");
    check("[]", "invalid type");
    check("{\"id\":\"kf-1\",\"body\":{}}", "missing field `op`");
    check("{\"op\":\"keyfrme\"}", "unknown variant `keyfrme`, expected one of `map`, `keyframe`");
    check("{\"op\":\"keyframe\",\"body\":{}}", "missing field `id`");
    check("{\"op\":\"keyframe\",\"id\":\"k\"}", "missing field `body`");
    check("{\"op\":\"query\",\"keyframe\":\"k\",\"truth\":\"kf-1\"}", "expected a sequence");
    check("{\"op\":\"loop\",\"body\":3}", "expected a map");
    check(&"x".repeat(1001), "longer than 1000 bytes");
    check("\u{0}", "expected value (column 1)");
}

#[test]
fn a_line_of_just_the_allowed_length_is_read() {
    let text = format!("{:1000}\n{{\"op\":\"map\",\"id\":\"n\"}}", "{\"op\":\"map\",\"id\":\"m\"}");
    let maps: Vec<_> = read(text).into_iter().map(|line| line.expect("an operation").map).collect();
    assert_eq!(maps, ["m", "n"]);
}

#[test]
fn a_byte_order_mark_is_no_part_of_a_recording_and_utf_16_is_told() {
    assert_eq!(read(format!("\u{feff}{THREE_LINES}")), read(THREE_LINES));
    let wide: Vec<u8> = "\u{feff}{}".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let lines = read(wide);
    assert!(lines[0].as_ref().is_err_and(|error| error.contains("UTF-16")), "{lines:?}");
}

#[test]
fn a_keyframe_before_any_map_belongs_nowhere() {
    let lines = read(r#"{"op":"keyframe","id":"kf-1","body":{}}"#);
    let error = lines[0].as_ref().expect_err("no map");
    assert!(error.starts_with("line 1: belongs to no map"), "{error}");
}

#[test]
fn a_file_cut_in_the_middle_is_an_error_after_the_lines_that_are_whole() {
    let whole = gzip(THREE_LINES);
    let lines = read(&whole[..whole.len() - 4]);
    assert!(lines.last().is_some_and(Result::is_err), "{lines:?}");
    let long = THREE_LINES.repeat(50_000);
    let zstd = zstd::encode_all(long.as_bytes(), 1).expect("memory");
    let lines = read(&zstd[..zstd.len() / 2]);
    let error = lines.last().expect("lines").as_ref().expect_err("cut");
    assert!(error.contains("cannot be read"), "{error}");
}

#[test]
fn a_delete_line_names_one_thing() {
    let deleted = |line: &str| match read(line).remove(0) {
        Ok(Line { op: Op::Delete(deleted), .. }) => Ok(deleted),
        Ok(other) => panic!("{other:?}"),
        Err(error) => Err(error),
    };
    let keyframe = "kf-1".to_owned();
    assert_eq!(
        deleted(r#"{"op":"delete","map":"m","keyframe":"kf-1"}"#),
        Ok(Deleted::Keyframe(keyframe.clone()))
    );
    assert_eq!(
        deleted(r#"{"op":"delete","map":"m","keyframe":"kf-1","detection":2}"#),
        Ok(Deleted::Anchor { keyframe, detection: 2 })
    );
    assert_eq!(deleted(r#"{"op":"delete","map":"m","loop":"l1"}"#), Ok(Deleted::Loop("l1".to_owned())));
    for bad in [
        r#"{"op":"delete","map":"m"}"#,
        r#"{"op":"delete","map":"m","detection":2}"#,
        r#"{"op":"delete","map":"m","keyframe":"kf-1","loop":"l1"}"#,
        r#"{"op":"delete","map":"m","keyframe":"kf-1","detection":-1}"#,
    ] {
        let error = deleted(bad).expect_err(bad);
        assert!(error.starts_with("line 1"), "{error}");
    }
}
