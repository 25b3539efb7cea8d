//! World: few pairs reach a model, and its word joins nothing that identifiers part.

use super::generated;

#[tokio::test]
async fn of_four_hundred_anchors_few_pairs_reach_the_model_and_none_is_merged_wrongly() {
    let outcome = generated::play().await;
    assert_eq!((outcome.founded, generated::kinds().len()), (generated::ANCHORS, 3), "{outcome:?}");
    assert!(
        outcome.pairs_asked > 0 && outcome.asked_percent() <= 2.0,
        "{:.2} %: {outcome:?}",
        outcome.asked_percent()
    );
    assert!(outcome.calls >= outcome.pairs_asked, "{outcome:?}");
    // The generous model joined paintings, and no plate.
    assert!(outcome.objects < outcome.founded, "{outcome:?}");
    assert_eq!((outcome.wrongly_merged, outcome.wrongly_matched), (0, 0), "{outcome:?}");
}
