//! Turns to compute, of which no tenant has more than half.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, Weak};

use tokio::sync::OwnedSemaphorePermit;

use super::concurrency_limit::{ConcurrencyLimit, Wait};
use crate::domain::key::KeySeq;
use crate::engine::Result;
use crate::engine::lock::lock;
use crate::store::MapKey;

/// Tenants that are remembered before those without requests are forgotten.
const REMEMBERED: usize = 256;

tokio::task_local! {
    static KEY: KeySeq;
}

/// A party whose requests share a part of the server: a key, or where a request brings none, a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in crate::engine) enum Tenant {
    Key(KeySeq),
    Map(MapKey),
    /// Requests without a key that concern several maps.
    Anyone,
}

impl Tenant {
    /// Returns the tenant of the request under way.
    pub fn current(map: Option<MapKey>) -> Self {
        KEY.try_with(|key| Self::Key(*key)).unwrap_or_else(|_| map.map_or(Self::Anyone, Self::Map))
    }
}

/// Works on a request that a key brings: it takes the turns of that key.
pub async fn for_key<T>(key: Option<KeySeq>, work: impl Future<Output = T>) -> T {
    match key {
        Some(key) => KEY.scope(key, work).await,
        None => work.await,
    }
}

/// Turns for all, and half of them for each tenant: whoever asks much keeps none of the others waiting.
#[derive(Debug)]
pub(in crate::engine) struct SharedTurns {
    all: Arc<ConcurrencyLimit>,
    of_each: usize,
    waiting_max: usize,
    of_tenants: Mutex<HashMap<Tenant, Weak<ConcurrencyLimit>>>,
}

/// A turn, until it is dropped.
#[derive(Debug)]
pub(in crate::engine) struct Turn {
    _of_all: OwnedSemaphorePermit,
    _of_tenant: OwnedSemaphorePermit,
    _tenant: Arc<ConcurrencyLimit>,
}

impl SharedTurns {
    pub fn new(at_once: usize, waiting_max: usize) -> Self {
        let all = ConcurrencyLimit::new(at_once, waiting_max);
        Self { all, of_each: at_once.div_ceil(2), waiting_max, of_tenants: Mutex::default() }
    }

    /// Waits for a turn, or hears that it would take too long.
    pub async fn enter(&self, tenant: Tenant) -> Result<Turn> {
        self.enter_after(tenant, Wait::BOUNDED).await
    }

    /// Waits for a turn, so long.
    pub async fn enter_after(&self, tenant: Tenant, wait: Wait) -> Result<Turn> {
        let limit = self.of(tenant);
        let of_tenant = limit.enter(wait).await?;
        Ok(Turn { _of_all: self.all.enter(wait).await?, _of_tenant: of_tenant, _tenant: limit })
    }

    /// Returns how many have a turn.
    pub fn inside(&self) -> usize {
        self.all.inside()
    }

    /// Returns how many wait for one, most of them for one of their tenant's.
    pub fn waiting(&self) -> usize {
        let of_tenants = lock(&self.of_tenants);
        let waiting = of_tenants.values().filter_map(Weak::upgrade).map(|limit| limit.waiting());
        waiting.sum::<usize>() + self.all.waiting()
    }

    fn of(&self, tenant: Tenant) -> Arc<ConcurrencyLimit> {
        let mut of_tenants = lock(&self.of_tenants);
        if let Some(known) = of_tenants.get(&tenant).and_then(Weak::upgrade) {
            return known;
        }
        if of_tenants.len() >= REMEMBERED {
            of_tenants.retain(|_, limit| limit.strong_count() > 0);
        }
        let limit = ConcurrencyLimit::new(self.of_each, self.waiting_max);
        of_tenants.insert(tenant, Arc::downgrade(&limit));
        limit
    }
}

#[cfg(test)]
mod tests {
    use futures_util::FutureExt as _;

    use super::*;

    #[tokio::test]
    async fn a_tenant_has_half_of_the_turns_and_another_one_needs_not_wait() {
        let turns = SharedTurns::new(4, 8);
        let enter = |tenant| turns.enter(tenant).map(Result::unwrap);
        let (a, b) = (Tenant::Anyone, Tenant::Key(KeySeq(1)));
        let of_a = (enter(a).await, enter(a).await);
        assert!(enter(a).now_or_never().is_none(), "it has its half");
        let of_b = enter(b).now_or_never().expect("the other half is free");
        drop(of_a.0);
        let again = enter(a).now_or_never().expect("one has ended");
        assert_eq!((turns.inside(), turns.waiting()), (3, 0));
        drop((of_a.1, of_b, again));
        assert_eq!(turns.inside(), 0);
    }

    #[tokio::test]
    async fn a_request_is_of_its_key_and_without_one_of_its_map() {
        let map = Some(7);
        assert_eq!(for_key(Some(KeySeq(3)), async { Tenant::current(map) }).await, Tenant::Key(KeySeq(3)));
        assert_eq!(for_key(None, async { Tenant::current(map) }).await, Tenant::Map(7));
        assert_eq!(Tenant::current(None), Tenant::Anyone);
    }
}
