//! The same bytes on any processor: a digest of every verdict is committed, and compared on the machine that runs this.

use std::fs;
use std::path::{Path, PathBuf};

use revisit::api::space::rounded;
use revisit::hotel::building::floor_plan::Layout;
use revisit::hotel::building::signs::SignPlan;
use revisit::hotel::building::texture::Patterns;
use revisit::hotel::building::world::{World, WorldPlan};
use revisit::hotel::recording::recording;
use revisit::hotel::rng::SeededRng;
use revisit::hotel::route::tour;
use revisit::hotel::run::Course;
use revisit::hotel::sensing::noise::Noise;
use revisit::hotel::sequence::Sequence;
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};

use crate::support::Server;

/// The committed digests: one a line, as `sha256sum` writes them.
const DIGESTS: &str = "tests/data/verdicts.sha256";
/// Where this variable is set, the digests are written instead of compared.
const UPDATE: &str = "REVISIT_TEST_UPDATE";

/// The verdicts of a source, or what was sent, one a line.
struct NamedLines {
    name: String,
    lines: Vec<String>,
}

impl NamedLines {
    fn new(name: &str, lines: impl IntoIterator<Item = Value>) -> Self {
        let lines = lines.into_iter().map(|line| format!("{line}\n")).collect();
        Self { name: name.to_owned(), lines }
    }

    fn digest(&self) -> String {
        let hash = Sha256::digest(self.lines.concat());
        let hex = hash.iter().fold(String::new(), |hex, byte| hex + &format!("{byte:02x}"));
        format!("{hex}  {}\n", self.name)
    }

    /// Writes the lines to a file, so that those of two machines can be compared.
    fn write(&self, folder: &Path) {
        fs::write(folder.join(format!("{}.ndjson", self.name)), self.lines.concat()).unwrap();
    }
}

fn in_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Returns the lines of a committed recording.
fn committed(name: &str) -> Vec<Value> {
    let file = fs::File::open(in_repository(&format!("tests/data/recordings/{name}.ndjson.zst"))).unwrap();
    let text = String::from_utf8(zstd::decode_all(file).unwrap()).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Returns the lines of a short tour: a room, another one, and the first again.
fn hotel() -> Vec<Value> {
    const SEED: u64 = 7;
    const DRIFT_M: f64 = 0.6;
    const ROOMS: [usize; 3] = [3, 5, 3];
    let patterns = Patterns::new();
    let plan = WorldPlan { layout: Layout::SE1, floor: 9, signs: SignPlan::default(), seed: SEED };
    let world = World::new(&plan, &patterns);
    let stops = tour(&world.plan, &ROOMS, &mut SeededRng::new(SEED, "route"));
    let course = Course::new(vec![Sequence::record(&world, &stops, Noise::default(), DRIFT_M, SEED)]);
    let mut lines = recording("hotel", &course, &patterns.vocabulary().unwrap()).unwrap();
    // The simulation computes with the platform's sines. Its last bits are no part of what is shown here.
    lines.iter_mut().for_each(round);
    lines
}

fn round(value: &mut Value) {
    match value {
        Value::Number(number) if number.is_f64() => *value = json!(rounded(number.as_f64().unwrap())),
        Value::Array(items) => items.iter_mut().for_each(round),
        Value::Object(members) => members.values_mut().for_each(round),
        _ => {}
    }
}

/// Returns the same keyframes without signs and without positions of points, so that images alone are compared, and a share of the
/// questions, as these take long.
fn images_alone(mut lines: Vec<Value>) -> Vec<Value> {
    const ASKED_OF: usize = 5;
    let mut asked = (0..ASKED_OF).cycle();
    lines.retain(|line| line["op"] != "query" || asked.next() == Some(0));
    for line in &mut lines {
        match line["op"].as_str() {
            Some("map") => {
                line["body"]["settings"] = json!({"without_anchors": "geometry",
                    "building_repeats": false, "loop_min_confidence": 0.6});
            }
            Some("keyframe") => {
                line["body"]["detections"] = json!([]);
                line["body"]["map_points"] = json!({"ids": [], "positions": []});
            }
            _ => {}
        }
    }
    lines
}

fn by_the_paper(mut lines: Vec<Value>) -> Vec<Value> {
    lines[0]["body"]["settings"]["method"] = json!("paper");
    lines
}

/// Plays the lines of a recording to a server, and returns its verdicts.
async fn verdicts(name: &str, lines: Vec<Value>) -> NamedLines {
    let server = Server::start().await;
    let mut verdicts = Vec::new();
    for line in &lines {
        let body = &line["body"];
        match line["op"].as_str() {
            Some("map") => drop(server.put("/v1/maps/m", body).await.expect(201)),
            Some("keyframe") => {
                let id = line["id"].as_str().unwrap();
                server.put(&format!("/v1/maps/m/keyframes/{id}"), body).await.expect(201);
            }
            Some("query") => {
                let mut query = body.clone();
                query["keyframe"] = line["keyframe"].clone();
                let mut verdict = server.post("/v1/maps/m/loop-queries", &query).await.expect(200);
                // What counts the questions and the writes is no part of the answer.
                for member in ["id", "map_version"] {
                    assert_ne!(verdict[member].take(), Value::Null, "{verdict:#}");
                }
                verdicts.push(verdict);
            }
            other => panic!("no operation of these recordings: {other:?}"),
        }
    }
    server.stop().await;
    NamedLines::new(name, verdicts)
}

fn loops(played: &NamedLines) -> usize {
    played.lines.iter().filter(|line| line.contains(r#""best":""#)).count()
}

#[tokio::test(flavor = "multi_thread")]
async fn every_verdict_is_to_the_byte_the_committed_one() {
    let (tower, boards, hotel) = (committed("tower"), committed("tower_boards"), hotel());
    let sent = NamedLines::new("hotel-sent", hotel.clone());
    let (a, b, c, d, e, f, g) = tokio::join!(
        verdicts("tower", tower.clone()),
        verdicts("tower-paper", by_the_paper(tower)),
        verdicts("tower_boards", boards.clone()),
        verdicts("tower_boards-paper", by_the_paper(boards)),
        verdicts("hotel", hotel.clone()),
        verdicts("hotel-paper", by_the_paper(hotel.clone())),
        verdicts("hotel-images", images_alone(hotel)),
    );
    let answered = [a, b, c, d, e, f, g];
    for of_source in &answered {
        assert!(loops(of_source) > 0, "{} has no loop, and so shows little", of_source.name);
    }
    let all = answered.iter().chain([&sent]);
    let now: String = all.clone().map(NamedLines::digest).collect();
    let file = in_repository(DIGESTS);
    if std::env::var_os(UPDATE).is_some() {
        fs::write(file, now).unwrap();
        return;
    }
    if fs::read_to_string(file).unwrap_or_default() != now {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("verdicts");
        fs::create_dir_all(&folder).unwrap();
        all.for_each(|lines| lines.write(&folder));
        panic!(
            "The verdicts are not those of {DIGESTS}. On this machine ({arch}) the digests are:\n\n{now}\n\
            A change of the method changes them in its own commit:\n\n    {UPDATE}=1 cargo test --test it verdicts\n\n\
            Without such a change this machine computes other bytes: please report it. Where `hotel-sent` differs, it is the \
            simulation that computes them. {folder} holds the verdicts, to compare with another machine's.",
            arch = std::env::consts::ARCH,
            folder = folder.display(),
        );
    }
}
