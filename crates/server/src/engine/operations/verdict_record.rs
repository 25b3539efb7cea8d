//! The record of verdicts: each answer is counted and kept, for reading back with every figure.

use std::sync::Arc;

use bytes::Bytes;

use super::named::find;
use crate::domain::event::EventKind;
use crate::domain::ids::{KeyframeId, MapId, ReleaseName, SessionId};
use crate::domain::reason::ReasonCode;
use crate::domain::report::Page;
use crate::domain::request::{LoopQuery, PageRequest, Subject};
use crate::domain::verdict::{Decision, Verify};
use crate::domain::verdict_line::{ListedVerdict, VerdictFilter, VerdictLine};
use crate::engine::error::parsed;
use crate::engine::keys::keyring::now;
use crate::engine::lock::lock;
use crate::engine::maps::live::{LiveMap, State};
use crate::engine::{QueryAnswer, Result, Service, ServiceError};
use crate::store::GivenAnswer;

impl Service {
    /// Answers a loop query, and records the answer. Changes nothing else, and calls no model.
    pub async fn loop_query(&self, map: &MapId, query: LoopQuery) -> Result<QueryAnswer> {
        let live = self.live_or_release(map, query.release.as_ref()).await?;
        let session = if live.is_release() { self.session_of(&live, &query.subject).await? } else { None };
        let answer = self.answer_and_record(&live, query).await?;
        if let Some(session) = session
            && !self.follows
        {
            live.count_use(&self.store, session, now());
        }
        Ok(answer)
    }

    /// Returns the session of the keyframe that is asked about.
    async fn session_of(&self, live: &Arc<LiveMap>, subject: &Subject) -> Result<Option<SessionId>> {
        let keyframe = match subject {
            Subject::Inline(keyframe, _) => return Ok(Some(keyframe.session.clone())),
            Subject::Stored(id) => id.clone(),
        };
        let look = move |state: &State| {
            let known = state.index.keyframe(find(&state.index, &keyframe)?);
            Ok(known.map(|known| state.index.sessions()[known.session.index()].clone()))
        };
        Ok(self.glance(live, look).await?.1)
    }

    async fn answer_and_record(&self, live: &Arc<LiveMap>, query: LoopQuery) -> Result<QueryAnswer> {
        let answer = self.answer(live, query).await?;
        *lock(&self.verdicts).entry(answer.verdict.decision).or_default() += 1;
        // Written behind, bounded, oldest out first.
        let line = VerdictLine::of(answer.keyframe.as_ref(), &answer.verdict);
        let given = GivenAnswer { id: answer.id.clone(), line, body: answer.body.clone() };
        if self.follows {
            self.hand_answer_on(live, given);
        } else {
            live.keep_query(&self.store, given);
        }
        Ok(answer)
    }

    /// Answers the loop query about a keyframe that has just arrived. The verdict is recorded; if it is a loop, or evidence speaks
    /// against one, listeners are notified of it.
    pub(in crate::engine) async fn query_and_announce(
        &self,
        map: &MapId,
        keyframe: KeyframeId,
    ) -> Result<QueryAnswer> {
        let live = self.live(map).await?;
        let answer = self.answer_and_record(&live, about(keyframe.clone())).await?;
        let stopped_by = answer.verdict.candidates.first().and_then(|candidate| candidate.reason.as_ref());
        let is_rejected = answer.verdict.decision == Decision::NoLoop
            && stopped_by.is_some_and(|reason| reason.code == ReasonCode::Contradiction);
        if answer.verdict.decision == Decision::Loop {
            self.announce(EventKind::LoopFound, &live, &answer);
        }
        // Of a drive past such places the first keyframe is told.
        let session = self.session_of(&live, &Subject::Stored(keyframe)).await?;
        if session.is_some_and(|session| live.notes_rejection(session, is_rejected)) {
            self.announce(EventKind::LoopRejected, &live, &answer);
        }
        Ok(answer)
    }

    /// Lists the verdicts of a map, or of a release of it, the newest first. Any server reads them; one that was given a moment ago
    /// by another server may be missing.
    pub async fn list_verdicts(
        &self,
        map: &MapId,
        release: Option<&ReleaseName>,
        filter: &VerdictFilter,
        page: PageRequest,
    ) -> Result<Page<ListedVerdict>> {
        let before = parsed(&page)?.unwrap_or(i64::MAX);
        let key = match release {
            Some(name) => self.live_release(map, name).await?.key,
            None => self.key_of(map).await?,
        };
        // Those that this server gave are written behind.
        self.store.committer().settled().await;
        let found = self.store.verdicts(key, filter, before, page.limit + 1).await?;
        let Page { items, next_cursor } = Page::of(found, page.limit, |(kept, _)| kept.to_string());
        Ok(Page { items: items.into_iter().map(|(_, listed)| listed).collect(), next_cursor })
    }

    /// Returns a recorded answer.
    pub async fn kept_query(&self, map: &MapId, id: &str) -> Result<Bytes> {
        // One that is on its way to the disk keeps its map in memory.
        let live = self.registry.in_memory_now(map);
        if let Some(body) = live.and_then(|live| live.query_under_way(id)) {
            return Ok(body);
        }
        let releases = self.registry.in_memory(|live| live.is_release() && live.id.parts().0 == map.as_str());
        if let Some(body) = releases.iter().find_map(|live| live.query_under_way(id)) {
            return Ok(body);
        }
        let key = self.key_of(map).await?;
        let found = match self.store.kept_query(key, id).await? {
            None => self.store.answer_on_its_way(key, id).await?,
            found => found,
        };
        found
            .map(Bytes::from)
            .ok_or_else(|| ServiceError::NotFound(format!("there is no loop query {id} in this map")))
    }
}

/// Returns the loop query about a stored keyframe.
pub(super) fn about(keyframe: KeyframeId) -> LoopQuery {
    LoopQuery {
        subject: Subject::Stored(keyframe),
        release: None,
        verify: Verify::default(),
        max_wait_ms: 0,
        seed: 0,
        again: false,
    }
}
