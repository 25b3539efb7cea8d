//! Sessions of a map: what each holds, its alignment to a plan, and merges: two maps of a client became one, and two again.

use std::collections::BTreeMap;

use super::corrections::ChangedCounts;
use super::named::find_session;
use crate::domain::ids::{MapId, SessionId, SessionSeq};
use crate::domain::invalid::FieldError;
use crate::domain::keyframe::Stamp;
use crate::domain::report::{AlignmentReport, Page, SessionReport};
use crate::domain::request::PageRequest;
use crate::domain::session_merge::{Renumbering, SessionMergeRequest};
use crate::engine::error::refuse;
use crate::engine::limits::quota::check_merge;
use crate::engine::maps::live::Decision;
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::anchors::observations::ObservationsChanged;
use crate::recognition::anchors::session_merge::{
    is_open, keyframes_of_session, merge_faults, merge_sessions, revoke_merge,
};
use crate::recognition::map::index::MapIndex;
use crate::recognition::plans::alignments::Alignments;
use crate::recognition::plans::plan_alignment::PlanAlignment;

/// Keyframes of a session that may merge: all are held and moved at once.
pub const MERGED_KEYFRAMES_MAX: usize = 100_000;

/// Keyframes of one whose map points get other numbers: each is a row, and all are written in one transaction.
pub const RENUMBERED_KEYFRAMES_MAX: usize = 10_000;

impl Service {
    /// Returns the sessions of a map, in order of appearance.
    pub async fn list_sessions(&self, map: &MapId, page: PageRequest) -> Result<(u64, Page<SessionReport>)> {
        let live = self.live(map).await?;
        self.read(&live, move |state| {
            let index = &state.index;
            let from = match &page.cursor {
                Some(cursor) => after_session(index, cursor)?,
                None => 0,
            };
            let held = held(index);
            let mut alignments = Alignments::of(index);
            let mut rest = (from..index.sessions().len()).map(|number| SessionSeq(number as u32));
            let items: Vec<SessionReport> = rest
                .by_ref()
                .take(page.limit)
                .map(|session| report(index, session, &held, &mut alignments))
                .collect();
            let next_cursor = items.last().filter(|_| rest.next().is_some()).map(|last| last.id.to_string());
            Ok(Page { items, next_cursor })
        })
        .await
    }

    /// Merges a session into another one, all of it or nothing. One without keyframes is left as it is: it was merged before.
    pub async fn merge_sessions(
        &self,
        map: &MapId,
        request: SessionMergeRequest,
    ) -> Result<(ChangedCounts, u64)> {
        let live = self.live(map).await?;
        let room = self.room(live.owner).await?;
        let decide = move |index: &mut MapIndex| {
            let session = driven(index, &request.session)?;
            refuse(merge_faults(index, &request))?;
            let keyframes = keyframes_of_session(index, session);
            if keyframes.is_empty() {
                return Ok(Decision::Unchanged(ChangedCounts::default()));
            }
            let (limit, what) = match request.map_points {
                Renumbering::Same => (MERGED_KEYFRAMES_MAX, "keyframes"),
                _ => (RENUMBERED_KEYFRAMES_MAX, "keyframes whose map points get other numbers"),
            };
            if keyframes.len() > limit {
                let detail = format!("the session has {} {what}", keyframes.len());
                return Err(ServiceError::TooLarge(format!("{detail}, and at most {limit} may merge")));
            }
            check_merge(&room, index, &request, &keyframes)?;
            let changed = merge_sessions(index, session, &request);
            let ObservationsChanged { keyframes, map_points, merged, decided } = changed;
            Ok(Decision::Changed(ChangedCounts { keyframes, map_points, merged }, decided, None))
        };
        self.change(&live, decide).await
    }

    /// Takes the merge of a session back, and returns how many keyframes moved.
    pub async fn revoke_merge(&self, map: &MapId, session: SessionId) -> Result<(usize, u64)> {
        let live = self.live(map).await?;
        let wanted = session.clone();
        let (_, found) = self.read(&live, move |state| driven(&state.index, &wanted)).await?;
        let kept = self.store.merge_undo(live.key, found).await?;
        let decide = move |index: &mut MapIndex| {
            let Some((undo, former)) = kept.filter(|(undo, _)| is_open(index, undo)) else {
                let detail = format!(
                    "no merge of session {session} can be revoked: it was not merged, or one of the two sessions was written since"
                );
                return Err(ServiceError::Conflict { code: "no_open_merge", detail });
            };
            let keyframes = undo.keyframes.len();
            Ok(Decision::Changed(keyframes, revoke_merge(index, undo, &former), None))
        };
        self.change(&live, decide).await
    }
}

/// Returns the number of the session that follows the one that a cursor names.
fn after_session(index: &MapIndex, cursor: &str) -> Result<usize> {
    let id: Option<SessionId> = cursor.parse().ok();
    let named = id.and_then(|id| index.session(&id));
    named.map(|session| session.index() + 1).ok_or_else(|| ServiceError::bad_cursor(cursor))
}

/// By session, the number of its keyframes, their first and their last stamp.
type Held = BTreeMap<SessionSeq, (usize, Stamp, Stamp)>;

fn held(index: &MapIndex) -> Held {
    let mut held = Held::new();
    for keyframe in index.keyframes() {
        let stamp = keyframe.stamp;
        let of_session = held.entry(keyframe.session).or_insert((0, stamp, stamp));
        *of_session = (of_session.0 + 1, of_session.1.min(stamp), of_session.2.max(stamp));
    }
    held
}

fn report(
    index: &MapIndex,
    session: SessionSeq,
    held: &Held,
    alignments: &mut Alignments<'_>,
) -> SessionReport {
    let held = held.get(&session);
    let priors = index.priors().frames().find(|(frame, _)| *frame == session);
    SessionReport {
        id: index.sessions()[session.index()].clone(),
        keyframes: held.map_or(0, |(keyframes, ..)| *keyframes),
        stamps: held.map(|(_, first, last)| (*first, *last)),
        priors: priors.map_or(0, |(_, anchors)| anchors.len()),
        alignment: alignments.session(session).and_then(|alignment| named(index, &alignment)),
    }
}

fn named(index: &MapIndex, alignment: &PlanAlignment) -> Option<AlignmentReport> {
    Some(AlignmentReport {
        frame: index.sessions().get(alignment.frame.index())?.clone(),
        plan_from_session: alignment.plan_from_session,
        inliers: alignment.inliers,
        position_sigma_m: alignment.position_sigma_m,
        yaw_sigma_rad: alignment.yaw_sigma_rad,
    })
}

/// Returns the number of a session that robots drive or drove.
fn driven(index: &MapIndex, id: &SessionId) -> Result<SessionSeq> {
    let session = find_session(index, id)?;
    if index.priors().is_frame(session) {
        let detail = "this session is the frame of a plan, and no robot drives it";
        return Err(FieldError::new("{session}", detail).got(id).into());
    }
    Ok(session)
}
