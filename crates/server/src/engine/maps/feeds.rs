//! Event feeds: the number of each map's latest event, for the streams that listen to it.
//!
//! A feed belongs to a map and to those who listen, and lives as long as either. So a stream outlives the eviction of its
//! map from memory, and keeps no map there: a map that comes back finds the feed of those who still listen.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, Weak};

use tokio::sync::watch;

use crate::engine::lock::lock;
use crate::store::MapKey;

/// The feeds of all maps that are in memory or listened to.
#[derive(Debug, Default)]
pub(in crate::engine) struct Feeds {
    by_map: Mutex<HashMap<MapKey, Weak<Feed>>>,
}

/// The number of one map's latest event on disk.
#[derive(Debug)]
pub(in crate::engine) struct Feed {
    map: MapKey,
    latest: watch::Sender<u64>,
    feeds: Arc<Feeds>,
}

impl Feeds {
    /// Returns the feed of a map of which events up to this number are on disk, as far as is known.
    pub fn of(self: &Arc<Self>, map: MapKey, latest: u64) -> Arc<Feed> {
        let mut by_map = lock(&self.by_map);
        if let Some(feed) = by_map.get(&map).and_then(Weak::upgrade) {
            drop(by_map);
            feed.reached(latest);
            return feed;
        }
        let feed = Arc::new(Feed { map, latest: watch::Sender::new(latest), feeds: self.clone() });
        by_map.insert(map, Arc::downgrade(&feed));
        feed
    }
}

impl Feed {
    /// Wakes those who listen if they have not heard of this event: everything up to it is on disk.
    pub fn reached(&self, event: u64) {
        self.latest.send_if_modified(|latest| event > std::mem::replace(latest, event.max(*latest)));
    }
}

impl Drop for Feed {
    fn drop(&mut self) {
        let mut by_map = lock(&self.feeds.by_map);
        // Another may have been made since the last user of this one went.
        if by_map.get(&self.map).is_some_and(|feed| feed.strong_count() == 0) {
            by_map.remove(&self.map);
        }
    }
}

/// One who listens to a map's events.
#[derive(Debug)]
pub struct Listener {
    latest: watch::Receiver<u64>,
    /// Without a sender there would be nothing to wait for.
    _feed: Arc<Feed>,
}

impl Listener {
    pub(in crate::engine) fn to(feed: Arc<Feed>) -> Self {
        Self { latest: feed.latest.subscribe(), _feed: feed }
    }

    /// Marks the events so far as seen; those that come from now on end [`Self::more`].
    pub fn mark_seen(&mut self) {
        self.latest.borrow_and_update();
    }

    /// Waits for events after those that are marked as seen.
    pub async fn more(&mut self) {
        // The feed is held: its sender cannot go.
        let _ = self.latest.changed().await;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_feed_lives_as_long_as_its_map_or_one_who_listens() {
        let feeds = Arc::new(Feeds::default());
        let mut listener = Listener::to(feeds.of(1, 5));
        listener.mark_seen();
        // The map is loaded again, with what was committed meanwhile.
        let feed = feeds.of(1, 5);
        feed.reached(6);
        listener.more().await;
        drop(listener);
        assert_eq!(lock(&feeds.by_map).len(), 1);
        drop(feed);
        assert!(lock(&feeds.by_map).is_empty(), "nothing is left of it");
    }
}
