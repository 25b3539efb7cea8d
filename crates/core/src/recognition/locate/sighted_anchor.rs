//! Anchors that the camera sees now, in the frame of its first keyframe, and the anchors of a map that may be they.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::domain::ids::{AnchorSeq, SessionSeq};
use crate::geometry::{Point3, Pose};
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::loops::candidates::MAX_REVISITS_PER_ANCHOR;
use crate::recognition::loops::query::Query;
use crate::recognition::map::index::MapIndex;
use crate::recognition::plans::alignments::Alignments;
use crate::semantics::Text;

/// Pairs of a sighted anchor and an anchor of one session's frame that are looked at; those of the most distinctive texts
/// come first.
pub(in crate::recognition) const PAIRS_PER_SESSION_MAX: usize = 48;

/// An anchor that the camera sees.
#[derive(Clone, Debug)]
pub struct SightedAnchor {
    /// The keyframe that sees it, by its number in the request, and its detection.
    pub detection: (usize, usize),
    /// Its class.
    pub class: Box<str>,
    /// Its text.
    pub text: Arc<Text>,
    /// Its centre, in the camera frame of the first keyframe, in metres.
    pub centre: Point3,
}

/// A sighted anchor, and an anchor of the map with a matching text.
#[derive(Clone, Debug)]
pub struct AnchorPair {
    /// The number of the sighted anchor.
    pub sighted: usize,
    /// The object of the map.
    pub object: AnchorSeq,
    /// Its centre in the session's frame, in metres.
    pub centre_in_session: Point3,
    /// In how many places its text hangs.
    pub places: usize,
    /// Its identifier as written, where it has one and hangs in one place only.
    pub identifier: Option<String>,
}

/// Returns the valid anchors with a measured position that a keyframe sees. `reference_from_session` brings the keyframe's
/// own frame into that of the first keyframe's camera.
pub fn sighted_anchors(
    index: &MapIndex,
    query: &Query<'_>,
    keyframe: usize,
    reference_from_session: &Pose,
) -> Vec<SightedAnchor> {
    let min_level = index.properties().settings.description_min_information_level;
    let is_valid = |level: u8| u32::from(level) >= min_level;
    let inline = query.centre.inline.iter();
    inline
        .filter(|anchor| !anchor.range_assumed && anchor.information_level().is_some_and(is_valid))
        .filter_map(|anchor| {
            Some(SightedAnchor {
                detection: (keyframe, anchor.detection),
                class: anchor.class.clone(),
                text: anchor.text.clone()?,
                centre: reference_from_session.transform(&anchor.centre_in_session),
            })
        })
        .collect()
}

/// Returns, for each session and each plan, the pairs of sighted anchors and anchors that stand in its frame.
pub fn pairs_by_session(
    index: &MapIndex,
    sighted: &[SightedAnchor],
    counts: &mut PlaceCounts,
    alignments: &mut Alignments<'_>,
) -> BTreeMap<SessionSeq, Vec<AnchorPair>> {
    let mut pairs: BTreeMap<SessionSeq, Vec<AnchorPair>> = BTreeMap::new();
    for (number, anchor) in sighted.iter().enumerate() {
        let drawn = alignments.priors_of(&anchor.class, &anchor.text);
        for seq in &drawn {
            let Some(prior) = index.anchor(*seq).and_then(|found| found.prior.as_ref()) else { continue };
            let is_distinctive = drawn.len() == 1;
            pairs.entry(prior.frame).or_default().push(AnchorPair {
                sighted: number,
                object: *seq,
                centre_in_session: prior.position_in_frame,
                places: drawn.len(),
                identifier: is_distinctive.then(|| anchor.text.gist().to_owned()),
            });
        }
        for text in index.texts().matching_text(&anchor.class, &anchor.text) {
            let places = counts.of_text(index, text);
            for root in index.texts().objects(text).take(MAX_REVISITS_PER_ANCHOR) {
                let Some(object) = index.objects().get(root) else { continue };
                let measured = object.shapes.iter().filter(|(_, shape)| !shape.range_assumed);
                for (session, aabb) in measured.filter_map(|(session, shape)| Some((*session, shape.aabb?))) {
                    let described = object.description.as_ref();
                    let identifies = |text: &Text| places == 1 && text.has_name();
                    let named = described.filter(|described| identifies(&described.text));
                    pairs.entry(session).or_default().push(AnchorPair {
                        sighted: number,
                        object: root,
                        centre_in_session: aabb.centre(),
                        places,
                        identifier: named.map(|described| described.text.gist().to_owned()),
                    });
                }
            }
        }
    }
    for of_session in pairs.values_mut() {
        of_session.sort_by_key(|pair| (pair.places, pair.sighted, pair.object));
        of_session.truncate(PAIRS_PER_SESSION_MAX);
    }
    pairs
}
