//! Embeddings: they choose the pairs of texts that a model is asked about, and stand in for nobody.

use std::process::Command;
use std::time::Duration;

use serde_json::{Value, json};

use super::scene::{described, hear, keyframe, put};
use super::stub::{Asked, Reply, Stub, level};
use crate::support::Server;

/// Ten paintings that share no word; the first and the last are one.
const PAINTINGS: [&str; 10] = [
    "a portrait of a lady with a mysterious smile",
    "fox, barrel, thunderstorm",
    "heron, cactus, harvest",
    "violinist, ladder, fog",
    "volcano, lantern, carnival",
    "glacier, umbrella, dawn",
    "submarine, birch, springtime",
    "beekeeper, teapot, seaside",
    "zebra, hammock, moonlight",
    "the famous picture of Mona Lisa",
];

/// Another one, with a description that no word joins to it.
const LATER: [&str; 2] = ["whale, wagon, sunrise", "sperm cachalot, handcart, morning glow"];

/// A vector of a server: all texts have something in common, and what is one painting has nearly everything.
fn vector(text: &str) -> Vec<f64> {
    let one = |text: &str| match text {
        "the famous picture of mona lisa" => 0,
        text if text.starts_with("sperm") => 10,
        text if text.starts_with("whale") => 10,
        text => PAINTINGS.iter().position(|painting| *painting == text).expect(text),
    };
    let mut vector = vec![0.0; 16];
    vector[0] = 0.7;
    vector[1 + one(text)] = 0.7;
    vector
}

fn embedded(asked: &Asked) -> Reply {
    let text = asked.body["input"].as_str().expect("a text");
    let body = json!({
        "object": "list", "model": asked.body["model"], "usage": {"prompt_tokens": 9, "total_tokens": 9},
        "data": [{"object": "embedding", "index": 0, "embedding": vector(text)}]
    });
    Reply::Raw { status: 200, headers: vec![], body: body.to_string() }
}

/// One painting is known again by who knows it.
fn knows(asked: &Asked) -> Reply {
    let [a, b] = ["a", "b"].map(|side| asked.data[side].as_str().unwrap_or_default().to_owned());
    let is = |x: &str, y: &str| (a.contains(x) && b.contains(y)) || (a.contains(y) && b.contains(x));
    match asked.what {
        "similarity" if is("lisa", "smile") || is("whale", "cachalot") => level(5),
        "similarity" => level(1),
        _ => level(4),
    }
}

fn pairs(stub: &Stub) -> Vec<(String, String)> {
    let asked = stub.journal().into_iter().filter(|asked| asked.what == "similarity");
    let side = |asked: &Asked, side: &str| asked.data[side].as_str().unwrap().to_owned();
    asked.map(|asked| (side(&asked, "a"), side(&asked, "b"))).collect()
}

async fn see(server: &Server, number: usize, text: &str) {
    let x = number as f64 * 50.0;
    let seen = described("painting", [x, 0.0, 2.0], text);
    put(server, "m", &format!("kf-{number}"), &keyframe(90 * number as i64 + 1, x, &[seen])).await;
}

fn matched(anchor: &'static str, other: &'static str) -> impl Fn(&Value) -> bool {
    move |event| event["event"] == "anchors_matched" && event["anchor"] == anchor && event["other"] == other
}

/// All paintings seen, and the later ones once the first pair is known: what the earlier lacked was asked by then.
async fn walk(server: &Server) {
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    for (number, text) in PAINTINGS.iter().enumerate() {
        see(server, number, text).await;
    }
    hear(server, "m", matched("a-9", "a-0")).await;
    for (number, text) in LATER.iter().enumerate() {
        see(server, 10 + number, text).await;
    }
    hear(server, "m", matched("a-11", "a-10")).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn only_what_is_near_is_asked_about_and_a_restart_pays_for_nothing() {
    let (model, vectors) = (Stub::start(knows).await, Stub::start(embedded).await);
    let (url, directory) = (vectors.url(), tempfile::tempdir().unwrap());
    let flags = ["--model-embeddings-url", &url, "--model-embeddings-name", "small"];
    // Seen before there was a model: among few, all are near.
    let server = Server::on(directory.path()).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    for (number, text) in PAINTINGS.iter().chain(&LATER).enumerate() {
        see(&server, number, text).await;
    }
    server.stop().await;
    let server = Server::with_models_on(directory.path(), model.choice(&flags)).await;
    // Whoever reads the map makes the models look at it.
    server.get("/v1/maps/m/anchors/a-0").await.expect(200);
    hear(&server, "m", matched("a-9", "a-0")).await;
    hear(&server, "m", matched("a-11", "a-10")).await;
    let asked = pairs(&model);
    assert_eq!(asked.len(), 2, "{asked:#?}");
    assert_eq!(vectors.calls(), PAINTINGS.len() + LATER.len());
    assert!(vectors.journal().iter().all(|asked| asked.body["model"] == "small"));
    let usage = server.get("/v1/usage").await.expect(200);
    let embed = usage["items"].as_array().unwrap().iter().find(|item| item["operation"] == "embed").unwrap();
    assert_eq!((&embed["model"], &embed["calls"]), (&json!("small"), &json!(12)), "{usage}");
    assert_eq!((&embed["input_tokens"], &embed["output_tokens"]), (&json!(12 * 9), &json!(0)), "{usage}");
    server.stop().await;

    // The embeddings are on disk: the next text alone is new.
    let server = Server::with_models_on(directory.path(), model.choice(&flags)).await;
    vectors.script(|asked| {
        assert_eq!(asked.body["input"], "cachalot whale, barrow, dusk");
        let body = json!({"data": [{"embedding": vector("whale")}]});
        Reply::Raw { status: 200, headers: vec![], body: body.to_string() }
    });
    see(&server, 12, "cachalot whale, barrow, dusk").await;
    hear(&server, "m", matched("a-12", "a-10")).await;
    assert_eq!(vectors.calls(), PAINTINGS.len() + LATER.len() + 1);
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn without_usable_embeddings_words_choose() {
    let answers = |body: Value| Reply::Raw { status: 200, headers: vec![], body: body.to_string() };
    let mut words = vec![json!(0.1); 15];
    words.push(json!("x"));
    for (name, reply) in [
        ("a failing server", Reply::Raw { status: 500, headers: vec![], body: "{}".to_owned() }),
        ("no such model", Reply::Raw { status: 404, headers: vec![], body: "{}".to_owned() }),
        ("no vector", answers(json!({"data": []}))),
        ("a vector of zeros", answers(json!({"data": [{"embedding": [0, 0, 0, 0, 0, 0, 0, 0]}]}))),
        ("a short vector", answers(json!({"data": [{"embedding": [1.0, 2.0]}]}))),
        ("a word among numbers", answers(json!({"data": [{"embedding": words}]}))),
    ] {
        let (model, vectors) = (Stub::start(knows).await, Stub::start(move |_| reply.clone()).await);
        let url = vectors.url();
        let flags =
            ["--model-embeddings-url", &url, "--model-embeddings-name", "small", "--model-retries", "0"];
        let server = Server::with_models(model.choice(&flags)).await;
        walk(&server).await;
        assert!(pairs(&model).len() > 2 && vectors.calls() > 0, "{name}");
        server.stop().await;
    }
}

/// A painting of nothing else's words.
fn filler(number: usize) -> String {
    let syllables = ["ba", "ce", "di", "fo", "gu", "ka"];
    let stem = format!("{}{}", syllables[number / 6], syllables[number % 6]);
    format!("{stem}lor, {stem}min, {stem}tus")
}

/// The same vectors for more paintings than words ask about without a word in common.
fn embedded_among_many(asked: &Asked) -> Reply {
    let text = asked.body["input"].as_str().expect("a text");
    let number = (0..36).position(|number| filler(number) == text).unwrap_or(36);
    let mut vector = vec![0.0; 64];
    (vector[0], vector[1 + number]) = (0.7, 0.7);
    let body = json!({"data": [{"embedding": vector}]});
    Reply::Raw { status: 200, headers: vec![], body: body.to_string() }
}

#[tokio::test(flavor = "multi_thread")]
async fn embeddings_that_come_back_choose_what_words_could_not() {
    let model = Stub::start(knows).await;
    let vectors = Stub::start(|_| Reply::Raw { status: 500, headers: vec![], body: "{}".to_owned() }).await;
    let (url, directory) = (vectors.url(), tempfile::tempdir().unwrap());
    let server = Server::on(directory.path()).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    let texts = [PAINTINGS[0].to_owned(), PAINTINGS[9].to_owned()];
    for (number, text) in texts.into_iter().chain((0..36).map(filler)).enumerate() {
        see(&server, number, &text).await;
    }
    server.stop().await;
    let flags = ["--model-embeddings-url", &url, "--model-embeddings-name", "small", "--model-retries", "0"];
    let server = Server::with_models_on(directory.path(), model.choice(&flags)).await;
    server.get("/v1/maps/m/anchors/a-0").await.expect(200);
    // Five failures in a row: they are away, and words find no pair.
    while vectors.calls() < 5 {
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    assert_eq!(pairs(&model), []);
    vectors.script(embedded_among_many);
    hear(&server, "m", matched("a-1", "a-0")).await;
    assert_eq!(pairs(&model).len(), 1);
    server.stop().await;
}

#[test]
fn embeddings_need_a_name_and_a_model_to_choose_for() {
    let directory = tempfile::tempdir().unwrap();
    let database = format!("sqlite://{}", directory.path().join("test.db").display());
    for (flags, said) in [
        (&["--model-embeddings-url", "http://127.0.0.1:1/v1"][..], "needs a name"),
        (
            &["--model-embeddings-url", "http://127.0.0.1:1/v1", "--model-embeddings-name", "small"],
            "needs --model-url",
        ),
        (&["--model-embeddings-url", "nonsense", "--model-embeddings-name", "small"], "no http"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_revisit"))
            .args([&["serve", "--listen", "127.0.0.1:0", "--database", &database], flags].concat())
            .output()
            .unwrap();
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && error.contains(said), "{flags:?}: {error}");
    }
}
