//! Judging: the three functions over HTTP, the built-in judge in front of a model.

use serde_json::{Value, json};

use super::stub::{Asked, Reply, Stub, level};
use crate::support::Server;

const A: &str = "a portrait of a lady with a mysterious smile";
const B: &str = "the Mona Lisa in a golden frame";

async fn similarity(server: &Server, a: &str, b: &str) -> Value {
    let body = json!({"a": a, "b": b, "class": "painting"});
    server.post("/v1/semantics/similarity", &body).await.expect(200)
}

#[tokio::test]
async fn pairs_that_the_built_in_judge_decides_reach_no_model() {
    let stub = Stub::start(|_| level(3)).await;
    let server = Server::with_models(stub.choice(&[])).await;
    for (a, b, expected) in [
        ("901", "901", 5),
        ("room 901", "door 901", 5),
        ("room 901", "room 910", 1),
        ("", "a boat", 1),
        ("901", "A 901", 3),
    ] {
        let answer = similarity(&server, a, b).await;
        assert_eq!(answer["level"], expected, "{a} | {b}: {answer}");
        assert_eq!(answer["degraded"], false);
        assert!(!answer["source"].as_str().unwrap().starts_with("model:"), "{answer}");
    }
    assert_eq!(stub.calls(), 0);
}

#[tokio::test]
async fn a_model_answers_what_is_open_and_the_next_to_ask_gets_it_from_the_cache() {
    let stub = Stub::start(|_| level(5)).await;
    let server = Server::with_models(stub.choice(&[])).await;
    let first = similarity(&server, A, B).await;
    assert_eq!(
        (&first["level"], &first["source"], &first["cached"]),
        (&json!(5), &json!("model:stub"), &json!(false))
    );
    // The same pair the other way round, in other letters.
    let second = similarity(&server, &B.to_uppercase(), A).await;
    assert_eq!((&second["level"], &second["cached"]), (&json!(5), &json!(true)));
    assert_eq!(stub.calls(), 1);
    let asked = &stub.journal()[0];
    assert!(asked.data["a"].as_str() < asked.data["b"].as_str(), "in canonical order: {}", asked.data);
    let usage = server.get("/v1/usage").await.expect(200);
    assert_eq!(
        (&usage["calls"], &usage["input_tokens"], &usage["cache_hits"]),
        (&json!(1), &json!(100), &json!(1))
    );
    assert_eq!(usage["items"][0]["operation"], "similarity");
}

#[tokio::test]
async fn a_4_is_asked_again_the_other_way_round_and_the_lower_counts() {
    for (swapped, expected) in [(4, 4), (5, 4), (2, 2)] {
        let stub = Stub::start(move |asked: &Asked| {
            level(if asked.data["a"].as_str() < asked.data["b"].as_str() { 4 } else { swapped })
        })
        .await;
        let server = Server::with_models(stub.choice(&[])).await;
        assert_eq!(similarity(&server, A, B).await["level"], expected);
        assert_eq!(stub.calls(), 2);
    }
}

#[tokio::test]
async fn information_and_merge_ask_where_words_alone_tell() {
    let stub = Stub::start(|asked: &Asked| match asked.what {
        "merge" => {
            Reply::Say(json!({"text": "the Mona Lisa, a lady who smiles, in a golden frame"}).to_string())
        }
        _ => level(2),
    })
    .await;
    let server = Server::with_models(stub.choice(&[])).await;
    let information =
        async |text: &str| server.post("/v1/semantics/information", &json!({"text": text})).await.expect(200);
    assert_eq!(information("room 901").await["level"], 5);
    assert_eq!(information("EXIT").await["level"], 2);
    assert_eq!(stub.calls(), 0);
    let open = information(A).await;
    assert_eq!((&open["level"], &open["source"]), (&json!(2), &json!("model:stub")));
    let merged = server.post("/v1/semantics/merge", &json!({"a": A, "b": B})).await.expect(200);
    assert_eq!(merged["text"], "the Mona Lisa, a lady who smiles, in a golden frame");
    assert_eq!(merged["source"], "model:stub");
}

#[tokio::test]
async fn a_merged_text_that_invents_or_loses_an_identifier_does_not_stand() {
    for wrong in ["a green door", "room 910, a green door", "room 901, a green door, since 1888"] {
        let stub = Stub::start(move |_| Reply::Say(json!({"text": wrong}).to_string())).await;
        let server = Server::with_models(stub.choice(&[])).await;
        let body = json!({"a": "room 901", "b": "a green door made of oak"});
        let merged = server.post("/v1/semantics/merge", &body).await.expect(200);
        assert_eq!((&merged["source"], &merged["degraded"]), (&json!("lexical"), &json!(false)), "{merged}");
        let text = merged["text"].as_str().unwrap();
        assert!(text.contains("901") && text.contains("oak"), "{text}");
        assert_eq!(stub.calls(), 1);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_hundred_equal_questions_at_once_make_one_call_and_a_restart_makes_none() {
    let stub = Stub::start(|_| level(5)).await;
    let directory = tempfile::tempdir().unwrap();
    let server = Server::with_models_on(directory.path(), stub.choice(&[])).await;
    let body = json!({"a": A, "b": B, "class": "painting"});
    let asked = (0..100).map(|_| server.post("/v1/semantics/similarity", &body));
    for answer in futures_util::future::join_all(asked).await {
        assert_eq!(answer.expect(200)["level"], 5);
    }
    assert_eq!(stub.calls(), 1);
    let usage = server.get("/v1/usage").await.expect(200);
    assert_eq!((&usage["calls"], &usage["cache_hits"]), (&json!(1), &json!(99)));
    server.stop().await;

    let server = Server::with_models_on(directory.path(), stub.choice(&[])).await;
    let again = similarity(&server, A, B).await;
    assert_eq!((&again["level"], &again["cached"]), (&json!(5), &json!(true)));
    assert_eq!(stub.calls(), 1);
    server.stop().await;

    // Another model is another key.
    let server = Server::with_models_on(directory.path(), stub.choice(&["--model-seed", "7"])).await;
    assert_eq!(similarity(&server, A, B).await["cached"], false);
    assert_eq!(stub.calls(), 2);
}

#[tokio::test]
async fn the_daily_budget_is_a_hard_stop_that_a_restart_does_not_lift() {
    let stub = Stub::start(|_| level(5)).await;
    let directory = tempfile::tempdir().unwrap();
    let motifs = ["castle", "lighthouse", "orchard", "violin", "falcon", "glacier", "harbour", "meadow"];
    for (motifs, expected_degraded) in
        [(&motifs[..4], [false, false, true, true]), (&motifs[4..], [true, true, true, true])]
    {
        let server =
            Server::with_models_on(directory.path(), stub.choice(&["--model-daily-calls", "2"])).await;
        for (motif, degraded) in motifs.iter().zip(expected_degraded) {
            let answer = similarity(&server, A, &format!("a lady beside a {motif}")).await;
            assert_eq!(answer["degraded"], degraded, "{motif}: {answer}");
        }
        assert_eq!(stub.calls(), 2);
        let usage = server.get("/v1/usage").await.expect(200);
        assert_eq!((&usage["calls_today"], &usage["daily_calls"]), (&json!(2), &json!(2)));
        assert_eq!(usage["away"], true);
        server.stop().await;
    }
}

#[tokio::test]
async fn money_is_reserved_before_a_call_and_settled_by_what_was_reported() {
    let stub = Stub::start(|_| level(5)).await;
    // 100 tokens at 10 dollars a million, 10 tokens at 30: 1,300 millionths a call.
    let flags = ["--model-input-usd", "10", "--model-output-usd", "30", "--model-daily-usd", "0.03"];
    let server = Server::with_models(stub.choice(&flags)).await;
    assert_eq!(similarity(&server, A, B).await["degraded"], false);
    let usage = server.get("/v1/usage").await.expect(200);
    assert_eq!((&usage["cost_usd"], &usage["cost_usd_today"]), (&json!(0.0013), &json!(0.0013)));
    // A call may cost some 0.015 dollars: with 0.001 nothing is asked.
    let flags = ["--model-input-usd", "10", "--model-output-usd", "30", "--model-daily-usd", "0.001"];
    let poor = Server::with_models(stub.choice(&flags)).await;
    assert_eq!(similarity(&poor, A, B).await["degraded"], true);
    assert_eq!(stub.calls(), 1);
}
