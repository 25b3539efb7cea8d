//! Loading ahead: a map whose owner does not answer is loaded as a copy where it will be owned next, while the lease runs out.
//!
//! The copy is promoted when this server has taken the map (`engine/maps/promotion.rs`). If the owner answers again, it is given up
//! as any copy that nobody asks for.

use crate::domain::ids::MapId;
use crate::engine::{Result, Service, ServiceError};
use crate::store::Node;

impl Service {
    /// Loads a map of a server that does not answer, if this one takes it when that one is gone and there is memory for it. At most
    /// once per lease duration, as the owner may still answer other servers.
    pub fn load_ahead(&self, map: &MapId, silent: &Node) {
        let Some(membership) = self.membership.get() else { return };
        let copies = self.following();
        if !membership.takes_after(map, silent) || self.registry.has(map) || copies.registry.has(map) {
            return;
        }
        let Ok(turn) = self.followers.ahead.clone().try_acquire_owned() else { return };
        if !membership.try_begin_ahead(map) {
            return;
        }
        let map = map.clone();
        tokio::spawn(async move {
            let _turn = turn;
            if let Err(error) = copies.load_copy_of(&map).await {
                tracing::debug!(%map, %error, "a map was not loaded ahead");
            }
        });
    }

    async fn load_copy_of(&self, map: &MapId) -> Result<()> {
        let about = self.store.map_memory(map).await?.ok_or_else(|| ServiceError::no_map(map))?;
        let (copies, owned) = (&self.registry.memory, &self.owned.memory);
        // A large one may take what it will take as this server's own, while there is no other copy.
        let fits = copies.excess(about) == 0 || copies.used() == 0 && owned.excess(about) == 0;
        if !fits || self.owned.has(map) {
            return Ok(());
        }
        tracing::info!(%map, "its server does not answer: the map is loaded as a copy");
        self.live(map).await.map(drop)
    }
}
