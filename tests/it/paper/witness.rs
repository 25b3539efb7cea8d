//! M22: a text without an identifier closes a loop only with a witness.

use serde_json::{Value, json};

use super::equation::compared;
use super::scene::{Detection, Keyframe, Scene, close_to, door, keyframe, thing, to_the_letter};

/// A poster, a metre ahead.
fn poster(text: &str) -> Detection {
    thing("sign", text).at([0.0, 0.0, 1.0])
}

#[tokio::test]
async fn a_slogan_alone_makes_no_loop_and_beside_a_door_number_it_counts() {
    let check = async |what: &str, settings: Value, sights: &[Detection], verdict: &str, code: Value| {
        let found = compared(&settings, sights.to_vec(), sights.to_vec()).await;
        close_to(what, &found["anchors"]["similarity"], 1.0);
        assert_eq!((&found["verdict"], &found["reason"]["code"]), (&json!(verdict), &code), "{what}");
    };
    let slogan = || poster("Be Updated");
    check("a slogan", json!({}), &[slogan()], "undecided", json!("no_witness")).await;
    let two = [slogan(), thing("sign", "Library Corner").at([0.5, 0.0, 1.0])];
    check("two do not witness each other", json!({}), &two, "undecided", json!("no_witness")).await;
    check("turned off", json!({"single_text_needs_witness": false}), &two, "loop", json!(null)).await;
    check("the paper's letter", to_the_letter(&json!({})), &[slogan()], "loop", json!(null)).await;
    let numbered = [slogan(), door("901", [0.5, 0.0, 1.0])];
    check("beside a number", json!({}), &numbered, "loop", json!(null)).await;
    let described = [poster("a sailing boat before a windmill")];
    check("three specific words are a description", json!({}), &described, "loop", json!(null)).await;
    let container = [poster("Library Corner, level 5")];
    check("a floor is no identifier", json!({}), &container, "undecided", json!("no_witness")).await;
}

/// A keyframe at x on a way whose neighbours share fifteen points; the ends share none.
fn on_the_way(x: f64, first_point: i64) -> Keyframe {
    keyframe().at([x, 0.0, 0.0]).observes(first_point..first_point + 30)
}

#[tokio::test]
async fn odometry_over_an_unbroken_chain_is_a_witness_if_it_has_the_two_at_one_place() {
    let check = async |what: &str, chain: bool, ahead_m: f64, back_m: f64, verdict: &str| {
        let scene = Scene::new().await;
        let sees = |x: f64| [thing("sign", "Be Updated").at([x, 0.0, 1.0])];
        scene.put("candidate", on_the_way(0.0, 0).stamp(0).sees(sees(0.0))).await;
        // So many that neither end's local anchor map holds what the other sees.
        for (number, x) in [0.5 * ahead_m, ahead_m, back_m].into_iter().enumerate() {
            let first_point = if chain || number != 1 { 15 * (number as i64 + 1) } else { 1_000 };
            scene.put(&format!("between-{number}"), on_the_way(x, first_point).stamp(number + 1)).await;
        }
        scene.put("query", on_the_way(back_m, 60).stamp(4).sees(sees(back_m))).await;
        let found = scene.compare("query", "candidate").await;
        let reason = if verdict == "loop" { json!(null) } else { json!("no_witness") };
        assert_eq!((&found["verdict"], &found["reason"]["code"]), (&json!(verdict), &reason), "{what}");
    };
    // There and back: 2 m + 1.1 m of way explain 1 m + 5 % of it, 1.155 m; the two posters hang 0.9 m apart.
    check("back at the poster", true, 2.0, 0.9, "loop").await;
    // 2 m + 0.8 m of way: 1.14 m, and 1.2 m apart.
    check("a little farther", true, 2.0, 1.2, "undecided").await;
    check("another poster", true, 2.0, 4.0, "undecided").await;
    check("the chain is broken", false, 2.0, 0.9, "undecided").await;
}

#[tokio::test]
async fn a_confirmed_loop_that_joins_the_passages_is_a_witness() {
    let scene = Scene::new().await;
    let sees = || [poster("Be Updated")];
    scene.put("monday-1", keyframe().session("monday").sees(sees())).await;
    scene.put("monday-2", keyframe().session("monday").words(&[(7, 1.0)]).covisible(&["monday-1"])).await;
    scene.put("tuesday-1", keyframe().session("tuesday").sees(sees())).await;
    let tuesday_2 = keyframe().session("tuesday").words(&[(8, 1.0)]).covisible(&["tuesday-1"]);
    scene.put("tuesday-2", tuesday_2).await;
    let alone = scene.compare("tuesday-1", "monday-1").await;
    assert_eq!(alone["reason"]["code"], "no_witness", "{alone:#}");
    scene.close("somebody-knows", "tuesday-2", "monday-2").await;
    let joined = scene.compare("tuesday-1", "monday-1").await;
    assert_eq!(joined["verdict"], "loop", "{joined:#}");
}

#[tokio::test]
async fn a_number_that_begins_unlike_those_around_it_makes_no_loop_alone() {
    let plate = || door("3.02", [0.0, 0.0, 1.0]);
    let check = async |what: &str, settings: Value, around: [&str; 2], verdict: &str, code: Value| {
        let [left, above] = around;
        let sees = [plate(), door(left, [3.0, 0.0, 0.0]), door(above, [0.0, 3.0, 0.0])];
        let found = compared(&settings, sees, [plate()]).await;
        // (1 + 1) / (1 + 1 + 1/3 + 1/3).
        close_to(what, &found["anchors"]["similarity"], 0.75);
        assert_eq!(
            (&found["verdict"], &found["reason"]["code"]),
            (&json!(verdict), &code),
            "{what}: {found:#}"
        );
    };
    check("floor 3 among floor 9", json!({}), ["9.01", "9.04"], "undecided", json!("no_witness")).await;
    check("two floors meet", json!({}), ["9.01", "3.04"], "loop", json!(null)).await;
    let off = json!({"single_text_needs_witness": false});
    check("turned off", off, ["9.01", "9.04"], "loop", json!(null)).await;
}
