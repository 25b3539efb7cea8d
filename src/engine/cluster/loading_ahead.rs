//! Loading ahead: a map whose owner does not answer is loaded as a copy where it will be owned next, while the lease runs out.
//!
//! The copy is promoted when this server has taken the map (`engine/maps/promotion.rs`). If the owner answers again, it is given up
//! as any copy that nobody asks for.

use crate::domain::ids::MapId;
use crate::engine::Service;
use crate::store::Node;

impl Service {
    /// Loads a map of a server that does not answer, if this one takes it when that one is gone.
    pub fn load_ahead(&self, map: &MapId, silent: &Node) {
        let Some(membership) = self.membership.get() else { return };
        let copies = self.following();
        if !membership.takes_after(map, silent) || copies.registry.has(map) {
            return;
        }
        let map = map.clone();
        tokio::spawn(async move {
            tracing::info!(%map, "its server does not answer: the map is loaded as a copy");
            if let Err(error) = copies.live(&map).await {
                tracing::debug!(%map, %error, "a map was not loaded ahead");
            }
        });
    }
}
