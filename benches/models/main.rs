//! How much of a world reaches a model, and whether its word can join what identifiers part.

mod world;

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
}
