//! "Is this keyframe a loop?"

use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use sha2::{Digest as _, Sha256};
use tokio::time::{Instant, timeout_at};

use super::named::find;
use crate::domain::bow::BowVector;
use crate::domain::ids::{KeyframeId, MapId};
use crate::domain::request::{LoopQuery, Subject};
use crate::domain::roles::Roles;
use crate::domain::verdict::{ReasonCode, Verdict};
use crate::engine::error::refuse;
use crate::engine::limits::shared_turns::Tenant;
use crate::engine::maps::live::LiveMap;
use crate::engine::tasks::blocking_part;
use crate::engine::vocabulary::{check_global_descriptor, check_vocabulary};
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::anchors::ingest::unknown_covisible;
use crate::recognition::loops::check_loop::{screen, verify_and_decide};
use crate::recognition::loops::query::Query;
use crate::recognition::loops::screening::Screening;
use crate::recognition::map::index::MapIndex;
use crate::store::MapKey;

/// A verdict and its name.
#[derive(Clone, Debug, PartialEq)]
pub struct QueryAnswer {
    /// Derived from the map's version and the query, so that the same question has the same name.
    pub id: String,
    /// The keyframe that was asked about, unless it was inline.
    pub keyframe: Option<KeyframeId>,
    /// The answer.
    pub verdict: Verdict,
    /// The answer as clients receive it, which is what is recorded.
    pub body: Bytes,
    /// What it took. Not a part of the answer's body, which the same question gives again to the byte.
    pub timings: Timings,
}

/// Milliseconds that a query waited, and that its steps took: what is slow under load is told from what is busy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timings {
    /// Waiting for other requests: for a permit, a thread, the map's lock, or a write that was read before it was on disk.
    pub queue_ms: f64,
    /// Checks 1 to 3.
    pub screen_ms: f64,
    /// Reading the bag of words and the features, from disk or cache.
    pub features_ms: f64,
    /// Geometric verification and the conclusion.
    pub geometry_ms: f64,
}

impl Timings {
    /// Notes a step that began at `started` and worked for `work_ms` of the time since; the rest was spent waiting.
    pub(super) fn note(&mut self, started: Instant, work_ms: f64, step: fn(&mut Self) -> &mut f64) {
        *step(self) += work_ms;
        self.queue_ms += (milliseconds_since(started) - work_ms).max(0.0);
    }
}

/// Returns a result with the milliseconds that it took.
pub(super) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let started = Instant::now();
    let result = work();
    (result, milliseconds_since(started))
}

impl Service {
    /// Answers a loop query. Changes nothing, and calls no model.
    pub(in crate::engine) async fn answer(
        &self,
        live: &Arc<LiveMap>,
        mut query: LoopQuery,
    ) -> Result<QueryAnswer> {
        if let Subject::Inline(keyframe, _) = &mut query.subject {
            **keyframe = self.compute_bow((**keyframe).clone()).await?;
        }
        let query = Arc::new(query);
        let deadline = Instant::now() + Duration::from_millis(query.max_wait_ms);
        loop {
            let answer = self.check(live, &query).await?;
            // Only a write can bring what is missing; each is worth another look.
            let version = answer.verdict.map_version;
            let waits =
                !live.is_release() && waits_for_descriptions(&answer.verdict) && !self.pressure.is_high();
            if !waits || Instant::now() >= deadline {
                return Ok(answer);
            }
            if timeout_at(deadline, live.next_version(version)).await.is_err() {
                return Ok(answer);
            }
        }
    }

    /// Returns the configuration that this server's verdicts depend on.
    pub(in crate::engine) fn configured(&self) -> Configured<'_> {
        Configured {
            roles: self.models.as_ref().map_or_else(Roles::default, |models| models.roles()),
            vocabulary: self.vocabulary().map(|(fingerprint, _)| fingerprint),
        }
    }

    async fn check(&self, live: &Arc<LiveMap>, query: &Arc<LoopQuery>) -> Result<QueryAnswer> {
        let mut timings = Timings::default();
        let started = Instant::now();
        let bow = self.bow_of(live, &query.subject).await?;
        timings.features_ms = milliseconds_since(started);

        let started = Instant::now();
        let asked = query.clone();
        let configured = self.configured();
        let roles = configured.roles;
        let screened = self.read(live, move |state| {
            let (screening, took_ms) =
                timed(|| screen_subject(&state.index, state.version, &asked, &bow, roles));
            Ok((screening?, took_ms))
        });
        let (version, (screening, took_ms)) = screened.await?;
        timings.note(started, took_ms, |timings| &mut timings.screen_ms);

        let started = Instant::now();
        let wanted = screening.wanted_features();
        let mut features = self.features.read(&self.store, live.key, wanted).await?;
        if let Subject::Inline(keyframe, _) = &query.subject
            && let Some(own) = keyframe.features.clone()
        {
            features.inline = self.features.prepare(own).await?;
        }
        timings.features_ms += milliseconds_since(started);

        let started = Instant::now();
        let (verdict, took_ms) = if screening.waiting().next().is_none() {
            timed(|| verify_and_decide(screening, &features, query.seed))
        } else {
            let seed = query.seed;
            self.verify(Some(live.key), move || timed(|| verify_and_decide(screening, &features, seed)))
                .await?
        };
        timings.note(started, took_ms, |timings| &mut timings.geometry_ms);
        let keyframe = match &query.subject {
            Subject::Stored(id) => Some(id.clone()),
            Subject::Inline(..) => None,
        };
        let id = name(&live.id, version, query, configured);
        let body = (self.write_answer)(&id, keyframe.as_ref(), &verdict);
        let body = body.map_err(|error| ServiceError::Internal(error.to_string()))?.into();
        Ok(QueryAnswer { id, keyframe, verdict, body, timings })
    }

    /// Runs geometry, which keeps a core busy: it waits its turn, off the async threads and without the map's lock.
    pub(super) async fn verify<T: Send + 'static>(
        &self,
        map: Option<MapKey>,
        verify: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T> {
        let _turn = self.reads.enter(Tenant::current(map)).await?;
        blocking_part("verify", verify).await
    }

    /// Returns the bag of words of a stored keyframe; it lies on disk only.
    async fn bow_of(&self, live: &Arc<LiveMap>, subject: &Subject) -> Result<BowVector> {
        let Subject::Stored(id) = subject else { return Ok(BowVector::default()) };
        let name = id.clone();
        let (_, seq) = self.glance(live, move |state| find(&state.index, &name)).await?;
        self.store.bow(live.key, seq).await?.ok_or_else(|| ServiceError::no_keyframe(id))
    }
}

/// Returns the milliseconds since a moment, for `server-timing`.
pub(super) fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

fn screen_subject(
    index: &MapIndex,
    version: u64,
    query: &LoopQuery,
    bow: &BowVector,
    roles: Roles,
) -> Result<Screening> {
    let subject = match &query.subject {
        Subject::Stored(keyframe) => {
            let seq = find(index, keyframe)?;
            Query::stored(index, seq, bow).ok_or_else(|| ServiceError::no_keyframe(keyframe))?
        }
        Subject::Inline(keyframe, _) => {
            let declared = keyframe.declared().iter().enumerate().map(|(place, (id, _))| (place, id));
            refuse(unknown_covisible(index, declared).into_iter().map(within_inline).collect())?;
            check_vocabulary(index, keyframe)?;
            check_global_descriptor(index, keyframe.global_descriptor.as_ref())?;
            Query::inline(index, keyframe)
        }
    };
    Ok(screen(index, version, &subject.with_roles(roles).asked(query.again), query.verify))
}

fn waits_for_descriptions(verdict: &Verdict) -> bool {
    verdict.candidates.iter().any(|candidate| {
        candidate.reason.as_ref().is_some_and(|reason| reason.code == ReasonCode::LlmPending)
    })
}

fn within_inline(mut error: crate::domain::invalid::FieldError) -> crate::domain::invalid::FieldError {
    error.pointer = format!("/inline{}", error.pointer);
    error
}

/// All of a server's configuration that a verdict depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) struct Configured<'a> {
    /// Whether descriptions may still come.
    pub roles: Roles,
    /// The fingerprint of the vocabulary: it computes the words of an inline keyframe that brings none, and groups the
    /// features that geometry matches.
    pub vocabulary: Option<&'a str>,
}

/// Returns the id of an answer: the same for the same question of the same version, answered by servers of one
/// configuration.
fn name(map: &MapId, version: u64, query: &LoopQuery, configured: Configured<'_>) -> String {
    let mut hash = Sha256::new();
    hash.update(format!("{map}\n{version}\n{}\n{}\n", query.verify.as_str(), query.seed));
    let Configured { roles, vocabulary } = configured;
    let vocabulary = vocabulary.unwrap_or_default();
    hash.update(format!("vision {} text {} vocabulary {vocabulary}\n", roles.vision, roles.text));
    if query.again {
        hash.update("again\n");
    }
    match &query.subject {
        Subject::Stored(id) => hash.update(format!("stored\n{id}")),
        Subject::Inline(_, digest) => {
            hash.update("inline\n");
            hash.update(digest);
        }
    }
    hash.finalize().iter().take(8).fold(String::from("q-"), |mut name, byte| {
        let _ = write!(name, "{byte:02x}");
        name
    })
}
