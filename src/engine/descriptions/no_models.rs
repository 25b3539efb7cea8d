//! A map that waits for a model comes to a server that has none: it waits no longer.
//!
//! A server that alone has the database tells all maps when it starts; among others each map is told by the server that takes it.

use std::sync::Arc;

use crate::engine::maps::live::{Decision, LiveMap};
use crate::engine::{Result, Service};
use crate::recognition::anchors::apply_model_answer::learn_away;
use crate::recognition::map::index::MapIndex;

impl Service {
    /// Has a map that was just taken wait for no model, if this server has none.
    pub(in crate::engine) async fn wait_for_no_model(&self, live: &Arc<LiveMap>) {
        let is_told = self.models.is_some() || !self.store.is_shared() || self.follows || live.is_release();
        if is_told || live.glance(|state| state.index.model_away()).is_none_or(|(_, waits)| !waits) {
            return;
        }
        if let Err(error) = self.tell_away(live, false).await {
            tracing::warn!(map = %live.id, %error, "a map still waits for a model that this server has not");
        }
    }

    /// Has a map record whether it waits for a model that is away.
    pub(super) async fn tell_away(&self, live: &Arc<LiveMap>, away: bool) -> Result<()> {
        let decide = move |index: &mut MapIndex| Ok(Decision::of((), learn_away(index, away)));
        self.change(live, decide).await.map(drop)
    }
}
