//! Worker: what anchors lack arrives by itself, and what it changes is told.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::{Value, json};

use super::scene::{
    LADY, LISA, crop, described, describes, hear, keyframe, put, put_paintings, put_plates, server_with_map,
};
use super::stub::{Asked, Reply, Stub, level};
use crate::support::Server;

/// Every crop is a door of room 901.
fn reads_901(asked: &Asked) -> Reply {
    match asked.what {
        "look" => Reply::Say("901".to_owned()),
        "similarity" | "information" => level(4),
        "merge" => {
            Reply::Say(json!({"text": "a portrait of Mona Lisa, a lady with a mysterious smile"}).to_string())
        }
        _ => Reply::Say("room 901".to_owned()),
    }
}

async fn anchor(server: &Server, id: &str) -> Value {
    server.get(&format!("/v1/maps/m/anchors/{id}")).await.expect(200)
}

#[tokio::test(flavor = "multi_thread")]
async fn a_crop_is_described_and_the_dialogue_can_be_read() {
    let stub = Stub::start(reads_901).await;
    let server = server_with_map(stub.choice(&[])).await;
    let stored =
        put(&server, "m", "kf-1", &keyframe(1, 0.0, &[crop("door_number", [0.0, 0.0, 2.0], [9, 9, 9])]))
            .await;
    assert_eq!(stored["detections"][0]["state"], "pending");
    hear(&server, "m", describes("a-0")).await;
    let anchor = anchor(&server, "a-0").await;
    assert_eq!((&anchor["state"], &anchor["description"]), (&json!("valid"), &json!("901")), "{anchor}");
    assert_eq!(anchor["identifiers"], json!(["901"]));
    // Read twice alike: no third question, no summary.
    assert_eq!(stub.calls(), 2);
    let transcript = server.get("/v1/maps/m/anchors/a-0/transcript").await.expect(200);
    let item = &transcript["items"][0];
    assert_eq!((&item["keyframe"], &item["text"]), (&json!("kf-1"), &json!("901")));
    assert_eq!((&item["source"], &item["degraded"]), (&json!("model:stub"), &json!(false)));
    let steps = item["steps"].as_array().unwrap();
    assert_eq!(steps.len(), 2);
    assert!(steps[0]["question"].as_str().unwrap().contains("door number"), "{transcript}");
    let usage = server.get("/v1/usage").await.expect(200);
    assert_eq!((&usage["calls"], &usage["items"][0]["operation"]), (&json!(2), &json!("describe")));
    server.get("/v1/maps/m/anchors/a-7/transcript").await.expect(404);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_crop_that_its_client_read_is_not_read_again() {
    let stub = Stub::start(reads_901).await;
    let server = server_with_map(stub.choice(&[])).await;
    let mut read = crop("door_number", [0.0, 0.0, 2.0], [9, 9, 9]);
    read["text"] = json!("room 7");
    let open = crop("door_number", [5.0, 0.0, 2.0], [9, 9, 9]);
    put(&server, "m", "kf-1", &keyframe(1, 0.0, &[read, open])).await;
    hear(&server, "m", describes("a-1")).await;
    assert_eq!(anchor(&server, "a-0").await["description"], "room 7");
    let looks = stub.journal().iter().filter(|asked| asked.what == "look").count();
    assert_eq!(looks, 2, "only the second anchor");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_verdict_of_the_model_matches_two_anchors_and_triggers_a_loop_check() {
    let stub = Stub::start(reads_901).await;
    let server = server_with_map(stub.choice(&[])).await;
    put_paintings(&server, LADY, LISA).await;
    let matched = |event: &Value| event["event"] == "anchors_matched";
    let events = hear(&server, "m", matched).await;
    let event = &events[events.len() - 1];
    assert_eq!((&event["anchor"], &event["other"]), (&json!("a-1"), &json!("a-0")));
    let found = hear(&server, "m", |event| event["event"] == "loop_found").await;
    let found = &found[found.len() - 1];
    assert_eq!((&found["keyframe"], &found["candidate"]), (&json!("kf-2"), &json!("kf-1")));
    let shown = anchor(&server, "a-1").await;
    let shown = &shown["matches"][0];
    assert_eq!(
        (&shown["level"], &shown["source"], &shown["kind"]),
        (&json!(4), &json!("model:stub"), &json!("revisit"))
    );
    let verdict = server.post("/v1/maps/m/loop-queries", &json!({"keyframe": "kf-2"})).await.expect(200);
    assert_eq!((&verdict["verdict"], &verdict["degraded"]), (&json!("loop"), &json!(false)), "{verdict}");
    assert_eq!(verdict["candidates"][0]["anchors"]["matches"][0]["source"], "model:stub");
    // The reason is that of the model, not of the judge that was not asked.
    let matched = &anchor(&server, "a-0").await["matches"][0];
    assert_eq!(
        (&matched["source"], &matched["reason"]),
        (&json!("model:stub"), &json!("so it was told")),
        "{matched}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_models_verdict_stands_after_a_restart_without_a_model() {
    let stub = Stub::start(reads_901).await;
    let directory = tempfile::tempdir().unwrap();
    let server = Server::with_models_on(directory.path(), stub.choice(&[])).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    put_paintings(&server, LADY, LISA).await;
    hear(&server, "m", |event| event["event"] == "loop_found").await;
    let ask = async |server: &Server| {
        server.post("/v1/maps/m/loop-queries", &json!({"keyframe": "kf-2"})).await.expect(200)
    };
    let before = ask(&server).await;
    server.stop().await;
    let server = Server::on(directory.path()).await;
    let after = ask(&server).await;
    // Another configuration has records of its own; the verdict is the same.
    assert_ne!(after["id"], before["id"]);
    assert_eq!((&after["candidates"], &after["best"]), (&before["candidates"], &before["best"]));
}

#[tokio::test(flavor = "multi_thread")]
async fn another_map_of_the_same_name_is_worked_on_anew() {
    let stub = Stub::start(reads_901).await;
    let server = Server::with_models(stub.choice(&[])).await;
    for round in 0..2 {
        server.put("/v1/maps/m", &json!({})).await.expect(201);
        put_paintings(&server, LADY, LISA).await;
        let events = hear(&server, "m", |event| event["event"] == "anchors_matched").await;
        assert!(!events.is_empty(), "round {round}");
        server.delete("/v1/maps/m").await.expect(204);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn two_readings_of_one_painting_become_one_text() {
    let stub = Stub::start(reads_901).await;
    let server = server_with_map(stub.choice(&[])).await;
    let mut second = keyframe(2, 0.0, &[described("painting", [0.1, 0.0, 2.0], LISA)]);
    second["covisible"] = json!([{"keyframe": "kf-1", "shared": 50}]);
    put(&server, "m", "kf-1", &keyframe(1, 0.0, &[described("painting", [0.0, 0.0, 2.0], LADY)])).await;
    put(&server, "m", "kf-2", &second).await;
    let merged = "a portrait of Mona Lisa, a lady with a mysterious smile";
    hear(&server, "m", |event| event["detail"] == merged).await;
    assert_eq!(anchor(&server, "a-0").await["description"], merged);
}

#[tokio::test(flavor = "multi_thread")]
async fn readings_that_contradict_each_other_are_shown() {
    // The second crop is read otherwise than the first, so a third decides.
    let stub = Stub::start(|asked: &Asked| match asked.what {
        "look" if asked.body.to_string().contains(&sent([1, 1, 1])) => Reply::Say("910".to_owned()),
        _ => reads_901(asked),
    })
    .await;
    let server = Server::with_models(stub.choice(&[])).await;
    server.put("/v1/maps/m", &json!({"settings": {"agreeing_reads": 2}})).await.expect(201);
    let place = [0.0, 0.0, 2.0];
    for (n, colour) in [[1, 1, 1], [2, 2, 2], [3, 3, 3]].into_iter().enumerate() {
        let mut body = keyframe(n as i64, 0.0, &[crop("door_number", place, colour)]);
        if n > 0 {
            body["covisible"] = json!([{"keyframe": "kf-0", "shared": 50}]);
        }
        put(&server, "m", &format!("kf-{n}"), &body).await;
    }
    hear(&server, "m", |event| event["event"] == "anchor_described" && event["detail"] == "901").await;
    let answer = wait_for(&server, |anchor| anchor["disagreement"].is_string()).await;
    assert!(
        answer["disagreement"] == "901 is not 910" || answer["disagreement"] == "910 is not 901",
        "{answer}"
    );
    let settled = wait_for(&server, |anchor| anchor["readings"][0]["count"] == 2).await;
    assert_eq!((&settled["description"], &settled["readings"][1]["text"]), (&json!("901"), &json!("910")));
}

/// Asks for the anchor again with every version that a write brings, until it is as wanted.
async fn wait_for(server: &Server, wanted: impl Fn(&Value) -> bool) -> Value {
    let waiting = async {
        loop {
            let anchor = anchor(server, "a-0").await;
            if wanted(&anchor) {
                return anchor;
            }
            tokio::task::yield_now().await;
        }
    };
    tokio::time::timeout(std::time::Duration::from_mins(2), waiting).await.expect("it comes to be so")
}

pub(super) fn sent(colour: [u8; 3]) -> String {
    use base64::Engine as _;
    let picture = revisit::llm::picture::Picture::decode(&super::scene::png(60, 40, colour)).unwrap();
    base64::engine::general_purpose::STANDARD.encode(picture.png)
}

/// A crop of this size at the plate of `a-0`, seen together with the first.
fn crop_of_size(sec: i64, [width, height]: [f64; 2]) -> Value {
    let mut plate = crop("door_number", [0.0, 0.0, 2.0], [sec as u8, 0, 0]);
    plate["box"] = json!([100.0, 100.0, 100.0 + width, 100.0 + height]);
    let mut body = keyframe(sec, 0.0, &[plate]);
    if sec > 1 {
        body["covisible"] = json!([{"keyframe": "kf-1", "shared": 50}]);
    }
    body
}

#[tokio::test(flavor = "multi_thread")]
async fn an_old_crop_left_over_keeps_no_newer_one_from_being_read() {
    let stub = Stub::start(reads_901).await;
    let server = Server::with_models(stub.choice(&[])).await;
    server.put("/v1/maps/m", &json!({"settings": {"description_refresh_s": 100}})).await.expect(201);
    put(&server, "m", "kf-1", &crop_of_size(1, [60.0, 40.0])).await;
    wait_for(&server, |anchor| anchor["readings"][0]["count"] == 1).await;
    // Larger, yet neither twice as large nor much later: it stays unread.
    put(&server, "m", "kf-2", &crop_of_size(2, [70.0, 50.0])).await;
    // Smaller, and late enough to refresh the description (§IV-B).
    put(&server, "m", "kf-3", &crop_of_size(150, [50.0, 30.0])).await;
    wait_for(&server, |anchor| anchor["readings"][0]["count"] == 2).await;
    let transcript = server.get("/v1/maps/m/anchors/a-0/transcript").await.expect(200);
    assert_eq!(transcript["items"][0]["keyframe"], "kf-3", "{transcript}");
}

#[tokio::test(flavor = "multi_thread")]
async fn small_crops_are_read_once_the_first_has_waited_however_many_larger_ones_came() {
    let stub = Stub::start(reads_901).await;
    let server = Server::with_models(stub.choice(&[])).await;
    server.put("/v1/maps/m", &json!({"settings": {"description_refresh_s": 100}})).await.expect(201);
    put(&server, "m", "kf-1", &crop_of_size(1, [9.0, 9.0])).await;
    put(&server, "m", "kf-2", &crop_of_size(60, [10.0, 10.0])).await;
    put(&server, "m", "kf-3", &crop_of_size(120, [11.0, 11.0])).await;
    wait_for(&server, |anchor| anchor["description"] == "901").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn maps_take_turns() {
    let stub = Stub::start(reads_901).await;
    let server = Server::with_models(stub.choice(&["--model-calls-at-once", "1"])).await;
    let crowd: Vec<Value> =
        (0..60).map(|n| crop("door_number", [f64::from(n) * 3.0, 0.0, 2.0], [n as u8, 0, 0])).collect();
    for map in ["busy", "small"] {
        server.put(&format!("/v1/maps/{map}"), &json!({})).await.expect(201);
    }
    put(&server, "busy", "kf-1", &keyframe(1, 0.0, &crowd)).await;
    put(&server, "small", "kf-1", &keyframe(1, 0.0, &[crop("door_number", [0.0, 0.0, 2.0], [0, 0, 200])]))
        .await;
    hear(&server, "small", describes("a-0")).await;
    let busy = server.get("/v1/maps/busy/anchors?state=pending&limit=100").await.expect(200);
    assert!(
        !busy["items"].as_array().unwrap().is_empty(),
        "the small map waited for the whole of the busy one"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_crop_that_is_no_image_is_read_once_and_left_alone() {
    let stub = Stub::start(reads_901).await;
    let server = server_with_map(stub.choice(&[])).await;
    let mut broken = crop("door_number", [0.0, 0.0, 2.0], [9, 9, 9]);
    broken["crop"] = json!("iVBORw0KGgo=");
    put(&server, "m", "kf-1", &keyframe(1, 0.0, &[broken])).await;
    hear(&server, "m", describes("a-0")).await;
    assert_eq!(anchor(&server, "a-0").await["state"], "uninformative");
    let transcript = server.get("/v1/maps/m/anchors/a-0/transcript").await.expect(200);
    assert_eq!(transcript["items"][0]["steps"][0]["answer"], "the crop cannot be decoded");
    assert_eq!(stub.calls(), 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_query_that_waits_gets_the_description_it_waits_for() {
    let open = Arc::new(AtomicBool::new(false));
    let gate = open.clone();
    let stub = Stub::start(move |asked: &Asked| {
        if gate.load(Ordering::SeqCst) {
            reads_901(asked)
        } else {
            Reply::Raw { status: 500, headers: vec![], body: String::new() }
        }
    })
    .await;
    let flags = ["--model-breaker-failures", "1000000", "--model-retries", "0"];
    let server = server_with_map(stub.choice(&flags)).await;
    put_plates(&server).await;
    let at_once = server.post("/v1/maps/m/loop-queries", &json!({"keyframe": "kf-2"})).await.expect(200);
    assert_eq!(
        (&at_once["verdict"], &at_once["candidates"][0]["reason"]["code"]),
        (&json!("undecided"), &json!("llm_pending"))
    );
    let query = json!({"keyframe": "kf-2", "max_wait_ms": 60000});
    let opened = async { open.store(true, Ordering::SeqCst) };
    let (waited, ()) = tokio::join!(server.post("/v1/maps/m/loop-queries", &query), opened);
    let waited = waited.expect(200);
    assert_eq!((&waited["verdict"], &waited["best"]), (&json!("loop"), &json!("kf-1")), "{waited}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_under_way_when_the_server_stops_is_finished() {
    let (gate, directory) = (Arc::new(tokio::sync::Notify::new()), tempfile::tempdir().unwrap());
    let (held, (arrived, mut begun)) = (gate.clone(), tokio::sync::mpsc::unbounded_channel());
    let stub = Stub::start(move |_| {
        arrived.send(()).unwrap();
        Reply::After(held.clone(), "room 901".to_owned())
    })
    .await;
    let server = Server::with_models_on(directory.path(), stub.choice(&[])).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    put(&server, "m", "kf-1", &keyframe(1, 0.0, &[crop("door_number", [0.0, 0.0, 2.0], [9, 9, 9])])).await;
    begun.recv().await.unwrap();
    let let_go = async {
        // Two looks; the second is asked when the first is answered.
        gate.notify_one();
        begun.recv().await.unwrap();
        gate.notify_one();
    };
    tokio::join!(server.stop(), let_go);
    let server = Server::on(directory.path()).await;
    assert_eq!(anchor(&server, "a-0").await["description"], "room 901");
}
