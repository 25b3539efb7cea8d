//! A scene: one map on a real server, and the few words needed to fill it and to ask it.

use std::time::Duration;

use reqwest::Method;
use serde_json::{Map, Value, json};

use crate::support::{self, Server};

const MAP: &str = "/v1/maps/tower";

/// A stream that tells nothing for so long has nothing to tell: the test fails instead of hanging.
const PATIENCE: Duration = Duration::from_secs(20);

/// Names of rooms, each a valid description, no two of them alike.
pub(super) const NAMES: [&str; 6] = ["Turing", "Curie", "Noether", "Kepler", "Lovelace", "Gauss"];

/// One map on a server of its own.
pub(super) struct Scene {
    pub(super) server: Server,
    map: &'static str,
}

/// An object with the members of another put in.
fn merged(mut base: Value, more: &Value) -> Value {
    let none = Map::new();
    for (name, value) in more.as_object().unwrap_or(&none) {
        base[name] = value.clone();
    }
    base
}

impl Scene {
    /// With the default settings.
    pub(super) async fn new() -> Self {
        Self::with(json!({})).await
    }

    /// With these settings, the others at their defaults.
    pub(super) async fn with(settings: Value) -> Self {
        Self::of(json!({"settings": settings})).await
    }

    pub(super) async fn of(map: Value) -> Self {
        let server = Server::start().await;
        server.put(MAP, &map).await.expect(201);
        Self { server, map: MAP }
    }

    /// A path below the map.
    pub(super) fn path(&self, rest: &str) -> String {
        format!("{}{rest}", self.map)
    }

    /// Stores a keyframe; its answer.
    pub(super) async fn put(&self, id: &str, keyframe: Keyframe) -> Value {
        self.server.put(&self.path(&format!("/keyframes/{id}")), &keyframe.0).await.expect(201)
    }

    /// What is at a path below the map.
    pub(super) async fn get(&self, rest: &str) -> Value {
        self.server.get(&self.path(rest)).await.expect(200)
    }

    pub(super) async fn post(&self, rest: &str, body: &Value) -> Value {
        let answer = self.server.post(&self.path(rest), body).await;
        assert!(answer.status.is_success(), "{answer:#?}");
        answer.body
    }

    pub(super) async fn delete(&self, rest: &str) -> Value {
        let answer = self.server.delete(&self.path(rest)).await;
        assert!(answer.status.is_success(), "{answer:#?}");
        answer.body
    }

    /// Changes settings.
    pub(super) async fn set(&self, settings: Value) {
        self.server.patch(self.map, &json!({"settings": settings})).await.expect(200);
    }

    /// Describes an anchor by hand, or takes that back.
    pub(super) async fn describe(&self, anchor: &str, description: Option<&str>) -> Value {
        let path = self.path(&format!("/anchors/{anchor}"));
        let request = self.server.request(Method::PATCH, &path).header("if-match", "*");
        support::Answer::of(request.json(&json!({"description": description}))).await.expect(200)
    }

    /// Asks about a stored keyframe.
    pub(super) async fn ask(&self, keyframe: &str) -> Value {
        self.post("/loop-queries", &json!({"keyframe": keyframe})).await
    }

    /// What the query about one keyframe says of another.
    pub(super) async fn compare(&self, query: &str, candidate: &str) -> Value {
        let answer = self.ask(query).await;
        candidate_of(&answer, candidate)
            .unwrap_or_else(|| panic!("{candidate} is no candidate of {query}: {answer:#}"))
    }

    /// Confirms a loop.
    pub(super) async fn close(&self, id: &str, keyframe: &str, candidate: &str) -> Value {
        let body = json!({"id": id, "keyframe": keyframe, "candidate": candidate});
        self.server.post(&self.path("/loops"), &body).await.expect(201)
    }

    pub(super) async fn anchor(&self, id: &str) -> Value {
        self.get(&format!("/anchors/{id}")).await
    }

    /// All anchors that go by their own name, oldest first.
    pub(super) async fn anchors(&self) -> Vec<Value> {
        list(&self.get("/anchors?limit=1000").await["items"])
    }

    /// M_k of a keyframe.
    pub(super) async fn local_map(&self, keyframe: &str) -> Vec<Value> {
        list(&self.get(&format!("/keyframes/{keyframe}/local-anchor-map")).await["anchors"])
    }

    /// The map's events from the first to the last of this kind that was told `times` times.
    pub(super) async fn events_until(&self, kind: &str, times: usize) -> Vec<Value> {
        let request = self.server.request(Method::GET, &self.path("/events?since=0"));
        let mut response = request.send().await.expect("a stream");
        let (mut text, mut events) = (Vec::new(), Vec::new());
        loop {
            let chunk = tokio::time::timeout(PATIENCE, response.chunk()).await;
            let chunk = chunk.unwrap_or_else(|_| panic!("no {kind} after {events:#?}"));
            text.extend(chunk.expect("a stream").expect("a stream without an end"));
            events = events_in(&String::from_utf8_lossy(&text));
            let mut told = events.iter().enumerate().filter(|(_, event)| event["event"] == kind);
            if let Some((last, _)) = told.nth(times - 1) {
                events.truncate(last + 1);
                return events;
            }
        }
    }
}

/// The whole events at the start of a stream.
fn events_in(stream: &str) -> Vec<Value> {
    let whole = stream.rfind("\n\n").map_or("", |end| &stream[..end]);
    let data = whole.lines().filter_map(|line| line.strip_prefix("data:"));
    data.map(|data| serde_json::from_str(data).expect("an event is JSON")).collect()
}

/// One candidate of an answer.
pub(super) fn candidate_of(answer: &Value, keyframe: &str) -> Option<Value> {
    list(&answer["candidates"]).into_iter().find(|candidate| candidate["keyframe"] == keyframe)
}

pub(super) fn list(value: &Value) -> Vec<Value> {
    value.as_array().unwrap_or_else(|| panic!("{value} is no list")).clone()
}

/// One member of each item of a list, as text.
pub(super) fn texts(items: &Value, member: &str) -> Vec<String> {
    list(items).iter().map(|item| item[member].as_str().unwrap_or_default().to_owned()).collect()
}

/// Answers show nine decimals.
#[track_caller]
pub(super) fn close_to(what: &str, got: &Value, expected: f64) {
    let number = got.as_f64().unwrap_or_else(|| panic!("{what}: {got} is no number"));
    assert!((number - expected).abs() < 2e-9, "{what}: {number}, not {expected}");
}

/// The same for a vector.
#[track_caller]
pub(super) fn close_to_all(what: &str, got: &Value, expected: [f64; 3]) {
    let numbers = list(got);
    assert_eq!(numbers.len(), 3, "{what}: {got}");
    for (number, expected) in numbers.iter().zip(expected) {
        close_to(what, number, expected);
    }
}

/// A keyframe to be sent.
#[derive(Clone)]
pub(super) struct Keyframe(pub(super) Value);

/// A keyframe at the origin, with the word 1.
pub(super) fn keyframe() -> Keyframe {
    Keyframe(support::keyframe()).words(&[(1, 1.0)])
}

impl Keyframe {
    fn set(mut self, name: &str, value: Value) -> Self {
        self.0[name] = value;
        self
    }

    pub(super) fn words(self, words: &[(u32, f64)]) -> Self {
        let (words, weights): (Vec<u32>, Vec<f64>) = words.iter().copied().unzip();
        self.set("bow", json!({"words": words, "weights": weights}))
    }

    pub(super) fn session(self, session: &str) -> Self {
        self.set("session", json!(session))
    }

    /// It was taken then.
    pub(super) fn stamp(self, sec: usize) -> Self {
        self.set("stamp", json!({"sec": sec, "nanosec": 0}))
    }

    /// It stands there, not turned.
    pub(super) fn at(self, place: [f64; 3]) -> Self {
        self.set("pose", support::pose(place))
    }

    pub(super) fn covisible(self, keyframes: &[&str]) -> Self {
        let declared: Vec<Value> = keyframes.iter().map(|id| json!({"keyframe": id, "shared": 40})).collect();
        self.set("covisible", json!(declared))
    }

    pub(super) fn member(self, name: &str, value: Value) -> Self {
        self.set(name, value)
    }

    pub(super) fn observes(self, points: impl IntoIterator<Item = i64>) -> Self {
        let points: Vec<i64> = points.into_iter().collect();
        self.set("observes", json!(points))
    }

    /// It brings these map points.
    pub(super) fn points(self, points: &[(i64, [f64; 3])]) -> Self {
        let (ids, positions): (Vec<i64>, Vec<[f64; 3]>) = points.iter().copied().unzip();
        self.set("map_points", json!({"ids": ids, "positions": positions}))
    }

    pub(super) fn sees(self, detections: impl IntoIterator<Item = Detection>) -> Self {
        let detections: Vec<Value> = detections.into_iter().map(|seen| seen.0).collect();
        self.set("detections", json!(detections))
    }
}

/// A pose at a place, turned by a quaternion `[x,y,z,w]`.
pub(super) fn turned(place: [f64; 3], [x, y, z, w]: [f64; 4]) -> Value {
    merged(support::pose(place), &json!({"rotation": {"x": x, "y": y, "z": z, "w": w}}))
}

/// A detection to be sent.
#[derive(Clone)]
pub(super) struct Detection(pub(super) Value);

/// A thing of a class, seen with full confidence, not yet anywhere.
pub(super) fn thing(class: &str, text: &str) -> Detection {
    Detection(json!({"class": class, "confidence": 1.0, "box": [0, 0, 10, 10], "text": text}))
}

/// A door plate at a position.
pub(super) fn door(text: &str, position: [f64; 3]) -> Detection {
    thing("door_number", text).at(position)
}

/// A door plate that nobody has read.
pub(super) fn unread(position: [f64; 3]) -> Detection {
    door("", position)
}

impl Detection {
    pub(super) fn at(mut self, position: [f64; 3]) -> Self {
        self.0["position"] = json!(position);
        self
    }

    /// Its place is these map points.
    pub(super) fn on(mut self, points: impl IntoIterator<Item = i64>) -> Self {
        let points: Vec<i64> = points.into_iter().collect();
        self.0["map_points"] = json!(points);
        self
    }

    pub(super) fn confidence(mut self, confidence: f64) -> Self {
        self.0["confidence"] = json!(confidence);
        self
    }
}
