//! Curves: what it costs where n keyframes see the same points, or n texts share their words.

use std::time::Duration;

use revisit::domain::bow::BowVector;
use revisit::domain::keyframe::{Detection, NewKeyframe, Stamp};
use revisit::domain::verdict::Verify;
use revisit::geometry::{Point3, Pose};
use revisit::recognition::anchors::ingest::ingest;
use revisit::recognition::loops::check_loop::screen;
use revisit::recognition::loops::query::Query;
use revisit::recognition::map::index::MapIndex;

use crate::{again, process};

/// Inserts at the end of each curve that its figure is the mean of.
const MEASURED: u32 = 100;
const QUERIES: u32 = 3;
/// Texts of an ordinary query, and the most that a body may bring.
const TEXTS_ASKED: [u32; 2] = [10, 500];
/// Keyframes whose detections share one place of `room`.
const DETECTIONS_OF_KEYFRAME: u32 = 250;

const CURVES: [(&str, &str, &[u32]); 5] = [
    ("covisible", "n keyframes that see the same 15 map points", &[1_000, 4_000, 10_000]),
    ("words", "n anchors, \"a red wooden boat on a stormy lake, NAME NAME\"", &[1_000, 10_000]),
    ("rooms", "n anchors, \"room 901 NAME\"", &[1_000, 10_000]),
    ("numbering", "n anchors, \"7.04\" and so on", &[1_000, 10_000]),
    ("place", "n anchors of one place, \"room 901 NAME\"", &[500, 1_000, 2_000]),
];

/// Prints every curve. A map of 100,000 texts that all share their words is not filled within five minutes: `crowd rooms 100000`.
pub fn print_curves() {
    for (curve, what, sizes) in CURVES {
        println!("{what}");
        for size in sizes {
            print!("{}", again(&["crowd", curve, &size.to_string()], &format!("n = {size}")));
        }
    }
}

/// Measures one point of a curve.
pub fn measure(curve: &str, size: u32) {
    match curve {
        "covisible" => covisible(size),
        "numbering" => numbering(size),
        "place" => texts(size, room, in_one_place),
        "rooms" => texts(size, room, apart),
        _ => texts(size, words, apart),
    }
}

fn covisible(size: u32) {
    let mut index = MapIndex::default();
    let before = process::resident_bytes();
    let keyframe = |number| NewKeyframe { observes: (1..=15).collect(), ..bare(number) };
    let insert = mean_of_last(size, |number| drop(ingest(&mut index, &keyframe(number))));
    let grown = process::resident_bytes().saturating_sub(before);
    println!(
        "{:>9.1} MB, {:>6} bytes a keyframe; insert {}",
        grown as f64 / 1e6,
        grown / u64::from(size),
        shown(insert)
    );
}

/// Measures the write with which a map learns a numbering, and so parses every text of the class anew.
fn numbering(size: u32) {
    // Nine of ten values have been read alike.
    const ALIKE: u32 = 9;
    let plate = |number: u32| format!("{}.{:02}", number / 100, number % 100);
    let mut index = MapIndex::default();
    let mut insert = |number: u32, plate_number: u32| {
        let sight = detection(number, |_| String::new(), f64::from(number) * 9.0);
        let sight = Detection { text: Some(plate(plate_number)), ..sight };
        let before = process::cpu_time();
        ingest(&mut index, &NewKeyframe { detections: vec![sight], ..bare(number) });
        process::cpu_time().saturating_sub(before)
    };
    for number in 0..size {
        insert(number, number + 100);
    }
    let before = (0..ALIKE).map(|number| insert(size + number, number + 100)).max().unwrap_or_default();
    let learning = insert(size + ALIKE, ALIKE + 100);
    let after = insert(size + ALIKE + 1, ALIKE + 101);
    println!(
        "a write before at most {}; that learns {}; after {}",
        shown(before),
        shown(learning),
        shown(after)
    );
}

/// What the object of a number is called.
type Naming = fn(u32) -> String;

/// Puts objects with these texts into a map, by these keyframes, and asks what texts like them match.
fn texts(size: u32, text: Naming, place: fn(u32, Naming) -> NewKeyframe) {
    let mut index = MapIndex::default();
    let seen = place(0, text).detections.len() as u32;
    let insert = mean_of_last(size.div_ceil(seen), |number| drop(ingest(&mut index, &place(number, text))));
    print!("insert {}", shown(insert / seen));
    for asked in TEXTS_ASKED {
        let detections = (0..asked).map(|number| detection(size + number, text, f64::from(number) * 9.0));
        let query = NewKeyframe { detections: detections.collect(), ..bare(u32::MAX) };
        print!("; a query of {asked} texts {}", shown(asking(&index, |index| Query::inline(index, &query))));
    }
    let last =
        index.keyframe(index.next_keyframe()).or(index.keyframes().last()).map(|keyframe| keyframe.seq);
    let bow = BowVector::default();
    let stored = last.expect("a keyframe");
    println!(
        "; of a stored keyframe {}",
        shown(asking(&index, |index| Query::stored(index, stored, &bow).expect("it is stored")))
    );
}

fn asking<'a>(index: &'a MapIndex, query: impl Fn(&'a MapIndex) -> Query<'a>) -> Duration {
    let before = process::cpu_time();
    for _ in 0..QUERIES {
        std::hint::black_box(screen(index, 1, &query(index), Verify::Auto));
    }
    process::cpu_time().saturating_sub(before) / QUERIES
}

fn mean_of_last(size: u32, mut insert: impl FnMut(u32)) -> Duration {
    let measured = MEASURED.min(size / 2 + 1);
    (0..size - measured).for_each(&mut insert);
    let before = process::cpu_time();
    (size - measured..size).for_each(insert);
    process::cpu_time().saturating_sub(before) / measured
}

fn shown(time: Duration) -> String {
    format!("{:.3} ms", time.as_secs_f64() * 1e3)
}

fn apart(number: u32, text: Naming) -> NewKeyframe {
    NewKeyframe { detections: vec![detection(number, text, f64::from(number) * 9.0)], ..bare(number) }
}

/// All keyframes see the same points, and each sees objects of its own.
fn in_one_place(number: u32, text: Naming) -> NewKeyframe {
    let first = number * DETECTIONS_OF_KEYFRAME;
    let detections = (first..first + DETECTIONS_OF_KEYFRAME)
        .map(|object| detection(object, text, f64::from(object) * 0.9));
    NewKeyframe { observes: (1..=20).collect(), detections: detections.collect(), ..bare(number) }
}

fn detection(number: u32, text: Naming, x: f64) -> Detection {
    Detection {
        position_in_session: Some(Point3::new(x, 2.0, 0.0)),
        text: Some(text(number)),
        ..Detection::of("sign", 0.9, [100.0, 100.0, 160.0, 130.0])
    }
}

fn bare(number: u32) -> NewKeyframe {
    let id = format!("kf-{number}").parse().expect("an id");
    let stamp = Stamp { sec: i64::from(number), nanosec: 0 };
    let pose =
        Pose::new([f64::from(number % 100_000) * 9.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]).expect("a pose");
    NewKeyframe { session: "run".parse().expect("an id"), ..NewKeyframe::at(id, stamp, pose) }
}

fn name(number: u32) -> String {
    (0..5).map(|at| char::from(b'b' + (number >> (at * 4) & 15) as u8)).collect()
}

fn room(number: u32) -> String {
    format!("room 901 x{}", name(number))
}

fn words(number: u32) -> String {
    format!("a red wooden boat on a stormy lake, x{} y{}", name(number), name(number / 3))
}
