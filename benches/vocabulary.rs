//! A vocabulary of a million words: how long it takes to load, and to make the bag of words of 1,000 descriptors.
//!
//! `cargo bench --bench vocabulary`. The vocabulary is drawn from a seed: k = 10, L = 6, every node a mutation of its
//! parent, and the descriptors mutations of words, so that a descent is as uneven as on real images. The peers'
//! figures were measured elsewhere, with such a vocabulary: a ratio to them would measure this machine.

use std::io::{self, BufWriter, Write as _};
use std::path::Path;
use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use revisit::vocabulary::{LEVELS_UP, Vocabulary};

/// As the binary has it: half of the time of a binary load goes into getting memory.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

const SEED: u64 = 6;
const BRANCHING: usize = 10;
const LEVELS: usize = 6;
const DESCRIPTOR_BYTES: usize = 32;
const DESCRIPTORS: usize = 1_000;
const IMAGES: usize = 100;
const ROUNDS: usize = 5;
const LOADS: usize = 7;

const DBOW2_LOAD_TEXT_MS: f64 = 4_300.0;
const FBOW_LOAD_BINARY_MS: f64 = 21.0;
const DBOW2_TRANSFORM_MS: f64 = 2.85;
const FBOW_TRANSFORM_MS: f64 = 0.88;

fn main() -> io::Result<()> {
    let folder = tempfile::tempdir()?;
    let (text, binary) = (folder.path().join("drawn.txt"), folder.path().join("drawn.voc"));
    let words = write_drawn(&text)?;

    let (vocabulary, text_ms) = load(&text, 3);
    vocabulary.write_binary(std::fs::File::create(&binary)?)?;
    let (from_binary, binary_ms) = load(&binary, LOADS);
    assert_eq!(vocabulary.fingerprint(), from_binary.fingerprint());
    let same = vocabulary == from_binary;
    assert!(same, "the two forms hold the same");
    drop(vocabulary);

    let transform_ms = transform(&from_binary, &words);
    println!(
        "{} words, {} nodes, {:.1} MB in memory; text {:.1} MB, binary {:.1} MB",
        from_binary.word_count(),
        from_binary.node_count(),
        from_binary.heap_bytes() as f64 / 1e6,
        megabytes(&text)?,
        megabytes(&binary)?
    );
    println!("{:<34}{:>12}{:>12}{:>24}", "", "median", "p99", "peer, elsewhere");
    row("load text", &text_ms, &[("DBoW2", DBOW2_LOAD_TEXT_MS)]);
    row("load binary", &binary_ms, &[("fbow", FBOW_LOAD_BINARY_MS)]);
    let peers = [("DBoW2", DBOW2_TRANSFORM_MS), ("fbow", FBOW_TRANSFORM_MS)];
    row("1,000 descriptors -> BoW, groups", &transform_ms, &peers);
    Ok(())
}

fn row(name: &str, times: &Times, peers: &[(&str, f64)]) {
    for (at, (peer, theirs)) in peers.iter().enumerate() {
        let own = [format!("{:.3} ms", times.median), format!("{:.3} ms", times.p99)];
        let [median, p99] = if at == 0 { own } else { [String::new(), String::new()] };
        let (name, theirs_ms) = (if at == 0 { name } else { "" }, format!("{theirs} ms"));
        println!("{name:<34}{median:>12}{p99:>12}{peer:>12}{theirs_ms:>12}");
    }
}

/// In milliseconds.
struct Times {
    median: f64,
    p99: f64,
}

impl Times {
    fn of(mut times: Vec<Duration>) -> Self {
        times.sort_unstable();
        let at = |share: usize| times[(times.len() * share / 100).min(times.len() - 1)].as_secs_f64() * 1e3;
        Self { median: at(50), p99: at(99) }
    }
}

fn load(path: &Path, times: usize) -> (Vocabulary, Times) {
    let mut taken = Vec::new();
    let mut loaded = None;
    for _ in 0..times {
        drop(loaded.take());
        let start = Instant::now();
        let vocabulary = Vocabulary::load(path).expect("a vocabulary written by this program");
        taken.push(start.elapsed());
        loaded = Some(vocabulary);
    }
    (loaded.expect("loaded at least once"), Times::of(taken))
}

fn transform(vocabulary: &Vocabulary, words: &[[u8; DESCRIPTOR_BYTES]]) -> Times {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED + 1);
    let images: Vec<Vec<u8>> = (0..IMAGES)
        .map(|_| {
            let word = |_| mutated(&words[rng.random_range(0..words.len())], 24, &mut rng);
            (0..DESCRIPTORS).flat_map(word).collect()
        })
        .collect();
    let mut taken = Vec::new();
    for image in std::iter::repeat_n(&images, ROUNDS).flatten() {
        let start = Instant::now();
        let transformed = vocabulary.transform(DESCRIPTOR_BYTES, image, LEVELS_UP);
        taken.push(start.elapsed());
        assert!(!transformed.expect("descriptors of 32 bytes").words.is_empty());
    }
    Times::of(taken)
}

/// Writes the vocabulary depth first, as DBoW2 numbers its nodes; returns the words' descriptors.
fn write_drawn(path: &Path) -> io::Result<Vec<[u8; DESCRIPTOR_BYTES]>> {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut out = BufWriter::new(std::fs::File::create(path)?);
    write!(out, "{BRANCHING} {LEVELS}  0 0")?;
    let mut words = Vec::new();
    let mut nodes = 0;
    let root: [u8; DESCRIPTOR_BYTES] = rng.random();
    let mut open = vec![(0, 0, root)];
    while let Some((node, level, descriptor)) = open.pop() {
        let mut children = Vec::new();
        for _ in 0..BRANCHING {
            nodes += 1;
            // Clusters are the tighter, the deeper they lie.
            let child = mutated(&descriptor, 96 >> level, &mut rng);
            let is_word = level + 1 == LEVELS;
            write!(out, "\n{node} {} ", u8::from(is_word))?;
            child.iter().try_for_each(|byte| write!(out, "{byte} "))?;
            if is_word {
                write!(out, " {:.5}", rng.random_range(2.0..10.0))?;
                words.push(child);
            } else {
                write!(out, " 0")?;
                children.push((nodes, level + 1, child));
            }
        }
        open.extend(children.into_iter().rev());
    }
    out.flush()?;
    Ok(words)
}

/// Flips up to so many bits.
fn mutated(
    descriptor: &[u8; DESCRIPTOR_BYTES],
    flips: usize,
    rng: &mut ChaCha8Rng,
) -> [u8; DESCRIPTOR_BYTES] {
    let mut mutated = *descriptor;
    for _ in 0..flips {
        let bit = rng.random_range(0..DESCRIPTOR_BYTES * 8);
        mutated[bit / 8] ^= 1 << (bit % 8);
    }
    mutated
}

fn megabytes(path: &Path) -> io::Result<f64> {
    Ok(path.metadata()?.len() as f64 / 1e6)
}
