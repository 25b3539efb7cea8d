//! Who is asking? Every key in memory, so that a request is admitted or refused without the disk.
//!
//! Another process may make or revoke keys in the same database (`revisit keys`): a glance at one row each second
//! tells, and a secret that nobody knows waits for another look, of which there is one every [`GLANCE_AGAIN`] at most,
//! for [`MAX_UNKNOWN_KEY_LOOKUPS`] at once.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, PoisonError, RwLock};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use base64::Engine as _;
use base64::prelude::BASE64_URL_SAFE_NO_PAD;
use rand::TryRng as _;
use rand::rngs::SysRng;
use tokio::sync::{Mutex, Semaphore, watch};
use tokio::time::{Instant, sleep, sleep_until};

use super::access::{Access, HeldKey};
use super::lockout::{Lockout, WAY_BACK, check_first_key, check_revocation};
use crate::domain::invalid::FieldError;
use crate::domain::key::{Action, Key, KeyProperties, KeySeq, MadeKey, SecretHash, secret_hash};
use crate::domain::keyframe::Stamp;
use crate::domain::report::Page;
use crate::engine::ServiceError;
use crate::store::{Job, KeyTable, NewKeyRow, Store, StoreError};

/// What another process did is seen after this time at the latest.
pub(in crate::engine) const POLL_INTERVAL: Duration = Duration::from_secs(1);

/// A flood of wrong secrets does not become a flood of looks at the disk.
const GLANCE_AGAIN: Duration = Duration::from_millis(100);

/// Maximum concurrent lookups of unknown secrets. Further ones are rejected, so that a flood of them cannot queue.
const MAX_UNKNOWN_KEY_LOOKUPS: usize = 32;

/// An expiry is waited for in steps of this.
const EXPIRY_POLL: Duration = Duration::from_mins(1);

/// The most keys of one database, revoked ones among them.
const KEYS_MAX: usize = 10_000;

/// Maximum tries to make a key whose number another server took.
const CREATED_AGAIN_MAX: u32 = 8;

/// What secrets begin with, so that scanners for leaked secrets can tell them.
const SECRET_PREFIX: &str = "revisit_";

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
struct Table {
    change: i64,
    by_hash: HashMap<SecretHash, Arc<HeldKey>>,
    by_seq: BTreeMap<KeySeq, Arc<HeldKey>>,
}

/// The keys of a database; clones share everything.
#[derive(Clone, Debug)]
pub struct Keyring {
    store: Store,
    table: Arc<RwLock<Arc<Table>>>,
    /// When the disk was last looked at.
    looked: Arc<Mutex<Instant>>,
    /// Those who wait for a look at the disk.
    strangers: Arc<Semaphore>,
    /// Held while a key is made or revoked.
    changing: Arc<Mutex<()>>,
    /// Counts the times that the table was taken anew.
    taken: watch::Sender<u64>,
    /// Whether a key is wanted even while there is none.
    required: bool,
}

impl Keyring {
    /// Returns the keys of a database. Where `required`, nobody is admitted without one; else only once there has been
    /// one.
    pub async fn open(store: Store, required: bool) -> Result<Self, ServiceError> {
        let keyring = Self {
            table: Arc::default(),
            looked: Arc::new(Mutex::new(Instant::now())),
            strangers: Arc::new(Semaphore::new(MAX_UNKNOWN_KEY_LOOKUPS)),
            changing: Arc::default(),
            taken: watch::Sender::new(0),
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
        let administers =
            |held: &Arc<HeldKey>| held.key.is_good(now) && held.key.properties.actions.has(Action::Admin);
        self.table().by_hash.values().any(administers)
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
        let mut taken = self.taken.subscribe();
        loop {
            taken.borrow_and_update();
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

    /// Returns what a key was made with, good or not.
    pub fn properties(&self, key: KeySeq) -> Option<KeyProperties> {
        self.table().by_seq.get(&key).map(|held| held.key.properties.clone())
    }

    /// Returns every key, in order of creation.
    pub fn list(&self) -> Vec<Key> {
        self.table().by_seq.values().map(|held| held.key.clone()).collect()
    }

    /// One part of the list, from a cursor on.
    pub fn page(&self, cursor: Option<&str>, limit: usize) -> Result<Page<Key>, ServiceError> {
        let from = match cursor {
            Some(cursor) => KeySeq::from_public(cursor).ok_or_else(|| ServiceError::bad_cursor(cursor))?,
            None => KeySeq(0),
        };
        let mut rest = self.list().into_iter().filter(|key| key.seq >= from);
        let items = rest.by_ref().take(limit).collect();
        Ok(Page { items, next_cursor: rest.next().map(|key| key.seq.public()) })
    }

    /// Makes a key.
    pub async fn create(&self, properties: KeyProperties, lockout: Lockout) -> Result<MadeKey, ServiceError> {
        check(&properties)?;
        let _changing = self.changing.lock().await;
        let mut tries = 0;
        loop {
            tries += 1;
            match self.create_next(properties.clone(), lockout).await {
                // Another server made one of this number meanwhile.
                Err((error, Some(seq))) if tries < CREATED_AGAIN_MAX => {
                    self.reload().await?;
                    if self.properties(seq).is_none() {
                        return Err(error);
                    }
                }
                made => return made.map_err(|(error, _)| error),
            }
        }
    }

    /// Makes a key with the number that is next; an error names it, if that may be taken.
    async fn create_next(
        &self,
        properties: KeyProperties,
        lockout: Lockout,
    ) -> Result<MadeKey, (ServiceError, Option<KeySeq>)> {
        let refused = |error: ServiceError| (error, None);
        self.reload().await.map_err(refused)?;
        let keys = self.list();
        let is_first = keys.is_empty();
        if is_first && lockout == Lockout::Refused {
            check_first_key(&properties).map_err(refused)?;
        }
        check_reach(&properties).map_err(refused)?;
        if keys.len() >= KEYS_MAX {
            let detail = format!("a database has at most {KEYS_MAX} keys, revoked ones among them");
            return Err(refused(ServiceError::Conflict { code: "too_many_keys", detail }));
        }
        let seq = KeySeq(keys.last().map_or(0, |last| last.seq.0) + 1);
        let secret = new_secret().map_err(refused)?;
        let key = Key { seq, properties, created_sec: now().sec, revoked_sec: None };
        let row = NewKeyRow { key: key.clone(), hash: secret_hash(&secret) };
        let created = self.store.committer().commit(Job::CreateKey(Box::new(row))).await;
        created.map_err(|error| (error.into(), Some(seq)))?;
        self.reload().await.map_err(refused)?;
        tracing::info!(key = %key.seq.public(), name = ?key.properties.name, may = %key.properties.actions, "a key was made");
        Ok(MadeKey { key, secret, is_first })
    }

    /// Revokes a key; revoking it again changes nothing.
    pub async fn revoke(&self, id: &str, lockout: Lockout) -> Result<Key, ServiceError> {
        let none = || ServiceError::NotFound(format!("there is no key {id}"));
        let seq = KeySeq::from_public(id).ok_or_else(none)?;
        let find = || self.list().into_iter().find(|key| key.seq == seq);
        // Two requests that each revoke one of the last two keys must not both see the other.
        let _changing = self.changing.lock().await;
        self.reload().await?;
        let found = find().ok_or_else(none)?;
        if found.revoked_sec.is_some() {
            return Ok(found);
        }
        if lockout == Lockout::Refused {
            check_revocation(&self.list(), seq, now())?;
        }
        self.store.committer().commit(Job::RevokeKey(seq, now().sec)).await?;
        self.reload().await?;
        tracing::info!(key = %seq.public(), "a key was revoked");
        if found.properties.actions.has(Action::Admin) && !self.has_administrator() {
            tracing::warn!("no key may administer any more: {WAY_BACK}");
        }
        find().ok_or_else(none)
    }

    /// Looks whether another process has made or revoked a key.
    pub(in crate::engine) async fn poll_changes(&self) {
        if let Err(error) = self.look().await {
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

    async fn look(&self) -> Result<(), StoreError> {
        if self.store.key_change().await? != self.table().change {
            let was_open = self.is_open();
            self.take(self.store.keys().await?);
            if was_open && !self.is_open() {
                tracing::warn!("the database has its first key: from now on every request needs a key");
            }
        }
        Ok(())
    }

    async fn reload(&self) -> Result<(), ServiceError> {
        Ok(self.look().await?)
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

    fn table(&self) -> Arc<Table> {
        self.table.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Holds these keys from now on; one that is as it was keeps its count of requests.
    fn take(&self, rows: KeyTable) {
        let mut table = self.table.write().unwrap_or_else(PoisonError::into_inner);
        if rows.change < table.change {
            return;
        }
        let hold = |(hash, key): (SecretHash, Key)| {
            let held = table.by_hash.get(&hash).filter(|held| held.key == key).cloned();
            (hash, held.unwrap_or_else(|| Arc::new(HeldKey::new(key))))
        };
        let by_hash: HashMap<_, _> = rows.by_hash.into_iter().map(hold).collect();
        let by_seq = by_hash.values().map(|held| (held.key.seq, held.clone())).collect();
        *table = Arc::new(Table { change: rows.change, by_hash, by_seq });
        self.taken.send_modify(|times| *times += 1);
    }
}

/// Rejects properties that no key can have.
fn check(properties: &KeyProperties) -> Result<(), ServiceError> {
    let mut errors = Vec::new();
    if properties.actions.iter().next().is_none() {
        errors.push(FieldError::new("/actions", "a key must be good for something"));
    }
    if properties.maps.is_empty() {
        errors.push(FieldError::new("/maps", "no map would exist for this key; leave it out for every map"));
    }
    if properties.expires.is_some_and(|expires| expires <= now()) {
        errors.push(FieldError::new("/expires", "the key would have expired already"));
    }
    if errors.is_empty() { Ok(()) } else { Err(ServiceError::Invalid(errors)) }
}

/// Rejects an administrator's key that does not reach every map: it could make itself one that does.
fn check_reach(properties: &KeyProperties) -> Result<(), ServiceError> {
    let every = properties.maps.iter().any(|pattern| pattern.to_string() == "*");
    if every || !properties.actions.has(Action::Admin) {
        return Ok(());
    }
    let detail = "an admin key makes keys for any map, so it cannot be kept from some";
    Err(ServiceError::Invalid(vec![FieldError::new("/maps", detail).limit("[\"*\"]")]))
}

fn new_secret() -> Result<String, ServiceError> {
    let mut bytes = [0; 32];
    let drawn = SysRng.try_fill_bytes(&mut bytes);
    drawn.map_err(|error| ServiceError::Internal(format!("no random numbers: {error}")))?;
    Ok(format!("{SECRET_PREFIX}{}", BASE64_URL_SAFE_NO_PAD.encode(bytes)))
}

/// Returns the server's clock.
pub(in crate::engine) fn now() -> Stamp {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    Stamp { sec: since.as_secs() as i64, nanosec: since.subsec_nanos() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::key::Actions;
    use crate::store::test_database::postgres_in;

    #[tokio::test(flavor = "multi_thread")]
    #[ignore = "needs REVISIT_TEST_POSTGRES"]
    async fn servers_that_share_a_database_number_keys_once_and_share_their_rates() {
        let folder = tempfile::tempdir().unwrap();
        let database = postgres_in(folder.path()).await;
        let mut keyrings = Vec::new();
        for _ in 0..2 {
            let store = Store::open(&database).await.unwrap();
            keyrings.push(Keyring::open(store, true).await.unwrap());
        }
        let properties = KeyProperties {
            name: "robots".to_owned(),
            actions: Actions::from_iter([Action::Read]),
            maps: vec!["*".parse().unwrap()],
            expires: None,
            rate_per_s: Some(20),
            model_daily_calls: None,
            model_daily_microusd: None,
        };
        let making = (0..12).map(|number| {
            let (keyring, properties) = (keyrings[number % 2].clone(), properties.clone());
            tokio::spawn(async move { keyring.create(properties, Lockout::Meant).await })
        });
        let mut made = Vec::new();
        for made_by in making.collect::<Vec<_>>() {
            made.push(made_by.await.unwrap().unwrap());
        }
        let mut numbers: Vec<KeySeq> = made.iter().map(|made| made.key.seq).collect();
        numbers.sort();
        assert_eq!(numbers, (1..=12).map(KeySeq).collect::<Vec<_>>());

        let held: Vec<Arc<HeldKey>> =
            keyrings.iter().map(|keyring| keyring.table().by_seq[&KeySeq(1)].clone()).collect();
        for of_server in &held {
            let admitted = (0..30).filter(|_| of_server.count().is_ok()).count();
            assert!(admitted >= 20, "alone, each admits the rate, not {admitted}");
        }
        for keyring in [&keyrings[0], &keyrings[1], &keyrings[0]] {
            keyring.share_rates().await;
        }
        // The second one knows of the first one's 20, and the first one of the second's.
        assert_eq!(held.iter().map(|of_server| of_server.parts_of_a_request()).collect::<Vec<_>>(), [32, 32]);
        for keyring in keyrings {
            keyring.store.close().await;
        }
    }
}
