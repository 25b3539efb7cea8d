//! A recording is replayed against a stub of the service, and its answers are scored.

use std::sync::{Arc, Mutex};

use axum::body::Bytes;
use axum::http::{Method, StatusCode, Uri};
use axum::response::{IntoResponse, Response};
use axum::{Json, Router};
use clap::{CommandFactory as _, Parser};
use serde_json::{Value, json};
use tokio::net::TcpListener;

use super::*;
use crate::api::examples;

#[derive(Parser)]
struct CommandLine {
    #[command(flatten)]
    args: ReplayArgs,
}

/// The requests received by a stub.
type Seen = Arc<Mutex<Vec<(String, Value)>>>;

/// Stops the stub with the value that `OwnServer` holds.
struct StopOnDrop(tokio::task::JoinHandle<()>);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.abort();
    }
}

async fn stub(seen: Seen) -> Result<OwnServer, Failure> {
    let handler = move |method: Method, uri: Uri, body: Bytes| {
        let body: Value = serde_json::from_slice(&body).expect("a body");
        let request = format!("{method} {uri}");
        let answer = answer(&request, &body);
        seen.lock().expect("no test panicked").push((request, body));
        std::future::ready(answer)
    };
    let listener = TcpListener::bind("127.0.0.1:0").await?;
    let url = format!("http://{}", listener.local_addr()?);
    let router = Router::new().fallback(handler);
    let running = tokio::spawn(async move {
        axum::serve(listener, router).await.expect("a stub serves");
    });
    Ok(OwnServer::new(url, StopOnDrop(running)))
}

/// Returns the stub's responses: `taken` has another map, `before` already exists, `bad-*` is rejected.
fn answer(request: &str, body: &Value) -> Response {
    let problem = |status: StatusCode, title: &str| {
        (status, Json(json!({"title": title, "status": status.as_u16(), "errors": []}))).into_response()
    };
    match request {
        "PUT /v1/maps/taken" | "PUT /v1/maps/before/keyframes/k2" => {
            problem(StatusCode::CONFLICT, "Conflict")
        }
        "PUT /v1/maps/before" => ([("idempotent-replayed", "true")], Json(examples::map())).into_response(),
        request if request.contains("/before/keyframes/") => {
            ([("idempotent-replayed", "true")], Json(examples::keyframe_answer())).into_response()
        }
        request if request.contains("/bad-") => problem(StatusCode::UNPROCESSABLE_ENTITY, "Bad keyframe"),
        request if request.ends_with("/loop-queries") => Json(loop_answer(body)).into_response(),
        request if request.ends_with("/merge") => Json(examples::sessions_merged()).into_response(),
        request if request.ends_with("/observations") => {
            Json(examples::observations_answer()).into_response()
        }
        request if request.ends_with("/poses") => Json(examples::poses_answer()).into_response(),
        request if request.ends_with("/loops") => Json(examples::loop_closed()).into_response(),
        request if request.contains("/keyframes/") => Json(examples::keyframe_answer()).into_response(),
        _ => (StatusCode::CREATED, Json(examples::map())).into_response(),
    }
}

fn loop_answer(body: &Value) -> Value {
    let candidate = |id: &str, verdict: &str, bow: f64, similarity: f64| {
        let reason =
            json!({"code": "score_below_threshold", "measured": similarity, "limit": 0.3, "detail": ""});
        json!({"keyframe": id, "verdict": verdict, "geometry": {"status": "skipped"},
            "bow": {"score": bow, "common_words": 1, "reference_score": 0.0},
            "anchors": {"similarity": similarity, "threshold": 0.3, "in_query": 1, "in_candidate": 1, "pending": 0,
                "matches": [], "contradictions": []},
            "reason": if verdict == "loop" { Value::Null } else { reason }})
    };
    let (verdict, best, candidates) = match body["keyframe"].as_str() {
        Some("right") => (
            "loop",
            Some("k1"),
            vec![candidate("k1", "loop", 0.2, 0.7), candidate("k9", "rejected", 0.4, 0.1)],
        ),
        Some("wrong") => ("loop", Some("k9"), vec![candidate("k9", "loop", 0.3, 0.5)]),
        Some("missed") => (
            "no_loop",
            None,
            vec![candidate("k1", "rejected", 0.1, 0.2), candidate("k9", "rejected", 0.05, 0.25)],
        ),
        Some("unsure") => ("loop", Some("k5"), vec![candidate("k5", "loop", 0.3, 0.5)]),
        _ => ("undecided", None, Vec::new()),
    };
    let mut answer = json!({"id": "q", "map_version": 1, "verdict": verdict, "best": best, "loops": [],
        "degraded": false, "excluded_covisible": 0, "closed": [], "candidates": candidates});
    if verdict == "undecided" {
        answer["reason"] = json!({"code": "empty_bow", "detail": ""});
    }
    answer
}

const RECORDING: &str = r#"{"op":"map","id":"m","body":{"settings":{"candidates_max":3}}}
{"op":"keyframe","id":"k1","body":{"stamp":1}}
{"op":"query","keyframe":"right","body":{"verify":"auto"},"truth":["k1","k2"]}
{"op":"query","keyframe":"wrong","truth":[]}
{"op":"query","keyframe":"missed","truth":["k1"]}
{"op":"query","keyframe":"unsure","truth":["k1"],"ignore":["k5"]}
{"op":"query","keyframe":"blank","truth":["k1"]}
{"op":"query","keyframe":"right"}
{"op":"loop","body":{"id":"l1","keyframe":"right","candidate":"k1"}}
{"op":"poses","body":{"session":"default"}}
{"op":"observations","body":{"removed":[3]}}
{"op":"merge_sessions","session":"r2","body":{"into":"r1"}}
"#;

/// Replays `recording` with these flags; returns the requests and the result.
async fn play(recording: &str, flags: &[&str]) -> (Vec<(String, Value)>, Result<Report, Failure>) {
    let file = tempfile::NamedTempFile::new().expect("a temporary file");
    std::fs::write(file.path(), recording).expect("a temporary file");
    let path = file.path().to_str().expect("a plain name");
    let command_line = [&["replay", path], flags].concat();
    let args = CommandLine::parse_from(command_line).args;
    let seen = Seen::default();
    let report = replay(&args, async || stub(Arc::clone(&seen)).await).await;
    let requests = seen.lock().expect("no test panicked").clone();
    (requests, report)
}

#[test]
fn the_command_line_is_sound() {
    CommandLine::command().debug_assert();
}

#[tokio::test]
async fn every_line_is_one_request_in_the_order_recorded() {
    let (requests, report) = play(RECORDING, &["--max-wait-ms", "7"]).await;
    report.expect("a score");
    let asked = |request: &str, body: Value| (request.to_owned(), body);
    assert_eq!(requests.len(), 12);
    assert_eq!(requests[0], asked("PUT /v1/maps/m", json!({"settings": {"candidates_max": 3}})));
    assert_eq!(requests[1], asked("PUT /v1/maps/m/keyframes/k1", json!({"stamp": 1})));
    let query = json!({"keyframe": "right", "verify": "auto", "max_wait_ms": 7});
    assert_eq!(requests[2], asked("POST /v1/maps/m/loop-queries", query));
    assert_eq!(requests[8].0, "POST /v1/maps/m/loops");
    assert_eq!(requests[9], asked("POST /v1/maps/m/poses", json!({"session": "default"})));
    assert_eq!(requests[10], asked("POST /v1/maps/m/observations", json!({"removed": [3]})));
    assert_eq!(requests[11], asked("POST /v1/maps/m/sessions/r2/merge", json!({"into": "r1"})));
}

#[tokio::test]
async fn the_json_has_the_documented_keys_and_the_score_worked_out_by_hand() {
    let (_, report) = play(RECORDING, &["--explain"]).await;
    let json: Value = serde_json::from_str(&report.expect("a score").to_json()).expect("JSON");
    let check = |pointer: &str, expected: Value| {
        assert_eq!(json.pointer(pointer), Some(&expected), "{pointer}: {json:#}");
    };
    check("/queries", json!(6));
    // right and wrong; "unsure" named an ignored keyframe, and the last is not labelled.
    check("/accepted", json!(2));
    check("/correct", json!(1));
    check("/precision", json!(0.5));
    // right, missed and blank have a true loop and are scored.
    check("/with_truth", json!(3));
    check("/recall", json!(1.0 / 3.0));
    check("/undecided", json!(1));
    check("/ignored", json!(1));
    check("/unlabelled", json!(1));
    // BoW alone: right -> k9 (0.4, false), wrong -> k9 (0.3, false), missed -> k1 (0.1, true).
    check("/bow_only/precision", json!(1.0 / 3.0));
    check("/bow_only/recall", json!(1.0 / 3.0));
    check("/bow_only/best_f1/threshold", json!(0.1));
    check("/bow_only/best_f1/precision", json!(1.0 / 3.0));
    check("/bow_only/best_f1/recall", json!(1.0 / 3.0));
    check("/bow_only/recall_at_precision_1", json!(0.0));
    check("/reasons/queries", json!({"score_below_threshold": 1, "empty_bow": 1}));
    check("/reasons/candidates", json!({"score_below_threshold": 4}));
    check("/false_loops/0/keyframe", json!("wrong"));
    check("/missed/0/nearest_true/keyframe", json!("k1"));
    assert!(json["latency_ms"]["p50"].is_f64() && json["latency_ms"]["p99"].is_f64());
}

#[tokio::test]
async fn the_table_shows_the_same_to_a_person() {
    let (_, report) = play(RECORDING, &["--explain", "--set", "candidates_max=5"]).await;
    let mut report = report.expect("a score");
    report.recording = "tower.ndjson".to_owned();
    let time = |p50, p99| latency::Latency { p50: Some(p50), p99: Some(p99) };
    report.latency_ms = time(1.25, 3.0);
    report.keyframe_latency_ms = time(2.0, 4.0);
    let expected = "\
tower.ndjson: 1 map, 1 keyframe, 1 closed loop, 1 pose correction, 1 change of observations, 1 merge of sessions, 6 queries (3 with a true loop)
with candidates_max=5
1 not scored: best is neither correct nor wrong
1 not scored: the ground truth is unknown

                                      accepted  correct  precision   recall
Revisit                                      2        1      0.500    0.333
BoW alone, every best candidate              3        1      0.333    0.333
BoW alone, best F1 (score >= 0.100)          3        1      0.333    0.333
BoW alone, without false loops                               1.000    0.000

verdicts  4 loop, 1 no_loop, 1 undecided
          1 of all queries, scored or not, include a wrong loop
latency   query p50 1.2 ms, p99 3.0 ms; keyframe write p50 2.0 ms, p99 4.0 ms

why not a loop                         queries  candidates
empty_bow                                    1           0
score_below_threshold                        1           4

false loops: 1
  wrong -> k9 S 0.500 BoW 0.300

with a true loop, not accepted: 2
  missed  no_loop  score_below_threshold 0.250/0.300; k9 S 0.250 BoW 0.050; true k1 S 0.200 BoW 0.100 score_below_threshold 0.200/0.300
  blank  undecided  empty_bow; no candidate
";
    assert_eq!(report.to_string(), expected);
}

#[tokio::test]
async fn nothing_accepted_is_null_in_json_and_not_a_number_in_the_table() {
    let (_, report) = play("{\"op\":\"map\",\"id\":\"m\"}\n", &[]).await;
    let report = report.expect("a score");
    let json: Value = serde_json::from_str(&report.to_json()).expect("JSON");
    assert_eq!(json["precision"], Value::Null);
    assert_eq!(json["recall"], Value::Null);
    assert_eq!(json["bow_only"]["recall_at_precision_1"], Value::Null);
    assert_eq!(json["latency_ms"], json!({"p50": null, "p99": null}));
    assert!(report.to_string().contains("n/a"));
}

#[tokio::test]
async fn the_settings_of_every_map_can_be_changed() {
    let (requests, _) =
        play(RECORDING, &["--paper", "--set", "candidates_max=5,without_anchors=reject"]).await;
    let expected = json!({"settings": {"candidates_max": 5, "without_anchors": "reject",
        "method": "paper"}});
    assert_eq!(requests[0].1, expected);
}

#[tokio::test]
async fn a_refused_keyframe_stops_the_replay_unless_it_is_to_keep_going() {
    let recording = RECORDING.replace("\"id\":\"k1\"", "\"id\":\"bad-1\"");
    let (requests, report) = play(&recording, &[]).await;
    assert_eq!(requests.len(), 2);
    let error = report.expect_err("refused").to_string();
    assert!(error.starts_with("line 2, keyframe bad-1 of m: 422 Bad keyframe"), "{error}");

    let (requests, report) = play(&recording, &["--keep-going"]).await;
    assert_eq!(requests.len(), 12);
    let report = report.expect("a score");
    assert_eq!((report.failed, report.performed.keyframes, report.queries), (1, 0, 6));
}

#[tokio::test]
async fn a_map_with_other_content_is_named_with_the_way_out() {
    let check = async |recording: &str, flags: &[&str]| {
        let (_, report) = play(recording, flags).await;
        let error = report.expect_err("taken").to_string();
        assert!(error.contains("other content") && error.contains("--map-prefix"), "{error}");
    };
    check("{\"op\":\"map\",\"id\":\"taken\"}", &["--keep-going"]).await;
    check("{\"op\":\"map\",\"id\":\"en\"}", &["--map-prefix", "tak"]).await;
    let keyframe = "{\"op\":\"keyframe\",\"id\":\"k2\",\"body\":{}}";
    check(&format!("{{\"op\":\"map\",\"id\":\"before\"}}\n{keyframe}"), &[]).await;
    let (_, report) = play("{\"op\":\"map\",\"id\":\"taken\"}", &["--map-prefix", "new-"]).await;
    report.expect("a score");
}

#[tokio::test]
async fn keyframes_that_were_there_before_are_counted() {
    let recording = "{\"op\":\"map\",\"id\":\"before\"}\n{\"op\":\"keyframe\",\"id\":\"k1\",\"body\":{}}";
    let (_, report) = play(recording, &[]).await;
    let report = report.expect("a score");
    assert_eq!((report.performed.keyframes, report.replayed_keyframes), (1, 1));
}

#[tokio::test]
async fn a_malformed_line_stops_the_replay_after_the_lines_before_it() {
    let (requests, report) =
        play("{\"op\":\"map\",\"id\":\"m\"}\n{\"op\":\"plan\"}\n", &["--keep-going"]).await;
    assert_eq!(requests.len(), 1);
    let error = report.expect_err("malformed").to_string();
    assert!(error.starts_with("line 2: not an operation: unknown variant `plan`"), "{error}");
}

#[tokio::test]
async fn a_given_server_is_used_and_none_is_started() {
    let seen = Seen::default();
    let server = stub(Arc::clone(&seen)).await.expect("a stub");
    let (unused, report) = play(RECORDING, &["--server", server.url()]).await;
    report.expect("a score");
    assert_eq!(unused.len(), 0);
    assert_eq!(seen.lock().expect("no test panicked").len(), 12);
}

#[tokio::test]
async fn a_file_that_is_not_there_is_named() {
    let args = CommandLine::parse_from(["replay", "/nowhere/tower.ndjson"]).args;
    let report = replay(&args, async || Err("not needed".into())).await;
    let error = report.expect_err("no file").to_string();
    assert!(error.starts_with("cannot read /nowhere/tower.ndjson: "), "{error}");
}
