//! Sessions of a map: what each holds, and its alignment to a plan.

use std::collections::BTreeMap;

use crate::domain::ids::{MapId, SessionId, SessionSeq};
use crate::domain::keyframe::Stamp;
use crate::domain::report::{AlignmentReport, Page, SessionReport};
use crate::domain::request::PageRequest;
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::map::index::MapIndex;
use crate::recognition::plans::alignments::Alignments;
use crate::recognition::plans::plan_alignment::PlanAlignment;

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
