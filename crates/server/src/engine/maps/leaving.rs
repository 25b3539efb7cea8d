//! Leaving: a map leaves memory, or ends; nobody decides or reads any more.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use tokio::runtime::Handle;
use tokio::sync::oneshot;

use super::live::{LiveMap, Urgency};
use super::live_state::free;
use crate::engine::error::Result;
use crate::store::{Job, Store, StoreError};

impl LiveMap {
    /// Lets nobody decide or read any more, after all that is decided is on disk. Blocks: not for async threads.
    pub fn leave_memory(&self, store: &Store, runtime: &Handle) -> Result<()> {
        let _state = self.state.write().map_err(|_| self.broke())?;
        self.exists()?;
        runtime.block_on(store.committer().settled());
        self.line.store(true, Ordering::Release);
        Ok(())
    }

    /// Has the next request load the map anew. Nothing may be decided and not on disk.
    pub fn throw_away(&self) {
        self.line.store(true, Ordering::Release);
    }

    /// Changes rows beside the index, after all that is decided is on disk. Nobody decides or reads meanwhile, and the next request
    /// loads the map anew. Blocks: not for async threads.
    pub fn change_rows(&self, store: &Store, runtime: &Handle, job: Job) -> Result<()> {
        let _state = self.state.write().map_err(|_| self.broke())?;
        self.exists()?;
        let changed = runtime.block_on(async {
            store.committer().settled().await;
            if self.is_poisoned() { Err(StoreError::Superseded) } else { store.committer().commit(job).await }
        });
        self.line.store(true, Ordering::Release);
        Ok(changed?)
    }

    /// Nobody reads or writes the map from here on; queues its deletion.
    pub fn delete(self: &Arc<Self>, store: &Store) -> Result<oneshot::Receiver<Result<(), StoreError>>> {
        let mut state = self.state.write().map_err(|_| self.broke())?;
        self.exists()?;
        self.gone.store(true, Ordering::Release);
        free(std::mem::take(&mut state.index));
        self.memory.set(state.index.memory_bytes());
        let job = Job::DeleteMap(self.key);
        Ok(self.submit(store, job, Urgency::Prompt, state.version, state.next_event, None))
    }
}
