//! A robot without map points, by curl: poses and plates, as in the README, and nothing that says which keyframes are neighbours.

use serde_json::{Value, json};

use crate::support::{Server, curl, pose};

const PLATES: [(&str, [f64; 3]); 4] = [
    ("901", [2.0, 0.0, 1.0]),
    ("903", [9.0, 0.0, -2.0]),
    ("905", [6.0, 0.0, -5.0]),
    ("907", [-1.0, 0.0, -2.0]),
];
const SIGHT_M: f64 = 2.2;
const STEPS: usize = 48;

/// The place after a number of steps around a block of 8 m by 4 m, half a metre each.
fn place(step: usize) -> [f64; 3] {
    let along = |from: usize| (step - from) as f64 / 2.0;
    match step {
        0..16 => [along(0), 0.0, 0.0],
        16..24 => [8.0, 0.0, -along(16)],
        24..40 => [8.0 - along(24), 0.0, -4.0],
        _ => [0.0, 0.0, along(40) - 4.0],
    }
}

fn keyframe(second: usize) -> Value {
    let at = place(second % STEPS);
    let distance = |sign: &[f64; 3]| (sign[0] - at[0]).hypot(sign[2] - at[2]);
    let near = PLATES.iter().filter(|(_, sign)| distance(sign) < SIGHT_M);
    let detections = near.map(|(text, sign)| {
        json!({"class": "door_number", "confidence": 0.9, "box": [300, 200, 340, 220], "position": sign, "text": text})
    });
    json!({"stamp": {"sec": second, "nanosec": 0}, "pose": pose(at), "bow": {"words": [3, 17, 42], "weights": [1, 1, 1]},
        "detections": detections.collect::<Vec<_>>()})
}

#[tokio::test]
async fn two_laps_past_four_plates_make_four_anchors_and_the_second_laps_loops() {
    let server = Server::start().await;
    let map = "http://127.0.0.1:7878/v1/maps/hotel";
    curl(&server, &format!("curl -X PUT {map} --json '{{}}'")).await;
    let mut closed: Vec<(usize, usize)> = Vec::new();
    for second in 0..2 * STEPS {
        let put =
            format!("curl -X PUT '{map}/keyframes/kf-{second}?query=loop' --json '{}'", keyframe(second));
        let answer = curl(&server, &put).await;
        assert!(answer["loop"]["verdict"].is_string(), "{answer:#}");
        if let Some(best) = answer["loop"]["best"].as_str() {
            let body =
                json!({"id": format!("l-{second}"), "keyframe": format!("kf-{second}"), "candidate": best});
            curl(&server, &format!("curl {map}/loops --json '{body}'")).await;
            closed.push((second, best.trim_start_matches("kf-").parse().unwrap()));
        }
    }
    let answer = curl(&server, &format!("curl {map}")).await;
    assert_eq!(answer["anchors"], PLATES.len(), "{answer:#}");
    assert!((1..=PLATES.len()).contains(&closed.len()), "{closed:?}");
    for (second, earlier) in &closed {
        assert!(*second >= STEPS && *earlier < STEPS, "{closed:?}");
        assert!((second - STEPS).abs_diff(*earlier) <= 4, "{closed:?}");
    }
}
