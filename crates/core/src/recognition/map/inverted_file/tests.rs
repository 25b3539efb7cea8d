//! Laws of the inverted file, held against brute force over the vectors themselves.

use std::collections::BTreeMap;

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::domain::bow::Score;

/// The accumulators of a block.
const BLOCK_BYTES: usize = 8 * block_number::BLOCK_KEYFRAMES;

type Vectors = BTreeMap<u32, BowVector>;

fn random_bow(rng: &mut ChaCha8Rng) -> BowVector {
    let words = rng.random_range(0..40_u32);
    let entries: BTreeMap<u32, f64> = (0..words).map(|_| (rng.random_range(0..200), rng.random())).collect();
    BowVector::normalised(entries.into_iter().collect()).unwrap()
}

/// A file after many random inserts and removes, some keyframes coming back, and what should be in it.
fn random_history(seed: u64, steps: u32, id_step: u32, remove_share: f64) -> (InvertedFile, Vectors) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (mut file, mut vectors, mut gone) = (InvertedFile::default(), Vectors::new(), Vec::new());
    let mut next = 0;
    for _ in 0..steps {
        let kept: Vec<u32> = vectors.keys().copied().collect();
        if !kept.is_empty() && rng.random_bool(remove_share) {
            let keyframe = kept[rng.random_range(0..kept.len())];
            let bow = vectors.remove(&keyframe).unwrap();
            file.remove(keyframe, &bow);
            file.remove(keyframe, &bow);
            gone.push(keyframe);
        } else if !gone.is_empty() && rng.random_bool(0.2) {
            let keyframe = gone.swap_remove(rng.random_range(0..gone.len()));
            vectors.insert(keyframe, random_bow(&mut rng));
            file.insert(keyframe, &vectors[&keyframe]);
        } else {
            next += rng.random_range(1..=id_step);
            vectors.insert(next, random_bow(&mut rng));
            file.insert(next, &vectors[&next]);
        }
    }
    (file, vectors)
}

fn assert_scores(file: &InvertedFile, vectors: &Vectors, query: &BowVector, scratch: &mut Scratch) {
    let scores = file.score_all(query, scratch);
    for (&keyframe, bow) in vectors {
        assert_eq!(scores.get(keyframe), query.similarity(bow), "keyframe {keyframe}");
    }
    let expected = vectors.iter().map(|(&keyframe, bow)| (keyframe, query.similarity(bow)));
    let expected: Vec<_> = expected.filter(|(_, score)| *score != Score::default()).collect();
    assert_eq!(scores.iter().collect::<Vec<_>>(), expected);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn scores_are_those_of_brute_force(
        seed in any::<u64>(), steps in 0_u32..900, id_step in 1_u32..40, remove_share in 0.0..0.6_f64,
    ) {
        let (file, vectors) = random_history(seed, steps, id_step, remove_share);
        let mut scratch = Scratch::default();
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 1);
        for _ in 0..5 {
            assert_scores(&file, &vectors, &random_bow(&mut rng), &mut scratch);
        }
        for query in vectors.values().step_by(50) {
            assert_scores(&file, &vectors, query, &mut scratch);
        }
        let postings: usize = vectors.values().map(BowVector::len).sum();
        prop_assert_eq!(file.posting_count(), postings);
    }

    #[test]
    fn equality_is_about_content_and_not_history(
        seed in any::<u64>(), steps in 1_u32..600, id_step in 1_u32..40, remove_share in 0.0..0.6_f64,
    ) {
        let (file, vectors) = random_history(seed, steps, id_step, remove_share);
        let mut rebuilt = InvertedFile::default();
        for (&keyframe, bow) in &vectors {
            rebuilt.insert(keyframe, bow);
        }
        prop_assert!(file == rebuilt);
        let mut backwards = InvertedFile::default();
        for (&keyframe, bow) in vectors.iter().rev() {
            backwards.insert(keyframe, bow);
        }
        prop_assert!(file == backwards);
        assert_scores(&backwards, &vectors, &random_bow(&mut ChaCha8Rng::seed_from_u64(seed)), &mut Scratch::default());

        let Some((&keyframe, bow)) = vectors.iter().find(|(_, bow)| !bow.is_empty()) else { return Ok(()) };
        rebuilt.remove(keyframe, bow);
        prop_assert!(file != rebuilt);
        let other_word = BowVector::normalised(bow.iter().map(|(word, weight)| (word + 1, f64::from(weight))).collect());
        rebuilt.insert(keyframe, &other_word.unwrap());
        prop_assert!(file != rebuilt);
    }

    #[test]
    fn nothing_is_left_between_queries(seed in any::<u64>(), large in 1_u32..300, small in 1_u32..100) {
        let files = [random_history(seed, large, 60, 0.1), random_history(!seed, small, 3, 0.1)];
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut scratch = Scratch::default();
        for _ in 0..6 {
            let (file, vectors) = &files[rng.random_range(0..2)];
            assert_scores(file, vectors, &random_bow(&mut rng), &mut scratch);
        }
    }
}

#[test]
fn a_map_of_several_blocks_scores_like_brute_force() {
    let (mut file, mut vectors) = random_history(7, 9_500, 1, 0.02);
    let mut scratch = Scratch::default();
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    assert_scores(&file, &vectors, &random_bow(&mut rng), &mut scratch);
    // Enough of one sealed block that it is rewritten, then all of it.
    for keyframe in 1000..4096 {
        if let Some(bow) = vectors.remove(&keyframe) {
            file.remove(keyframe, &bow);
        }
    }
    assert_scores(&file, &vectors, &random_bow(&mut rng), &mut scratch);
    assert_eq!(file, file.clone());
}

#[test]
fn a_map_emptied_again_scores_nothing_and_equals_a_new_one() {
    let (mut file, vectors) = random_history(3, 500, 1, 0.0);
    for (&keyframe, bow) in &vectors {
        file.remove(keyframe, bow);
    }
    assert_eq!(file, InvertedFile::default());
    assert_eq!(file.score_all(&vectors[&1], &mut Scratch::default()).iter().count(), 0);
}

#[test]
fn an_empty_vector_is_no_candidate_and_has_none() {
    let (mut file, vectors) = random_history(3, 50, 1, 0.0);
    file.insert(1000, &BowVector::default());
    let mut scratch = Scratch::default();
    assert_eq!(file.score_all(&BowVector::default(), &mut scratch).iter().count(), 0);
    assert_scores(&file, &vectors, &vectors[&1], &mut scratch);
}

#[test]
fn a_patrol_of_years_costs_what_its_last_keyframes_do() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let (mut file, mut vectors, mut scratch) = (InvertedFile::default(), Vectors::new(), Scratch::default());
    for keyframe in 0..50_000 {
        let bow = random_bow(&mut rng);
        file.insert(keyframe, &bow);
        vectors.insert(keyframe, bow);
        if vectors.len() > 200 {
            let (oldest, bow) = vectors.pop_first().unwrap();
            file.remove(oldest, &bow);
        }
    }
    assert_scores(&file, &vectors, &random_bow(&mut rng), &mut scratch);
    assert!(file.blocks.iter().filter(|block| !block.is_empty()).count() <= 2);
    assert!(scratch.heap_bytes() <= 3 * BLOCK_BYTES, "{}", scratch.heap_bytes());
}

#[test]
fn a_loaded_file_equals_a_live_one_in_any_order() {
    let (live, vectors) = random_history(11, 20_000, 1, 0.01);
    let mut forwards = InvertedFile::default();
    forwards.begin_loading();
    for (&keyframe, bow) in &vectors {
        forwards.insert(keyframe, bow);
    }
    forwards.finish_loading();
    let mut backwards = InvertedFile::default();
    backwards.begin_loading();
    for (&keyframe, bow) in vectors.iter().rev() {
        backwards.insert(keyframe, bow);
    }
    // What is on top of the rows may take some away while the map is loaded.
    let (&first, bow) = vectors.first_key_value().unwrap();
    backwards.remove(first, bow);
    backwards.insert(first, bow);
    backwards.finish_loading();
    assert!(live == forwards && live == backwards);
    let query = random_bow(&mut ChaCha8Rng::seed_from_u64(12));
    for file in [&live, &forwards, &backwards] {
        assert_scores(file, &vectors, &query, &mut Scratch::default());
    }
}

#[test]
fn a_merge_under_way_answers_and_forgets_what_is_removed() {
    let (mut file, mut vectors) = random_history(13, 9_000, 1, 0.0);
    let mut rng = ChaCha8Rng::seed_from_u64(14);
    let mut next = 20_000;
    let mut merges_seen = 0;
    for step in 0..3_000 {
        next += 1;
        let bow = random_bow(&mut rng);
        file.insert(next, &bow);
        vectors.insert(next, bow);
        if file.merging.is_empty() {
            continue;
        }
        merges_seen += 1;
        let kept: Vec<u32> = vectors.keys().copied().collect();
        let keyframe = kept[rng.random_range(0..kept.len())];
        let bow = vectors.remove(&keyframe).unwrap();
        file.remove(keyframe, &bow);
        if step % 50 == 0 {
            assert_scores(&file, &vectors, &random_bow(&mut rng), &mut Scratch::default());
        }
    }
    assert!(merges_seen > 10, "{merges_seen}");
    file.advance_merges(usize::MAX);
    assert_scores(&file, &vectors, &random_bow(&mut rng), &mut Scratch::default());
}
