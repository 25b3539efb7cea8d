//! Small vocabularies by hand, and every way a file can be wrong.

use super::train::{TrainSettings, TrainingSet, train};
use super::*;

/// 8-byte descriptors: a node is `parent isLeaf`, the value of all eight bytes, and the weight.
fn text(header: &str, nodes: &[(u32, u8, u8, &str)]) -> String {
    let mut text = header.to_owned();
    for (parent, is_leaf, byte, weight) in nodes {
        let bytes = format!("{byte} ").repeat(8);
        text.extend([format!("\n{parent} {is_leaf} {bytes} {weight}")]);
    }
    text
}

/// Unequal child counts, words at three levels, the children of node 1 far from each other in the file:
///
/// ```text
/// 0 -- 1 (0x00) -- 4 (0x00) -- 6 (0x00) word 2, weight 0
///   |           |           `- 7 (0x01) word 3, weight 2
///   |           `- 5 (0x0f) word 1, weight 0.5
///   |- 2 (0xff) word 0, weight 1
///   `- 3 (0xf0) -- 8 (0xf0) word 4, weight 0.25
/// ```
fn uneven() -> String {
    text(
        "3 3  0 0",
        &[
            (0, 0, 0x00, "0"),
            (0, 1, 0xff, "1"),
            (0, 0, 0xf0, "0"),
            (1, 0, 0x00, "0"),
            (1, 1, 0x0f, "0.5"),
            (4, 1, 0x00, "0"),
            (4, 1, 0x01, "2"),
            (3, 1, 0xf0, "2.5e-1"),
        ],
    )
}

fn read(text: &str) -> Result<Vocabulary, VocabularyError> {
    Vocabulary::read_text(text.as_bytes())
}

fn descriptors(bytes: &[u8]) -> Vec<u8> {
    bytes.iter().flat_map(|&byte| [byte; 8]).collect()
}

fn groups(transformed: &Transformed) -> Vec<(u32, Vec<u32>)> {
    transformed.groups.iter().map(|(node, features)| (node, features.to_vec())).collect()
}

#[test]
fn words_weights_and_groups_of_an_uneven_tree() {
    let vocabulary = read(&uneven()).unwrap();
    assert_eq!((vocabulary.node_count(), vocabulary.word_count()), (9, 5));
    assert_eq!(vocabulary.shape(), Shape { branching: 3, levels: 3, descriptor_bytes: 8 });
    let image = descriptors(&[0xff, 0x00, 0x01, 0xf0, 0x0f, 0x01, 0xfe]);
    assert_eq!(vocabulary.words_of(8, &image).unwrap(), [0, 2, 3, 4, 1, 3, 0]);

    let at_leaves = vocabulary.transform(8, &image, 0).unwrap();
    // 1 + 1, 0.5, 2 + 2, 0.25; word 2 weighs nothing.
    let sum = 6.75;
    assert_eq!(at_leaves.words.entries(), [(0, 2.0 / sum), (1, 0.5 / sum), (3, 4.0 / sum), (4, 0.25 / sum)]);
    // Nodes as the file numbers them; word 0 lies above the level asked for.
    let by_word = vec![(2, vec![0, 6]), (5, vec![4]), (7, vec![2, 5]), (8, vec![3])];
    assert_eq!(groups(&at_leaves), by_word);
    let one_up = vec![(2, vec![0, 6]), (4, vec![2, 5]), (5, vec![4]), (8, vec![3])];
    assert_eq!(groups(&vocabulary.transform(8, &image, 1).unwrap()), one_up);
    let two_up = vec![(1, vec![2, 4, 5]), (2, vec![0, 6]), (3, vec![3])];
    assert_eq!(groups(&vocabulary.transform(8, &image, 2).unwrap()), two_up);
    for levels_up in [3, 4, 100] {
        let all = vec![(0, vec![0, 2, 3, 4, 5, 6])];
        assert_eq!(groups(&vocabulary.transform(8, &image, levels_up).unwrap()), all);
    }
}

#[test]
fn the_first_child_wins_a_tie() {
    let nodes = [(0, 1, 0x0f, "1"), (0, 1, 0xf0, "1"), (0, 1, 0x0f, "1"), (0, 1, 0x3c, "1")];
    let vocabulary = read(&text("4 1  0 0", &nodes)).unwrap();
    assert_eq!(vocabulary.words_of(8, &descriptors(&[0x00, 0xff, 0xf0, 0x0f])).unwrap(), [0, 0, 1, 0]);
}

#[test]
fn groups_two_images_have_in_common() {
    let vocabulary = read(&uneven()).unwrap();
    let a = vocabulary.transform(8, &descriptors(&[0xff, 0xf0, 0x01]), 0).unwrap();
    let b = vocabulary.transform(8, &descriptors(&[0x01, 0x0f, 0xff, 0x01]), 0).unwrap();
    let common: Vec<_> = a.groups.common(&b.groups).collect();
    assert_eq!(common, [(&[0][..], &[2][..]), (&[2][..], &[0, 3][..])]);
}

#[test]
fn an_image_without_features_has_no_words() {
    let nothing = read(&uneven()).unwrap().transform(8, &[], 4).unwrap();
    assert_eq!(nothing, Transformed::default());
    let weightless = read(&uneven()).unwrap().transform(8, &descriptors(&[0]), 4).unwrap();
    assert_eq!(weightless, Transformed::default());
}

#[test]
fn descriptors_of_another_length_are_refused() {
    let vocabulary = read(&uneven()).unwrap();
    let other = vocabulary.transform(16, &[0; 32], 4);
    assert_eq!(other, Err(DescriptorMismatch::Length { got: 16, expected: 8 }));
    let broken = vocabulary.transform(8, &[0; 9], 4);
    assert_eq!(broken, Err(DescriptorMismatch::Remainder { bytes: 9, each: 8 }));
}

#[test]
fn the_end_of_the_file_and_of_its_lines_may_vary() {
    let plain = read(&uneven()).unwrap();
    for ending in ["\n", "\n\n", "\n \n\n", "\r\n", " "] {
        assert_eq!(read(&(uneven() + ending)).unwrap(), plain, "{ending:?}");
    }
    assert_eq!(read(&format!("\u{feff}{}", uneven())).unwrap(), plain, "a byte order mark");
    assert_eq!(read(&uneven().replace('\n', "\r\n")).unwrap(), plain);
    assert_eq!(read(&uneven().replace(' ', "\t ")).unwrap(), plain);
}

#[cfg(feature = "compressed")]
#[test]
fn compressed_files_are_told_by_their_first_bytes() {
    use std::io::Write as _;

    let plain = read(&uneven()).unwrap();
    let mut binary = Vec::new();
    plain.write_binary(&mut binary).unwrap();
    for form in [uneven().into_bytes(), binary] {
        let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        gzip.write_all(&form).unwrap();
        let zstd = zstd::encode_all(form.as_slice(), 1).unwrap();
        for bytes in [form, gzip.finish().unwrap(), zstd] {
            assert_eq!(Vocabulary::read(std::io::Cursor::new(bytes)).unwrap(), plain);
        }
    }
}

#[test]
fn bad_text_is_refused_with_its_line() {
    let check = |text: &str, expected: &str| {
        assert_eq!(read(text).map(|_| ()).unwrap_err().to_string(), expected);
    };
    let bytes = "1 2 3 4 5 6 7 8";
    let header = "10 6  0 0";
    check("", "line 1 of the vocabulary: expected the header `k L  scoring weighting`, four whole numbers");
    check(
        "10 6 0",
        "line 1 of the vocabulary: expected the header `k L  scoring weighting`, four whole numbers",
    );
    check("10 6  2 0", "line 1 of the vocabulary: scoring 2 (chi square) is not supported, only 0 (L1 norm)");
    check("10 6  0 1", "line 1 of the vocabulary: weighting 1 (TF) is not supported, only 0 (TF-IDF)");
    check("0 6  0 0", "line 1 of the vocabulary: k = 0 and L = 6; k must lie in 1..=65536, L in 1..=64");
    check("10 65  0 0", "line 1 of the vocabulary: k = 10 and L = 65; k must lie in 1..=65536, L in 1..=64");
    check(
        &format!("{} 6 0 0", "1".repeat(40)),
        "line 1 of the vocabulary: expected the header `k L  scoring weighting`, four whole numbers",
    );
    check(header, "the vocabulary is no tree of words: it has no words");
    let node = |lines: &str, expected: &str| check(&format!("{header}\n{lines}"), expected);
    let expects = "expected `parent isLeaf d0 ... dN  weight`;";
    node(
        &format!("1 1 {bytes} 1"),
        "line 2 of the vocabulary: node 1 hangs on node 1, which does not come before it",
    );
    node(
        &format!("0 1 {bytes} 1\n1 1 {bytes} 1"),
        "line 3 of the vocabulary: node 2 hangs on node 1, which is a word",
    );
    node(
        &format!("0 0 {bytes} 0\n0 1 {bytes} 1"),
        "the vocabulary is no tree of words: node 1 is marked as inner, but has no children",
    );
    node(
        &format!("0 2 {bytes} 1"),
        &format!("line 2 of the vocabulary: {expects} isLeaf is neither 0 nor 1"),
    );
    node(
        &format!("-1 1 {bytes} 1"),
        &format!("line 2 of the vocabulary: {expects} the parent is not a whole number"),
    );
    node(
        "0 1 1 2 3 4 5 6 7 256 1",
        &format!(
            "line 2 of the vocabulary: {expects} a byte of the descriptor is not a whole number from 0 to 255"
        ),
    );
    node(
        &format!("0 1 {bytes} one"),
        &format!("line 2 of the vocabulary: {expects} the weight is not one number"),
    );
    node("0 1", &format!("line 2 of the vocabulary: {expects} there are fewer than four numbers"));
    node(
        "0 1 1 2 3 4 5 6 7 1",
        "line 2 of the vocabulary: a descriptor of 7 bytes; it must be a multiple of 8, at most 512",
    );
    node(
        &format!("0 1 {bytes} 1\n0 1 {bytes} {bytes} 1"),
        "line 3 of the vocabulary: a descriptor of 16 bytes, where the lines before have 8",
    );
    for weight in ["-0.5", "inf", "NaN", "1e999"] {
        let error = read(&format!("{header}\n0 1 {bytes} {weight}")).map(|_| ()).unwrap_err().to_string();
        assert!(error.ends_with("it must be finite and not negative"), "{error}");
    }
    node(
        &format!("0 1 {bytes} 1\n\n0 1 {bytes} 1"),
        "line 3 of the vocabulary: blank, but not the last line",
    );
    node(&" ".repeat(20_000), "line 2 of the vocabulary: longer than 16384 bytes");
    let chain: Vec<(u32, u8, u8, &str)> = (0..70).map(|node| (node, 0, 0, "0")).collect();
    check(&text(header, &chain), "line 66 of the vocabulary: node 65 lies deeper than 64 levels");
}

#[test]
fn bad_binary_is_refused() {
    let mut bytes = Vec::new();
    read(&uneven()).unwrap().write_binary(&mut bytes).unwrap();
    let refused = |bytes: &[u8]| match Vocabulary::read_binary(bytes) {
        Err(VocabularyError::Binary(fault)) => fault,
        other => panic!("{other:?}"),
    };
    for at in 0..bytes.len() {
        for bit in 0..8 {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1 << bit;
            let fault = refused(&damaged);
            let expected = match at {
                0..8 => matches!(fault, BinaryFault::Magic),
                8..12 => matches!(fault, BinaryFault::Version(_)),
                12..88 => matches!(fault, BinaryFault::HeaderChecksum),
                _ => matches!(fault, BinaryFault::Checksum),
            };
            assert!(expected, "bit {bit} of byte {at}: {fault}");
        }
        assert_eq!(refused(&bytes[..at]), BinaryFault::CutShort);
    }
    bytes.push(0);
    assert_eq!(refused(&bytes), BinaryFault::TooLong);
}

#[test]
fn the_fingerprint_is_the_content_s() {
    let plain = read(&uneven()).unwrap();
    assert!(plain.fingerprint_holds());
    let same = ["0.25", ".25", "25e-2"].map(|weight| read(&uneven().replace("2.5e-1", weight)).unwrap());
    assert!(same.iter().all(|same| same.fingerprint() == plain.fingerprint()));
    for other in
        [uneven().replace("2.5e-1", "0.26"), uneven().replace("3 3 ", "3 4 "), uneven().replace("15 ", "14 ")]
    {
        assert_ne!(read(&other).unwrap().fingerprint(), plain.fingerprint());
    }
    let hex = plain.fingerprint().to_string();
    assert_eq!(
        (hex.len(), Fingerprint::from_bytes(*plain.fingerprint().as_bytes())),
        (64, plain.fingerprint())
    );
}

/// Two kinds of images: one of descriptors near 0x00, one near 0xff, all with one descriptor in common.
fn training_set() -> TrainingSet {
    let mut set = TrainingSet::default();
    for image in 0..8_u8 {
        let base = if image % 2 == 0 { 0x00 } else { 0xff };
        let mut bytes = descriptors(&[0x3c]);
        for feature in 0..8_u8 {
            let mut descriptor = [base; 8];
            descriptor[usize::from(feature)] ^= 1 << image;
            bytes.extend(descriptor);
        }
        set.add_image(8, &bytes).unwrap();
    }
    set
}

#[test]
fn training_weighs_words_by_the_images_that_have_them() {
    let set = training_set();
    let settings = TrainSettings { branching: 3, levels: 1, ..TrainSettings::default() };
    let mut last = None;
    let vocabulary = train(&set, settings, |progress| last = Some(progress)).unwrap();
    let last = last.unwrap();
    assert_eq!((last.done, last.total), (72, 72));
    assert_eq!(vocabulary.word_count(), 3);
    let words = vocabulary.words_of(8, &descriptors(&[0x3c, 0x00, 0xff])).unwrap();
    let weights: Vec<f64> = words.iter().map(|&word| vocabulary.word_weight(word).unwrap()).collect();
    // All 8 images have the first, 4 each of the others.
    assert_eq!(weights, [0.0, 2_f64.ln(), 2_f64.ln()]);
    assert!(vocabulary.fingerprint_holds());
}

#[test]
fn training_repeats_itself_and_depends_on_the_seed() {
    let trained = |seed| {
        let settings = TrainSettings { branching: 2, levels: 5, seed, ..TrainSettings::default() };
        train(&training_set(), settings, |_| {}).unwrap()
    };
    assert_eq!(trained(7), trained(7));
    assert!((0..10).any(|seed| trained(seed).fingerprint() != trained(7).fingerprint()));
}

#[test]
fn training_refuses_what_makes_no_vocabulary() {
    let settings = TrainSettings::default();
    let nothing = train(&TrainingSet::default(), settings, |_| {}).unwrap_err();
    assert_eq!(nothing.to_string(), "there are no descriptors to train on");
    let unary = train(&training_set(), TrainSettings { branching: 1, ..settings }, |_| {}).unwrap_err();
    assert_eq!(unary.to_string(), "k must be at least 2, it is 1");
    assert!(train(&training_set(), TrainSettings { levels: 0, ..settings }, |_| {}).is_err());
    let mut set = training_set();
    assert!(set.add_image(8, &[0; 9]).is_err() && set.add_image(12, &[0; 12]).is_err());
    assert!(set.add_image(16, &[0; 16]).is_err());
    // Equal descriptors are one word.
    let mut equal = TrainingSet::default();
    equal.add_image(32, &[5; 32 * 40]).unwrap();
    assert_eq!(train(&equal, settings, |_| {}).unwrap().word_count(), 1);
}
