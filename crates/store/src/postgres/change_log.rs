//! The change log: what the newest versions of a map changed, for the servers that follow it.
//!
//! The owner writes it beside the facts, in the same transaction, while a server follows the map ([`super::followers`]). It is
//! no fact: a version that is not there, or in a form that is not known, has the follower load the map anew.

use revisit_core::domain::change::Change;

use crate::jobs::job::Batch;

use crate::log::entry::to_bytes;
use crate::map_key::MapKey;
use crate::sql::run;
use crate::sql::{self, Connection};
use crate::{Store, StoreError};

/// The version of the form of changes: another version of the program may have another one.
const FORMAT: &str = concat!(env!("CARGO_PKG_VERSION"), "/3");

/// Changes that take more bytes are not logged: a map of which so much changed is loaded anew.
const BYTES_MAX: usize = 1 << 20;

/// Versions that are read at once.
const VERSIONS_AT_ONCE: i64 = 64;

/// The news of a map that another server owns.
#[derive(Debug, PartialEq)]
pub enum News {
    /// The changes of the versions after the one that is known, in their order and without a gap; none if there is none.
    Changes(Vec<(u64, Vec<Change>)>),
    /// More changed than the log tells.
    Unknown,
    /// The map is deleted.
    Gone,
}

/// Logs what a batch changes, unless it is too much.
pub(crate) async fn log(db: &mut Connection, batch: &Batch) -> Result<(), StoreError> {
    let Ok(changes) = to_bytes(&batch.changes) else { return Ok(()) };
    if changes.len() > BYTES_MAX {
        return Ok(());
    }
    let insert = "insert into map_changes (map_key, version, format, changes) values ($1, $2, $3, $4)";
    run(db, sql::statement(insert, (batch.map, batch.version, FORMAT, changes))).await
}

/// Notes that rows of a map changed that no version tells.
pub(crate) async fn note_rewrite(db: &mut Connection, map: MapKey) -> Result<(), StoreError> {
    let upsert = "insert into map_rewrites (map_key, rewritten) values ($1, 1)
        on conflict (map_key) do update set rewritten = map_rewrites.rewritten + 1";
    run(db, sql::query(upsert).bind(map)).await
}

/// Forgets what the log tells of a map, and what copies answered: an erasure leaves no trace in either.
pub(crate) async fn forget(db: &mut Connection, map: MapKey) -> Result<(), StoreError> {
    for delete in
        ["delete from map_changes where map_key = $1", "delete from followed_queries where map_key = $1"]
    {
        run(db, sql::query(delete).bind(map)).await?;
    }
    Ok(())
}

/// Returns how often a map was rewritten.
pub(crate) async fn rewrites(db: &mut Connection, map: MapKey) -> Result<i64, StoreError> {
    let select = "select rewritten from map_rewrites where map_key = $1";
    let found = sql::query_scalar(select).bind(map).fetch_optional(db).await?;
    Ok(found.unwrap_or(0))
}

impl Store {
    /// Returns how often a map was rewritten: to be asked before the map is loaded.
    pub async fn rewrites(&self, map: MapKey) -> Result<i64, StoreError> {
        // The row is there from now on, for answers to wait for who rewrites the map.
        let insert =
            "insert into map_rewrites (map_key, rewritten) select map_key, 0 from maps where map_key = $1
            on conflict do nothing";
        sql::query(insert).bind(map).execute(&self.readers).await?;
        rewrites(&mut self.readers.acquire().await?, map).await
    }

    /// Returns what happened to a map since this version, and since it was rewritten so often.
    pub async fn news(&self, map: MapKey, version: u64, rewrites: i64) -> Result<News, StoreError> {
        let select =
            "select m.version, coalesce(r.rewritten, 0) from maps m left join map_rewrites r using (map_key)
            where m.map_key = $1 and m.deleted = 0";
        let found: Option<(u64, i64)> = sql::query_as(select).bind(map).fetch_optional(&self.readers).await?;
        let Some((newest, rewritten)) = found else { return Ok(News::Gone) };
        if rewritten != rewrites {
            return Ok(News::Unknown);
        }
        if newest <= version {
            return Ok(News::Changes(Vec::new()));
        }
        let select = "select version, format, changes from map_changes
            where map_key = $1 and version > $2 order by version limit $3";
        let query = sql::query_as(select).bind(map).bind(version).bind(VERSIONS_AT_ONCE);
        Ok(without_gap(version, query.fetch_all(&self.readers).await?).map_or(News::Unknown, News::Changes))
    }
}

/// Returns the changes of the versions that follow each other from the one that is known; `None` if the next one is not there.
fn without_gap(known: u64, rows: Vec<(u64, String, Vec<u8>)>) -> Option<Vec<(u64, Vec<Change>)>> {
    let mut changes = Vec::new();
    for (next, (version, format, bytes)) in (known + 1..).zip(rows) {
        if version != next || format != FORMAT {
            break;
        }
        let Ok(of_version) = rmp_serde::from_slice(&bytes) else { break };
        changes.push((next, of_version));
    }
    (!changes.is_empty()).then_some(changes)
}

#[cfg(test)]
mod tests {
    use revisit_core::domain::ids::AnchorSeq;

    use super::*;

    fn row(version: u64, format: &str) -> (u64, String, Vec<u8>) {
        let changes = vec![Change::AnchorTouched(AnchorSeq(3), version)];
        (version, format.to_owned(), to_bytes(&changes).expect("bytes"))
    }

    #[test]
    fn what_follows_a_gap_or_has_another_form_is_not_applied() {
        let versions = |rows| -> Option<Vec<u64>> {
            Some(without_gap(4, rows)?.into_iter().map(|(version, _)| version).collect())
        };
        assert_eq!(versions(vec![row(5, FORMAT), row(6, FORMAT), row(8, FORMAT)]), Some(vec![5, 6]));
        assert_eq!(versions(vec![row(5, FORMAT), row(6, "another")]), Some(vec![5]));
        assert_eq!(versions(vec![row(6, FORMAT)]), None);
        assert_eq!(versions(vec![(5, FORMAT.to_owned(), vec![0xff])]), None);
        assert_eq!(versions(Vec::new()), None);
    }
}
