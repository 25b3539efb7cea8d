//! Sources of facts: the maps of this server, and those of others, for copies.

use revisit_core::domain::change::Change;
use revisit_core::domain::ids::MapId;

use super::facts::{FactSource, MapFacts, Order};
use super::loading::load::{Db, facts_of, load, map_row};
use super::postgres::change_log;
use super::{Store, StoreError};

impl FactSource for &Store {
    async fn load(
        &mut self,
        id: &MapId,
        order: Order,
        take: impl FnMut(Vec<Change>) + Send,
    ) -> Result<Option<MapFacts>, StoreError> {
        // One read transaction, so that the facts are those of one version of the map.
        let mut db = self.snapshot().await?;
        let facts = load(&mut db, id, order, take).await?;
        self.expect_ours(&mut db, facts.as_ref()).await?;
        db.commit().await?;
        Ok(facts)
    }
}

/// The facts of maps that another server owns, for copies. This server may come to own a map while they are read.
#[derive(Debug)]
pub struct FactsForCopies<'s>(pub &'s Store);

impl FactSource for FactsForCopies<'_> {
    async fn load(
        &mut self,
        id: &MapId,
        order: Order,
        take: impl FnMut(Vec<Change>) + Send,
    ) -> Result<Option<MapFacts>, StoreError> {
        let mut db = self.0.snapshot().await?;
        let facts = load(&mut db, id, order, take).await?;
        db.commit().await?;
        Ok(facts)
    }
}

impl Store {
    /// Returns the row of a map of this server, without its changes; `None` unless its count of rewrites is still `rewrites`.
    pub async fn map_facts(&self, id: &MapId, rewrites: i64) -> Result<Option<MapFacts>, StoreError> {
        let mut db = self.snapshot().await?;
        let mut facts = None;
        if let Some(row) = map_row(&mut db, id).await? {
            facts = Some(facts_of(&mut db, &row).await.map_err(|error| error.of_map(id))?);
        }
        self.expect_ours(&mut db, facts.as_ref()).await?;
        let rewritten = match &facts {
            Some(facts) => change_log::rewrites(&mut db, facts.key).await?,
            None => 0,
        };
        db.commit().await?;
        Ok(facts.filter(|_| rewritten == rewrites))
    }

    async fn expect_ours(&self, db: &mut Db, facts: Option<&MapFacts>) -> Result<(), StoreError> {
        match (&self.leases, facts) {
            (Some(leases), Some(facts)) => leases.expect_ours(db, facts.key).await,
            _ => Ok(()),
        }
    }
}
