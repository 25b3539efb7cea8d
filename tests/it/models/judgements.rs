//! Judgements: a changed model is asked again, over restarts and within the budget, and the old verdicts stay on record.

use std::path::Path;

use serde_json::{Value, json};

use super::scene::{
    HANGS_AFTER, LADY, LISA, crop, describes, hear, keyframe, put, put_paintings, server_with_map,
};
use super::stub::{Asked, Reply, Stub, level};
use crate::support::Server;

const JUDGEMENTS: &str = "/v1/maps/m/judgements";

/// A model of another name is another model.
async fn serve(folder: &Path, stub: &Stub, name: &str, more: &[&str]) -> Server {
    let flags = [&["--model-name", name], more].concat();
    Server::with_models_on(folder, stub.choice(&flags)).await
}

/// Gives pairs this level, and information that is enough.
fn judges(of_pairs: u8) -> impl Fn(&Asked) -> Reply {
    move |asked| match asked.what {
        "similarity" => level(of_pairs),
        _ => level(4),
    }
}

/// Two paintings far apart, judged by a small model that tells them from each other.
async fn judged_by_small(folder: &Path, stub: &Stub) -> Value {
    stub.script(judges(2));
    let server = serve(folder, stub, "small", &[]).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    put_paintings(&server, LADY, LISA).await;
    // Two levels of information and one of similarity; the last is kept when the map has no more to ask.
    let settled = async {
        loop {
            let seen = server.get("/v1/maps/m").await.expect(200)["map_version"].clone();
            if stub.calls() >= 3 && seen.as_u64() >= Some(7) {
                return;
            }
            tokio::task::yield_now().await;
        }
    };
    tokio::time::timeout(HANGS_AFTER, settled).await.expect("three verdicts");
    let answer = ask(&server).await;
    server.stop().await;
    answer
}

async fn ask(server: &Server) -> Value {
    server.post("/v1/maps/m/loop-queries", &json!({"keyframe": "kf-2"})).await.expect(200)
}

/// Reads a job until it is as wanted.
async fn until(server: &Server, id: &str, wanted: impl Fn(&Value) -> bool) -> Value {
    let reading = async {
        loop {
            let job = server.get(&format!("{JUDGEMENTS}/{id}")).await.expect(200);
            if wanted(&job) {
                return job;
            }
            tokio::task::yield_now().await;
        }
    };
    tokio::time::timeout(HANGS_AFTER, reading).await.expect("the job comes to be so")
}

fn is(state: &'static str) -> impl Fn(&Value) -> bool {
    move |job| job["state"] == state
}

#[tokio::test(flavor = "multi_thread")]
async fn a_changed_model_is_asked_again_and_the_old_verdicts_stay_on_record() {
    let folder = tempfile::tempdir().unwrap();
    let stub = Stub::start(judges(2)).await;
    let before = judged_by_small(folder.path(), &stub).await;
    assert_ne!(before["verdict"], "loop", "{before}");

    stub.script(judges(5));
    let flags = ["--model-input-usd", "10", "--model-output-usd", "10"];
    let server = serve(folder.path(), &stub, "large", &flags).await;
    assert_eq!(ask(&server).await["verdict"], before["verdict"], "nothing changes by itself");
    let calls = stub.calls();
    let preview = server.post(JUDGEMENTS, &json!({"preview": true})).await.expect(200);
    assert_eq!(
        (&preview["state"], &preview["questions"], &preview["calls_max"], &preview["left"]),
        (&json!("preview"), &json!(3), &json!(4), &json!(3)),
        "{preview}"
    );
    assert!(preview["cost_max_usd"].as_f64().is_some_and(|usd| usd > 0.0 && usd < 1.0), "{preview}");
    assert_eq!(stub.calls(), calls, "a preview asks nothing");

    let started = server.post(JUDGEMENTS, &json!({})).await.expect(201);
    let id = started["id"].as_str().unwrap();
    let done = until(&server, id, is("done")).await;
    assert_eq!(
        (&done["changed"], &done["unchanged"], &done["failed"], &done["left"]),
        (&json!(1), &json!(2), &json!(0), &json!(0)),
        "{done}"
    );
    let replaced = &done["replaced"][0];
    assert_eq!(
        (&replaced["operation"], &replaced["before"], &replaced["source_before"]),
        (&json!("similarity"), &json!("2"), &json!("model:small")),
        "{done}"
    );
    assert_eq!((&replaced["after"], &replaced["source_after"]), (&json!("5"), &json!("model:large")));
    assert_eq!(ask(&server).await["verdict"], "loop");
    let spent = server.get("/v1/usage").await.expect(200);
    assert_eq!(stub.calls() - calls, 3, "{spent}");
    // The answer of the earlier version stands as it was given.
    let kept = format!("/v1/maps/m/loop-queries/{}", before["id"].as_str().unwrap());
    assert_eq!(server.get(&kept).await.expect(200), before);
    // There is nothing more to ask this model.
    let again = server.post(JUDGEMENTS, &json!({"id": "again"})).await.expect(201);
    assert_eq!((&again["state"], &again["questions"]), (&json!("done"), &json!(0)), "{again}");
    server.get(&format!("{JUDGEMENTS}/none")).await.expect(404);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_goes_on_after_a_restart_where_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let stub = Stub::start(judges(2)).await;
    judged_by_small(folder.path(), &stub).await;
    // The large model answers one question, and then it is away.
    let asked = stub.calls();
    let (journal, flags) = (stub.clone(), ["--model-calls-at-once", "1", "--model-retries", "0"]);
    stub.script(move |question| {
        if journal.calls() == asked + 1 {
            return judges(5)(question);
        }
        Reply::Raw { status: 500, headers: vec![], body: String::new() }
    });
    let more = [&flags[..], &["--model-breaker-failures", "1"]].concat();
    let server = serve(folder.path(), &stub, "large", &more).await;
    server.post(JUDGEMENTS, &json!({"id": "again", "asks": "texts"})).await.expect(201);
    let waiting = until(&server, "again", |job| job["state"] == "waiting" && job["left"] == 2).await;
    // One job of a map at a time; the same job again is the same job.
    server.post(JUDGEMENTS, &json!({})).await.expect(409);
    server.post(JUDGEMENTS, &json!({"id": "again", "asks": "crops"})).await.expect(409);
    let same = server.post(JUDGEMENTS, &json!({"id": "again", "asks": "texts"})).await;
    assert_eq!((same.header("idempotent-replayed"), &same.body["left"]), ("true", &json!(2)), "{same:?}");
    assert_eq!(waiting["failed"], 0, "a model that is away fails no question: {waiting}");
    server.stop().await;

    // Without any model it waits; with one it goes on.
    let server = Server::on(folder.path()).await;
    until(&server, "again", is("waiting")).await;
    server.stop().await;
    stub.script(judges(5));
    let calls = stub.calls();
    let server = serve(folder.path(), &stub, "large", &flags).await;
    let done = until(&server, "again", is("done")).await;
    assert_eq!((&done["changed"], &done["unchanged"]), (&json!(1), &json!(2)), "{done}");
    assert_eq!(stub.calls() - calls, 2, "what was answered before the restart is not asked again");
    assert_eq!(ask(&server).await["verdict"], "loop");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_is_stopped_and_stays_within_the_budget() {
    let folder = tempfile::tempdir().unwrap();
    let stub = Stub::start(judges(2)).await;
    judged_by_small(folder.path(), &stub).await;
    stub.script(judges(5));
    // Three calls were made today; one more is allowed.
    let flags = ["--model-daily-calls", "4", "--model-calls-at-once", "1"];
    let server = serve(folder.path(), &stub, "large", &flags).await;
    let calls = stub.calls();
    let started = server.post(JUDGEMENTS, &json!({})).await.expect(201);
    let job = format!("{JUDGEMENTS}/{}", started["id"].as_str().unwrap());
    let spent = |job: &Value| job["state"] == "waiting" && job["left"] == 2;
    let waiting = until(&server, started["id"].as_str().unwrap(), spent).await;
    assert_eq!(stub.calls() - calls, 1, "{waiting}");
    for _ in 0..2 {
        let stopped = server.delete(&job).await.expect(200);
        assert_eq!((&stopped["state"], &stopped["left"]), (&json!("stopped"), &json!(2)), "{stopped}");
    }
    assert_eq!(server.get(&job).await.expect(200)["state"], "stopped");
    // Another one may begin.
    server.post(JUDGEMENTS, &json!({})).await.expect(201);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_crop_is_read_again_by_another_model() {
    let folder = tempfile::tempdir().unwrap();
    let reads = |text: &'static str| move |_: &Asked| Reply::Say(text.to_owned());
    let stub = Stub::start(reads("901")).await;
    let server = serve(folder.path(), &stub, "small", &[]).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    put(&server, "m", "kf-1", &keyframe(1, 0.0, &[crop("door_number", [0.0, 0.0, 2.0], [9, 9, 9])])).await;
    hear(&server, "m", describes("a-0")).await;
    server.stop().await;

    stub.script(reads("907"));
    let server = serve(folder.path(), &stub, "large", &[]).await;
    let texts = server.post(JUDGEMENTS, &json!({"asks": "texts", "preview": true})).await.expect(200);
    assert_eq!(texts["questions"], 0, "an identifier is no question about texts: {texts}");
    server.post(JUDGEMENTS, &json!({"id": "again", "asks": "crops"})).await.expect(201);
    let done = until(&server, "again", is("done")).await;
    let replaced = &done["replaced"][0];
    assert_eq!(
        (&replaced["keyframe"], &replaced["before"], &replaced["after"]),
        (&json!("kf-1"), &json!("901"), &json!("907")),
        "{done}"
    );
    let anchor = server.get("/v1/maps/m/anchors/a-0").await.expect(200);
    assert_eq!(anchor["description"], "907", "{anchor}");
    let transcript = server.get("/v1/maps/m/anchors/a-0/transcript").await.expect(200);
    assert_eq!(transcript["items"][0]["source"], "model:large", "{transcript}");
}

#[tokio::test]
async fn a_server_without_models_has_nothing_to_ask() {
    let server = Server::with_map("m").await;
    let preview = server.post(JUDGEMENTS, &json!({"preview": true})).await.expect(200);
    assert_eq!((&preview["questions"], &preview["cost_max_usd"]), (&json!(0), &json!(0.0)), "{preview}");
    assert_eq!(server.post(JUDGEMENTS, &json!({})).await.expect(201)["state"], "done");
    let wrong = server.post(JUDGEMENTS, &json!({"id": "a b", "asks": "some", "preview": 1, "more": 2})).await;
    assert_eq!(wrong.status, 422, "{wrong:?}");
    server.post("/v1/maps/none/judgements", &json!({})).await.expect(404);
}

#[tokio::test(flavor = "multi_thread")]
async fn each_role_has_its_price() {
    for (vision_price, eats) in [(Some("0"), false), (None, true)] {
        let stub = Stub::start(|_: &Asked| Reply::Say("901".to_owned())).await;
        let mut flags = vec!["--model-input-usd", "100", "--model-output-usd", "100"];
        if let Some(price) = vision_price {
            flags.extend(["--model-vision-input-usd", price, "--model-vision-output-usd", price]);
        }
        let server = server_with_map(stub.choice(&flags)).await;
        put(&server, "m", "kf-1", &keyframe(1, 0.0, &[crop("door_number", [0.0, 0.0, 2.0], [9, 9, 9])]))
            .await;
        hear(&server, "m", describes("a-0")).await;
        let usage = server.get("/v1/usage").await.expect(200);
        let cost = usage["items"][0]["cost_usd"].as_f64().unwrap();
        assert_eq!((cost > 0.0, usage["items"][0]["calls"].as_u64()), (eats, Some(2)), "{usage}");
    }
}
