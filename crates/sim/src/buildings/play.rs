//! A world played against a server, or recorded for `revisit replay`.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::kind::Kind;
use super::route;
use super::sight::{self, Keyframe};
use super::truth::{Standing, standing};
use super::world::World;
use crate::api::loops::LoopBody;
use crate::api::map::MapBody;
use crate::api::verdict::{CandidateView, LoopAnswer};
use crate::client::{Client, ClientError, Recorded};
use crate::domain::verdict::Decision;
use crate::hotel::method::Method;

/// The length of a piece of corridor that counts as one visit, in metres.
const VISIT_M: f64 = 7.0;
/// Every so many keyframes of a further drive ask where they are.
const LOCATE_EVERY: usize = 4;

/// One query, as it is scored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    /// The visit that it belongs to: its session, its place and its piece of corridor.
    pub visit: String,
    /// Whether an earlier keyframe is of the same place.
    pub has_truth: bool,
    /// The place that the answer names.
    pub named: Option<Named>,
}

/// The place that an answer names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Named {
    /// Its standing to the query.
    pub standing: Standing,
    /// Whether the two sessions have never been in one place; then a wrong loop joins what has nothing in common.
    pub never_met: Option<(usize, usize)>,
    /// The loop's grounds: the kinds of the texts that match, and whether geometry verified it.
    pub rests_on: String,
}

/// One answer to "where am I?".
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Located {
    /// The confidence that the answer says, 0 to 1.
    pub confidence: f64,
    /// Whether its first place is within ten metres, on the right floor and wing.
    pub is_right: bool,
    /// Whether the place was mapped.
    pub is_mapped: bool,
}

/// A world after it was played.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Played {
    /// Its kind.
    pub kind: Kind,
    /// Its seed.
    pub seed: u64,
    /// Its queries, in order.
    pub asked: Vec<Asked>,
    /// Its answers to "where am I?".
    pub located: Vec<Located>,
}

/// Returns the keyframes of a world, in the order in which they are sent.
pub fn keyframes(world: &World) -> Vec<Keyframe> {
    let sessions = route::sessions(world);
    sessions.iter().enumerate().flat_map(|(number, stands)| sight::session(world, number, stands)).collect()
}

/// Plays a world in a map of its own. The robot closes every loop that it is told.
pub async fn play(client: &Client, kind: Kind, seed: u64, arm: Method) -> Result<Played, ClientError> {
    let world = World::new(kind, seed);
    let all = keyframes(&world);
    let map = format!("{}-{seed}-{}", kind.as_str(), arm.as_str());
    client.put_map(&map, &map_body(arm)).await?;
    let mut asked = Vec::with_capacity(all.len());
    for (number, keyframe) in all.iter().enumerate() {
        let body = Recorded(keyframe.body.clone());
        let answer = client.put_keyframe(&map, &keyframe.id, &body, true).await?.answer.loop_answer;
        let place = answer.as_ref().and_then(LoopAnswer::place);
        let named = place.and_then(|place| {
            let other = all[..number].iter().find(|other| other.id == place.keyframe)?;
            Some(named(&all[..=number], keyframe, other, place))
        });
        if let (Some(answer), Some(place)) = (&answer, place)
            && answer.verdict.0 == Decision::Loop
        {
            let id = format!("loop-{number}");
            let closed = LoopBody::found(&id, &keyframe.id, &place.keyframe, answer.id.clone())?;
            client.post_loop(&map, &closed).await?;
        }
        let has_truth = all[..number].iter().any(|other| standing(keyframe, other) == Standing::Right);
        asked.push(Asked { visit: visit(keyframe), has_truth, named });
    }
    let located = locate(client, &map, &world, &all).await?;
    client.delete_map(&map).await?;
    Ok(Played { kind, seed, asked, located })
}

fn map_body(arm: Method) -> MapBody {
    MapBody { metric: Some(true), settings: Some(arm.settings()), ..MapBody::default() }
}

fn visit(keyframe: &Keyframe) -> String {
    let space = keyframe.stand.space;
    let piece = if space.is_room { -1.0 } else { (keyframe.stand.at[1] / VISIT_M).floor() };
    format!("{} {} {} {piece}", keyframe.session, space.floor, space.wing)
}

fn named(so_far: &[Keyframe], query: &Keyframe, other: &Keyframe, place: &CandidateView) -> Named {
    let spaces = |session: usize| so_far.iter().filter(move |keyframe| keyframe.session == session);
    let met =
        spaces(query.session).any(|a| spaces(other.session).any(|b| a.stand.space.is_beside(b.stand.space)));
    let kinds = place.anchors.iter().flat_map(|anchors| anchors.matches.iter().flatten());
    let mut kinds: Vec<&str> = kinds.map(|pair| pair.kind.0.as_str()).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let geometry = if place.inliers().is_some() { "geometry" } else { "no geometry" };
    let texts = if kinds.is_empty() { "no text".to_owned() } else { kinds.join(" + ") };
    Named {
        standing: standing(query, other),
        never_met: (!met).then_some((other.session, query.session)),
        rests_on: format!("{texts}, {geometry}"),
    }
}

/// Asks where the keyframes of two further drives are: one where robots have been, one where none has.
async fn locate(
    client: &Client,
    map: &str,
    world: &World,
    all: &[Keyframe],
) -> Result<Vec<Located>, ClientError> {
    let mut located = Vec::new();
    for (drive, stands) in route::questions(world).iter().enumerate() {
        for keyframe in sight::session(world, 90 + drive, stands).iter().step_by(LOCATE_EVERY) {
            let question = json!({"keyframe": keyframe.body, "maps": [map]});
            let question = Recorded(question.as_object().cloned().unwrap_or_default());
            let answer = client.locate(&question).await?;
            let place = answer.places.first().and_then(|place| place.keyframe.as_deref());
            let place = place.and_then(|id| all.iter().find(|other| other.id == id));
            let is_near = |other: &Keyframe| {
                let apart_m = (other.stand.place() - keyframe.stand.place()).norm();
                other.stand.space.is_beside(keyframe.stand.space) && apart_m <= 10.0
            };
            located.push(Located {
                confidence: answer.confidence,
                is_right: place.is_some_and(is_near),
                is_mapped: all.iter().any(is_near),
            });
        }
    }
    Ok(located)
}

/// Returns the lines of a world for `revisit replay`: its map, and each keyframe with its query and its truth.
pub fn recording(kind: Kind, seed: u64, arm: Method) -> Vec<Value> {
    let all = keyframes(&World::new(kind, seed));
    let id = format!("{}-{seed}", kind.as_str());
    let mut lines = vec![json!({"op": "map", "id": id, "body": map_body(arm)})];
    for (number, keyframe) in all.iter().enumerate() {
        lines.push(json!({"op": "keyframe", "id": keyframe.id, "body": keyframe.body}));
        let of = |wanted: Standing| -> Vec<&str> {
            let others = all[..number].iter().filter(|other| standing(keyframe, other) == wanted);
            others.map(|other| other.id.as_str()).collect()
        };
        let (truth, ignore) = (of(Standing::Right), of(Standing::Near));
        lines.push(
            json!({"op": "query", "keyframe": keyframe.id, "body": {}, "truth": truth, "ignore": ignore}),
        );
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_world_is_small_has_returns_and_is_the_same_each_time() {
        for kind in Kind::ALL {
            let lines = recording(kind, 3, Method::Ours);
            let keyframes = lines.iter().filter(|line| line["op"] == "keyframe").count();
            assert!((120..=400).contains(&keyframes), "{}: {keyframes} keyframes", kind.as_str());
            let returns = |line: &&Value| line["truth"].as_array().is_some_and(|truth| !truth.is_empty());
            assert!(lines.iter().filter(returns).count() >= 20, "{}: too few returns", kind.as_str());
            assert_eq!(lines, recording(kind, 3, Method::Ours), "{}", kind.as_str());
        }
    }
}
