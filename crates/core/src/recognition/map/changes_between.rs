//! Changes between two versions of a map: for who decides whether robots need a newer one.
//!
//! Dense numbers are given once, so a keyframe or an anchor of both versions has the same number in both.

use std::collections::BTreeMap;

use super::index::MapIndex;
use crate::domain::anchor::AnchorState;
use crate::domain::ids::{AnchorSeq, KeyframeId, KeyframeSeq};
use crate::domain::release::{AnchorChange, ReleaseChanges};
use crate::geometry::Pose;

/// A version of a map, as far as it is compared: taken under the map's lock, and compared without any.
#[derive(Clone, Debug, Default)]
pub struct ComparedVersion {
    keyframes: BTreeMap<KeyframeSeq, (KeyframeId, Pose)>,
    /// Signs by their oldest anchor.
    signs: BTreeMap<AnchorSeq, Sign>,
    /// The sign of each anchor.
    sign_of: BTreeMap<AnchorSeq, AnchorSeq>,
}

#[derive(Clone, Debug)]
struct Sign {
    class: String,
    description: Option<String>,
    is_retired: bool,
    anchors: Vec<AnchorSeq>,
}

impl ComparedVersion {
    /// Takes what is compared of a map.
    pub fn of(index: &MapIndex) -> Self {
        let mut this = Self::default();
        for keyframe in index.keyframes() {
            this.keyframes.insert(keyframe.seq, (keyframe.id.clone(), keyframe.map_from_camera));
        }
        for (seq, object) in index.objects().iter() {
            let sign = Sign {
                class: index.class_of(object).to_owned(),
                description: object.description.as_ref().map(|description| description.raw.to_string()),
                is_retired: object.state == AnchorState::Retired,
                anchors: object.members.clone(),
            };
            this.sign_of.extend(sign.anchors.iter().map(|anchor| (*anchor, seq)));
            this.signs.insert(seq, sign);
        }
        this
    }

    fn sign(&self, anchor: AnchorSeq) -> Option<&Sign> {
        self.signs.get(self.sign_of.get(&anchor)?)
    }
}

/// Returns what is other in the later version. Each list has at most `limit`, by number; the counts are of all.
pub fn changes_between(earlier: &ComparedVersion, later: &ComparedVersion, limit: usize) -> ReleaseChanges {
    let mut changes = ReleaseChanges::default();
    for (seq, (id, pose)) in &later.keyframes {
        match earlier.keyframes.get(seq) {
            None => changes.keyframes_added.add(limit, id.clone()),
            Some((_, before)) if before != pose => {
                changes.keyframes_moved.add(limit, (id.clone(), distance_m(before, pose)));
            }
            Some(_) => {}
        }
    }
    for (seq, (id, _)) in &earlier.keyframes {
        if !later.keyframes.contains_key(seq) {
            changes.keyframes_removed.add(limit, id.clone());
        }
    }
    for (seq, sign) in &later.signs {
        let before = earlier.sign(*seq);
        let change = || change(*seq, before, Some(sign));
        let Some(known) = before else {
            changes.anchors_added.add(limit, change());
            continue;
        };
        match (known.is_retired, sign.is_retired) {
            (false, true) => changes.anchors_retired.add(limit, change()),
            (true, false) => changes.anchors_returned.add(limit, change()),
            _ => {}
        }
        if known.description != sign.description {
            changes.anchors_described.add(limit, change());
        }
    }
    for (seq, sign) in &earlier.signs {
        // One that merged into another is gone as little as its sign is.
        if sign.anchors.iter().all(|anchor| later.sign(*anchor).is_none()) {
            changes.anchors_removed.add(limit, change(*seq, Some(sign), None));
        }
    }
    changes
}

fn change(anchor: AnchorSeq, before: Option<&Sign>, after: Option<&Sign>) -> AnchorChange {
    let text = |of: Option<&Sign>| of.and_then(|sign| sign.description.clone());
    let class = after.or(before).map_or_else(String::new, |sign| sign.class.clone());
    AnchorChange { anchor, class, before: text(before), after: text(after) }
}

fn distance_m(a: &Pose, b: &Pose) -> f64 {
    let [a, b] = [a, b].map(Pose::translation_m);
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}
