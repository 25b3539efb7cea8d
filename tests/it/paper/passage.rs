//! M10 and M21, in the answers: one passage, and an unsure reading; `crates/core/tests/paper/passage.rs` asks the core.

use super::scene::{Scene, door, keyframe, texts};

#[tokio::test]
async fn a_tracked_plate_and_an_unsure_reading_are_told_as_such() {
    let scene = Scene::new().await;
    let plate = || [door("901", [0.0, 0.0, 3.0])];
    let at = |x: f64| keyframe().at([x, 0.0, 0.0]);
    scene.put("first", at(0.0).sees(plate())).await;
    scene.put("second", at(0.5).covisible(&["first"]).sees(plate())).await;
    scene.put("third", at(1.0).covisible(&["second"]).sees(plate())).await;
    let found = scene.compare("third", "first").await;
    assert_eq!([&found["verdict"], &found["reason"]["code"]], ["undecided", "tracked_only"], "{found:#}");
    let unsure = keyframe().sees([door("907", [9.0, 0.0, 3.0]).confidence(0.79)]);
    assert_eq!(texts(&scene.put("unsure", unsure).await["detections"], "state"), ["uninformative"]);
}
