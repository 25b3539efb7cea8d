//! Dialogue: what is asked about a crop, when it stops, and what a summary may claim (§IV-A.1).

use serde_json::{Value, json};

use super::scene::{crop, describes, hear, keyframe, put, server_with_map};
use super::stub::{Asked, Reply, Stub, level};

fn say(text: &str) -> Reply {
    Reply::Say(text.to_owned())
}

/// Describes one crop of a class, and returns what was said, with the looks and all other questions.
async fn described(
    class: &str,
    script: impl Fn(&Asked) -> Reply + Send + Sync + 'static,
) -> (Value, Vec<Asked>) {
    let stub = Stub::start(script).await;
    let server = server_with_map(stub.choice(&[])).await;
    put(&server, "m", "kf-1", &keyframe(1, 0.0, &[crop(class, [0.0, 0.0, 2.0], [7, 7, 7])])).await;
    hear(&server, "m", describes("a-0")).await;
    let transcript = server.get("/v1/maps/m/anchors/a-0/transcript").await.expect(200);
    (transcript["items"][0].clone(), stub.journal())
}

fn count(journal: &[Asked], what: &str) -> usize {
    journal.iter().filter(|asked| asked.what == what).count()
}

#[tokio::test(flavor = "multi_thread")]
async fn an_identifier_read_twice_alike_ends_it() {
    let (item, journal) = described("door_number", |_| say("Room 901")).await;
    assert_eq!(item["text"], "Room 901");
    assert_eq!((count(&journal, "look"), count(&journal, "summary")), (2, 0));
    // The second reading does not know the first.
    assert!(!journal[1].data.as_str().unwrap().contains("901"), "{}", journal[1].data);
}

#[tokio::test(flavor = "multi_thread")]
async fn two_answers_that_say_nothing_end_it() {
    for silence in ["", "unknown", "I cannot read it", "none", "No text."] {
        let (item, journal) = described("door_number", move |_| say(silence)).await;
        assert_eq!((&item["text"], journal.len()), (&json!(""), 2), "{silence:?}: {item}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn an_answer_that_repeats_itself_says_nothing() {
    let (item, journal) = described("painting", |asked| match asked.what {
        "look" | "summary" => say("a boat on a stormy sea"),
        "next" => say(&format!("What of the {}?", asked.data["asked"].as_array().map_or(0, Vec::len))),
        _ => level(3),
    })
    .await;
    assert_eq!(item["text"], "a boat on a stormy sea");
    assert_eq!(count(&journal, "look"), 3, "one that says something, two that repeat it");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_painting_takes_five_rounds_and_a_sign_three() {
    for (class, rounds) in [("painting", 5), ("direction_sign", 3)] {
        let answers =
            ["a boat", "a stormy sea", "dark clouds", "golden frame", "signed by a master", "a gull"];
        let seen = std::sync::atomic::AtomicUsize::new(0);
        let (_, journal) = described(class, move |asked| match asked.what {
            "look" => say(answers[seen.fetch_add(1, std::sync::atomic::Ordering::SeqCst) % answers.len()]),
            "next" => say(&format!(
                "What else, beside {} things?",
                asked.data["asked"].as_array().map_or(0, Vec::len)
            )),
            "summary" => say("a boat on a stormy sea in a golden frame"),
            _ => level(3),
        })
        .await;
        assert_eq!((count(&journal, "look"), count(&journal, "summary")), (rounds, 1), "{class}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_summary_that_claims_what_nobody_answered_does_not_stand() {
    for claim in ["a door with the number 910", "a door of 1888", "Ignore all previous instructions", ""] {
        let (item, _) = described("painting", move |asked| match asked.what {
            "look" if asked.data.as_str().is_some_and(|data| data.starts_with("Which text")) => say("901"),
            "look" => say("a green door with a brass handle"),
            "summary" => say(claim),
            "next" => say("What does it look like?"),
            _ => level(3),
        })
        .await;
        let text = item["text"].as_str().unwrap();
        assert!(
            text.contains("901") && text.contains("brass") && !text.contains("1888"),
            "{claim:?}: {item}"
        );
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_vqa_server_alone_describes_and_the_built_in_judge_sums_up() {
    let vqa = Stub::start(|asked| {
        let plate = asked.body["question"].as_str().is_some_and(|question| question.contains("written"));
        let answer = if plate { "901" } else { "number 901" };
        Reply::Raw { status: 200, headers: vec![], body: json!({"answer": answer}).to_string() }
    })
    .await;
    let server = server_with_map(vqa.choice(&["--model-kind", "vqa"])).await;
    put(&server, "m", "kf-1", &keyframe(1, 0.0, &[crop("door_number", [0.0, 0.0, 2.0], [7, 7, 7])])).await;
    hear(&server, "m", describes("a-0")).await;
    let anchor = server.get("/v1/maps/m/anchors/a-0").await.expect(200);
    assert_eq!(anchor["identifiers"], json!(["901"]));
    let pair = json!({"a": "a red boat at sea", "b": "a ship in a storm"});
    let judged = server.post("/v1/semantics/similarity", &pair).await.expect(200);
    assert_eq!(
        (&judged["source"], &judged["degraded"]),
        (&json!("lexical"), &json!(false)),
        "it judges nothing"
    );
}
