//! Geometry without anchors: it decides where the map says so, and where nothing repeats.

use revisit::geometry::Pose;
use serde_json::json;

use super::scene::{Shot, asked, query_pose};

#[tokio::test]
async fn without_anchors_geometry_decides_only_where_the_map_says_so() {
    let candidate = Shot::of(1, Pose::identity());
    let check = async |room: u64, features: bool, policy: &str, repeats: bool, expected: [&str; 2]| {
        let query = Shot::of(room, query_pose()).body("b", features);
        let settings = json!({"without_anchors": policy, "building_repeats": repeats});
        let (verdict, found) = asked(&candidate.body("a", true), &query, settings, "auto").await;
        assert_eq!(
            [verdict.as_str(), found["reason"]["code"].as_str().unwrap_or("none")],
            expected,
            "{found:#}"
        );
    };
    check(1, true, "geometry", false, ["loop", "none"]).await;
    // A copy of the room would look the same.
    check(1, true, "geometry", true, ["undecided", "no_anchors"]).await;
    check(2, true, "geometry", false, ["no_loop", "too_few_inliers"]).await;
    check(1, false, "geometry", false, ["undecided", "no_anchors"]).await;
    check(1, true, "undecided", false, ["undecided", "no_anchors"]).await;
    check(1, true, "reject", false, ["no_loop", "no_anchors"]).await;
}
