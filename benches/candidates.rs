//! The candidate search at 1,000, 10,000 and 100,000 keyframes: how long, how much memory, and does it find the place.
//!
//! `cargo bench --bench candidates [-- KEYFRAMES...]`. One query is the whole search of §V's first two checks: every
//! keyframe of the map scored, those covisible with the query left out, the rest grouped into places.

use std::collections::HashSet;
use std::ops::Range;
use std::time::{Duration, Instant};

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use revisit::domain::bow::BowVector;
use revisit::recognition::map::covisible_groups::{PlaceLimits, PlaceScratch, best_places};
use revisit::recognition::map::inverted_file::{InvertedFile, Scratch};

const SEED: u64 = 20;
const QUERIES: usize = 500;
const LIMITS: PlaceLimits = PlaceLimits { places_max: 20, min_score: 0.0 };
/// Keyframes -> what ORB-SLAM3's search was measured to take on such a map, in milliseconds.
const ORB_SLAM3_MS: [(u32, f64); 2] = [(10_000, 27.0), (100_000, 370.0)];

fn main() {
    let asked: Vec<u32> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    let sizes = if asked.is_empty() { vec![1_000, 10_000, 100_000] } else { asked };
    let reports: Vec<Report> = sizes.into_iter().map(measure).collect();
    print_table(&reports);
}

struct Report {
    keyframes: u32,
    query: Percentiles,
    insert: Percentiles,
    inserts_total: Duration,
    load: Duration,
    postings_per_query: f64,
    bytes_per_keyframe: f64,
    words_per_keyframe: f64,
    found_first: f64,
    found_at_all: f64,
}

fn measure(keyframes: u32) -> Report {
    let map = DrawnMap::new(keyframes);
    let mut order: Vec<u32> =
        (0..keyframes).filter(|&keyframe| map.other_visit(keyframe).is_some()).collect();
    order.shuffle(&mut rng(&[3]));
    order.truncate(QUERIES);
    let wanted: HashSet<u32> = order.iter().copied().collect();

    let mut file = InvertedFile::default();
    let mut inserts = Vec::new();
    let mut queries = Vec::new();
    map.for_each_keyframe(|keyframe, bow| {
        let start = Instant::now();
        file.insert(keyframe, &bow);
        inserts.push(start.elapsed());
        if wanted.contains(&keyframe) {
            queries.push((keyframe, bow));
        }
    });
    let load = load(&map);
    // The order they were drawn in: each query hops to another end of the map.
    queries.shuffle(&mut rng(&[4]));

    let (mut scratch, mut place_scratch) = (Scratch::default(), PlaceScratch::default());
    let ids: Vec<u32> = (0..keyframes).collect();
    let covisible = |keyframe: u32| ids[map.visit_of(keyframe)].iter().copied();
    let mut search = |query: u32, bow: &BowVector| {
        let own_visit = map.visit_of(query);
        let scores = file.score_all(bow, &mut scratch);
        let excluded = |keyframe: u32| own_visit.contains(&(keyframe as usize));
        best_places(|| scores.iter(), LIMITS, excluded, |a, b| a.cmp(&b), covisible, &mut place_scratch)
    };
    for (query, bow) in queries.iter().take(QUERIES / 10) {
        search(*query, bow);
    }
    let (mut times, mut found_first, mut found_at_all) = (Vec::new(), 0, 0);
    for (query, bow) in &queries {
        let start = Instant::now();
        let places = search(*query, bow);
        times.push(start.elapsed());
        let truth = map.other_visit(*query).expect("queries are drawn from places visited twice");
        let is_true = |place: &(u32, _)| truth.contains(&(place.0 as usize));
        found_first += usize::from(places.first().is_some_and(is_true));
        found_at_all += usize::from(places.iter().any(is_true));
    }

    let postings = |bow: &BowVector, scratch: &mut Scratch| -> u64 {
        file.score_all(bow, scratch).iter().map(|(_, score)| u64::from(score.common_words())).sum()
    };
    let postings: u64 = queries.iter().map(|(_, bow)| postings(bow, &mut scratch)).sum();
    Report {
        keyframes,
        query: Percentiles::of(times),
        inserts_total: inserts.iter().sum(),
        load,
        insert: Percentiles::of(inserts),
        postings_per_query: postings as f64 / queries.len() as f64,
        bytes_per_keyframe: file.heap_bytes() as f64 / f64::from(keyframes),
        words_per_keyframe: file.posting_count() as f64 / f64::from(keyframes),
        found_first: found_first as f64 / queries.len() as f64,
        found_at_all: found_at_all as f64 / queries.len() as f64,
    }
}

/// Times the building of the whole file at once, as a server does when it reads a map from disk.
fn load(map: &DrawnMap) -> Duration {
    let mut file = InvertedFile::default();
    file.begin_loading();
    let mut total = Duration::ZERO;
    map.for_each_keyframe(|keyframe, bow| {
        let start = Instant::now();
        file.insert(keyframe, &bow);
        total += start.elapsed();
    });
    let start = Instant::now();
    file.finish_loading();
    total + start.elapsed()
}

fn print_table(reports: &[Report]) {
    let row = |name: &str, cell: &dyn Fn(&Report) -> String| {
        print!("{name:<34}");
        for report in reports {
            print!("{:>14}", cell(report));
        }
        println!();
    };
    row("keyframes", &|report| report.keyframes.to_string());
    row("query, median", &|report| milliseconds(report.query.median));
    row("query, 99th percentile", &|report| milliseconds(report.query.p99));
    row("  ORB-SLAM3, measured elsewhere", &|report| {
        orb_slam3_ms(report).map_or("-".into(), |theirs| format!("{theirs:.0} ms"))
    });
    row("postings a query", &|report| format!("{:.0}", report.postings_per_query));
    row("postings a second", &|report| {
        format!("{:.2e}", report.postings_per_query / report.query.median.as_secs_f64())
    });
    row("words a keyframe", &|report| format!("{:.0}", report.words_per_keyframe));
    row("bytes a keyframe", &|report| format!("{:.0}", report.bytes_per_keyframe));
    row("insert, median", &|report| microseconds(report.insert.median));
    row("insert, mean", &|report| microseconds(report.inserts_total / report.keyframes));
    row("insert, 99th percentile", &|report| microseconds(report.insert.p99));
    row("insert, longest", &|report| milliseconds(report.insert.longest));
    row("loading of the whole map", &|report| milliseconds(report.load));
    row("true place named first", &|report| format!("{:.1} %", report.found_first * 100.0));
    row("true place among the 20", &|report| format!("{:.1} %", report.found_at_all * 100.0));
}

fn orb_slam3_ms(report: &Report) -> Option<f64> {
    ORB_SLAM3_MS.iter().find(|(keyframes, _)| *keyframes == report.keyframes).map(|&(_, ms)| ms)
}

fn milliseconds(time: Duration) -> String {
    format!("{:.3} ms", time.as_secs_f64() * 1e3)
}

fn microseconds(time: Duration) -> String {
    format!("{:.1} us", time.as_secs_f64() * 1e6)
}

struct Percentiles {
    median: Duration,
    p99: Duration,
    longest: Duration,
}

impl Percentiles {
    fn of(mut times: Vec<Duration>) -> Self {
        times.sort_unstable();
        let at = |share: usize| times[(times.len() * share / 100).min(times.len() - 1)];
        Self { median: at(50), p99: at(99), longest: at(100) }
    }
}

/// A building that a robot passes through twice, drawn from the seed.
struct DrawnMap {
    keyframes: u32,
    /// The place of each visit, in the order of the visits.
    places: Vec<usize>,
    /// The two visits of each place.
    visits: Vec<[usize; 2]>,
}

impl DrawnMap {
    const KEYFRAMES_PER_VISIT: usize = 12;
    const WORDS_PER_KEYFRAME: Range<usize> = 600..801;
    const SHARED_WITH_PREVIOUS: f64 = 0.65;
    const FROM_THE_PLACE: f64 = 0.85;
    const WORDS_PER_PLACE: usize = 1_500;
    /// This share of the places comes in groups of lookalikes that share a part of their words.
    const LOOKALIKES: f64 = 0.3;
    const LOOKALIKES_PER_GROUP: usize = 8;
    const SHARED_IN_GROUP: f64 = 0.8;
    const WORDS_IN_BUILDING: f64 = 60_000.0;
    const WORDS_IN_VOCABULARY: u64 = 1_000_003;
    /// Some words are more common than others: so much that a query meets some 1,340,000 postings in 100,000
    /// keyframes, where equally common words would give 820,000.
    const SKEW: f64 = 1.72;

    fn new(keyframes: u32) -> Self {
        let visit_count = (keyframes as usize).div_ceil(Self::KEYFRAMES_PER_VISIT);
        let place_count = visit_count.div_ceil(2);
        let mut places: Vec<usize> = (0..2 * place_count).map(|visit| visit / 2).collect();
        places.shuffle(&mut rng(&[0]));
        let mut visits = vec![[usize::MAX; 2]; place_count];
        for (visit, &place) in places.iter().enumerate() {
            let nth = usize::from(visits[place][0] != usize::MAX);
            visits[place][nth] = visit;
        }
        Self { keyframes, places, visits }
    }

    /// The keyframes of the visit this one belongs to: those covisible with it, and itself.
    fn visit_of(&self, keyframe: u32) -> Range<usize> {
        self.keyframes_of(keyframe as usize / Self::KEYFRAMES_PER_VISIT)
    }

    /// The keyframes of the other visit to the same place, if the map has it.
    fn other_visit(&self, keyframe: u32) -> Option<Range<usize>> {
        let visit = keyframe as usize / Self::KEYFRAMES_PER_VISIT;
        let [first, second] = self.visits[self.places[visit]];
        let other = self.keyframes_of(if first == visit { second } else { first });
        (!other.is_empty()).then_some(other)
    }

    fn keyframes_of(&self, visit: usize) -> Range<usize> {
        let end = self.keyframes as usize;
        let first = visit * Self::KEYFRAMES_PER_VISIT;
        first.min(end)..(first + Self::KEYFRAMES_PER_VISIT).min(end)
    }

    fn for_each_keyframe(&self, mut each: impl FnMut(u32, BowVector)) {
        for (visit, &place) in self.places.iter().enumerate() {
            let rng = &mut rng(&[1, visit as u64]);
            let pool = self.pool(place);
            let mut words: Vec<u32> = Vec::new();
            for keyframe in self.keyframes_of(visit) {
                words = Self::draw_words(&words, &pool, rng);
                each(keyframe as u32, Self::weigh(&words, rng));
            }
        }
    }

    /// The words of a place, as ranks in the building.
    fn pool(&self, place: usize) -> Vec<u32> {
        let has_lookalikes = (place as f64) < self.visits.len() as f64 * Self::LOOKALIKES;
        let shared = if has_lookalikes { Self::SHARED_IN_GROUP } else { 0.0 };
        let group = (place / Self::LOOKALIKES_PER_GROUP) as u64;
        let shared_count = (Self::WORDS_PER_PLACE as f64 * shared) as usize;
        let mut pool = HashSet::new();
        let mut words = Vec::new();
        let (of_group, of_place) = (&mut rng(&[2, 0, group]), &mut rng(&[2, 1, place as u64]));
        while words.len() < Self::WORDS_PER_PLACE {
            let source = if words.len() < shared_count { &mut *of_group } else { &mut *of_place };
            let word = Self::draw_word(source);
            if pool.insert(word) {
                words.push(word);
            }
        }
        words
    }

    fn draw_words(previous: &[u32], pool: &[u32], rng: &mut ChaCha8Rng) -> Vec<u32> {
        let count = rng.random_range(Self::WORDS_PER_KEYFRAME);
        let mut words = previous.to_vec();
        words.shuffle(rng);
        words.truncate((count as f64 * Self::SHARED_WITH_PREVIOUS) as usize);
        let mut known: HashSet<u32> = words.iter().copied().collect();
        while words.len() < count {
            let from_place = rng.random_bool(Self::FROM_THE_PLACE);
            let word = if from_place { pool[rng.random_range(0..pool.len())] } else { Self::draw_word(rng) };
            if known.insert(word) {
                words.push(word);
            }
        }
        words
    }

    fn draw_word(rng: &mut ChaCha8Rng) -> u32 {
        (rng.random::<f64>().powf(Self::SKEW) * Self::WORDS_IN_BUILDING) as u32
    }

    /// Term frequency times inverse document frequency; the building's words lie scattered over the vocabulary.
    fn weigh(words: &[u32], rng: &mut ChaCha8Rng) -> BowVector {
        let weigh = |&rank: &u32| {
            let id = u64::from(rank) * 617 % Self::WORDS_IN_VOCABULARY;
            let times_seen = if rng.random_bool(0.2) { 2.0 } else { 1.0 };
            let rarity = 1.0 + f64::from(rank + 1).ln() / Self::WORDS_IN_BUILDING.ln();
            (id as u32, times_seen * rarity)
        };
        BowVector::normalised(words.iter().map(weigh).collect()).expect("distinct words of positive weight")
    }
}

/// A generator of its own for each thing drawn, so that a place does not depend on what was drawn before it.
fn rng(path: &[u64]) -> ChaCha8Rng {
    let seed = path
        .iter()
        .fold(SEED, |seed, &part| (seed ^ part).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(31));
    ChaCha8Rng::seed_from_u64(seed)
}
