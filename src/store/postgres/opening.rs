//! Opening: connections to a PostgreSQL server.

use std::str::FromStr as _;
use std::sync::Arc;
use std::time::Duration;

use sqlx::Connection as _;
use sqlx::postgres::{PgConnectOptions, PgPool, PgPoolOptions};

use super::leases::Leases;
use super::schema;
use crate::store::commit::group_commit::{self, Served};
use crate::store::sql::Pool;
use crate::store::{Store, StoreError};

/// Readers beside the one writer.
const READERS: u32 = 8;

/// The longest wait for a connection.
const ACQUIRE_TIMEOUT: Duration = Duration::from_secs(10);

/// A connection is made anew after so long: after a fail-over it may lead to a server that only reads.
const LIFETIME_MAX: Duration = Duration::from_mins(10);

/// A connection that was not used for so long is asked whether it still leads somewhere.
const UNTESTED: Duration = Duration::from_secs(1);

/// Statements that a connection keeps: many are there for each number of rows.
const STATEMENTS_KEPT: usize = 512;

/// Opens the database at an address, and brings it to this version's schema.
pub(in crate::store) async fn open(url: &str) -> Result<Store, StoreError> {
    let options = options(url)?;
    let pool = |connections: u32| {
        PgPoolOptions::new()
            .max_connections(connections)
            .acquire_timeout(ACQUIRE_TIMEOUT)
            .max_lifetime(LIFETIME_MAX)
            // Asking one that was used a moment ago costs a round trip, and tells nothing.
            .test_before_acquire(false)
            .before_acquire(|db, used| {
                Box::pin(async move { Ok(used.idle_for < UNTESTED || db.ping().await.is_ok()) })
            })
            .connect_lazy_with(options.clone())
    };
    let readers: PgPool = pool(READERS);
    schema::migrate(&readers).await?;
    // Its one connection is made by the writer's thread, which alone uses it.
    let leases = Arc::new(Leases::of(random_name(), Pool::Postgres(pool(1))));
    let committer = group_commit::start(Pool::Postgres(pool(1)), None, Served::Shared(leases.clone()))?;
    Ok(Store { readers: Pool::Postgres(readers), committer, files: None, lock: None, leases: Some(leases) })
}

fn options(url: &str) -> Result<PgConnectOptions, StoreError> {
    let options = PgConnectOptions::from_str(url)?;
    Ok(options.application_name("revisit").statement_cache_capacity(STATEMENTS_KEPT))
}

/// Returns a name that nobody else has, and nobody can guess: 128 random bits.
pub(in crate::store) fn random_name() -> String {
    format!("{:032x}", rand::random::<u128>())
}
