//! Quiet map: written once and never again, so its verdicts repeat to the byte, whatever befalls
//! the server.

use serde_json::{Value, json};

use super::server::{Answer, Api};
use super::writer::keyframe;

const MAP: &str = "quiet";
/// Two robots that walk the same corridor, each keyframe of the second asked about.
const SESSIONS: [&str; 2] = ["first", "second"];
const KEYFRAMES: u64 = 10;
/// Time for whatever the server still owes a new keyframe (descriptions, matches).
const MAX_WAIT_MS: u64 = 10_000;

pub(super) struct QuietMap {
    verdicts: Vec<Verdict>,
}

struct Verdict {
    question: Value,
    /// The answer, to the byte.
    answer: Vec<u8>,
    /// Where it can be read back, and what was read there.
    path: String,
    record: Option<Vec<u8>>,
}

impl QuietMap {
    /// Writes the map and asks every question once.
    pub async fn prepare(api: &Api) -> Self {
        let answer = api.put(&format!("/v1/maps/{MAP}"), &json!({})).await;
        assert_eq!(answer.status, 201, "{}", answer.text());
        for session in SESSIONS {
            for number in 0..KEYFRAMES {
                let path = format!("/v1/maps/{MAP}/keyframes/{session}-{number}");
                let answer = api.put(&path, &keyframe(session, number)).await;
                assert_eq!(answer.status, 201, "{path}: {}", answer.text());
            }
        }
        // The longest wait first: after it, nothing is owed any more and the map is quiet.
        let last = question(KEYFRAMES - 1);
        ask(api, &last).await;
        let mut verdicts = Vec::new();
        for number in 0..KEYFRAMES {
            verdicts.push(Verdict::of(api, question(number)).await);
        }
        let candidates = |verdict: &Verdict| json_of(&verdict.answer)["candidates"] != json!([]);
        assert!(verdicts.iter().any(candidates), "questions without candidates test nothing");
        Self { verdicts }
    }

    /// Every verdict is what it was before the server was killed.
    pub async fn answers_as_before(&self, api: &Api) {
        for verdict in &self.verdicts {
            // Before it is asked again, which would write the record anew: a crash may lose the
            // record, not change it.
            let record = api.get(&verdict.path).await;
            match (&verdict.record, record.status) {
                (Some(before), 200) => assert_same(before, &record, &verdict.path),
                (_, 200 | 404) => {}
                (_, other) => panic!("{}: {other} {}", verdict.path, record.text()),
            }
            let answer = ask(api, &verdict.question).await;
            assert_same(&verdict.answer, &answer, "the answer");
        }
    }
}

impl Verdict {
    async fn of(api: &Api, question: Value) -> Self {
        let answer = ask(api, &question).await.body;
        let id = json_of(&answer)["id"].clone();
        let id = id.as_str().expect("a query has an id");
        let path = format!("/v1/maps/{MAP}/loop-queries/{id}");
        let record = api.get(&path).await;
        Self { question, answer, record: (record.status == 200).then_some(record.body), path }
    }
}

fn question(number: u64) -> Value {
    let keyframe = format!("{}-{number}", SESSIONS[1]);
    json!({"keyframe": keyframe, "verify": "auto", "max_wait_ms": MAX_WAIT_MS, "seed": 7})
}

async fn ask(api: &Api, question: &Value) -> Answer {
    let answer = api.post(&format!("/v1/maps/{MAP}/loop-queries"), question).await;
    assert!(answer.is_success(), "{question}: {}", answer.text());
    answer
}

fn json_of(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).expect("an answer is JSON")
}

fn assert_same(before: &[u8], after: &Answer, what: &str) {
    let before_text = String::from_utf8_lossy(before);
    assert!(before == after.body, "{what} changed:\n{before_text}\n{}", after.text());
}
