//! Laws of a vocabulary, on trees drawn at random: both forms agree, the descent is the obvious one, readers never panic.

use std::fmt::Write as _;
use std::io;

use proptest::prelude::*;

use super::train::{TrainSettings, TrainingSet, train};
use super::*;
use crate::geometry::instruction_set::portable::portably;

/// A tree in the order of its file, whose obvious descent is easy to write down.
#[derive(Clone, Debug)]
struct Drawn {
    levels: u32,
    /// Parent, descriptor, weight; a node is a word if nobody hangs on it.
    nodes: Vec<(usize, Vec<u8>, f64)>,
    each: usize,
}

impl Drawn {
    fn is_word(&self, node: usize) -> bool {
        self.nodes.iter().all(|(parent, _, _)| *parent != node)
    }

    fn text(&self) -> String {
        let mut text = format!("3 {}  0 0", self.levels);
        for (at, (parent, descriptor, weight)) in self.nodes.iter().enumerate() {
            let bytes: Vec<String> = descriptor.iter().map(u8::to_string).collect();
            let _ =
                write!(text, "\n{parent} {} {}  {weight}", u8::from(self.is_word(at + 1)), bytes.join(" "));
        }
        text
    }

    /// Returns the path of a descriptor below the root, by brute force.
    fn path(&self, descriptor: &[u8]) -> Vec<usize> {
        let mut path = Vec::new();
        let mut at = 0;
        loop {
            let children = (1..=self.nodes.len()).filter(|&node| self.nodes[node - 1].0 == at);
            let distance = |&node: &usize| -> u32 {
                let bytes = self.nodes[node - 1].1.iter().zip(descriptor);
                bytes.map(|(a, b)| (a ^ b).count_ones()).sum()
            };
            // `min_by_key` takes the first of equals.
            match children.min_by_key(distance) {
                Some(child) => path.push(child),
                None => return path,
            }
            at = path[path.len() - 1];
        }
    }
}

/// Few distinct bytes, so that distances tie often.
fn descriptor(each: usize) -> impl Strategy<Value = Vec<u8>> {
    proptest::collection::vec(prop_oneof![3 => 0_u8..4, 1 => any::<u8>()], each)
}

fn drawn() -> impl Strategy<Value = (Drawn, Vec<u8>)> {
    let lengths = prop_oneof![Just(8_usize), Just(24), Just(32), Just(48), Just(64), Just(72)];
    (lengths, 1..60_usize, 1..7_u32).prop_flat_map(|(each, count, levels)| {
        let weight = prop_oneof![1 => Just(0.0), 4 => 0.01..10.0];
        let node = (any::<prop::sample::Index>(), descriptor(each), weight);
        let nodes = proptest::collection::vec(node, count).prop_map(move |nodes| {
            let hang = |(at, (parent, descriptor, weight)): (usize, (prop::sample::Index, _, _))| {
                (parent.index(at + 1), descriptor, weight)
            };
            Drawn { levels, nodes: nodes.into_iter().enumerate().map(hang).collect(), each }
        });
        (nodes, proptest::collection::vec(descriptor(each), 0..150).prop_map(|rows| rows.concat()))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn the_descent_is_the_obvious_one((tree, image) in drawn(), levels_up in 0..8_u32) {
        let vocabulary = Vocabulary::read_text(tree.text().as_bytes()).unwrap();
        let word_of: Vec<usize> = (1..=tree.nodes.len()).filter(|&node| tree.is_word(node)).collect();
        let words: Vec<usize> =
            vocabulary.words_of(tree.each, &image).unwrap().iter().map(|&word| word_of[word as usize]).collect();
        let paths: Vec<Vec<usize>> = image.chunks(tree.each).map(|descriptor| tree.path(descriptor)).collect();
        let ends: Vec<usize> = paths.iter().map(|path| path[path.len() - 1]).collect();
        prop_assert_eq!(words, ends);

        let transformed = vocabulary.transform(tree.each, &image, levels_up).unwrap();
        let on_the_plain_target = portably(|| vocabulary.transform(tree.each, &image, levels_up).unwrap());
        prop_assert_eq!(&on_the_plain_target, &transformed);
        let level = tree.levels.saturating_sub(levels_up) as usize;
        let mut groups = std::collections::BTreeMap::<usize, Vec<u32>>::new();
        let mut sums = std::collections::BTreeMap::<usize, f64>::new();
        for (feature, path) in (0..).zip(&paths) {
            let end = path[path.len() - 1];
            let weight = tree.nodes[end - 1].2;
            if weight > 0.0 {
                let node = if level == 0 { 0 } else { path[level.min(path.len()) - 1] };
                groups.entry(node).or_default().push(feature);
                *sums.entry(end).or_insert(0.0) += weight;
            }
        }
        let got: Vec<(usize, Vec<u32>)> =
            transformed.groups.iter().map(|(node, features)| (node as usize, features.to_vec())).collect();
        prop_assert_eq!(got, groups.into_iter().collect::<Vec<_>>());
        let norm: f64 = sums.values().fold(0.0, |norm, weight| norm + weight);
        let expected: Vec<(usize, f64)> = sums.into_iter().map(|(node, sum)| (node, sum / norm)).collect();
        let got: Vec<(usize, f64)> =
            transformed.words.entries().iter().map(|&(word, weight)| (word_of[word as usize], weight)).collect();
        prop_assert_eq!(got, expected);
    }

    #[test]
    fn both_forms_hold_the_same((tree, image) in drawn()) {
        let from_text = Vocabulary::read_text(tree.text().as_bytes()).unwrap();
        let (mut binary, mut text) = (Vec::new(), Vec::new());
        from_text.write_binary(&mut binary).unwrap();
        let from_binary = Vocabulary::read_binary(binary.as_slice()).unwrap();
        prop_assert_eq!(&from_binary, &from_text);
        prop_assert!(from_binary.fingerprint_holds());
        let of_text = from_text.transform(tree.each, &image, 2).unwrap();
        prop_assert_eq!(from_binary.transform(tree.each, &image, 2).unwrap(), of_text);
        from_binary.write_text(&mut text).unwrap();
        prop_assert_eq!(Vocabulary::read_text(text.as_slice()).unwrap(), from_text);
    }

    #[test]
    fn a_reader_never_panics_and_what_it_accepts_works(
        (tree, image) in drawn(),
        edits in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..3_u8), 1..5),
        binary in any::<bool>(),
        checksums in any::<bool>(),
    ) {
        let mut bytes = tree.text().into_bytes();
        if binary {
            let vocabulary = Vocabulary::read_text(bytes.as_slice()).unwrap();
            bytes.clear();
            vocabulary.write_binary(&mut bytes).unwrap();
        }
        for (at, byte, edit) in edits {
            let at = at.index(bytes.len());
            match edit {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                _ => drop(bytes.remove(at)),
            }
        }
        if binary && checksums {
            binary::mend(&mut bytes);
        }
        if let Ok(vocabulary) = Vocabulary::read(io::Cursor::new(bytes)) {
            let _ = vocabulary.transform(tree.each, &image, 2);
            let _ = vocabulary.write_text(io::sink());
        }
    }

    #[test]
    fn training_keeps_its_bounds_and_repeats_itself(
        image in proptest::collection::vec(descriptor(16), 1..120),
        branching in 2..6_u32,
        levels in 1..5_u32,
        seed in any::<u64>(),
    ) {
        let mut set = TrainingSet::default();
        for part in image.chunks(7) {
            set.add_image(16, &part.concat()).unwrap();
        }
        let settings = TrainSettings { branching, levels, seed, ..TrainSettings::default() };
        let mut last = None;
        let trained = train(&set, settings, |progress| last = Some(progress)).unwrap();
        let last = last.unwrap();
        prop_assert_eq!(last.done, last.total);
        prop_assert!(trained.word_count() <= (branching as usize).pow(levels));
        prop_assert!(trained.word_count() <= image.len());
        prop_assert_eq!(&train(&set, settings, |_| {}).unwrap(), &trained);
        let mut text = Vec::new();
        trained.write_text(&mut text).unwrap();
        prop_assert_eq!(&Vocabulary::read_text(text.as_slice()).unwrap(), &trained);
    }
}
