//! Who is asking? Every key in memory, so that a request is admitted or refused without the disk.
//!
//! Another process may make or revoke keys in the same database (`revisit keys`): a glance at one row each second
//! tells, and a secret that nobody knows waits for another look, of which there is one every [`GLANCE_AGAIN`] at most,
//! for [`MAX_UNKNOWN_KEY_LOOKUPS`] at once.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use tokio::sync::{Mutex, Semaphore, watch};
use tokio::time::{Instant, sleep, sleep_until};

use super::access::{Access, HeldKey, KeyUse};
use super::lockout::administers;
use crate::domain::key::{Key, KeySeq, SecretHash, secret_hash};
use crate::domain::keyframe::Stamp;
use crate::domain::report::Page;
use crate::domain::request::PageRequest;
use crate::engine::{Result, ServiceError};
use crate::store::{KeyTable, Store, StoreError};

/// What another process did is seen after this time at the latest.
pub(in crate::engine) const POLL_INTERVAL: Duration = Duration::from_secs(1);

/// A flood of wrong secrets does not become a flood of looks at the disk.
const GLANCE_AGAIN: Duration = Duration::from_millis(100);

/// Maximum concurrent lookups of unknown secrets. Further ones are rejected, so that a flood of them cannot queue.
const MAX_UNKNOWN_KEY_LOOKUPS: usize = 32;

/// An expiry is waited for in steps of this.
const EXPIRY_POLL: Duration = Duration::from_mins(1);

/// What memory tells of a secret.
#[derive(Clone, Debug)]
pub enum Found {
    /// It is good, or none is wanted.
    Admitted(Access),
    /// It is not good any more, or there is none and one is wanted.
    Nobody,
    /// It may be good: the disk has to be asked, by [`Keyring::look_for`].
    Unknown,
}

#[derive(Debug, Default)]
pub(super) struct Table {
    change: i64,
    by_hash: HashMap<SecretHash, Arc<HeldKey>>,
    pub(super) by_seq: BTreeMap<KeySeq, Arc<HeldKey>>,
}

/// The keys of a database; clones share everything.
#[derive(Clone, Debug)]
pub struct Keyring {
    pub(super) store: Store,
    table: watch::Sender<Arc<Table>>,
    /// When the disk was last looked at.
    looked: Arc<Mutex<Instant>>,
    /// Those who wait for a look at the disk.
    strangers: Arc<Semaphore>,
    /// Held while a key is made or revoked.
    pub(super) changing: Arc<Mutex<()>>,
    /// Whether a key is wanted even while there is none.
    required: bool,
}

impl Keyring {
    /// Returns the keys of a database. Where `required`, nobody is admitted without one; else only once there has been
    /// one.
    pub async fn open(store: Store, required: bool) -> Result<Self> {
        let keyring = Self {
            table: watch::Sender::default(),
            looked: Arc::new(Mutex::new(Instant::now())),
            strangers: Arc::new(Semaphore::new(MAX_UNKNOWN_KEY_LOOKUPS)),
            changing: Arc::default(),
            store,
            required,
        };
        keyring.take(keyring.store.keys().await?);
        Ok(keyring)
    }

    /// Whether there is a key that could be admitted.
    pub fn has_good_key(&self) -> bool {
        let now = now();
        self.table().by_hash.values().any(|held| held.key.is_good(now))
    }

    /// Whether there is a good key that may administer.
    pub fn has_administrator(&self) -> bool {
        let now = now();
        self.table().by_hash.values().any(|held| administers(&held.key, now))
    }

    /// Who sends this secret, as far as memory tells?
    pub fn find(&self, secret: Option<&str>) -> Found {
        let Some(secret) = secret else {
            return if self.is_open() { Found::Admitted(Access::Open) } else { Found::Nobody };
        };
        match self.table().by_hash.get(&secret_hash(secret)) {
            Some(held) if held.key.is_good(now()) => Found::Admitted(Access::Key(held.clone())),
            Some(_) => Found::Nobody,
            None => Found::Unknown,
        }
    }

    /// Who sends this secret, that memory does not know? It may have been made a moment ago: the disk is looked at, for so
    /// many at once; for others the look that is taken each second has to do. `None` if nobody may be admitted with it.
    pub async fn look_for(&self, secret: &str) -> Option<Access> {
        let _stranger = self.strangers.try_acquire().ok()?;
        self.glance_after(Instant::now()).await;
        match self.find(Some(secret)) {
            Found::Admitted(access) => Some(access),
            Found::Nobody | Found::Unknown => None,
        }
    }

    /// Whether an access is still good, without a look at the disk: for requests that last.
    pub fn is_good(&self, access: &Access) -> bool {
        match access {
            Access::Open => self.is_open(),
            Access::Key(held) => {
                self.table().by_seq.get(&held.key.seq).is_some_and(|held| held.key.is_good(now()))
            }
        }
    }

    fn is_open(&self) -> bool {
        !self.required && self.table().by_hash.is_empty()
    }

    /// Waits until an access is good no longer: its key is revoked or has expired, or there is a key now where there was
    /// none. For answers that go on and on.
    pub async fn ended(&self, access: &Access) {
        let mut taken = self.table.subscribe();
        loop {
            taken.mark_unchanged();
            let now = now();
            let expires = match access {
                Access::Open if self.is_open() => None,
                Access::Open => return,
                Access::Key(held) => match self.table().by_seq.get(&held.key.seq) {
                    Some(held) if held.key.is_good(now) => held.key.properties.expires,
                    _ => return,
                },
            };
            let left_s = expires.map_or(i64::MAX, |expires| expires.sec - now.sec + 1);
            // Looked at again once in a while: clocks are set.
            let wait = Duration::from_secs(left_s.max(0) as u64).min(EXPIRY_POLL);
            tokio::select! {
                changed = taken.changed() => if changed.is_err() { return },
                () = sleep(wait) => {}
            }
        }
    }

    /// Returns how each good key was used since this server started.
    pub fn uses(&self) -> BTreeMap<KeySeq, KeyUse> {
        let now = now();
        let table = self.table();
        let good = table.by_seq.iter().filter(|(_, held)| held.key.is_good(now));
        good.map(|(seq, held)| (*seq, held.uses())).collect()
    }

    /// Returns a key, good or not.
    pub fn held(&self, key: KeySeq) -> Option<Arc<HeldKey>> {
        self.table().by_seq.get(&key).cloned()
    }

    /// Returns every key, in order of creation.
    pub fn list(&self) -> Vec<Key> {
        self.table().by_seq.values().map(|held| held.key.clone()).collect()
    }

    /// One part of the list, from a cursor on.
    pub fn page(&self, page: PageRequest) -> Result<Page<Key>> {
        let from = match &page.cursor {
            Some(cursor) => KeySeq::from_public(cursor).ok_or_else(|| ServiceError::bad_cursor(cursor))?,
            None => KeySeq(0),
        };
        let mut rest = self.list().into_iter().filter(|key| key.seq >= from);
        let items = rest.by_ref().take(page.limit).collect();
        Ok(Page { items, next_cursor: rest.next().map(|key| key.seq.public()) })
    }

    /// Looks whether another process has made or revoked a key.
    pub(in crate::engine) async fn poll_changes(&self) {
        if let Err(error) = self.reload().await {
            // What is in memory stays in force: keys do not stop working because a disk does.
            tracing::warn!(%error, "the keys could not be looked at");
        }
    }

    /// Tells the other servers what this one admits of keys whose rate is limited, and leaves them what they admit.
    pub(in crate::engine) async fn share_rates(&self) {
        let limited = |held: &Arc<HeldKey>| held.take_admitted().map(|admitted| (held.clone(), admitted));
        let limited: Vec<(Arc<HeldKey>, u32)> = self.table().by_seq.values().filter_map(limited).collect();
        if limited.is_empty() || !self.store.is_shared() {
            return;
        }
        let asked = limited.iter().filter(|(_, admitted)| *admitted > 0);
        let asked: Vec<(i64, u32)> = asked.map(|(held, admitted)| (held.key.seq.0, *admitted)).collect();
        match self.store.share_rates(&asked).await {
            Ok(elsewhere) => {
                for (held, _) in limited {
                    held.share(elsewhere.get(&held.key.seq.0).copied().unwrap_or_default());
                }
            }
            // Each goes on as it did.
            Err(error) => tracing::warn!(%error, "the rates of keys could not be shared"),
        }
    }

    /// Takes the keys anew if they were changed.
    pub(super) async fn reload(&self) -> Result<(), StoreError> {
        if self.store.key_change().await? != self.table().change {
            let was_open = self.is_open();
            self.take(self.store.keys().await?);
            if was_open && !self.is_open() {
                tracing::warn!("the database has its first key: from now on every request needs a key");
            }
        }
        Ok(())
    }

    /// Waits for a look at the disk that began after a moment; all who wait share it.
    async fn glance_after(&self, moment: Instant) {
        let mut looked = self.looked.lock().await;
        if *looked >= moment {
            return;
        }
        sleep_until(*looked + GLANCE_AGAIN).await;
        *looked = Instant::now();
        self.poll_changes().await;
    }

    pub(super) fn table(&self) -> Arc<Table> {
        self.table.borrow().clone()
    }

    /// Holds these keys from now on; one that is as it was keeps its count of requests.
    fn take(&self, rows: KeyTable) {
        self.table.send_if_modified(|table| {
            if rows.change < table.change {
                return false;
            }
            let hold = |(hash, key): (SecretHash, Key)| {
                let known = table.by_hash.get(&hash);
                let held = known.filter(|held| held.key == key).cloned();
                let uses = known.map(|known| known.uses()).unwrap_or_default();
                (hash, held.unwrap_or_else(|| Arc::new(HeldKey::new(key, uses))))
            };
            let by_hash: HashMap<_, _> = rows.by_hash.into_iter().map(hold).collect();
            let by_seq = by_hash.values().map(|held| (held.key.seq, held.clone())).collect();
            *table = Arc::new(Table { change: rows.change, by_hash, by_seq });
            true
        });
    }
}

/// Returns the server's clock.
pub fn now() -> Stamp {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    Stamp { sec: since.as_secs() as i64, nanosec: since.subsec_nanos() }
}
