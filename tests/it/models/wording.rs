//! Wording: embeddings choose fewer pairs than words, and more of those that describe one painting.

use super::measured_wording::sets;

#[test]
fn by_embeddings_fewer_pairs_reach_the_model_and_more_paintings_are_known_again() {
    let sets = sets();
    assert_eq!(sets.len(), 4);
    for set in sets {
        let [words, embeddings] = [false, true].map(|by_embeddings| set.play(by_embeddings));
        println!("{}: words {words:?}, embeddings {embeddings:?} of {}", set.name, set.of_one_painting());
        assert_eq!((words.wrong, embeddings.wrong), (0, 0), "{}", set.name);
        let (asked, matched) = (embeddings.asked as f64, embeddings.matched as f64);
        if set.name.starts_with("hotel") {
            // The wordings share words; what is saved are questions.
            assert!(asked <= 0.6 * words.asked as f64, "{}: {words:?} {embeddings:?}", set.name);
            assert!(matched >= 0.98 * words.matched as f64, "{}: {words:?} {embeddings:?}", set.name);
        } else {
            assert!(matched >= 5.0 * words.matched as f64, "{}: {words:?} {embeddings:?}", set.name);
        }
    }
}
