//! A copy of a map that another server owns takes over what that one wrote.

use std::sync::atomic::Ordering;

use super::live::LiveMap;
use crate::domain::change::Change;
use crate::engine::error::Result;

impl LiveMap {
    /// Takes over the changes of the next versions, in their order. They are on disk. Blocks: not for async threads.
    pub fn take_over(&self, versions: &[(u64, Vec<Change>)]) -> Result<()> {
        let mut state = self.state.write().map_err(|_| self.broke())?;
        self.exists()?;
        for (version, changes) in versions {
            // The same may be under way twice: what a client waited for goes on when that has gone.
            if *version <= state.version {
                continue;
            }
            if *version != state.version + 1 {
                return Err(self.broke());
            }
            state.index.apply(changes);
            state.version = *version;
        }
        let version = state.version;
        self.memory.set(state.index.memory_bytes());
        drop(state);
        self.newest.store(version, Ordering::Release);
        self.on_disk.send_modify(|on_disk| *on_disk = version.max(*on_disk));
        Ok(())
    }
}
