//! Applying changes of what is observed: keyframes and detections have other map points, or are of another session (M57, M59).

use std::collections::BTreeSet;

use super::map_index::MapIndex;
use super::touched::Touched;
use crate::domain::change::{Change, Keyframe, PointsOfKeyframe};
use crate::domain::ids::{AnchorSeq, KeyframeSeq, PointId, SessionSeq};

impl MapIndex {
    /// Applies what happens to a merge of sessions.
    pub(super) fn apply_merge(&mut self, change: &Change, touched: &mut Touched) {
        match change {
            Change::SessionsMerged(merge) => {
                let is_moved = |keyframe: &&Keyframe| {
                    keyframe.session == merge.session && keyframe.seq < merge.next_keyframe
                };
                let moved: Vec<KeyframeSeq> = self.keyframes().filter(is_moved).map(|k| k.seq).collect();
                self.move_to_session(&moved, merge.into, touched);
            }
            Change::MergeKept(undo) => self.open_merges.open(undo),
            Change::MergeSettled(session) => self.open_merges.close(*session),
            Change::MergeRevoked(undo) => {
                self.move_to_session(&undo.keyframes, undo.session, touched);
                self.open_merges.close(undo.session);
            }
            _ => {}
        }
    }

    pub(super) fn set_points_of_keyframe(&mut self, now: &PointsOfKeyframe) {
        let seq = now.keyframe;
        let listed = self.lists.listed(seq).map(<[_]>::to_vec);
        self.count_unlinked(seq, false);
        let Some(keyframe) = self.keyframes.get_mut(seq.index()) else { return };
        self.tally.remove_keyframe(keyframe);
        let session = keyframe.session;
        let observed = std::mem::replace(&mut keyframe.observes, now.observes.clone());
        keyframe.declared.clone_from(&now.declared);
        keyframe.renamed = Some(now.renamed.clone());
        keyframe.bytes = now.bytes;
        self.tally.add_keyframe(keyframe);
        // Only what differs: a point's observers are written anew each time.
        let (old, new): (BTreeSet<PointId>, BTreeSet<PointId>) =
            (observed.iter().collect(), now.observes.iter().collect());
        let parted = self.points.sharing(session, old.difference(&new).copied());
        self.points.forget(session, old.difference(&new).copied(), seq);
        self.points.observe(session, new.difference(&old).copied(), seq);
        if let Some(before) = listed {
            let sharing = self.covisibility().counted(seq);
            self.lists.relist(seq, &before, &sharing);
        } else {
            let met = self.points.sharing(session, new.difference(&old).copied());
            self.share_with_listing(seq, parted.iter().chain(&met).map(|(other, _)| *other));
        }
        self.retrack(seq);
        self.count_unlinked(seq, true);
        for (other, points) in now.declared.iter().flatten() {
            let theirs = self.keyframe(*other).into_iter().flat_map(Keyframe::declared);
            let theirs = theirs.filter(|(back, _)| *back == seq).map(|(_, points)| *points).max();
            self.lists.redeclare(seq, *other, theirs.unwrap_or(0).max(*points));
        }
    }

    /// Tells those of some keyframes that list their neighbours how many points they share with a crowded one. It lists nothing
    /// itself, and to count all its neighbours costs as much as they observe.
    fn share_with_listing(&mut self, crowded: KeyframeSeq, others: impl Iterator<Item = KeyframeSeq>) {
        let enough = self.covisibility().enough();
        for other in others.filter(|other| *other != crowded).collect::<BTreeSet<KeyframeSeq>>() {
            if self.lists.listed(other).is_some() {
                let points = self.covisibility().common_points(crowded, other, u32::MAX);
                self.lists.share(other, crowded, (points >= enough).then_some(points));
            }
        }
    }

    /// Makes keyframes those of another session. Each shares map points with those that are of it already.
    fn move_to_session(&mut self, keyframes: &[KeyframeSeq], session: SessionSeq, touched: &mut Touched) {
        for seq in keyframes.iter().copied() {
            let before = self.covisibility().sharing(seq).into_owned();
            self.untrack(seq);
            let Some(keyframe) = self.keyframes.get_mut(seq.index()) else { continue };
            let former = std::mem::replace(&mut keyframe.session, session);
            self.points.forget(former, keyframe.observes.iter(), seq);
            self.points.observe(session, keyframe.observes.iter(), seq);
            let sharing = self.covisibility().counted(seq);
            self.lists.relist(seq, &before, &sharing);
            self.track(seq);
            touched.stale.extend(self.anchors_seen_by(seq));
        }
    }

    pub(super) fn set_points_of_detection(
        &mut self,
        seq: AnchorSeq,
        at: (KeyframeSeq, u16),
        points: &[PointId],
        touched: &mut Touched,
    ) {
        let Some(anchor) = self.anchors.get_mut(seq.index()) else { return };
        let Some(observation) = anchor.observations.get_mut(&at) else { return };
        self.tally.remove_observation(observation);
        observation.map_points = points.into();
        self.tally.add_observation(observation);
        touched.stale.insert(seq);
    }
}
