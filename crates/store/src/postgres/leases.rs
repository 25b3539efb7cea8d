//! Leases: which of several servers has a map in memory and may write to it.
//!
//! A lease is a row of `map_owners`: an owner, an epoch that grows with each taking, and a time by the database's clock. It says
//! two things of different strength.
//!
//! - *Writes* are fenced by the epoch alone. The first statement of each write compares it and locks the row's key until
//!   the write ends; a taking waits for that lock. So no write is accepted of an owner that is not the newest, whatever clocks do.
//! - *Reads* are answered from memory while the lease is valid by the server's own clock, counted from before the database was
//!   asked, less a margin. The look at the clock follows the reading: nobody else had written by then.
//!
//! Leases are modelled in `proofs/lease`, with the faults that each of these rules prevents.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use revisit_core::domain::ids::MapId;

use super::followed::followed;
use super::key_list::list;
use crate::StoreError;
use crate::log::log_rows;
use crate::map_key::MapKey;
use crate::sql::transaction::Transaction;
use crate::sql::{self, Connection, Pool};

/// The duration of a lease by the database's clock.
const LEASE: Duration = Duration::from_secs(10);

/// A server stops reading so long before its lease ends, for clocks that do not run alike.
const MARGIN: Duration = Duration::from_secs(1);

/// A map that this server owns.
#[derive(Debug)]
pub struct Lease {
    /// The map.
    pub map: MapKey,
    epoch: i64,
    /// In microseconds since [`since_start`] began to count.
    valid_until_us: AtomicU64,
    is_lost: AtomicBool,
    is_followed: AtomicBool,
}

/// The leases of this server.
#[derive(Debug)]
pub struct Leases {
    node: String,
    /// Of its own, so that leases are extended also while every other connection waits for something.
    pool: Pool,
    held: Mutex<HashMap<MapKey, Arc<Lease>>>,
    lost: AtomicU64,
}

/// The outcome of taking a map.
#[derive(Debug)]
pub enum Taken {
    /// It is this server's.
    Here(Arc<Lease>),
    /// Another one has it.
    Elsewhere,
    /// There is no such map.
    NoMap,
}

impl Lease {
    fn of(map: MapKey, epoch: i64) -> Self {
        Self {
            map,
            epoch,
            valid_until_us: AtomicU64::new(0),
            is_lost: AtomicBool::new(false),
            is_followed: AtomicBool::new(false),
        }
    }

    /// Whether the map may be read from memory. To be asked after it was read.
    pub fn is_valid(&self) -> bool {
        !self.is_lost() && since_start(Instant::now()) < self.valid_until_us.load(Ordering::Acquire)
    }

    /// Whether it is another server's by now, or nobody's. What is in memory is to be thrown away.
    pub fn is_lost(&self) -> bool {
        self.is_lost.load(Ordering::Acquire)
    }

    /// Whether another server follows the map, and needs to know what changes.
    pub fn is_followed(&self) -> bool {
        self.is_followed.load(Ordering::Relaxed)
    }

    fn extend(&self, asked: Instant) {
        let until = since_start(asked + LEASE.saturating_sub(MARGIN));
        self.valid_until_us.fetch_max(until, Ordering::AcqRel);
    }

    fn lose(&self) {
        self.is_lost.store(true, Ordering::Release);
    }
}

impl Leases {
    pub(crate) fn of(node: String, pool: Pool) -> Self {
        Self { node, pool, held: Mutex::default(), lost: AtomicU64::new(0) }
    }

    /// The name by which this server owns maps.
    pub fn node(&self) -> &str {
        &self.node
    }

    /// Returns the connections by which leases are extended.
    pub(crate) fn pool(&self) -> &Pool {
        &self.pool
    }

    /// Returns the maps that it owns.
    pub(crate) fn maps(&self) -> Vec<MapKey> {
        self.lock().keys().copied().collect()
    }

    /// Returns how many leases it has.
    pub fn count(&self) -> u64 {
        self.lock().len() as u64
    }

    /// Returns how many leases it has lost to others since the start.
    pub fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }

    /// Takes a map that is nobody's, or whose owner let its lease run out. What this server wrote to it before must be settled.
    pub(crate) async fn take(&self, pool: &Pool, id: &MapId) -> Result<Taken, StoreError> {
        let asked = Instant::now();
        let mut db = Transaction::write(pool).await?;
        match self.take_within(&mut db, id).await {
            Ok(Some(Ok((map, epoch)))) => {
                db.commit().await?;
                let lease = Arc::new(Lease::of(map, epoch));
                lease.extend(asked);
                if let Some(former) = self.lock().insert(map, lease.clone()) {
                    former.lose();
                }
                Ok(Taken::Here(lease))
            }
            Ok(other) => {
                db.commit().await?;
                Ok(if other.is_none() { Taken::NoMap } else { Taken::Elsewhere })
            }
            Err(error) => {
                db.roll_back().await;
                Err(error)
            }
        }
    }

    /// Returns the map's key and its new epoch; no value if there is no such map, an error if it is another server's.
    async fn take_within(
        &self,
        db: &mut Connection,
        id: &MapId,
    ) -> Result<Option<Result<(MapKey, i64), ()>>, StoreError> {
        let select = "select map_key from maps where id = $1 and deleted = 0";
        let Some(map) =
            sql::query_scalar::<MapKey>(select).bind(id.as_str()).fetch_optional(&mut *db).await?
        else {
            return Ok(None);
        };
        let insert =
            "insert into map_owners (map_key, owner, epoch, expires) values ($1, null, 0, clock_timestamp())
            on conflict do nothing";
        sql::query(insert).bind(map).execute(&mut *db).await?;
        // Waits for the writes of the former owner that are under way: they have locked the key.
        let select =
            "select owner, expires > clock_timestamp() from map_owners where map_key = $1 for update";
        let row: Option<(Option<String>, bool)> =
            sql::query_as(select).bind(map).fetch_optional(&mut *db).await?;
        match row {
            None => return Ok(None),
            Some((Some(owner), true)) if owner != self.node => return Ok(Some(Err(()))),
            Some(_) => {}
        }
        let update = "update map_owners set owner = $2, epoch = epoch + 1,
            expires = clock_timestamp() + make_interval(secs => $3) where map_key = $1 returning epoch";
        let query = sql::query_scalar(update).bind(map).bind(&self.node).bind(LEASE.as_secs_f64());
        let epoch = query.fetch_one(&mut *db).await?;
        // What the former owner staged and did not commit: no version is made of it.
        log_rows::remove_uncommitted_of(db, map).await?;
        Ok(Some(Ok((map, epoch))))
    }

    /// Extends every lease; those that another server has taken are lost.
    pub(crate) async fn renew(&self) -> Result<(), StoreError> {
        let held: Vec<Arc<Lease>> = self.lock().values().cloned().collect();
        // A map that has left memory holds its lease no more: only the table and this list do.
        let (idle, held): (Vec<_>, Vec<_>) =
            held.into_iter().partition(|lease| Arc::strong_count(lease) <= 2);
        for lease in idle {
            self.give_back(&lease).await?;
        }
        if held.is_empty() {
            return Ok(());
        }
        let keys: Vec<MapKey> = held.iter().map(|lease| lease.map).collect();
        let asked = Instant::now();
        let update = "update map_owners set expires = clock_timestamp() + make_interval(secs => $3)
            where owner = $1 and map_key in (select cast(value as bigint) from json_each($2)) returning map_key, epoch";
        let query = sql::query_as(update).bind(&self.node).bind(list(&keys)).bind(LEASE.as_secs_f64());
        let renewed: Vec<(MapKey, i64)> = query.fetch_all(&self.pool).await?;
        let renewed: HashMap<MapKey, i64> = renewed.into_iter().collect();
        for lease in held {
            match renewed.get(&lease.map) {
                Some(epoch) if *epoch == lease.epoch => lease.extend(asked),
                // Taken anew by this server meanwhile.
                Some(epoch) if *epoch > lease.epoch => lease.lose(),
                _ => self.lose(&lease),
            }
        }
        let followed = followed(&self.pool, &keys).await?;
        for lease in self.lock().values() {
            lease.is_followed.store(followed.contains(&lease.map), Ordering::Relaxed);
        }
        Ok(())
    }

    /// Gives a lease back. Nothing of the map may be under way, and nobody reads it from memory any more.
    pub(crate) async fn give_back(&self, lease: &Lease) -> Result<(), StoreError> {
        lease.lose();
        {
            let mut held = self.lock();
            if held.get(&lease.map).is_some_and(|current| current.epoch == lease.epoch) {
                held.remove(&lease.map);
            }
        }
        let update = "update map_owners set owner = null where map_key = $1 and owner = $2 and epoch = $3";
        sql::query(update).bind(lease.map).bind(&self.node).bind(lease.epoch).execute(&self.pool).await?;
        Ok(())
    }

    /// Gives all leases back.
    pub(crate) async fn give_all_back(&self) -> Result<(), StoreError> {
        for (_, lease) in self.lock().drain() {
            lease.lose();
        }
        sql::query("update map_owners set owner = null where owner = $1")
            .bind(&self.node)
            .execute(&self.pool)
            .await?;
        Ok(())
    }

    /// Fails unless this server owns these maps, and keeps it so until the transaction ends. To be its first statement.
    pub(crate) async fn fence(&self, db: &mut Connection, maps: &[MapKey]) -> Result<(), StoreError> {
        if maps.is_empty() {
            return Ok(());
        }
        let held: Option<Vec<Arc<Lease>>> = {
            let leases = self.lock();
            maps.iter().map(|map| leases.get(map).filter(|lease| !lease.is_lost()).cloned()).collect()
        };
        let Some(held) = held else { return Err(StoreError::Fenced) };
        let select = "select map_key, epoch from map_owners
            where owner = $1 and map_key in (select cast(value as bigint) from json_each($2))
            order by map_key for key share";
        let query = sql::query_as(select).bind(&self.node).bind(list(maps));
        let owned: Vec<(MapKey, i64)> = query.fetch_all(&mut *db).await?;
        let owned: HashMap<MapKey, i64> = owned.into_iter().collect();
        let mut is_fenced = false;
        for lease in held {
            if owned.get(&lease.map) != Some(&lease.epoch) {
                self.lose(&lease);
                is_fenced = true;
            }
        }
        if is_fenced { Err(StoreError::Fenced) } else { Ok(()) }
    }

    /// Fails if a database does not say what it said when this server took a map: what is read there may be older than what was
    /// written before. A balancer may lead to a replica for a moment.
    pub(crate) async fn expect_ours(&self, db: &mut Connection, map: MapKey) -> Result<(), StoreError> {
        let Some(lease) = self.lock().get(&map).cloned() else { return Ok(()) };
        let select = "select owner, epoch from map_owners where map_key = $1";
        let row: Option<(Option<String>, i64)> = sql::query_as(select).bind(map).fetch_optional(db).await?;
        match row {
            Some((Some(owner), epoch)) if owner == self.node && epoch == lease.epoch => Ok(()),
            _ => {
                Err(StoreError::Away("the one that answers is behind the one that was written to".to_owned()))
            }
        }
    }

    fn lose(&self, lease: &Arc<Lease>) {
        lease.lose();
        let mut held = self.lock();
        if held.get(&lease.map).is_some_and(|current| Arc::ptr_eq(current, lease)) {
            held.remove(&lease.map);
            self.lost.fetch_add(1, Ordering::Relaxed);
            tracing::warn!(
                map = lease.map,
                epoch = lease.epoch,
                "another server owns a map that was this one's"
            );
        }
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<MapKey, Arc<Lease>>> {
        // A table of leases is whole after each of its operations.
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns a moment in microseconds since this program first asked.
fn since_start(at: Instant) -> u64 {
    static START: OnceLock<Instant> = OnceLock::new();
    let start = START.get_or_init(Instant::now);
    u64::try_from(at.saturating_duration_since(*start).as_micros()).unwrap_or(u64::MAX)
}
