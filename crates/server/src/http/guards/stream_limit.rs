//! Stream limit: bounds open event streams, per key and in total.
//!
//! An event stream keeps its connection active indefinitely, so it is never evicted. One key must not occupy every
//! slot that way.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use crate::domain::counted::counted;
use crate::domain::key::KeySeq;
use crate::engine::keys::access::Access;
use crate::engine::lock::lock;
use crate::http::problem::Problem;

/// The streams of a server by key; `None` is all clients without a key.
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
    /// Creates a limit per key, and one for all keys together.
    pub fn new((most, most_in_all): (usize, usize)) -> Arc<Self> {
        Arc::new(Self { most, most_in_all, open: Mutex::default() })
    }

    /// Opens a stream, unless a limit is reached.
    pub fn begin(self: &Arc<Self>, access: &Access) -> Result<Listening, Problem> {
        let (key, most, most_in_all) = (access.key(), self.most, self.most_in_all);
        let mut open = lock(&self.open);
        let count = open.get(&key).copied().unwrap_or_default();
        if count >= most {
            let most = counted(most, "stream");
            return Err(match key {
                Some(_) => Problem::had_its_share(format!("the key has reached its limit of {most}")),
                None => Problem::overloaded(format!("a server without keys allows at most {most}")),
            });
        }
        if open.values().sum::<usize>() >= most_in_all {
            let most = counted(most_in_all, "stream");
            return Err(Problem::overloaded(format!("the server allows at most {most}")));
        }
        open.insert(key, count + 1);
        drop(open);
        Ok(Listening { streams: self.clone(), key })
    }
}

impl Drop for Listening {
    fn drop(&mut self) {
        let mut open = lock(&self.streams.open);
        let left = open.get(&self.key).map_or(0, |count| count.saturating_sub(1));
        // Keys come and go, so those without streams are removed.
        if left == 0 {
            open.remove(&self.key);
        } else {
            open.insert(self.key, left);
        }
    }
}
