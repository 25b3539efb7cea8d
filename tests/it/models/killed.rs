//! Killed: SIGKILL in the middle of a dialogue; the next process finishes it, and pays nothing twice.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::{Value, json};
use tokio::sync::mpsc;

use super::scene::{HANGS_AFTER, crop, describes, hear_stream, keyframe};
use super::stub::{Asked, Reply, Stub, level};
use crate::crash::server::Server;

/// A dialogue about a painting that takes all its rounds.
fn answer(asked: &Asked) -> Reply {
    let rounds = asked.data["asked"].as_array().map_or(0, Vec::len);
    let text = asked.data.as_str().unwrap_or_default();
    match asked.what {
        "look" => Reply::Say(format!(
            "{} clouds",
            ["dark", "wild", "grey", "tall", "thin"][text.matches("Asked before").count() % 5]
        )),
        "next" => Reply::Say(format!("What else, beside {rounds} things?")),
        "summary" => Reply::Say("a boat under dark and wild clouds".to_owned()),
        _ => level(4),
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_dialogue_that_was_killed_goes_on_and_no_answer_is_paid_for_twice() {
    // Five looks, four questions of the language model, a summary, and how much it tells.
    for killed_at in 1..=11 {
        let directory = tempfile::tempdir().unwrap();
        let database = directory.path().join("revisit.db");
        let (arrived, mut waiting) = mpsc::unbounded_channel();
        let count = AtomicUsize::new(0);
        let stub = Stub::start(move |asked| {
            if count.fetch_add(1, Ordering::SeqCst) + 1 < killed_at {
                return answer(asked);
            }
            arrived.send(()).unwrap();
            Reply::Hang
        })
        .await;
        let flags = ["--model-url", &stub.url(), "--model-name", "stub"];
        let mut server = Server::start_with(&database, &flags);
        server.api().put("/v1/maps/m", &json!({})).await;
        let body = keyframe(1, 0.0, &[crop("painting", [0.0, 0.0, 2.0], [7, 7, 7])]);
        let stored = server.api().put("/v1/maps/m/keyframes/kf-1", &body).await;
        assert!(stored.is_success(), "{}", stored.text());
        waiting.recv().await.expect("the question that nobody will answer");
        server.kill();
        let before: Vec<Value> = stub.journal().into_iter().map(|asked| asked.body).collect();
        let (unanswered, paid) = before.split_last().unwrap();

        stub.script(answer);
        let server = Server::start_with(&database, &flags);
        // Nobody asks for the map but the worker.
        let listen = server.api().request(reqwest::Method::GET, "/v1/maps/m/events?since=0");
        let wanted = |event: &Value| describes("a-0")(event) && event["detail"].is_string();
        hear_stream(listen, wanted).await;
        let mut times: BTreeMap<String, usize> = BTreeMap::new();
        for asked in stub.journal() {
            *times.entry(asked.body.to_string()).or_default() += 1;
        }
        for question in paid {
            assert_eq!(
                times[&question.to_string()],
                1,
                "killed at {killed_at}: {question} was paid for twice"
            );
        }
        assert!(times[&unanswered.to_string()] <= 2, "killed at {killed_at}");
        // How much the text tells is asked after the event, and a call counts once it is answered.
        let counted = async {
            loop {
                let usage = server.api().get("/v1/usage").await.json();
                if usage["calls"].as_u64().is_some_and(|calls| calls >= stub.calls() as u64) {
                    return;
                }
                tokio::task::yield_now().await;
            }
        };
        tokio::time::timeout(HANGS_AFTER, counted).await.expect("every call is counted");
    }
}
