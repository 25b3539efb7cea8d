//! Operations, as rows: what was said of a map beside keyframes and corrections, in the order in which it was said.

use serde::{Deserialize, Serialize};

use super::json;
use super::statement::run;
use crate::domain::change::{ObservationUpdate, SessionMerge};
use crate::domain::ids::{AnchorSeq, KeyframeSeq, LoopId, PriorId, SessionSeq};
use crate::domain::map::MapProperties;
use crate::domain::prior::Prior;
use crate::store::StoreError;
use crate::store::commit::job::MapKey;
use crate::store::sql::{self, Connection};

/// An operation, with the dense numbers of that time.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "operation", rename_all = "snake_case")]
pub(in crate::store) enum Operation {
    /// The map's properties are these from then on.
    Map(MapProperties),
    /// The client's map changed what keyframes of a session observe.
    Observations(ObservationUpdate),
    /// The same, not read yet: a map has thousands, and some are large.
    #[serde(skip)]
    ObservationsUnread,
    /// A session merged into another one.
    MergeSessions(SessionMerge),
    /// A merge of sessions was revoked.
    MergeRevoked { session: SessionSeq },
    /// A loop was confirmed between two keyframes.
    Loop { id: LoopId, keyframe: KeyframeSeq, candidate: KeyframeSeq, query: Option<String> },
    /// A loop was revoked.
    LoopRevoked { id: LoopId },
    /// An anchor was described by hand, or given back to its readings.
    Description { anchor: AnchorSeq, text: Option<Box<str>> },
    /// An anchor was deleted, with those merged into it: their detections say so.
    AnchorDeleted {},
    /// A prior anchor of this class was put.
    Prior {
        class: String,
        #[serde(flatten)]
        prior: Prior,
    },
    /// A prior anchor was deleted.
    PriorDeleted { id: PriorId },
}

impl Operation {
    fn name(&self) -> &'static str {
        match self {
            Self::Map(_) => "map",
            Self::Observations(_) | Self::ObservationsUnread => OBSERVATIONS,
            Self::MergeSessions(_) => "merge_sessions",
            Self::MergeRevoked { .. } => "merge_revoked",
            Self::Loop { .. } => "loop",
            Self::LoopRevoked { .. } => "loop_revoked",
            Self::Description { .. } => "description",
            Self::AnchorDeleted {} => "anchor_deleted",
            Self::Prior { .. } => "prior",
            Self::PriorDeleted { .. } => "prior_deleted",
        }
    }
}

/// The name of what changes observations.
const OBSERVATIONS: &str = "observations";

/// Adds an operation. Of one kind a version has one: of an object whose anchors are removed one by one, the first tells.
pub(in crate::store) async fn add(
    db: &mut Connection,
    (map, version): (MapKey, u64),
    operation: &Operation,
) -> Result<(), StoreError> {
    let body = json::text(operation)?;
    let insert = "insert into operations (map_key, version, operation, body) values ($1, $2, $3, $4)
        on conflict do nothing";
    let query = sql::query(insert).bind(map).bind(version as i64).bind(operation.name());
    run(db, query.bind(body)).await
}

/// Returns the operations of a map, in their order.
pub(in crate::store) async fn all(
    db: &mut Connection,
    map: MapKey,
) -> Result<Vec<(u64, Operation)>, StoreError> {
    // A map comes before all that is in it.
    let select =
        "select version, case when operation = $2 then null else body end from operations where map_key = $1
        order by version, operation <> 'map', operation";
    let query = sql::query_as(select).bind(map).bind(OBSERVATIONS);
    let rows: Vec<(i64, Option<String>)> = query.fetch_all(db).await?;
    let read = |(version, body): (i64, Option<String>)| {
        let operation = body.map_or(Ok(Operation::ObservationsUnread), |body| json::value(&body))?;
        Ok((version as u64, operation))
    };
    rows.into_iter().map(read).collect()
}

/// Reads what changed observations in a version.
pub(in crate::store) async fn observations(
    db: &mut Connection,
    (map, version): (MapKey, u64),
) -> Result<Operation, StoreError> {
    let select = "select body from operations where map_key = $1 and version = $2 and operation = $3";
    let query = sql::query_scalar(select).bind(map).bind(version as i64).bind(OBSERVATIONS);
    let body: String = query.fetch_one(db).await?;
    json::value(&body)
}
