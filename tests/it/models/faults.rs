//! Faults: a model that fails in every way that servers do fails no request, makes no false loop, and is asked again.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::{Value, json};

use super::scene::{crop, described, hear, keyframe, put, put_paintings, put_plates, server_with_map};
use super::stub::{Asked, Reply, Stub, completion, level};
use crate::support::Server;

const BOAT: &str = "a painting of a small red boat on a stormy sea";
const SHIP: &str = "a picture of a red sailing ship in a storm";

fn raw(status: u16, headers: &[(&'static str, &'static str)], body: &str) -> Reply {
    Reply::Raw { status, headers: headers.to_vec(), body: body.to_owned() }
}

/// Every way to fail that the issue names, and some more.
fn faults() -> Vec<(&'static str, Reply)> {
    let refusal = json!({"choices": [{"index": 0, "finish_reason": "stop",
        "message": {"role": "assistant", "content": null, "refusal": "I cannot help with that."}}]});
    let cut = json!({"choices": [{"index": 0, "finish_reason": "length",
        "message": {"role": "assistant", "content": "{\"level\": 5"}}]});
    vec![
        ("429 with retry-after", raw(429, &[("retry-after", "0")], "{}")),
        ("429 with a long retry-after", raw(429, &[("retry-after", "86400")], "{}")),
        ("429 without retry-after", raw(429, &[], "{}")),
        ("500", raw(500, &[], "{}")),
        ("503", raw(503, &[], "")),
        ("401", raw(401, &[], "{\"error\": \"no key\"}")),
        ("a redirect", raw(307, &[("location", "http://127.0.0.1:1/")], "")),
        ("no answer in time", Reply::Hang),
        ("truncated JSON", raw(200, &[], "{\"choices\": [{\"message\": {\"content\": \"{\\\"lev")),
        ("prose", Reply::Say("I would rate them 5 out of 5, they are surely the same.".to_owned())),
        ("6", Reply::Say("6".to_owned())),
        ("{\"level\": 6}", Reply::Say("{\"level\": 6}".to_owned())),
        ("empty choices", raw(200, &[], "{\"choices\": []}")),
        ("a refusal", raw(200, &[], &refusal.to_string())),
        ("an answer cut short", raw(200, &[], &cut.to_string())),
        (
            "another content type",
            raw(200, &[("content-type", "text/html")], &completion("{\"level\": 5}").to_string()),
        ),
        ("a dropped connection", Reply::Drop),
        ("no content", raw(200, &[], "{\"choices\": [{\"message\": {}}]}")),
        ("a list", raw(200, &[], "[]")),
    ]
}

const IMPATIENT: [&str; 4] = ["--model-text-timeout-ms", "200", "--model-vision-timeout-ms", "200"];

#[tokio::test(flavor = "multi_thread")]
async fn no_request_fails_and_the_built_in_judge_stands_in() {
    for (name, fault) in faults() {
        let stub = Stub::start(move |_| fault.clone()).await;
        let flags = [&IMPATIENT[..], &["--model-retries", "1"]].concat();
        let server = Server::with_models(stub.choice(&flags)).await;
        let pair = json!({"a": BOAT, "b": SHIP, "class": "painting"});
        let built_in = Server::start().await.post("/v1/semantics/similarity", &pair).await.expect(200);
        let answer = server.post("/v1/semantics/similarity", &pair).await.expect(200);
        assert_eq!(
            (&answer["degraded"], &answer["cached"]),
            (&json!(true), &json!(false)),
            "{name}: {answer}"
        );
        assert_eq!(
            (&answer["level"], &answer["source"]),
            (&built_in["level"], &built_in["source"]),
            "{name}"
        );
        let one = json!({"text": BOAT});
        let answer = server.post("/v1/semantics/information", &one).await.expect(200);
        assert_eq!(answer["degraded"], true, "{name}: {answer}");
        // "6" and prose are texts that could be merged; they invent, lose or say nothing, and do not stand.
        let merged = server.post("/v1/semantics/merge", &pair).await.expect(200);
        let text = merged["text"].as_str().unwrap();
        assert!(
            merged["degraded"] == true || text.contains("boat") || !text.contains('6'),
            "{name}: {merged}"
        );
        assert!(stub.calls() >= 1, "{name}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn errors_are_not_kept_and_what_was_degraded_is_asked_again() {
    for (name, fault) in faults() {
        let failing = Arc::new(fault);
        let stub = Stub::start(move |_| (*failing).clone()).await;
        let flags = [&IMPATIENT[..], &["--model-retries", "1"]].concat();
        let server = server_with_map(stub.choice(&flags)).await;
        put_paintings(&server, BOAT, SHIP).await;
        let ask =
            async || server.post("/v1/maps/m/loop-queries", &json!({"keyframe": "kf-2"})).await.expect(200);
        let before = ask().await;
        assert_ne!(before["verdict"], "loop", "{name}: {before}");
        // The model comes to its senses, and the map's open pair is judged though nobody asks.
        stub.script(|_| level(5));
        let events = hear(&server, "m", |event| event["event"] == "anchors_matched").await;
        assert!(events.iter().all(|event| event["event"] != "loop_found"), "{name}: {events:?}");
        let verdict = ask().await;
        assert_eq!(verdict["verdict"], "loop", "{name}: {verdict}");
        assert_eq!(verdict["candidates"][0]["anchors"]["matches"][0]["source"], "model:stub");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn while_the_model_is_away_verdicts_say_so_and_wait_for_nobody() {
    let stub = Stub::start(|_| raw(500, &[], "")).await;
    let flags = ["--model-retries", "0", "--model-breaker-failures", "1"];
    let server = server_with_map(stub.choice(&flags)).await;
    put_plates(&server).await;
    // With every write the answer may change, until the map knows that it waits for a model that is away.
    let query = json!({"keyframe": "kf-2", "max_wait_ms": 60000});
    let verdict = server.post("/v1/maps/m/loop-queries", &query).await.expect(200);
    assert_eq!((&verdict["verdict"], &verdict["degraded"]), (&json!("undecided"), &json!(true)), "{verdict}");
    assert_eq!(verdict["candidates"][0]["reason"]["code"], "llm_unavailable");
    let again = server.post("/v1/maps/m/loop-queries", &query).await.expect(200);
    assert_eq!(again["degraded"], true);
    let usage = server.get("/v1/usage").await.expect(200);
    assert_eq!(usage["away"], true, "{usage}");

    stub.script(|asked: &Asked| match asked.what {
        "look" => Reply::Say("901".to_owned()),
        _ => level(3),
    });
    hear(&server, "m", |event| event["event"] == "loop_found").await;
    let query = json!({"keyframe": "kf-2", "max_wait_ms": 60000});
    let verdict = server.post("/v1/maps/m/loop-queries", &query).await.expect(200);
    assert_eq!(verdict["verdict"], "loop", "{verdict}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_plate_that_the_model_failed_to_read_makes_no_loop_of_what_agrees_beside_it() {
    let stub = Stub::start(|_| raw(500, &[], "")).await;
    let flags = ["--model-retries", "0", "--model-breaker-failures", "2"];
    let server = server_with_map(stub.choice(&flags)).await;
    // Two lobbies with one board; the plate beside it, in the middle of the picture, would read 901 and 910.
    for (name, sec, x, colour) in [("kf-1", 1, 0.0, [255, 0, 0]), ("kf-2", 90, 50.0, [0, 0, 255])] {
        let board = described("sign", [x + 1.0, 0.0, 2.0], "HUB 04");
        let plate = crop("door_number", [x, 0.0, 1.0], colour);
        put(&server, "m", name, &keyframe(sec, x, &[board, plate])).await;
    }
    let ask = async |wait: u64| {
        let query = json!({"keyframe": "kf-2", "max_wait_ms": wait});
        server.post("/v1/maps/m/loop-queries", &query).await.expect(200)
    };
    let at_once = ask(0).await;
    assert_eq!(at_once["verdict"], "undecided", "{at_once}");
    let away = ask(60_000).await;
    assert_eq!((&away["verdict"], &away["degraded"]), (&json!("undecided"), &json!(true)), "{away}");
    assert_eq!(away["candidates"][0]["reason"]["code"], "llm_unavailable");
    // Back, it reads both plates: they contradict each other.
    let red = super::worker::sent([255, 0, 0]);
    stub.script(move |asked| {
        Reply::Say(if asked.body.to_string().contains(&red) { "901" } else { "910" }.to_owned())
    });
    hear(&server, "m", |event| event["detail"] == "901").await;
    hear(&server, "m", |event| event["detail"] == "910").await;
    let read = ask(0).await;
    assert_eq!(
        (&read["verdict"], &read["candidates"][0]["reason"]["code"]),
        (&json!("no_loop"), &json!("contradiction")),
        "{read}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_call_that_failed_in_passing_is_made_again_after_the_pause_that_was_asked_for() {
    for (name, fault) in [
        ("429", raw(429, &[("retry-after", "0")], "")),
        ("500", raw(500, &[], "")),
        ("dropped", Reply::Drop),
        ("truncated", raw(200, &[], "{\"choices\"")),
    ] {
        let count = Arc::new(AtomicUsize::new(0));
        let stub =
            Stub::start(
                move |_| if count.fetch_add(1, Ordering::SeqCst) == 0 { fault.clone() } else { level(5) },
            )
            .await;
        let server = Server::with_models(stub.choice(&[])).await;
        let pair = json!({"a": BOAT, "b": SHIP});
        let answer = server.post("/v1/semantics/similarity", &pair).await.expect(200);
        assert_eq!((&answer["level"], &answer["degraded"]), (&json!(5), &json!(false)), "{name}: {answer}");
        assert_eq!(stub.calls(), 2, "{name}");
    }
    // What will not pass is not tried again.
    let stub = Stub::start(|_| raw(401, &[], "")).await;
    let server = Server::with_models(stub.choice(&[])).await;
    server.post("/v1/semantics/similarity", &json!({"a": BOAT, "b": SHIP})).await.expect(200);
    assert_eq!(stub.calls(), 1);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_model_that_is_away_is_left_alone() {
    let stub = Stub::start(|_| raw(500, &[], "")).await;
    let flags =
        ["--model-retries", "0", "--model-breaker-failures", "3", "--model-breaker-pause-ms", "3600000"];
    let server = Server::with_models(stub.choice(&flags)).await;
    for n in 0..20 {
        let motif = ["castle", "lighthouse", "orchard", "violin", "falcon"][n % 5];
        let pair = json!({"a": format!("a {motif} at dawn"), "b": format!("{SHIP} beside a {motif}"), "class": format!("c{n}")});
        let answer = server.post("/v1/semantics/similarity", &pair).await.expect(200);
        assert_eq!(answer["degraded"], true);
    }
    assert_eq!(stub.calls(), 3);
    let metrics =
        server.request(reqwest::Method::GET, "/metrics").send().await.unwrap().text().await.unwrap();
    assert!(metrics.contains("revisit_models_away 1"), "{metrics}");
    let _: Value = server.get("/v1/usage").await.expect(200);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_client_waits_less_long_than_a_call_may_take() {
    let stub = Stub::start(|_| Reply::Hang).await;
    // A call may take an hour: without a limit of its own the request would hang.
    let flags = ["--model-text-timeout-ms", "3600000", "--model-client-timeout-ms", "100"];
    let server = Server::with_models(stub.choice(&flags)).await;
    let answer = server.post("/v1/semantics/similarity", &json!({"a": BOAT, "b": SHIP})).await.expect(200);
    assert_eq!((&answer["source"], &answer["degraded"]), (&json!("lexical"), &json!(true)), "{answer}");
}
