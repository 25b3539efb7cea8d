//! Opening: connections to a PostgreSQL server.

use std::str::FromStr as _;
use std::sync::Arc;
use std::time::Duration;

use sqlx::postgres::{PgConnectOptions, PgConnection, PgPool, PgPoolOptions};
use sqlx::{Connection as _, Row as _};
use tokio::time::{Instant, sleep, timeout_at};

use crate::commit::group_commit::{self, Served};
use crate::postgres::leases::Leases;
use crate::postgres::nodes::random_name;
use crate::postgres::schema;
use crate::sql::connection::limited;
use crate::sql::{Pool, Statements};
use crate::{Store, StoreError};

/// Readers beside the one writer.
const READERS: u32 = 8;

/// The longest wait for a connection.
const ACQUIRE_TIMEOUT: Duration = Duration::from_secs(10);

/// The pause between two tries to reach a server when the database is opened.
const TRY_AGAIN: Duration = Duration::from_millis(500);

/// The code by which PostgreSQL says that it takes no connections yet, or no more.
const STARTING_UP: &str = "57P03";

/// A connection is made anew after so long: after a fail-over it may lead to a server that is the primary no more and does not know.
const LIFETIME_MAX: Duration = Duration::from_mins(1);

/// A connection that was not used for so long is asked whether it still leads somewhere.
const UNTESTED: Duration = Duration::from_secs(1);

/// Statements that a connection keeps: many are there for each number of rows.
const STATEMENTS_KEPT: usize = 512;

/// Opens the database at an address, and brings it to this version's schema.
pub(crate) async fn open(url: &str) -> Result<Store, StoreError> {
    let (options, how) = (options(url)?, statements(url));
    expect_reachable(&options).await?;
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

/// Fails if nobody answers at an address, and says why; a database server that starts is waited for. A pool would only say that it
/// has no connection.
async fn expect_reachable(options: &PgConnectOptions) -> Result<(), StoreError> {
    let (host, port) = (options.get_host(), options.get_port());
    let deadline = Instant::now() + ACQUIRE_TIMEOUT;
    loop {
        let why = match timeout_at(deadline, PgConnection::connect_with(options)).await {
            Ok(Ok(db)) => return Ok(db.close().await?),
            Ok(Err(sqlx::Error::Database(error))) if error.code().as_deref() != Some(STARTING_UP) => {
                return Err(StoreError::Database(format!(
                    "PostgreSQL at {host}:{port}: {}",
                    error.message()
                )));
            }
            Ok(Err(error)) => error.to_string(),
            Err(_) => "it does not answer".to_owned(),
        };
        if Instant::now() + TRY_AGAIN >= deadline {
            return Err(StoreError::Database(format!(
                "PostgreSQL at {host}:{port} cannot be reached: {why}"
            )));
        }
        sleep(TRY_AGAIN).await;
    }
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
