//! How much of a world reaches a model, and whether its word can join what identifiers part.

mod wording;
mod world;
use world as generated;

#[tokio::main]
async fn main() {
    let outcome = world::play().await;
    println!(
        "anchors founded                      {:>8}  ({})",
        outcome.founded,
        Vec::from_iter(world::kinds()).join(", ")
    );
    println!("objects left after merging           {:>8}", outcome.objects);
    println!("naive pairs                          {:>8}", outcome.naive_pairs());
    println!(
        "pairs that reached the model         {:>8}  ({:.2} %)",
        outcome.pairs_asked,
        outcome.asked_percent()
    );
    println!("calls in all                         {:>8}", outcome.calls);
    println!("different identifiers merged         {:>8}", outcome.wrongly_merged);
    println!("different identifiers that match     {:>8}", outcome.wrongly_matched);
    println!(
        "\nPairs of descriptions that a model is asked about, chosen by words and by embeddings; pairs of one painting that match"
    );
    for set in wording::sets() {
        let [words, embeddings] = [false, true].map(|by_embeddings| set.play(by_embeddings));
        println!(
            "{:<46} asked {:>4} -> {:>4} ({:+.0} %), matched {:>3} -> {:>3} of {:>3}, wrong {} -> {}",
            set.name,
            words.asked,
            embeddings.asked,
            100.0 * (embeddings.asked as f64 / words.asked as f64 - 1.0),
            words.matched,
            embeddings.matched,
            set.of_one_painting(),
            words.wrong,
            embeddings.wrong
        );
    }
}
