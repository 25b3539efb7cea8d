//! Scene: keyframes that bring crops, and the ear that hears what a map tells.

use std::time::Duration;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use futures_util::StreamExt as _;
use reqwest::{Method, RequestBuilder};
use revisit::engine::ModelChoice;
use serde_json::{Value, json};

use crate::support::{Server, pose};

/// Nothing here takes so long unless it hangs.
pub const HANGS_AFTER: Duration = Duration::from_mins(2);

/// One painting in the words of two robots.
pub const LADY: &str = "a portrait of a lady with a mysterious smile";
pub const LISA: &str = "the famous portrait of Mona Lisa";

/// A PNG file of one colour.
pub fn png(width: u32, height: u32, colour: [u8; 3]) -> Vec<u8> {
    let picture = image::RgbImage::from_pixel(width, height, image::Rgb(colour));
    let mut file = Vec::new();
    let to = &mut std::io::Cursor::new(&mut file);
    image::DynamicImage::ImageRgb8(picture).write_to(to, image::ImageFormat::Png).unwrap();
    file
}

/// A detection of a class at a place, with a crop of one colour and no text.
pub fn crop(class: &str, at: [f64; 3], colour: [u8; 3]) -> Value {
    json!({
        "class": class, "confidence": 0.9, "box": [100.0, 100.0, 160.0, 140.0], "position": at,
        "crop": STANDARD.encode(png(60, 40, colour))
    })
}

/// A detection of a class at a place, with a description.
pub fn described(class: &str, at: [f64; 3], description: &str) -> Value {
    json!({
        "class": class, "confidence": 0.9, "box": [100.0, 100.0, 160.0, 140.0], "position": at,
        "description": description
    })
}

/// A keyframe at x that looks along z, with detections.
pub fn keyframe(sec: i64, x: f64, detections: &[Value]) -> Value {
    json!({
        "stamp": {"sec": sec, "nanosec": 0}, "pose": pose([x, 0.0, 0.0]),
        "bow": {"words": [3, 17, 42], "weights": [1.0, 1.0, 1.0]},
        "detections": detections
    })
}

/// Starts a server that asks these models, with an empty map `m`.
pub async fn server_with_map(models: ModelChoice) -> Server {
    let server = Server::with_models(models).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    server
}

/// Stores two keyframes 50 m apart, each before a painting with its description.
/// By the paper's letter such paintings are a loop; the sum of evidence asks for a name beside them.
pub async fn put_paintings(server: &Server, first: &str, second: &str) {
    let letter = json!({"settings": {"method": "paper"}});
    server.patch("/v1/maps/m", &letter).await.expect(200);
    for (id, sec, x, description) in [("kf-1", 1, 0.0, first), ("kf-2", 90, 50.0, second)] {
        put(server, "m", id, &keyframe(sec, x, &[described("painting", [x, 0.0, 2.0], description)])).await;
    }
}

/// Stores two keyframes 50 m apart, before a plate that says room 901 and before one that nobody has read.
pub async fn put_plates(server: &Server) {
    let mut read = crop("door_number", [0.0, 0.0, 2.0], [9, 9, 9]);
    read["text"] = json!("room 901");
    put(server, "m", "kf-1", &keyframe(1, 0.0, &[read])).await;
    put(server, "m", "kf-2", &keyframe(90, 50.0, &[crop("door_number", [50.0, 0.0, 2.0], [8, 8, 8])])).await;
}

/// Stores a keyframe.
pub async fn put(server: &Server, map: &str, id: &str, body: &Value) -> Value {
    server.put(&format!("/v1/maps/{map}/keyframes/{id}"), body).await.expect(201)
}

/// Listens to a map from its beginning until an event is the wanted one; all events up to it.
pub async fn hear(server: &Server, map: &str, wanted: impl Fn(&Value) -> bool) -> Vec<Value> {
    hear_stream(server.request(Method::GET, &format!("/v1/maps/{map}/events?since=0")), wanted).await
}

/// The same, of any server.
pub async fn hear_stream(listen: RequestBuilder, wanted: impl Fn(&Value) -> bool) -> Vec<Value> {
    let listening = async {
        let response = listen.send().await.unwrap();
        let (mut stream, mut text, mut heard) = (response.bytes_stream(), String::new(), Vec::new());
        while let Some(chunk) = stream.next().await {
            text.push_str(&String::from_utf8_lossy(&chunk.unwrap()));
            while let Some((message, rest)) =
                text.split_once("\n\n").map(|(a, b)| (a.to_owned(), b.to_owned()))
            {
                text = rest;
                let data = message.lines().find_map(|line| line.strip_prefix("data: "));
                let Some(event) = data.map(|data| serde_json::from_str::<Value>(data).unwrap()) else {
                    continue;
                };
                heard.push(event);
                if wanted(&heard[heard.len() - 1]) {
                    return heard;
                }
            }
        }
        panic!("the stream ended: {heard:#?}");
    };
    tokio::time::timeout(HANGS_AFTER, listening).await.expect("the event comes")
}

/// Is this event the description of an anchor?
pub fn describes(anchor: &str) -> impl Fn(&Value) -> bool {
    move |event| event["event"] == "anchor_described" && event["anchor"] == anchor
}
