//! A map in memory: its index, and its line of writes to the store.
//!
//! A request decides and applies under the map's lock, and queues its changes there, so that the
//! store commits in the order of decisions; it is answered when they are on disk. Requests that arrive
//! together thus share one fsync. What a reader has seen may not be on disk yet, so no answer leaves
//! before the version it was made from is ([`LiveMap::on_disk`]).

use std::collections::{BTreeSet, HashMap};
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, RwLock, RwLockReadGuard};

use bytes::Bytes;
use tokio::sync::{OwnedSemaphorePermit, oneshot, watch};
use tokio::time::Instant;
use tracing::Instrument as _;

use super::feeds::Feed;
pub(in crate::engine) use super::live_state::State;
use super::live_state::number;
use super::map_memory::{MapMemory, MemoryShare};
use super::release_uses::ReleaseUses;
use super::standing::Standing;
use crate::config::traces;
use crate::domain::event::Event;
use crate::domain::ids::{MapId, SessionId};
use crate::domain::key::KeySeq;
use crate::engine::error::{Result, ServiceError};
use crate::engine::limits::shared_turns::Turn;
use crate::engine::lock::lock;
use crate::integrity::rebuild::RebuiltMap;
use crate::recognition::map::index::MapIndex;
use crate::recognition::map::recorder::Decided;
use crate::store::{Batch, GivenAnswer, Job, Lease, MapKey, NewKeyframeRows, PoisonFlag, Store, StoreError};

/// Maximum answers of a map's loop queries that wait for the disk; further ones are not kept.
const KEPT_UNDER_WAY_MAX: usize = 256;

/// Reason why a database server that does not know what was written is not believed.
const BEHIND: &str = "the one that answers is behind the one that was written to";

/// The state of a map's frames as they are kept.
#[derive(Debug, Default)]
pub(in crate::engine) struct FramesChecked {
    /// The version at which they were last found to be those of the map; 0 if they never were.
    pub version: u64,
    /// When they may be computed in the background again.
    pub rested: Option<Instant>,
}

/// A map that is in memory.
#[derive(Debug)]
pub(in crate::engine) struct LiveMap {
    pub id: MapId,
    pub key: MapKey,
    /// The key that made it, which pays for its models.
    pub owner: Option<KeySeq>,
    pub(super) state: RwLock<State>,
    pub standing: Standing,
    /// Held by the one who waits for the lock of `state` to decide a write.
    pub lane: tokio::sync::Mutex<()>,
    pub(super) line: PoisonFlag,
    /// Whether the map is deleted. Set under the lock of `state`.
    pub(super) gone: AtomicBool,
    /// The version of `state`.
    pub(super) newest: AtomicU64,
    /// Held while the frames are read, computed and kept, so that older ones never replace newer ones.
    pub frames_checked: tokio::sync::Mutex<FramesChecked>,
    /// Whether somebody is to bring the frames up to date in the background, and has not begun.
    pub frames_due: AtomicBool,
    pub(super) on_disk: watch::Sender<u64>,
    feed: Arc<Feed>,
    /// What it takes of the memory for maps.
    pub memory: MemoryShare,
    /// When a client used it last, counted in uses of maps.
    pub last_use: AtomicU64,
    /// Answers of loop queries that are still on their way to the disk.
    kept: Mutex<HashMap<String, Bytes>>,
    next_kept: AtomicI64,
    /// Sessions whose newest keyframe looked like a place that evidence speaks against.
    rejecting: Mutex<BTreeSet<SessionId>>,
    /// As they were when somebody looked last.
    figures: Mutex<Figures>,
    /// Held while a release of it is published: one at a time.
    pub publishing: tokio::sync::Mutex<()>,
    /// The robots that asked it, if it holds a release.
    pub(super) uses: ReleaseUses,
}

/// How large a map is in memory.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::engine) struct Figures {
    pub keyframes: u64,
    pub anchors: u64,
    pub postings: u64,
    pub index_bytes: u64,
}

/// What a request decided.
pub(in crate::engine) enum Decision<T> {
    /// The index was changed.
    Changed(T, Decided, Option<NewKeyframeRows>),
    /// There was nothing to do.
    Unchanged(T),
}

impl<T> Decision<T> {
    /// Returns the decision with this value, if there was something to do.
    pub fn of(value: T, decided: Option<Decided>) -> Self {
        match decided {
            Some(decided) => Self::Changed(value, decided, None),
            None => Self::Unchanged(value),
        }
    }
}

/// When a decision goes to the disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum Urgency {
    /// With the next commit.
    Prompt,
    /// More may follow: it waits for them a moment, and shares a sync with them.
    Held,
}

/// A write that is decided and on its way to the disk.
pub(in crate::engine) struct Begun<T> {
    store: Store,
    live: Arc<LiveMap>,
    value: T,
    version: u64,
    committed: Option<oneshot::Receiver<Result<(), StoreError>>>,
}

impl LiveMap {
    /// Returns a map that was loaded.
    pub fn new(
        id: MapId,
        loaded: RebuiltMap,
        standing: Standing,
        feed: Arc<Feed>,
        memory: &Arc<MapMemory>,
    ) -> Arc<Self> {
        let RebuiltMap { facts, index } = loaded;
        Arc::new(Self {
            id,
            key: facts.key,
            owner: facts.owner,
            standing,
            lane: tokio::sync::Mutex::default(),
            line: Arc::new(AtomicBool::new(false)),
            gone: AtomicBool::new(false),
            newest: AtomicU64::new(facts.version),
            frames_checked: tokio::sync::Mutex::default(),
            frames_due: AtomicBool::new(false),
            on_disk: watch::Sender::new(facts.version),
            feed,
            memory: memory.share(index.memory_bytes()),
            last_use: AtomicU64::new(0),
            kept: Mutex::default(),
            rejecting: Mutex::default(),
            next_kept: AtomicI64::new(facts.next_kept),
            figures: Mutex::default(),
            publishing: tokio::sync::Mutex::default(),
            uses: ReleaseUses::default(),
            state: RwLock::new(State { index, version: facts.version, next_event: facts.next_event }),
        })
    }

    /// Whether it holds a release of another map, and stays as it is.
    pub fn is_release(&self) -> bool {
        self.id.parts().1.is_some()
    }

    /// Whether a write has failed. Then what is in memory is ahead of the disk, and must be loaded anew. Or another server has it.
    pub fn is_poisoned(&self) -> bool {
        self.line.load(Ordering::Acquire) || self.lease().is_some_and(Lease::is_lost)
    }

    /// Returns the lease by which this server has it, where others could.
    pub fn lease(&self) -> Option<&Lease> {
        self.standing.lease()
    }

    /// Whether it decides nothing any more, because a write failed or it was deleted.
    pub fn is_over(&self) -> bool {
        self.is_poisoned() || self.gone.load(Ordering::Acquire)
    }

    /// Returns the map as it stands; its version may not be on disk yet. A panic under the lock (a bug) leaves an index
    /// nobody can vouch for: the map is then loaded anew from its facts.
    pub fn state(&self) -> Result<RwLockReadGuard<'_, State>> {
        let state = self.state.read().map_err(|_| self.broke())?;
        self.exists()?;
        Ok(state)
    }

    /// Looks at the map as it stands, with its version, unless somebody writes to it. For a look that takes no time.
    pub fn glance<T>(&self, look: impl FnOnce(&State) -> T) -> Option<(u64, T)> {
        let state = self.state.try_read().ok()?;
        self.exists().ok()?;
        Some((state.version, look(&state)))
    }

    pub(super) fn exists(&self) -> Result<()> {
        if self.gone.load(Ordering::Acquire) { Err(ServiceError::no_map(&self.id)) } else { Ok(()) }
    }

    pub(super) fn broke(&self) -> ServiceError {
        self.line.store(true, Ordering::Release);
        StoreError::Superseded.into()
    }

    /// Decides under the lock, and queues what was decided, with the permit to write: it counts among the writes under
    /// way until the disk has it, also when nobody waits for that. Blocks: not for async threads. `core` is its turn to compute.
    pub fn decide<T>(
        self: &Arc<Self>,
        store: Store,
        permit: OwnedSemaphorePermit,
        core: Turn,
        urgency: Urgency,
        decide: impl FnOnce(&mut MapIndex) -> Result<Decision<T>>,
    ) -> Result<Begun<T>> {
        let (mut state, _core) = if let Ok(state) = self.state.try_write() {
            (state, Some(core))
        } else {
            // Whoever waits for readers of one map keeps no core from the writes of others.
            drop(core);
            (self.state.write().map_err(|_| self.broke())?, None)
        };
        self.exists()?;
        if self.is_poisoned() {
            return Err(StoreError::Superseded.into());
        }
        let (value, change) = match decide(&mut state.index)? {
            Decision::Changed(value, decided, rows) => (value, Some((decided, rows))),
            Decision::Unchanged(value) => (value, None),
        };
        let committed = change.map(|(decided, rows)| {
            let batch = self.next_batch(&mut state, decided, rows);
            let (version, event) = (batch.version, batch.next_event - 1);
            self.submit(&store, Job::Change(Box::new(batch)), urgency, version, event, Some(permit))
        });
        Ok(Begun { store, live: self.clone(), value, version: state.version, committed })
    }

    /// Numbers what was decided, and returns it for the store.
    fn next_batch(
        &self,
        state: &mut State,
        decided: Decided,
        new_keyframe: Option<NewKeyframeRows>,
    ) -> Batch {
        state.version += 1;
        let version = state.version;
        self.newest.store(version, Ordering::Release);
        let events = number(state, decided.events);
        let memory_bytes = state.index.memory_bytes();
        self.memory.set(memory_bytes);
        Batch {
            map: self.key,
            version,
            next_keyframe: state.index.next_keyframe(),
            next_anchor: state.index.next_anchor(),
            next_event: state.next_event,
            figures: state.index.figures(),
            learned: state.index.learned(),
            memory_bytes,
            changes: decided.changes,
            former: decided.former,
            new_keyframe,
            events,
            is_followed: self.lease().is_some_and(Lease::is_followed),
        }
    }

    /// Returns how large it is; as it was before, while a request holds the lock.
    pub fn figures(&self) -> Figures {
        let mut figures = lock(&self.figures);
        if let Ok(state) = self.state.try_read() {
            *figures = Figures {
                keyframes: state.index.keyframe_count() as u64,
                anchors: state.index.objects().len() as u64,
                postings: state.index.inverted_file().posting_count() as u64,
                index_bytes: state.index.inverted_file().heap_bytes() as u64,
            };
        }
        *figures
    }

    /// Queues a job; when it is on disk, so is this version, with its events.
    pub fn submit(
        self: &Arc<Self>,
        store: &Store,
        job: Job,
        urgency: Urgency,
        version: u64,
        event: u64,
        permit: Option<OwnedSemaphorePermit>,
    ) -> oneshot::Receiver<Result<(), StoreError>> {
        let (committed, heard) = oneshot::channel();
        let live = self.clone();
        let done = move |result: Result<(), StoreError>| {
            if result.is_ok() {
                live.on_disk.send_modify(|on_disk| *on_disk = version.max(*on_disk));
                live.feed.reached(event);
            } else {
                // Wakes those who wait for a version that will never be.
                live.on_disk.send_modify(|_| {});
            }
            drop(permit);
            let _ = committed.send(result);
        };
        match urgency {
            Urgency::Prompt => store.committer().submit(job, &self.line, done),
            Urgency::Held => store.committer().submit_held(job, &self.line, done),
        }
        heard
    }

    /// Waits until a version is on disk.
    pub async fn on_disk(&self, store: &Store, version: u64) -> Result<()> {
        if *self.on_disk.borrow() < version {
            store.committer().commit_held();
        }
        let mut on_disk = self.on_disk.subscribe();
        let reached = on_disk.wait_for(|on_disk| *on_disk >= version || self.is_poisoned()).await;
        match reached {
            Ok(on_disk) if *on_disk >= version => self.is_still_ours(),
            _ => Err(StoreError::Superseded.into()),
        }
    }

    /// Fails if another server may have written to the map since it was read.
    fn is_still_ours(&self) -> Result<()> {
        match self.lease() {
            Some(lease) if !lease.is_valid() => Err(StoreError::Fenced.into()),
            _ => Ok(()),
        }
    }

    /// Returns the newest version that is known to be on disk.
    pub fn version_on_disk(&self) -> u64 {
        *self.on_disk.borrow()
    }

    /// Fails if a database server told an older version than what was on disk before it was asked, as one does that was the primary
    /// before a fail-over; or if another of our servers may have the map by now.
    pub fn expect_up_to_date(&self, on_disk: u64, told: u64) -> Result<()> {
        if told < on_disk {
            return Err(StoreError::Away(BEHIND.to_owned()).into());
        }
        self.is_still_ours()
    }

    /// Returns the newest version decided, which may not be on disk yet; read without the map's lock.
    pub fn newest_version(&self) -> u64 {
        self.newest.load(Ordering::Acquire)
    }

    /// Waits until the version on disk is another one.
    pub async fn next_version(&self, after: u64) {
        let _ = self.on_disk.subscribe().wait_for(|on_disk| *on_disk > after || self.is_poisoned()).await;
    }

    /// Tells events that belong to no change, written behind.
    pub fn tell(self: &Arc<Self>, store: &Store, events: Vec<Event>) {
        let Ok(mut state) = self.state.write() else { return };
        if self.is_over() {
            return;
        }
        let events = number(&mut state, events);
        let (version, next_event) = (state.version, state.next_event);
        let job = Job::AppendEvents(self.key, next_event, events);
        drop(self.submit(store, job, Urgency::Prompt, version, next_event - 1, None));
    }

    /// Keeps the answer of a loop query, written behind.
    pub fn keep_query(self: &Arc<Self>, store: &Store, given: GivenAnswer) {
        if store.committer().refuses(false).is_some() {
            return;
        }
        let GivenAnswer { id, line, body } = given;
        {
            let mut under_way = lock(&self.kept);
            // An id stands for its answer, to the byte: one on its way to the disk need not go twice.
            if under_way.len() >= KEPT_UNDER_WAY_MAX || under_way.contains_key(&id) {
                return;
            }
            under_way.insert(id.clone(), body.clone());
        }
        let kept = self.next_kept.fetch_add(1, Ordering::Relaxed);
        let job = Job::KeepQuery { map: self.key, id: id.clone(), kept, line, body };
        let live = self.clone();
        // Nobody waits for it: it shares the sync of what comes next.
        store.committer().submit_held(job, &self.line, move |_| drop(lock(&live.kept).remove(&id)));
    }

    /// Notes whether the newest keyframe of a session is rejected; whether it is the first of a row of these.
    pub fn notes_rejection(&self, session: SessionId, is_rejected: bool) -> bool {
        let mut rejecting = lock(&self.rejecting);
        if is_rejected {
            return rejecting.insert(session);
        }
        rejecting.remove(&session);
        false
    }

    /// Returns the answer of a loop query that is still on its way to the disk.
    pub fn query_under_way(&self, id: &str) -> Option<Bytes> {
        lock(&self.kept).get(id).cloned()
    }
}

impl<T, U> Begun<(T, U)> {
    /// Returns the write with a part of its value, and the other part.
    pub fn split(self) -> (Begun<T>, U) {
        let Self { store, live, value: (value, other), version, committed } = self;
        (Begun { store, live, value, version, committed }, other)
    }
}

impl<T> Begun<T> {
    /// Waits until it is on disk.
    pub async fn committed(self) -> Result<(T, u64)> {
        let part = traces::part("commit");
        match self.committed {
            Some(committed) => committed.instrument(part).await.map_err(|_| StoreError::Closed)??,
            None => self.live.on_disk(&self.store, self.version).instrument(part).await?,
        }
        Ok((self.value, self.version))
    }
}
