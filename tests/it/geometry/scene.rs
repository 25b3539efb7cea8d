//! Planted rooms, seen from planted places.

use base64::Engine as _;
use revisit::geometry::{Point3, Pose};
use serde_json::{Value, json};

use crate::support::Server;

pub const POINTS: u64 = 90;

pub const DOOR: (&str, [f64; 3]) = ("room 901", [0.5, 0.0, 3.0]);

/// Small random numbers in [0, 1) that depend on nothing but their place (splitmix64).
pub fn random(seed: u64) -> f64 {
    let mut z = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x1234_5678_9abc_def1);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// A keyframe of room `room`, taken from `world_from_camera` by a robot whose frame is `session_from_world`.
pub struct Shot {
    pub room: u64,
    /// The room whose pictures hang in it: its descriptors.
    pub looks_like: u64,
    pub points: u64,
    pub world_from_camera: Pose,
    pub session_from_world: Pose,
    /// The robot's metre, in metres.
    pub unit_m: f64,
    /// Texts and where they hang in the world.
    pub plates: Vec<(&'static str, [f64; 3])>,
}

impl Shot {
    pub fn of(room: u64, world_from_camera: Pose) -> Self {
        let session_from_world = Pose::identity();
        Self {
            room,
            looks_like: room,
            points: POINTS,
            world_from_camera,
            session_from_world,
            unit_m: 1.0,
            plates: Vec::new(),
        }
    }

    pub fn looking_like(mut self, room: u64) -> Self {
        self.looks_like = room;
        self
    }

    pub fn plates(mut self, plates: &[(&'static str, [f64; 3])]) -> Self {
        self.plates = plates.to_vec();
        self
    }

    pub fn in_session(&self, point: &Point3) -> [f64; 3] {
        let p = self.session_from_world.transform(point) / self.unit_m;
        [p.x, p.y, p.z]
    }

    pub fn body(&self, session: &str, features: bool) -> Value {
        let map_from_camera = self.session_from_world.after(&self.world_from_camera);
        let [tx, ty, tz] = map_from_camera.translation_m().map(|t| t / self.unit_m);
        let [qx, qy, qz, qw] = map_from_camera.rotation_xyzw();
        let (mut keypoints, mut bytes, mut ids, mut positions) = (vec![], vec![], vec![], vec![]);
        for number in 0..self.points {
            let draw = |axis: u64| random(self.room * 1_000_000 + number * 64 + axis);
            let point = Point3::new(draw(0) * 5.0 - 2.5, draw(1) * 3.0 - 1.5, draw(2) * 4.0 + 2.5);
            let seen = self.world_from_camera.inverse_transform(&point);
            if seen.z < 0.3 {
                continue;
            }
            keypoints.push(json!([seen.x / seen.z * 525.0 + 320.0, seen.y / seen.z * 525.0 + 240.0, 0]));
            let look = |byte: u64| random(self.looks_like * 1_000_000 + number * 64 + 8 + byte);
            bytes.extend((0..32).map(|byte| (look(byte) * 256.0) as u8));
            ids.push(number);
            positions.push(json!(self.in_session(&point)));
        }
        let mut body = json!({
            "session": session, "stamp": {"sec": 1, "nanosec": 0},
            "pose": {"translation": {"x": tx, "y": ty, "z": tz}, "rotation": {"x": qx, "y": qy, "z": qz, "w": qw}},
            "bow": {"words": [1, 2], "weights": [1, 1]}, "covisible": [],
            "detections": self.plates.iter().map(|(text, at)| json!({
                "class": "door_number", "confidence": 0.9, "box": [0, 0, 10, 10], "text": text,
                "position": self.in_session(&Point3::from(*at))})).collect::<Vec<_>>(),
        });
        if features {
            body["camera"] = json!({"fx": 525, "fy": 525, "cx": 320, "cy": 240, "width": 640, "height": 480});
            body["map_points"] = json!({"ids": ids, "positions": positions});
            body["features"] = json!({"descriptor_bytes": 32, "keypoints": keypoints, "map_points": ids,
                "descriptors": base64::engine::general_purpose::STANDARD.encode(bytes)});
        }
        body
    }
}

pub fn pose(translation: [f64; 3], about_y_deg: f64) -> Pose {
    let half = about_y_deg.to_radians() / 2.0;
    Pose::new(translation, [0.0, half.sin(), 0.0, half.cos()]).unwrap()
}

pub async fn map(settings: Value, metric: bool) -> Server {
    let server = Server::start().await;
    server.put("/v1/maps/m", &json!({"settings": settings, "metric": metric})).await.expect(201);
    server
}

pub async fn store(server: &Server, id: &str, body: &Value) {
    server.put(&format!("/v1/maps/m/keyframes/{id}"), body).await.expect(201);
}

pub async fn ask(server: &Server, verify: &str) -> Value {
    server.post("/v1/maps/m/loop-queries", &json!({"keyframe": "query", "verify": verify})).await.expect(200)
}

/// The verdict, and the only candidate.
pub async fn asked(candidate: &Value, query: &Value, settings: Value, verify: &str) -> (String, Value) {
    let server = map(settings, true).await;
    store(&server, "candidate", candidate).await;
    store(&server, "query", query).await;
    let answer = ask(&server, verify).await;
    (answer["verdict"].as_str().unwrap().to_owned(), answer["candidates"][0].clone())
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Returns how far an answered transformation is from the planted one: metres, degrees.
pub fn off(answered: &Value, planted: &Pose) -> (f64, f64) {
    let (t, r) = (&answered["translation"], &answered["rotation"]);
    let answered =
        Pose::new(["x", "y", "z"].map(|axis| number(&t[axis])), ["x", "y", "z", "w"].map(|i| number(&r[i])));
    let answered = answered.expect("a rotation");
    let [.., w] = planted.inverse().after(&answered).rotation_xyzw();
    ((planted.centre() - answered.centre()).norm(), 2.0 * w.abs().min(1.0).acos().to_degrees())
}

pub fn query_pose() -> Pose {
    pose([0.4, 0.1, 0.3], 10.0)
}

/// A body whose plates a model or a person described.
pub fn described(mut body: Value) -> Value {
    for detection in body["detections"].as_array_mut().unwrap() {
        let text = detection.as_object_mut().and_then(|detection| detection.remove("text"));
        detection["description"] = text.unwrap();
    }
    body
}

/// A body whose points nobody has triangulated.
pub fn flat(session: &str, shot: Shot) -> Value {
    let mut body = shot.body(session, true);
    body["map_points"] = json!({"ids": [], "positions": []});
    body
}
