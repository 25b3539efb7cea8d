//! How a request gets its turn on a map: to decide a write, or to read.

use std::sync::Arc;

use super::live::{Begun, Decision, LiveMap, State, Urgency};
use super::loads::Used;
use crate::engine::limits::concurrency_limit::Wait;
use crate::engine::limits::shared_turns::Tenant;
use crate::engine::tasks::blocking_part;
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::map::index::MapIndex;

/// How often a read looks again because a write that it had seen failed.
const READ_AGAIN_MAX: usize = 3;

/// How a write gets its turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum Manner {
    /// It is refused if it would wait for too long.
    Prompt,
    /// It waits however long it takes.
    Patient,
    /// As [`Self::Prompt`], and it frees space: it goes on when the disk is full.
    Freeing,
    /// It waits however long it takes, goes on when the disk is full, and releases are written to, too: what is erased stays in
    /// none.
    Erasing,
}

impl Service {
    /// Decides a write off the async threads and queues it. If the client goes away, the decision is
    /// committed all the same.
    pub(in crate::engine) async fn begin<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        manner: Manner,
        decide: impl FnOnce(&mut MapIndex) -> Result<Decision<T>> + Send + 'static,
    ) -> Result<Begun<T>> {
        if self.follows {
            return Err(ServiceError::Internal(format!("{} is a copy, to which nobody writes", live.id)));
        }
        if live.is_release() && manner != Manner::Erasing {
            return Err(ServiceError::Internal(format!("{} is a release, to which nobody writes", live.id)));
        }
        self.disk_takes(matches!(manner, Manner::Freeing | Manner::Erasing)).await?;
        let wait = match manner {
            Manner::Prompt | Manner::Freeing => Wait::BOUNDED,
            Manner::Patient | Manner::Erasing => Wait::UNBOUNDED,
        };
        let permit = self.writes.enter(wait).await?;
        // One at a time takes a thread to wait for the map's lock; the others wait here, where waiting costs nothing.
        let anew;
        let lane = wait.until(live.lane.lock()).await?;
        let (live, _lane) = if live.is_poisoned() {
            // It was thrown away meanwhile, as an erasure does it, and nothing is decided yet.
            drop(lane);
            anew = self.anew(live).await?;
            (&anew, wait.until(anew.lane.lock()).await?)
        } else {
            (live, lane)
        };
        let core = self.deciding.enter_after(Tenant::current(Some(live.key)), wait).await?;
        let (deciding, store) = (live.clone(), self.store.clone());
        // A client of many writes has more, and waits for none of them alone.
        let urgency = if manner == Manner::Patient { Urgency::Held } else { Urgency::Prompt };
        let decide = move || deciding.decide(store, permit, core, urgency, decide);
        let begun = blocking_part("decide", decide).await??;
        self.registry.keep_to_budget();
        // Whatever was written, an anchor may lack something now.
        if self.models.is_some() {
            self.worker.note_write(live);
        }
        Ok(begun)
    }

    /// Returns a map that was thrown away as it is on disk.
    async fn anew(&self, live: &LiveMap) -> Result<Arc<LiveMap>> {
        self.should_have(&live.id, false).await?;
        let anew = self.registry.get(&self.store, &live.id, Used::ByClient).await?;
        if anew.key == live.key { Ok(anew) } else { Err(ServiceError::no_map(&live.id)) }
    }

    /// Has what waits for more of its request committed now: somebody waits for it.
    pub fn commit_held(&self) {
        self.store.committer().commit_held();
    }

    /// Refuses a write that the disk would not take, before the index is ahead of the disk.
    pub(in crate::engine) async fn disk_takes(&self, freeing: bool) -> Result<()> {
        self.store.committer().refuses_now(freeing).await.map_or(Ok(()), |error| Err(error.into()))
    }

    /// Decides a write and waits until it is on disk.
    pub(in crate::engine) async fn change<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        decide: impl FnOnce(&mut MapIndex) -> Result<Decision<T>> + Send + 'static,
    ) -> Result<(T, u64)> {
        self.begin(live, Manner::Prompt, decide).await?.committed().await
    }

    /// Reads the index off the async threads, and waits until what was read is on disk. If it never will be, because the
    /// write failed, the map as it is on disk is read instead: reads go on when writes do not.
    pub(in crate::engine) async fn read<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        read: impl Fn(&State) -> Result<T> + Send + Sync + 'static,
    ) -> Result<(u64, T)> {
        let (read, mut live) = (Arc::new(read), live.clone());
        let mut again = READ_AGAIN_MAX;
        loop {
            let looking = read.clone();
            let on_disk = self.look(&live, move |state| looking(state)).await;
            if on_disk.is_ok() || !live.is_poisoned() || again == 0 {
                return on_disk;
            }
            again -= 1;
            let anew = self.live(&live.id).await?;
            if anew.key != live.key {
                // Another map of this name: the question was about the one that is gone.
                return on_disk;
            }
            live = anew;
        }
    }

    /// [`Self::read`] for a look that takes no time: on the spot, unless somebody writes to the map.
    pub(in crate::engine) async fn glance<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        look: impl Fn(&State) -> Result<T> + Send + Sync + 'static,
    ) -> Result<(u64, T)> {
        if let Some((version, Ok(value))) = live.glance(&look)
            && live.on_disk(&self.store, version).await.is_ok()
        {
            return Ok((version, value));
        }
        self.read(live, look).await
    }

    /// [`Self::read`] for those who look again by themselves.
    pub(in crate::engine) async fn look<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        look: impl FnOnce(&State) -> Result<T> + Send + 'static,
    ) -> Result<(u64, T)> {
        let turn = self.reads.enter(Tenant::current(Some(live.key))).await?;
        let looking = live.clone();
        let (version, value) = blocking_part("read", move || {
            let state = looking.state()?;
            Ok::<_, ServiceError>((state.version, look(&state)?))
        })
        .await??;
        // Waiting for the disk takes no core.
        drop(turn);
        live.on_disk(&self.store, version).await?;
        Ok((version, value))
    }
}
