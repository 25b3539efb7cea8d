//! Loops that clients closed: confirm, list, revoke.

use super::named::find;
use crate::domain::change::Loop;
use crate::domain::ids::{KeyframeId, LoopId, MapId};
use crate::domain::invalid::FieldError;
use crate::domain::loop_warning::LoopWarning;
use crate::domain::report::{LoopReport, Page};
use crate::domain::request::{NewLoop, PageRequest};
use crate::engine::error::parsed;
use crate::engine::limits::quota::check_bytes;
use crate::engine::maps::live::Decision;
use crate::engine::maps::write_path::Manner;
use crate::engine::{Result, Service, ServiceError, Stored};
use crate::geometry::Sim3;
use crate::recognition::anchors::loop_closure::{close_loop, revoke_loop};
use crate::recognition::map::index::MapIndex;

/// A scale this near 1 is one that was computed to be 1.
const SCALE_TOLERANCE: f64 = 1e-6;

impl Service {
    /// Confirms a loop: matched anchors merge, and the two keyframes are covisible from now on. The transformation is the client's, else
    /// that of the query that found it, if it is known.
    pub async fn confirm_loop(
        &self,
        map: &MapId,
        new: NewLoop,
        candidate_from_query: Option<Sim3>,
    ) -> Result<(u64, Stored<ConfirmedLoop>)> {
        let live = self.live(map).await?;
        let room = self.room(live.owner).await?;
        let decide = move |index: &mut MapIndex| {
            if let Some(known) = index.loops().get(&new.id) {
                return again(index, known, &new);
            }
            let scale = new.candidate_from_query.as_ref().map_or(1.0, Sim3::scale);
            if index.properties().metric && (scale - 1.0).abs() > SCALE_TOLERANCE {
                let fault = FieldError::new("/candidate_from_query/scale", "the map is metric").got(scale);
                return Err(fault.limit("1").into());
            }
            let candidate_from_query = new.candidate_from_query.or(candidate_from_query);
            let closed = Loop { candidate_from_query, ..resolve(index, new)? };
            // The one that reaches the quota may still merge what it matches.
            check_bytes(&room, index, closed.bytes())?;
            let (warning, decided) = close_loop(index, closed.clone());
            Ok(Decision::Changed((true, confirmed(index, &closed, warning)), decided, None))
        };
        let ((created, value), version) = self.change(&live, decide).await?;
        if created {
            self.frame_behind(&live);
        }
        Ok((version, Stored { created, value }))
    }

    /// Returns the loops by name.
    pub async fn list_loops(&self, map: &MapId, page: PageRequest) -> Result<(u64, Page<LoopReport>)> {
        let live = self.live(map).await?;
        let after: Option<LoopId> = parsed(&page)?;
        self.read(&live, move |state| {
            let is_after = |closed: &&Loop| after.as_ref().is_none_or(|after| closed.id > *after);
            let rest = state.index.loops().values().filter(is_after).take(page.limit + 1);
            let items = rest.map(|closed| report(&state.index, closed)).collect();
            Ok(Page::of(items, page.limit, |report| report.id.to_string()))
        })
        .await
    }

    /// Takes a loop back: what it merged parts again.
    pub async fn revoke_loop(&self, map: &MapId, id: &LoopId) -> Result<(u64, LoopReport)> {
        let live = self.live(map).await?;
        let id = id.clone();
        let decide = move |index: &mut MapIndex| {
            let none = || ServiceError::NotFound(format!("there is no loop {id} in this map"));
            let mut known = report(index, index.loops().get(&id).ok_or_else(none)?);
            let (parted, decided) = revoke_loop(index, &id);
            known.merged = parted;
            Ok(Decision::Changed(known, decided, None))
        };
        let (report, version) = self.begin(&live, Manner::Freeing, decide).await?.committed().await?;
        self.frame_behind(&live);
        Ok((version, report))
    }
}

/// A confirmed loop, and what speaks against it.
#[derive(Clone, Debug, PartialEq)]
pub struct ConfirmedLoop {
    /// The loop.
    pub report: LoopReport,
    /// What spoke against it when it was confirmed; none in the answer to a retry.
    pub warnings: Vec<LoopWarning>,
}

fn confirmed(index: &MapIndex, closed: &Loop, warning: Option<LoopWarning>) -> ConfirmedLoop {
    ConfirmedLoop { report: report(index, closed), warnings: warning.into_iter().collect() }
}

fn again(index: &MapIndex, known: &Loop, new: &NewLoop) -> Result<Decision<(bool, ConfirmedLoop)>> {
    let closed_alike =
        new.candidate_from_query.is_none() || new.candidate_from_query == known.candidate_from_query;
    let same = known.keyframe_id == new.keyframe
        && known.candidate_id == new.candidate
        && known.query == new.query
        && closed_alike;
    if same {
        // What spoke against it was judged without it. Now the two maps overlap, and would agree with themselves.
        return Ok(Decision::Unchanged((false, confirmed(index, known, None))));
    }
    let detail = format!("loop {} exists between {} and {}", new.id, known.keyframe_id, known.candidate_id);
    Err(ServiceError::Conflict { code: "loop_exists", detail })
}

fn resolve(index: &MapIndex, new: NewLoop) -> Result<Loop> {
    let mut errors = Vec::new();
    let mut seq = |pointer: &str, id: &KeyframeId| {
        find(index, id).map_err(|error| errors.push(FieldError::new(pointer, error.to_string()).got(id))).ok()
    };
    let (keyframe, candidate) = (seq("/keyframe", &new.keyframe), seq("/candidate", &new.candidate));
    if keyframe.is_some() && keyframe == candidate {
        errors.push(FieldError::new("/candidate", "a keyframe is no loop with itself").got(&new.candidate));
    }
    match (keyframe, candidate) {
        (Some(keyframe), Some(candidate)) if errors.is_empty() => Ok(Loop {
            id: new.id,
            keyframe,
            candidate,
            keyframe_id: new.keyframe,
            candidate_id: new.candidate,
            query: new.query,
            candidate_from_query: None,
        }),
        _ => Err(ServiceError::Invalid(errors)),
    }
}

fn report(index: &MapIndex, closed: &Loop) -> LoopReport {
    LoopReport {
        id: closed.id.clone(),
        keyframe: closed.keyframe_id.clone(),
        candidate: closed.candidate_id.clone(),
        query: closed.query.clone(),
        merged: index.objects().links_of_loop(&closed.id),
    }
}
