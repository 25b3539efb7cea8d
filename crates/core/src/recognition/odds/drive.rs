//! The drive: what a robot read on its way to a keyframe belongs to the question.
//!
//! It is the unbroken chain of covisible keyframes back from the query, in their poses relative to it. Where tracking was lost
//! or another session begins it ends. Around a candidate the chain goes both ways: a robot may come from either side.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::domain::ids::KeyframeSeq;
use crate::geometry::Bearing;
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::loops::anchor_map::{LocalAnchor, LocalAnchorMap, LocalName, stored_anchor};
use crate::recognition::loops::centre::Centre;
use crate::recognition::map::index::{MapIndex, Shape};

/// Keyframes of a chain, in one direction.
pub(in crate::recognition) const CHAIN_MAX: usize = 30;
/// Signs with names of one side that are compared, the nearest first, so that a hall full of plates costs no more than a
/// corridor.
pub(in crate::recognition) const SIGNS_MAX: usize = 48;

/// Returns the chain back from a keyframe, that keyframe first.
pub fn chain_back(index: &MapIndex, from: KeyframeSeq) -> Vec<KeyframeSeq> {
    unbroken(index, index.way_back(from))
}

/// Returns the chains around the place of a keyframe, that keyframe first: back from the first of the keyframes that see what it
/// sees, and on from the last. A robot that turns on the spot takes many before it leaves.
pub fn chain_around(index: &MapIndex, keyframe: KeyframeSeq) -> Vec<KeyframeSeq> {
    let session = index.session_of(keyframe);
    let place = || {
        let near = index.covisibility().neighbours_by_sight(keyframe);
        near.filter(|near| index.session_of(*near) == session).chain([keyframe])
    };
    let (first, last) = (place().min().unwrap_or(keyframe), place().max().unwrap_or(keyframe));
    let mut chain = vec![keyframe];
    chain.extend(chain_back(index, first));
    chain.extend(unbroken(index, index.way_on(first)));
    chain.extend(unbroken(index, index.way_on(last)));
    chain.sort_unstable();
    chain.dedup();
    chain
}

fn unbroken(index: &MapIndex, way: impl Iterator<Item = KeyframeSeq>) -> Vec<KeyframeSeq> {
    let mut chain: Vec<KeyframeSeq> = Vec::new();
    for keyframe in way.take(CHAIN_MAX + 1) {
        if chain.last().is_some_and(|before| !index.covisibility().joins_by_sight(*before, keyframe)) {
            break;
        }
        chain.push(keyframe);
    }
    chain
}

/// Whether the poses of a chain move: a robot that tells turns alone tells no metres.
pub fn moves(index: &MapIndex, chain: &[KeyframeSeq]) -> bool {
    let mut centres = chain
        .iter()
        .filter_map(|keyframe| index.keyframe(*keyframe))
        .map(|stored| stored.map_from_camera.centre());
    centres.next().is_some_and(|first| centres.any(|other| other != first))
}

/// Returns the signs with names around a keyframe: those of its local anchor map, and those that the chain saw; the nearest
/// first. A sign stands where this drive saw it: what other passages saw of it may lie elsewhere, by their own drift.
pub fn named_signs(
    index: &MapIndex,
    centre: &Centre,
    chain: &[KeyframeSeq],
    local: &LocalAnchorMap,
    places: &mut PlaceCounts,
) -> Vec<Arc<LocalAnchor>> {
    let is_named = |sign: &LocalAnchor| sign.text.as_ref().is_some_and(|text| text.has_own_name());
    let known: BTreeSet<LocalName> = local.anchors.iter().map(|sign| sign.name).collect();
    let of_chain = index.objects_seen_by_any(chain).into_iter();
    let of_chain = of_chain.filter(|root| !known.contains(&LocalName::MergedAnchor(*root)));
    let of_chain = of_chain.filter_map(|root| stored_anchor(index, centre, root, places));
    let of_chain = LocalAnchorMap { session: centre.session, anchors: of_chain.collect() };
    let mut signs: Vec<LocalAnchor> =
        local.valid().chain(of_chain.valid()).filter(|sign| is_named(sign)).cloned().collect();
    let chain: BTreeSet<KeyframeSeq> = chain.iter().copied().collect();
    for sign in &mut signs {
        place_by(index, centre, &chain, sign);
    }
    let nearest_first = |a: &LocalAnchor, b: &LocalAnchor| {
        (a.bearing.distance_m().total_cmp(&b.bearing.distance_m())).then_with(|| a.name.cmp(&b.name))
    };
    signs.sort_by(nearest_first);
    signs.truncate(SIGNS_MAX);
    signs.into_iter().map(Arc::new).collect()
}

/// Puts a sign where the anchors of it stand that these keyframes saw, if they saw any.
fn place_by(index: &MapIndex, centre: &Centre, chain: &BTreeSet<KeyframeSeq>, sign: &mut LocalAnchor) {
    let (LocalName::MergedAnchor(root), Some(session)) = (sign.name, centre.session) else { return };
    let Some(object) = index.objects().get(root) else { return };
    if object.members.len() == 1 {
        return;
    }
    let mut shape = Shape::default();
    for anchor in index.anchors_of(object) {
        if let Some(of_anchor) = anchor.shapes.get(&session)
            && anchor.keyframes().any(|keyframe| chain.contains(&keyframe))
        {
            shape.join(of_anchor);
        }
    }
    if let Some(aabb) = shape.aabb {
        sign.centre_in_session = aabb.centre();
        sign.range_assumed = shape.range_assumed;
        sign.bearing = Bearing::of(&sign.centre_in_session, &centre.map_from_camera);
    }
}
