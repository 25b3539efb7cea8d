//! Mix: what a fleet asks. Of ten requests five bring a keyframe with words and features, three ask whether one is a
//! loop, two read.

use std::fmt::Write as _;

/// Words of a keyframe.
const WORDS: u64 = 300;
/// Features of a keyframe.
const FEATURES: u64 = 400;
/// Keyframes that a map has from the start.
pub const KNOWN: u64 = 60;
/// Maps that the fleet writes to.
pub const MAPS: u64 = 8;
/// Bodies made beforehand; a robot sees other places, not the same one always.
const PLACES: u64 = 40;

/// The requests of one phase: its maps are its own, so that every phase begins with the same maps.
pub struct Mix {
    phase: String,
    bodies: Vec<String>,
}

impl Mix {
    pub fn new(phase: &str) -> Self {
        Self { phase: phase.to_owned(), bodies: (0..PLACES).map(keyframe).collect() }
    }

    /// The requests that make the maps and what they have from the start.
    pub fn first(&self) -> Vec<Vec<u8>> {
        let maps = (0..MAPS).map(|map| request("PUT", &self.map(map), "{}"));
        let known = (0..MAPS).flat_map(|map| (0..KNOWN).map(move |number| (map, number)));
        maps.chain(known.map(|(map, number)| self.put(map, &format!("known-{number}"), number))).collect()
    }

    /// The n-th request.
    pub fn nth(&self, number: u64) -> Vec<u8> {
        let (map, known) = (number / 10 % MAPS, number * 7 % KNOWN);
        let path = self.map(map);
        match number % 10 {
            0 | 2 | 4 | 6 | 8 => self.put(map, &format!("kf-{number}"), number / 10 * 5 + number % 10 / 2),
            1 | 5 | 9 => request(
                "POST",
                &format!("{path}/loop-queries"),
                &format!("{{\"keyframe\":\"known-{known}\"}}"),
            ),
            3 => request("GET", &format!("{path}/keyframes?limit=20"), ""),
            _ => request("GET", &format!("{path}/keyframes/known-{known}"), ""),
        }
    }

    fn put(&self, map: u64, id: &str, place: u64) -> Vec<u8> {
        request("PUT", &format!("{}/keyframes/{id}", self.map(map)), &self.bodies[(place % PLACES) as usize])
    }

    fn map(&self, map: u64) -> String {
        format!("/v1/maps/{}-{map}", self.phase)
    }
}

pub fn request(method: &str, path: &str, body: &str) -> Vec<u8> {
    let length = body.len();
    let says = match length {
        0 => String::new(),
        _ => format!("content-type: application/json\r\ncontent-length: {length}\r\n"),
    };
    format!("{method} {path} HTTP/1.1\r\nhost: localhost\r\n{says}\r\n{body}").into_bytes()
}

fn keyframe(place: u64) -> String {
    // Neighbours share words; the numbers are arbitrary and always the same.
    let words = list(WORDS, |word| (place * 25 + word * 3).to_string());
    let weights = list(WORDS, |_| "1".to_owned());
    let keypoints = list(FEATURES, |n| format!("[{},{},{}]", n * 37 % 640, n * 53 % 480, n % 8));
    let points = list(FEATURES, |_| "-1".to_owned());
    let descriptors = "QUJDREVGR0hJSktMTU5PUFFSU1RVVldYWVphYmNkZWZn".chars().cycle();
    // Three bytes are four digits; what is left over is said by the last ones.
    let digits: String = descriptors.take((FEATURES * 32 / 3 * 4) as usize).collect();
    let rest = ["", "QQ==", "QUI="][(FEATURES * 32 % 3) as usize];
    let (x, session, number) = (place as f64 * 0.5, place % 4, 100 + place);
    format!(
        r#"{{"session":"robot-{session}","stamp":{{"sec":{place},"nanosec":0}},
"pose":{{"translation":{{"x":{x},"y":0,"z":0}},"rotation":{{"x":0,"y":0,"z":0,"w":1}}}},
"camera":{{"fx":525,"fy":525,"cx":320,"cy":240,"width":640,"height":480}},
"bow":{{"words":{words},"weights":{weights}}},
"features":{{"descriptor_bytes":32,"descriptors":"{digits}{rest}","keypoints":{keypoints},"map_points":{points}}},
"detections":[{{"class":"door_number","confidence":0.9,"box":[10,10,60,40],"position":[{x},1,2],"text":"{number}"}}]}}"#
    )
}

fn list(count: u64, item: impl Fn(u64) -> String) -> String {
    let mut list = String::from("[");
    for n in 0..count {
        let comma = if n == 0 { "" } else { "," };
        // Writing into a string does not fail.
        let _ = write!(list, "{comma}{}", item(n));
    }
    list + "]"
}
