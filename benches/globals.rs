//! The search by global descriptors at 100,000 keyframes, on one core: how long, and how much memory.
//!
//! `cargo bench --bench globals [-- KEYFRAMES...]`. One query is the likeness of one descriptor to all of the map; a ranking is
//! that and the best 320 of them, as many as the candidate search looks at first.

use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use revisit::domain::change::Change;
use revisit::domain::global_descriptor::{GlobalDescriptor, GlobalEncoding};
use revisit::domain::ids::KeyframeSeq;
use revisit::recognition::map::covisible_groups::{PlaceLimits, PlaceScratch, best_places};
use revisit::recognition::map::index::MapIndex;

const SEED: u64 = 20;
const QUERIES: usize = 200;
/// For each of them 16 keyframes are ranked.
const PLACES: usize = 20;
/// Encoding, bytes of a descriptor, and the time that a query may take at 100,000 keyframes, in milliseconds.
const FORMS: [(GlobalEncoding, usize, f64); 2] =
    [(GlobalEncoding::Int8, 512, 10.0), (GlobalEncoding::Bits, 1_056, 12.0)];

fn main() {
    let asked: Vec<u32> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    let sizes = if asked.is_empty() { vec![100_000] } else { asked };
    println!("keyframes  encoding  bytes  query p50  p95 (ms)  ranking p50  p95 (ms)  MiB  goal (ms)");
    for keyframes in sizes {
        for (encoding, bytes, goal_ms) in FORMS {
            measure(keyframes, encoding, bytes, goal_ms);
        }
    }
}

fn measure(keyframes: u32, encoding: GlobalEncoding, bytes: usize, goal_ms: f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut descriptor = || GlobalDescriptor {
        model: "drawn".parse().expect("an id"),
        encoding,
        data: (0..bytes).map(|_| rng.random::<u8>()).collect(),
    };
    let mut index = MapIndex::default();
    let empty = index.memory_bytes();
    for keyframe in 0..keyframes {
        index.apply(&[Change::GlobalDescriptorSet(KeyframeSeq(keyframe), Box::new(descriptor()))]);
    }
    let (mut queries, mut rankings, mut scores) = (Vec::new(), Vec::new(), Vec::new());
    let mut place_scratch = PlaceScratch::default();
    for _ in 0..QUERIES {
        let sought = descriptor();
        scores.clear();
        let begun = Instant::now();
        index.globals().score_all(&sought, &mut scores);
        queries.push(begun.elapsed());
        assert_eq!(scores.len(), keyframes as usize);
        let begun = Instant::now();
        scores.clear();
        index.globals().score_all(&sought, &mut scores);
        let best = best_places(
            || scores.iter().copied(),
            PlaceLimits { places_max: PLACES, min_score: 0.0 },
            |keyframe| keyframe % 100 == 0,
            |a, b| a.cmp(&b),
            |_| [],
            &mut place_scratch,
        );
        rankings.push(begun.elapsed());
        assert_eq!(best.len(), PLACES.min(keyframes as usize));
    }
    let [query_p50, query_p95] = percentiles_ms(queries);
    let [ranking_p50, ranking_p95] = percentiles_ms(rankings);
    let memory = (index.memory_bytes() - empty) as f64 / f64::from(1 << 20);
    let name = encoding.as_str();
    println!(
        "{keyframes:9}  {name:>8}  {bytes:5}  {query_p50:9.2}  {query_p95:8.2}  {ranking_p50:11.2}  {ranking_p95:8.2}  \
         {memory:3.0}  {goal_ms:9.0}"
    );
}

fn percentiles_ms(mut times: Vec<Duration>) -> [f64; 2] {
    times.sort_unstable();
    [50, 95].map(|percent| times[times.len() * percent / 100].as_secs_f64() * 1e3)
}
