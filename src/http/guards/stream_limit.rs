//! Stream limit: bounds open event streams, for each key and in all.
//!
//! A stream of events keeps its connection at work for as long as its client likes, so that it gives way to nobody. One
//! key must not take every seat that way.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::domain::counted::counted;
use crate::domain::key::KeySeq;
use crate::engine::keys::access::Access;
use crate::http::problem::Problem;

/// The streams of a server, by the key that opened them; `None` is everybody while there is no key.
#[derive(Debug)]
pub struct StreamLimit {
    most: usize,
    most_in_all: usize,
    open: Mutex<HashMap<Option<KeySeq>, usize>>,
}

/// One stream, until this is dropped.
#[derive(Debug)]
pub struct Listening {
    streams: Arc<StreamLimit>,
    key: Option<KeySeq>,
}

impl StreamLimit {
    /// Creates a limit for each key, and one for all of them together.
    pub fn new((most, most_in_all): (usize, usize)) -> Arc<Self> {
        Arc::new(Self { most, most_in_all, open: Mutex::default() })
    }

    /// Begins one, unless there are enough.
    pub fn begin(self: &Arc<Self>, access: &Access) -> Result<Listening, Problem> {
        let (key, most) = (access.key(), self.most);
        let mut open = self.lock();
        let count = open.get(&key).copied().unwrap_or_default();
        if count >= most {
            return Err(match key {
                Some(_) => Problem::had_its_share(format!(
                    "the key listens to {}, and may to no more",
                    counted(most, "stream")
                )),
                None => Problem::overloaded(format!(
                    "without keys there is room for {} at once",
                    counted(most, "stream")
                )),
            });
        }
        if open.values().sum::<usize>() >= self.most_in_all {
            let most = self.most_in_all;
            return Err(Problem::overloaded(format!(
                "there is room for {} at once",
                counted(most, "stream")
            )));
        }
        open.insert(key, count + 1);
        drop(open);
        Ok(Listening { streams: self.clone(), key })
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<Option<KeySeq>, usize>> {
        // A count is whole after each operation.
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Listening {
    fn drop(&mut self) {
        let mut open = self.streams.lock();
        let left = open.get(&self.key).map_or(0, |count| count.saturating_sub(1));
        // Keys come and go; those that listen to nothing leave nothing behind.
        if left == 0 {
            open.remove(&self.key);
        } else {
            open.insert(self.key, left);
        }
    }
}
