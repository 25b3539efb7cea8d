//! M7, "why not?": each identifier that differs without stopping a candidate says why.

use serde_json::{Value, json};

use super::scene::{Detection, Scene, close_to, door, keyframe, list};

const AHEAD: [f64; 3] = [0.0, 0.0, 1.0];

/// The differences between two passages of one keyframe each.
async fn between(settings: Value, query: &[Detection], candidate: &[Detection]) -> (Value, Vec<Value>) {
    let scene = Scene::with(settings).await;
    scene.put("candidate", keyframe().sees(candidate.iter().cloned())).await;
    scene.put("query", keyframe().sees(query.iter().cloned())).await;
    let found = scene.compare("query", "candidate").await;
    let differences = list(&found["anchors"]["differences"]);
    (found, differences)
}

#[tokio::test]
async fn a_differing_identifier_says_why_it_is_no_contradiction() {
    let plate = |text: &str| door(text, AHEAD);
    // What is read, the setting, and the reason with its figures.
    for (query, candidate, settings, reason, figures) in [
        (
            vec![plate("104")],
            vec![door("110", [0.0, 0.0, 2.5])],
            json!({}),
            "another_place",
            Some((1.5, 1.0)),
        ),
        (
            vec![plate("104")],
            vec![door("110", [1.0, 0.0, 0.0])],
            json!({}),
            "another_place",
            Some((std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_3)),
        ),
        (
            vec![plate("104")],
            vec![plate("110"), door("104", [0.0, 0.0, -5.0])],
            json!({}),
            "known_elsewhere",
            None,
        ),
        (vec![plate("104")], vec![plate("1O4")], json!({}), "no_conflict", None),
        (
            vec![plate("104"), door("107", [0.3, 0.0, 1.2])],
            vec![plate("220")],
            json!({}),
            "paired_otherwise",
            None,
        ),
        (
            vec![plate("104"), door("215", [0.5, 0.0, 0.0])],
            vec![plate("110"), door("215", [0.5, 0.0, 0.0])],
            json!({}),
            "outweighed",
            Some((2.0, 4.0)),
        ),
        (vec![plate("104")], vec![plate("110")], json!({"contradiction_veto": false}), "veto_off", None),
    ] {
        let (found, differences) = between(settings, &query, &candidate).await;
        let told = differences.iter().find(|pair| pair["reason"] == reason);
        let told = told.unwrap_or_else(|| panic!("{reason}: {found:#}"));
        assert!(told["query_identifier"].is_string() && told["candidate_identifier"].is_string(), "{told}");
        assert!(!told["detail"].as_str().unwrap_or_default().is_empty(), "{told}");
        match figures {
            Some((measured, limit)) => {
                close_to(reason, &told["measured"], measured);
                close_to(reason, &told["limit"], limit);
            }
            None => assert!(told.get("measured").is_none() && told.get("limit").is_none(), "{told}"),
        }
    }
}

#[tokio::test]
async fn what_contradicts_or_agrees_is_no_difference() {
    let plate = |text: &str| door(text, AHEAD);
    let (found, differences) = between(json!({}), &[plate("104")], &[plate("110")]).await;
    assert_eq!((found["reason"]["code"].as_str(), differences.len()), (Some("contradiction"), 0));
    let (found, differences) = between(json!({}), &[plate("104")], &[plate("104")]).await;
    assert_eq!((found["verdict"].as_str(), differences.len()), (Some("loop"), 0));
    let (_, differences) = between(json!({}), &[plate("Turing")], &[plate("Curie")]).await;
    assert_eq!(differences.len(), 0, "names are no identifiers");
}

#[tokio::test]
async fn differences_are_few_and_the_nearest_signs_come_first() {
    let hall = |first: u32| -> Vec<Detection> {
        (0..30).map(|n| door(&format!("{}", first + n * 7), [f64::from(n) * 2.0, 0.0, 1.5])).collect()
    };
    let (found, differences) = between(json!({}), &hall(1000), &hall(5001)).await;
    assert_eq!(found["reason"]["code"], "contradiction", "{found:#}");
    assert!(differences.len() <= 8, "{}", differences.len());
    let (_, differences) = between(json!({"contradiction_veto": false}), &hall(1000), &hall(5001)).await;
    assert_eq!(differences.len(), 8);
    assert_eq!(differences[0]["query_identifier"], "1000");
    assert_eq!(differences[0]["candidate_identifier"], "5001");
}

#[tokio::test]
async fn a_low_score_names_the_anchor_and_what_failed() {
    let settings = json!({"contradiction_veto": false});
    for (query, candidate, said) in [
        (door("901", AHEAD), door("901", [0.0, 0.0, 2.5]), "“901” is in both, but 1.50 m nearer or farther"),
        (door("901", AHEAD), door("901", [1.0, 0.0, 0.0]), "“901” is in both, but 1.57 rad aside"),
        (door("901", AHEAD), door("910", AHEAD), "nothing that is read in one is read in the other"),
    ] {
        let (found, _) = between(settings.clone(), &[query], &[candidate]).await;
        let reason = &found["reason"];
        assert_eq!(reason["code"], "score_below_threshold", "{found:#}");
        assert!(
            reason["detail"].as_str().unwrap_or_default().contains(said),
            "{reason:#} does not say {said}"
        );
    }
}
