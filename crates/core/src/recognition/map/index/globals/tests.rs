//! Laws of the global descriptors: their likeness is what plain arithmetic says, on every path, and what is removed is gone.

use std::collections::BTreeMap;

use proptest::prelude::*;

use super::Globals;
use crate::domain::bow::{BowVector, Score};
use crate::domain::global_descriptor::{GlobalDescriptor, GlobalEncoding};
use crate::domain::ids::KeyframeSeq;
use crate::geometry::instruction_set::portable::portably;

fn descriptor(encoding: GlobalEncoding, data: &[u8]) -> GlobalDescriptor {
    GlobalDescriptor { model: "law".parse().unwrap(), encoding, data: data.into() }
}

/// Plain arithmetic: bits one by one, and numbers as floats, whose sums of integers are exact.
fn cosine(encoding: GlobalEncoding, a: &[u8], b: &[u8]) -> f64 {
    let numbers = |data: &[u8]| -> Vec<f64> {
        match encoding {
            GlobalEncoding::Int8 => data.iter().map(|byte| f64::from(*byte as i8)).collect(),
            GlobalEncoding::Bits => {
                let bit = |at: usize| if data[at / 8] >> (at % 8) & 1 == 1 { 1.0 } else { -1.0 };
                (0..8 * data.len()).map(bit).collect()
            }
        }
    };
    let (a, b) = (numbers(a), numbers(b));
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let lengths = (product(&a, &a) * product(&b, &b)).sqrt();
    if lengths == 0.0 { 0.0 } else { product(&a, &b) / lengths }
}

fn scores(globals: &Globals, sought: &GlobalDescriptor) -> Vec<(u32, Score)> {
    let mut scores = Vec::new();
    globals.score_all(sought, &mut scores);
    scores
}

/// Descriptors of one length by keyframe, over two blocks.
fn stored(bytes: usize) -> impl Strategy<Value = BTreeMap<u32, Vec<u8>>> {
    prop::collection::btree_map(0_u32..500, prop::collection::vec(any::<u8>(), bytes), 0..40)
}

proptest! {
    #[test]
    fn likeness_is_the_cosine_on_every_path_in_whatever_order_they_came_and_went(
        (sought, stored, gone) in (1_usize..40).prop_flat_map(|bytes| {
            (prop::collection::vec(any::<u8>(), bytes), stored(bytes), stored(bytes))
        }),
        is_int8 in any::<bool>(),
    ) {
        let encoding = if is_int8 { GlobalEncoding::Int8 } else { GlobalEncoding::Bits };
        let (mut live, mut rebuilt) = (Globals::default(), Globals::default());
        for (keyframe, data) in gone.iter().filter(|(keyframe, _)| !stored.contains_key(keyframe)) {
            live.insert(KeyframeSeq(*keyframe), &descriptor(encoding, data));
        }
        for (keyframe, data) in &stored {
            live.insert(KeyframeSeq(*keyframe), &descriptor(encoding, data));
        }
        for keyframe in gone.keys().filter(|keyframe| !stored.contains_key(keyframe)) {
            live.remove(KeyframeSeq(*keyframe));
        }
        for (keyframe, data) in stored.iter().rev() {
            rebuilt.insert(KeyframeSeq(*keyframe), &descriptor(encoding, data));
        }
        prop_assert_eq!(&live, &rebuilt);
        prop_assert_eq!(live.len(), stored.len());

        let sought = descriptor(encoding, &sought);
        let found = scores(&live, &sought);
        prop_assert_eq!(&portably(|| scores(&live, &sought)), &found);
        prop_assert!(found.iter().map(|(keyframe, _)| keyframe).eq(stored.keys()));
        for (keyframe, score) in found {
            let expected = cosine(encoding, &sought.data, &stored[&keyframe]).max(0.0);
            prop_assert!((score.value() - expected).abs() < 2.0 / f64::from(BowVector::ONE));
            prop_assert_eq!(&*live.get(KeyframeSeq(keyframe)).unwrap().data, &stored[&keyframe][..]);
        }
    }
}

#[test]
fn the_longest_vectors_of_the_largest_numbers_are_exactly_alike() {
    let longest = descriptor(GlobalEncoding::Int8, &[0x80; GlobalDescriptor::MAX_BYTES]);
    let mut globals = Globals::default();
    globals.insert(KeyframeSeq(3), &longest);
    assert_eq!(scores(&globals, &longest), [(3, Score::new(BowVector::ONE, 0))]);
}

#[test]
fn another_form_is_not_taken_until_the_last_of_the_first_is_gone() {
    let (first, other) =
        (descriptor(GlobalEncoding::Bits, &[1, 2]), descriptor(GlobalEncoding::Bits, &[1, 2, 3]));
    let mut globals = Globals::default();
    globals.insert(KeyframeSeq(1), &first);
    globals.insert(KeyframeSeq(2), &other);
    assert_eq!((globals.len(), globals.takes(&other)), (1, false));
    assert_eq!(scores(&globals, &other), []);
    globals.remove(KeyframeSeq(1));
    assert!(globals.takes(&other));
    assert_eq!(globals, Globals::default());
}
