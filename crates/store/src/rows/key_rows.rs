//! The rows of API keys. They are few: a server holds all of them in memory and looks here whether that is still so.

use std::collections::HashMap;

use revisit_core::domain::key::{Actions, Key, KeyProperties, KeySeq, SecretHash};
use revisit_core::domain::keyframe::Stamp;
use sqlx::ConnectOptions as _;

use crate::columns::json;
use crate::files::paths::DatabaseFiles;
use crate::jobs::job::NewKeyRow;
use crate::sql::run;
use crate::sql::{self, Connection, Row};
use crate::{Store, StoreError};

/// Every key, as of one change.
#[derive(Debug, Default)]
pub struct KeyTable {
    /// Grows with each key made or revoked.
    pub change: i64,
    /// The keys by the hash of their secrets, revoked ones among them.
    pub by_hash: HashMap<SecretHash, Key>,
}

impl Store {
    /// Returns a number that grows with each key made or revoked, by whatever process.
    pub async fn key_change(&self) -> Result<i64, StoreError> {
        Ok(sql::query_scalar("select last from counters where name = 'key'").fetch_one(&self.readers).await?)
    }

    /// Returns every key.
    pub async fn keys(&self) -> Result<KeyTable, StoreError> {
        let mut db = self.snapshot().await?;
        let change =
            sql::query_scalar("select last from counters where name = 'key'").fetch_one(&mut *db).await?;
        let mut by_hash = HashMap::new();
        for row in sql::query("select * from keys").fetch_all(&mut *db).await? {
            by_hash.insert(row.try_get("hash")?, key(&row)?);
        }
        db.commit().await?;
        Ok(KeyTable { change, by_hash })
    }
}

fn key(row: &Row) -> Result<Key, StoreError> {
    let (seq, bits): (KeySeq, u8) = (row.try_get("key")?, row.try_get("actions")?);
    let expires: (Option<i64>, Option<u32>) = (row.try_get("expires_sec")?, row.try_get("expires_nanosec")?);
    Ok(Key {
        seq,
        properties: KeyProperties {
            name: row.try_get("name")?,
            actions: Actions::from_bits(bits)
                .ok_or_else(|| StoreError::corrupt(format!("actions {bits} of key {}", seq.0)))?,
            maps: json::value(row.try_get("maps")?)?,
            expires: expires.0.zip(expires.1).map(|(sec, nanosec)| Stamp { sec, nanosec }),
            rate_per_s: row.try_get("rate_per_s")?,
            max_maps: row.try_get("max_maps")?,
            max_bytes: row.try_get("max_bytes")?,
            model_daily_calls: row.try_get("model_daily_calls")?,
            model_daily_microusd: row.try_get("model_daily_microusd")?,
        },
        created_sec: row.try_get("created_sec")?,
        revoked_sec: row.try_get("revoked_sec")?,
    })
}

pub(crate) async fn create(db: &mut Connection, new: &NewKeyRow) -> Result<(), StoreError> {
    let (key, properties) = (&new.key, &new.key.properties);
    let insert =
        "insert into keys (key, name, hash, actions, created_sec, expires_sec, expires_nanosec, rate_per_s,
            max_maps, max_bytes, model_daily_calls, model_daily_microusd, maps)
        values ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13)";
    let query = sql::query(insert)
        .bind(key.seq)
        .bind(&properties.name)
        .bind(&new.hash[..])
        .bind(properties.actions.bits())
        .bind(key.created_sec)
        .bind(properties.expires.map(|expires| expires.sec))
        .bind(properties.expires.map(|expires| expires.nanosec))
        .bind(properties.rate_per_s)
        .bind(properties.max_maps)
        .bind(properties.max_bytes)
        .bind(properties.model_daily_calls)
        .bind(properties.model_daily_microusd);
    run(db, query.bind(json::text(&properties.maps)?)).await?;
    changed(db).await
}

pub(crate) async fn revoke(db: &mut Connection, key: KeySeq, at_sec: i64) -> Result<(), StoreError> {
    let update = "update keys set revoked_sec = $2 where key = $1 and revoked_sec is null";
    run(db, sql::statement(update, (key, at_sec))).await?;
    changed(db).await
}

async fn changed(db: &mut Connection) -> Result<(), StoreError> {
    run(db, sql::query("update counters set last = last + 1 where name = 'key'")).await
}

/// Returns the API keys of a database that are not revoked, by number and name.
pub async fn standing_keys(files: &DatabaseFiles) -> Result<Vec<(KeySeq, String)>, StoreError> {
    let mut db = sql::Connection::Sqlite(files.read_only().connect().await?);
    let select = "select key, name from keys where revoked_sec is null order by key";
    let keys = sql::query_as(select).fetch_all(&mut db).await?;
    db.close().await?;
    Ok(keys)
}
