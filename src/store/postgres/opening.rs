//! Opening: connections to a PostgreSQL server.

use std::str::FromStr as _;
use std::sync::Arc;
use std::time::Duration;

use sqlx::Row as _;
use sqlx::postgres::{PgConnectOptions, PgConnection, PgPool, PgPoolOptions};

use super::leases::Leases;
use super::schema;
use crate::store::commit::group_commit::{self, Served};
use crate::store::sql::connection::limited;
use crate::store::sql::{Pool, Statements};
use crate::store::{Store, StoreError};

/// Readers beside the one writer.
const READERS: u32 = 8;

/// The longest wait for a connection.
const ACQUIRE_TIMEOUT: Duration = Duration::from_secs(10);

/// A connection is made anew after so long: after a fail-over it may lead to a server that is the primary no more and does not know.
const LIFETIME_MAX: Duration = Duration::from_mins(1);

/// A connection that was not used for so long is asked whether it still leads somewhere.
const UNTESTED: Duration = Duration::from_secs(1);

/// Statements that a connection keeps: many are there for each number of rows.
const STATEMENTS_KEPT: usize = 512;

/// Opens the database at an address, and brings it to this version's schema.
pub(in crate::store) async fn open(url: &str) -> Result<Store, StoreError> {
    let (options, how) = (options(url)?, statements(url));
    let pool = |connections: u32| {
        PgPoolOptions::new()
            .max_connections(connections)
            .acquire_timeout(ACQUIRE_TIMEOUT)
            .max_lifetime(LIFETIME_MAX)
            .after_connect(|db, _| Box::pin(expect_writable(db)))
            // Asking one that was used a moment ago costs a round trip, and tells little.
            .test_before_acquire(false)
            .before_acquire(|db, used| {
                Box::pin(async move { Ok(used.idle_for < UNTESTED || expect_writable(db).await.is_ok()) })
            })
            .connect_lazy_with(options.clone())
    };
    let readers: PgPool = pool(READERS);
    schema::migrate(&readers, how).await?;
    // Its one connection is made by the writer's thread, which alone uses it.
    let leases = Arc::new(Leases::of(random_name(), Pool::Postgres(pool(1), how)));
    let committer = group_commit::start(Pool::Postgres(pool(1), how), None, Served::Shared(leases.clone()))?;
    Ok(Store {
        readers: Pool::Postgres(readers, how),
        committer,
        files: None,
        lock: None,
        leases: Some(leases),
    })
}

fn options(url: &str) -> Result<PgConnectOptions, StoreError> {
    let options = PgConnectOptions::from_str(url)?;
    // PgBouncer refuses connections that set it. Numbers come in binary, of which it changes nothing.
    let kept = match statements(url) {
        Statements::Named => STATEMENTS_KEPT,
        Statements::Unnamed => 0,
    };
    Ok(options.application_name("revisit").extra_float_digits(None).statement_cache_capacity(kept))
}

/// Fails if a connection leads to a replica, as a balancer may choose one for a moment, or to nobody any more.
async fn expect_writable(db: &mut PgConnection) -> Result<(), sqlx::Error> {
    let row = limited(sqlx::raw_sql("select pg_is_in_recovery()").fetch_one(db)).await?;
    if row.try_get::<bool, _>(0)? {
        return Err(sqlx::Error::Protocol("the server is a replica, which only reads".to_owned()));
    }
    Ok(())
}

/// Returns how statements are sent: with a cache of none (`statement-cache-capacity=0`, as sqlx names it) they have no names.
fn statements(url: &str) -> Statements {
    let parameters = url.split_once('?').map_or("", |(_, parameters)| parameters);
    if parameters.split('&').any(|parameter| parameter == "statement-cache-capacity=0") {
        Statements::Unnamed
    } else {
        Statements::Named
    }
}

/// Returns a name that nobody else has, and nobody can guess: 128 random bits.
pub(in crate::store) fn random_name() -> String {
    format!("{:032x}", rand::random::<u128>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_says_how_statements_are_sent() {
        for (url, how) in [
            ("postgres://me@host/base", Statements::Named),
            ("postgres://me@host/base?statement-cache-capacity=100", Statements::Named),
            ("postgres://me@host/base?sslmode=require&statement-cache-capacity=0", Statements::Unnamed),
        ] {
            assert_eq!(statements(url), how, "{url}");
        }
    }
}
