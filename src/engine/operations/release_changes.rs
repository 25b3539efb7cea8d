//! Changes between two releases, or since one.

use std::sync::Arc;

use crate::domain::ids::{MapId, ReleaseName};
use crate::domain::release::ReleaseChanges;
use crate::engine::maps::live::LiveMap;
use crate::engine::tasks::blocking;
use crate::engine::{Result, Service};
use crate::recognition::map::changes_between::{ComparedVersion, changes_between};

impl Service {
    /// Returns what changed from a release to another one, or to the map as it stands, with both versions. Each list has at most
    /// `limit`.
    pub async fn changes_since(
        &self,
        map: &MapId,
        since: &ReleaseName,
        until: Option<&ReleaseName>,
        limit: usize,
    ) -> Result<(u64, u64, ReleaseChanges)> {
        let (earlier, before) = self.compared(&self.live_release(map, since).await?).await?;
        let live = match until {
            Some(name) => self.live_release(map, name).await?,
            None => self.live(map).await?,
        };
        let (later, after) = self.compared(&live).await?;
        let compare = move || changes_between(&before, &after, limit);
        let changes = blocking(compare).await?;
        Ok((earlier, later, changes))
    }

    /// Takes what is compared of a map, with its version.
    async fn compared(&self, live: &Arc<LiveMap>) -> Result<(u64, ComparedVersion)> {
        self.read(live, |state| Ok(ComparedVersion::of(&state.index))).await
    }
}
