//! At whose expense models are asked.

use reqwest::Method;
use serde_json::{Value, json};

use crate::models::scene::{crop, describes, hear_stream, keyframe};
use crate::models::stub::{Asked, Reply, Stub, level};
use crate::support::{Answer, Server};

fn reads_901(asked: &Asked) -> Reply {
    match asked.what {
        "similarity" => level(4),
        _ => Reply::Say("901".to_owned()),
    }
}

async fn send(server: &Server, method: Method, path: &str, secret: &str, body: &Value) -> Answer {
    Answer::of(server.request(method, path).bearer_auth(secret).json(body)).await
}

/// A key of everything, and one with a budget.
async fn keys(server: &Server, budget: Value) -> (String, String) {
    let secret = |made: Value| made["secret"].as_str().unwrap().to_owned();
    let body = json!({"actions": ["read", "write", "query", "admin"]});
    let rich = secret(server.post("/v1/keys", &body).await.expect(201));
    let mut body = json!({"actions": ["read", "write", "query"]});
    body.as_object_mut().unwrap().extend(budget.as_object().unwrap().clone());
    let poor = secret(send(server, Method::POST, "/v1/keys", &rich, &body).await.expect(201));
    (rich, poor)
}

#[tokio::test(flavor = "multi_thread")]
async fn a_key_that_has_spent_its_budget_is_answered_by_the_built_in_judge_and_others_by_the_model() {
    let stub = Stub::start(reads_901).await;
    let server = Server::with_models(stub.choice(&["--model-input-usd", "100"])).await;
    // A call is a question in one order; a 4 is asked again in the other: two calls a pair.
    let (rich, poor) = keys(&server, json!({"model_daily_calls": 2})).await;
    let ask = async |secret: &str, boat: &str| {
        let pair = json!({"class": "painting", "a": format!("a painting of a {boat} on a stormy sea"),
            "b": format!("the {boat} in heavy weather, oil on canvas")});
        send(&server, Method::POST, "/v1/semantics/similarity", secret, &pair).await.expect(200)
    };
    let judged =
        |answer: &Value| (answer["source"].as_str().unwrap() == "model:stub", answer["degraded"].clone());
    assert_eq!(judged(&ask(&poor, "boat").await), (true, json!(false)));
    assert_eq!(judged(&ask(&poor, "schooner").await), (false, json!(true)), "its two calls are used up");
    assert_eq!(judged(&ask(&poor, "boat").await), (true, json!(false)), "what was paid for is free");
    assert_eq!(
        judged(&ask(&rich, "schooner").await),
        (true, json!(false)),
        "others have budgets of their own"
    );
    assert_eq!(
        judged(&ask(&poor, "schooner").await),
        (true, json!(false)),
        "an answer in the cache is for all"
    );
    assert_eq!(stub.calls(), 4);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_map_is_described_at_the_expense_of_the_key_that_made_it() {
    let stub = Stub::start(reads_901).await;
    let server = Server::with_models(stub.choice(&[])).await;
    let (rich, poor) = keys(&server, json!({"model_daily_usd": 0, "model_daily_calls": 0})).await;
    // Two crops: a reading is kept for every map that holds the same pixels, and is then free.
    for (map, maker, pixels) in [("of-poor", &poor, [9, 9, 8]), ("of-rich", &rich, [9, 9, 9])] {
        send(&server, Method::PUT, &format!("/v1/maps/{map}"), maker, &json!({})).await.expect(201);
        let body = keyframe(1, 0.0, &[crop("door_number", [0.0, 0.0, 2.0], pixels)]);
        // Who writes does not matter: the map is its maker's.
        send(&server, Method::PUT, &format!("/v1/maps/{map}/keyframes/kf-1"), &poor, &body).await.expect(201);
    }
    let events = server.request(Method::GET, "/v1/maps/of-rich/events?since=0").bearer_auth(&rich);
    hear_stream(events, describes("a-0")).await;
    let calls = stub.calls();
    let anchor =
        Answer::of(server.request(Method::GET, "/v1/maps/of-poor/anchors/a-0").bearer_auth(&poor)).await;
    assert_eq!(anchor.expect(200)["state"], "pending");
    assert_eq!(calls, 2, "one crop was read twice, at the expense of one key");
}
