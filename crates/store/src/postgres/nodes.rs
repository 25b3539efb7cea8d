//! The servers that share a database: which are there, and where the others reach them.

use std::time::Duration;

use revisit_core::domain::ids::MapId;

use super::leases::{Lease, Leases, Taken};
use super::schema;
use crate::sql::{self, Pool};
use crate::{Store, StoreError};

/// A server counts as gone so long after it was last heard of.
const NODE_LASTS: Duration = Duration::from_secs(10);

/// Rows of servers that are gone are removed after this time.
const NODE_KEPT: Duration = Duration::from_hours(1);

/// A server that shares this database.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// Made up when it starts.
    pub id: String,
    /// The address at which others reach it: `http://HOST:PORT`.
    pub address: String,
    /// Shown by their requests, so that it knows them.
    pub secret: String,
}

impl Node {
    /// Returns a server with a secret that nobody can guess.
    pub fn new(id: &str, address: String) -> Self {
        Self { id: id.to_owned(), address, secret: random_name() }
    }
}

/// A server that is there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LiveNode {
    /// The server.
    pub node: Node,
    /// The time from the question on for which it counts as there without another renewal.
    pub lasts: Duration,
}

/// The owner of a map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Owner {
    /// This server, or one whose lease has run out, or nobody.
    Free,
    /// Another server, by its id; with its row where it was heard of lately.
    Other(String, Option<Node>),
}

/// The owner of a map, its address and its secret.
type OwnerRow = (Option<String>, Option<String>, Option<String>);

impl Store {
    /// Returns the leases of this server; none where it alone has the database.
    pub fn leases(&self) -> Option<&Leases> {
        self.leases.as_deref()
    }

    /// Takes a map, unless another server has it. Without other servers a map needs no lease.
    pub async fn take(&self, id: &MapId) -> Result<Option<Taken>, StoreError> {
        match &self.leases {
            Some(leases) => leases.take(&self.readers, id).await.map(Some),
            None => Ok(None),
        }
    }

    /// Removes the rows of servers that were at an address before: whoever starts there knows that they are gone. Their leases run out.
    pub async fn succeed(&self, node: &Node) -> Result<(), StoreError> {
        let Some(leases) = &self.leases else { return Ok(()) };
        let delete = "delete from nodes where address = $1 and node <> $2";
        sql::query(delete).bind(&node.address).bind(&node.id).execute(leases.pool()).await?;
        Ok(())
    }

    /// Says that a server is there, extends its leases, and returns all that are there.
    pub async fn renew(&self, node: &Node) -> Result<Vec<LiveNode>, StoreError> {
        let Some(leases) = &self.leases else { return Ok(Vec::new()) };
        let upsert = "insert into nodes (node, address, secret, schema, expires)
            values ($1, $2, $3, $4, clock_timestamp() + make_interval(secs => $5))
            on conflict (node) do update set address = excluded.address, expires = excluded.expires";
        let query = sql::query(upsert).bind(&node.id).bind(&node.address).bind(&node.secret);
        query.bind(schema::newest()).bind(NODE_LASTS.as_secs_f64()).execute(leases.pool()).await?;
        leases.renew().await?;
        let sweep = "delete from nodes where expires < clock_timestamp() - make_interval(secs => $1)";
        sql::query(sweep).bind(NODE_KEPT.as_secs_f64()).execute(leases.pool()).await?;
        // Copies that a server did not complete before it went: `copying//` and its id begin their own.
        let copies = "update maps set deleted = 1, id = 'deleted//' || map_key
            where deleted = 2 and substr(id, 10, 32) not in (select node from nodes)";
        sql::query(copies).execute(leases.pool()).await?;
        live_nodes(leases.pool()).await
    }

    /// Returns the servers that are there. Renewals have a connection of their own and do not wait for this.
    pub async fn live_nodes(&self) -> Result<Vec<LiveNode>, StoreError> {
        live_nodes(&self.readers).await
    }

    /// Returns who owns a map now; `None` if there is no such map.
    pub async fn owner(&self, id: &MapId) -> Result<Option<Owner>, StoreError> {
        let Some(leases) = &self.leases else { return Ok(Some(Owner::Free)) };
        let select = "select case when o.expires > clock_timestamp() then o.owner end, n.address, n.secret
            from maps m left join map_owners o using (map_key)
            left join nodes n on n.node = o.owner and n.expires > clock_timestamp()
            where m.id = $1 and m.deleted = 0";
        let found: Option<OwnerRow> =
            sql::query_as(select).bind(id.as_str()).fetch_optional(&self.readers).await?;
        Ok(found.map(|(owner, address, secret)| match owner {
            Some(id) if id != leases.node() => {
                let node = address.zip(secret);
                Owner::Other(id.clone(), node.map(|(address, secret)| Node { id, address, secret }))
            }
            _ => Owner::Free,
        }))
    }

    /// Gives a map back, of which nothing is under way.
    pub async fn give_back(&self, lease: &Lease) -> Result<(), StoreError> {
        match &self.leases {
            Some(leases) => leases.give_back(lease).await,
            None => Ok(()),
        }
    }

    /// Gives all maps back, and says that this server is gone.
    pub async fn leave(&self) -> Result<(), StoreError> {
        let Some(leases) = &self.leases else { return Ok(()) };
        leases.give_all_back().await?;
        sql::query("delete from nodes where node = $1").bind(leases.node()).execute(leases.pool()).await?;
        Ok(())
    }
}

async fn live_nodes(pool: &Pool) -> Result<Vec<LiveNode>, StoreError> {
    let select =
        "select node, address, secret, cast(extract(epoch from expires - clock_timestamp()) as float8)
        from nodes where expires > clock_timestamp() order by node";
    let rows: Vec<(String, String, String, f64)> = sql::query_as(select).fetch_all(pool).await?;
    let nodes = rows.into_iter().map(|(id, address, secret, lasts_s)| LiveNode {
        node: Node { id, address, secret },
        lasts: Duration::try_from_secs_f64(lasts_s).unwrap_or_default(),
    });
    Ok(nodes.collect())
}

/// Returns a name that nobody else has, and nobody can guess: 128 random bits.
pub(crate) fn random_name() -> String {
    format!("{:032x}", rand::random::<u128>())
}
