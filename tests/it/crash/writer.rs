//! Writer: one robot that writes keyframes and loops until the server is gone, and remembers what
//! it sent and what of it was acknowledged.

use reqwest::Method;
use serde_json::{Value, json};
use tokio::sync::mpsc::UnboundedSender;

use super::server::{Answer, Api};

/// Every so many turns a robot sends several keyframes in one request ...
const BULK_EVERY: u64 = 7;
/// ... of so many lines ...
const BULK_KEYFRAMES: u64 = 5;
/// ... and closes a loop with the robot that went ahead.
const LOOP_EVERY: u64 = 9;
/// How far that robot went.
const KEYFRAMES_AHEAD: u64 = 40;
const AHEAD: &str = "ahead";
/// Every so many keyframes carry a detection, or ask for a loop in the same round trip.
const DETECTION_EVERY: u64 = 3;
const QUERY_EVERY: u64 = 5;

/// Consecutive keyframes observe this many points, and share all but a step of them.
const OBSERVED_POINTS: u64 = 30;
const POINTS_STEP: u64 = 10;

/// Everything that one writer sent.
#[derive(Debug)]
pub(super) struct Log {
    pub map: String,
    pub keyframes: Vec<Sent>,
    pub loops: Vec<Sent>,
}

/// One write.
#[derive(Debug)]
pub(super) struct Sent {
    pub id: String,
    /// Counted by its robot.
    pub number: u64,
    pub body: Value,
    /// As a line of a bulk request.
    pub bulk: bool,
    /// A 2xx came back: from here on it must be there.
    pub acknowledged: bool,
    /// The anchors that its detections were said to feed.
    pub anchors: Vec<String>,
}

/// One robot: a session of its own in a map that it shares.
pub(super) struct Writer {
    api: Api,
    session: String,
    keyframes_made: u64,
    acknowledge: UnboundedSender<()>,
    log: Log,
}

/// The server does not answer any more.
struct Gone;

impl From<reqwest::Error> for Gone {
    fn from(_: reqwest::Error) -> Self {
        Self
    }
}

impl Writer {
    pub fn new(api: &Api, map: &str, session: &str, acknowledge: UnboundedSender<()>) -> Self {
        Self {
            api: api.clone(),
            session: session.to_owned(),
            keyframes_made: 0,
            acknowledge,
            log: Log { map: map.to_owned(), keyframes: Vec::new(), loops: Vec::new() },
        }
    }

    /// Walks the corridor of `map` before anyone else does.
    pub async fn walk_ahead(api: &Api, map: &str, acknowledge: UnboundedSender<()>) -> Log {
        let mut ahead = Self::new(api, map, AHEAD, acknowledge);
        let written = ahead.write_in_bulk(KEYFRAMES_AHEAD).await;
        assert!(written.is_ok(), "{map}: the server is gone before anything was written");
        ahead.log
    }

    pub async fn write_until_the_server_is_gone(mut self) -> Log {
        for turn in 1_u64.. {
            let written = if turn.is_multiple_of(LOOP_EVERY) {
                self.close_a_loop(turn).await
            } else if turn.is_multiple_of(BULK_EVERY) {
                self.write_in_bulk(BULK_KEYFRAMES).await
            } else {
                self.write_one(turn).await
            };
            if written.is_err() {
                break;
            }
        }
        self.log
    }

    async fn write_one(&mut self, turn: u64) -> Result<(), Gone> {
        let sent = self.next_keyframe(false);
        let query = if turn.is_multiple_of(QUERY_EVERY) { "?query=loop" } else { "" };
        let path = format!("/v1/maps/{}/keyframes/{}{query}", self.log.map, sent.id);
        let request = self.api.request(Method::PUT, &path).json(&sent.body);
        // Remembered before it is sent: the server may have it without having said so.
        self.log.keyframes.push(sent);
        let answer = Answer::unless_gone(request).await?;
        if !answer.is_busy() {
            assert_eq!(answer.status, 201, "{path}: {}", answer.text());
            let keyframes = &mut self.log.keyframes;
            let sent = keyframes.last_mut().expect("pushed above");
            sent.acknowledged = true;
            sent.anchors = anchors_of(&answer.json());
            let _ = self.acknowledge.send(());
        }
        Ok(())
    }

    /// Each line that came back whole is an acknowledgement, even if the answer was cut after it.
    async fn write_in_bulk(&mut self, keyframes: u64) -> Result<(), Gone> {
        let first = self.log.keyframes.len();
        for _ in 0..keyframes {
            let sent = self.next_keyframe(true);
            self.log.keyframes.push(sent);
        }
        let sent = &mut self.log.keyframes[first..];
        let lines: String = sent.iter().map(Sent::as_bulk_line).collect();
        let path = format!("/v1/maps/{}/keyframes", self.log.map);
        let mut response = bulk(&self.api, &path, lines).send().await?;
        let status = response.status().as_u16();
        let mut answer = Vec::new();
        let cut = loop {
            match response.chunk().await {
                Ok(Some(chunk)) => answer.extend_from_slice(&chunk),
                Ok(None) => break false,
                Err(_) => break true,
            }
        };
        let text = String::from_utf8_lossy(&answer);
        if matches!(status, 429 | 503) {
            return if cut { Err(Gone) } else { Ok(()) };
        }
        assert!(matches!(status, 200 | 207), "{path}: {status} {text}");
        for line in text.split_inclusive('\n').filter(|line| line.ends_with('\n')) {
            let item: Value = serde_json::from_str(line).expect("a line is JSON");
            let status = item["status"].as_u64();
            assert_eq!(status, Some(201), "{path}: {line}");
            let sent = sent.iter_mut().find(|sent| item["id"] == *sent.id);
            sent.expect("an item that was sent").acknowledged = true;
            let _ = self.acknowledge.send(());
        }
        if cut { Err(Gone) } else { Ok(()) }
    }

    /// At the door where this robot stands, with the one that stood there before.
    async fn close_a_loop(&mut self, turn: u64) -> Result<(), Gone> {
        let mut here = self.log.keyframes.iter().rev().filter(|sent| sent.acknowledged);
        let Some(here) = here.next() else {
            return Ok(());
        };
        let id = format!("{}:loop-{turn}", self.session);
        let before = format!("{AHEAD}:{}", here.number % KEYFRAMES_AHEAD);
        let body = json!({"id": id, "keyframe": here.id, "candidate": before});
        let path = format!("/v1/maps/{}/loops", self.log.map);
        let request = self.api.request(Method::POST, &path).json(&body);
        self.log.loops.push(Sent::new(id, turn, body, false));
        let answer = Answer::unless_gone(request).await?;
        if !answer.is_busy() {
            assert_eq!(answer.status, 201, "{path}: {}", answer.text());
            self.log.loops.last_mut().expect("pushed above").acknowledged = true;
            let _ = self.acknowledge.send(());
        }
        Ok(())
    }

    fn next_keyframe(&mut self, bulk: bool) -> Sent {
        let number = self.keyframes_made;
        self.keyframes_made += 1;
        let id = format!("{}:{number}", self.session);
        Sent::new(id, number, keyframe(&self.session, number), bulk)
    }
}

impl Sent {
    fn new(id: String, number: u64, body: Value, bulk: bool) -> Self {
        Self { id, number, body, bulk, acknowledged: false, anchors: Vec::new() }
    }

    pub fn as_bulk_line(&self) -> String {
        let mut line = json!({"id": self.id});
        let (line_fields, body) = (line.as_object_mut(), self.body.as_object());
        let (line_fields, body) = (line_fields.expect("made above"), body.expect("made below"));
        line_fields.extend(body.clone());
        format!("{line}\n")
    }
}

/// A bulk request of these lines.
pub(super) fn bulk(api: &Api, path: &str, lines: String) -> reqwest::RequestBuilder {
    let request = api.request(Method::POST, path);
    request.header("content-type", "application/x-ndjson").body(lines)
}

/// The `number`th keyframe of a session: a robot that walks along a corridor of numbered doors.
///
/// Every number is a sum of few powers of two: it is the same number as an `f32`.
pub(super) fn keyframe(session: &str, number: u64) -> Value {
    let x = number as f64 * 0.5;
    let observed = number * POINTS_STEP..number * POINTS_STEP + OBSERVED_POINTS;
    let observed: Vec<u64> = observed.collect();
    let positions: Vec<[f64; 3]> = observed.iter().map(|id| [*id as f64 * 0.0625, 1.0, 2.0]).collect();
    let word = number * 2;
    let mut body = json!({
        "session": session,
        "stamp": {"sec": 1000 + number, "nanosec": 500},
        "pose": {"translation": {"x": x, "y": 0.25, "z": -1.5}, "rotation": {"x": 0.5, "y": 0.5, "z": 0.5, "w": 0.5}},
        "camera": {"fx": 525.0, "fy": 525.5, "cx": 320.0, "cy": 240.0, "width": 640, "height": 480},
        "bow": {"words": [word, word + 1, word + 2, 5000], "weights": [0.5, 0.25, 0.125, 0.125]},
        "map_points": {"ids": observed, "positions": positions},
        "observes": observed,
    });
    if number.is_multiple_of(DETECTION_EVERY) {
        body["detections"] = json!([{
            "class": "door_number", "confidence": 0.875, "box": [100.0, 120.0, 180.0, 160.5],
            "position": [x + 1.0, 0.5, 2.0], "text": format!("{}", 900 + number)}]);
    }
    body
}

fn anchors_of(answer: &Value) -> Vec<String> {
    let detections = answer["detections"].as_array().into_iter().flatten();
    let anchors = detections.filter_map(|detection| detection["anchor"].as_str());
    anchors.map(str::to_owned).collect()
}
