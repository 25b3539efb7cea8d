//! Operations, as rows: what was said of a map beside keyframes and corrections, in the order in which it was said.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::map_rows;
use super::statement::run;
use crate::domain::change::{KeyframeUpdate, Loop, ObservationUpdate, SessionMerge};
use crate::domain::ids::{AnchorSeq, LoopId};
use crate::domain::map::MapProperties;
use crate::domain::prior::Prior;
use crate::domain::session_merge::Renumbering;
use crate::store::StoreError;
use crate::store::commit::job::MapKey;
use crate::store::sql::{self, Connection};

/// An operation, with the dense numbers of that time.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "operation", rename_all = "snake_case")]
pub(in crate::store) enum Operation {
    /// The map's properties are these from then on; of its settings those that differ from their defaults.
    Map {
        description: String,
        metric: bool,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        gravity: Option<[f64; 3]>,
        anchor_classes: Vec<String>,
        code_classes: Vec<String>,
        settings: BTreeMap<String, String>,
    },
    /// The client's map changed what keyframes of a session observe.
    Observations {
        session: u32,
        replaced: Vec<(i64, i64)>,
        removed: Vec<i64>,
        keyframes: Vec<ChangedKeyframeRow>,
    },
    /// The same, not read yet: a map has thousands, and some are large.
    #[serde(skip)]
    ObservationsUnread,
    /// A session merged into another one.
    MergeSessions {
        session: u32,
        into: u32,
        next_keyframe: u32,
        scale: f64,
        translation: [f64; 3],
        rotation: [f64; 4],
        #[serde(default, skip_serializing_if = "Option::is_none")]
        offset: Option<i64>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        listed: Option<Vec<(i64, i64)>>,
    },
    /// A merge of sessions was revoked.
    MergeRevoked { session: u32 },
    /// A loop was confirmed between two keyframes.
    Loop { id: String, keyframe: u32, candidate: u32, query: Option<String> },
    /// A loop was revoked.
    LoopRevoked { id: String },
    /// An anchor was described by hand, or given back to its readings.
    Description { anchor: u32, text: Option<String> },
    /// An anchor was deleted, with those merged into it: their detections say so.
    AnchorDeleted {},
    /// A prior anchor was put, in the frame of this session.
    Prior {
        id: String,
        class: String,
        frame: u32,
        description: String,
        position: [f64; 3],
        normal: Option<[f64; 3]>,
        source: Option<String>,
    },
    /// A prior anchor was deleted.
    PriorDeleted { id: String },
}

/// A keyframe as a client changed it: what it observes, if it said so, and whom it is covisible with, by how many shared points.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::store) struct ChangedKeyframeRow {
    pub keyframe: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub observes: Option<Vec<i64>>,
    pub covisible: Vec<(u32, u32)>,
}

impl Operation {
    fn name(&self) -> &'static str {
        match self {
            Self::Map { .. } => "map",
            Self::Observations { .. } | Self::ObservationsUnread => OBSERVATIONS,
            Self::MergeSessions { .. } => "merge_sessions",
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

impl From<&MapProperties> for Operation {
    fn from(properties: &MapProperties) -> Self {
        Self::Map {
            description: properties.description.clone(),
            metric: properties.metric,
            gravity: properties.gravity.map(|gravity| gravity.as_given()),
            anchor_classes: properties.anchor_classes.clone(),
            code_classes: properties.code_classes.clone(),
            settings: map_rows::chosen(&properties.settings)
                .map(|(name, value)| (name.to_owned(), value))
                .collect(),
        }
    }
}

impl From<&ObservationUpdate> for Operation {
    fn from(update: &ObservationUpdate) -> Self {
        let keyframe = |of: &KeyframeUpdate| ChangedKeyframeRow {
            keyframe: of.keyframe.0,
            observes: of.observes.clone(),
            covisible: of.covisible.iter().map(|(other, shared)| (other.0, *shared)).collect(),
        };
        Self::Observations {
            session: update.session.0,
            replaced: update.replaced.clone(),
            removed: update.removed.clone(),
            keyframes: update.keyframes.iter().map(keyframe).collect(),
        }
    }
}

impl From<&SessionMerge> for Operation {
    fn from(merge: &SessionMerge) -> Self {
        let (offset, listed) = match &merge.map_points {
            Renumbering::Same => (None, None),
            Renumbering::Offset(offset) => (Some(*offset), None),
            Renumbering::Listed(pairs) => (None, Some(pairs.clone())),
        };
        Self::MergeSessions {
            session: merge.session.0,
            into: merge.into.0,
            next_keyframe: merge.next_keyframe.0,
            scale: merge.into_from_session.scale(),
            translation: merge.into_from_session.translation_m(),
            rotation: merge.into_from_session.rotation_xyzw(),
            offset,
            listed,
        }
    }
}

impl From<&Loop> for Operation {
    fn from(closed: &Loop) -> Self {
        Self::Loop {
            id: closed.id.as_str().to_owned(),
            keyframe: closed.keyframe.0,
            candidate: closed.candidate.0,
            query: closed.query.clone(),
        }
    }
}

/// Notes that a loop was revoked.
pub(in crate::store) fn revoked(id: &LoopId) -> Operation {
    Operation::LoopRevoked { id: id.as_str().to_owned() }
}

/// Notes what an anchor was called by hand.
pub(in crate::store) fn described(anchor: AnchorSeq, text: Option<&str>) -> Operation {
    Operation::Description { anchor: anchor.0, text: text.map(str::to_owned) }
}

/// Notes that a prior anchor was put.
pub(in crate::store) fn prior(class: String, prior: &Prior) -> Operation {
    let at = prior.position_in_frame;
    Operation::Prior {
        id: prior.id.to_string(),
        class,
        frame: prior.frame.0,
        description: prior.description.to_string(),
        position: [at.x, at.y, at.z],
        normal: prior.normal_in_frame,
        source: prior.source.as_ref().map(ToString::to_string),
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
    let body = serde_json::to_string(operation).map_err(|error| StoreError::Database(error.to_string()))?;
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
        let operation = body.map_or(Ok(Operation::ObservationsUnread), |body| read(version, &body))?;
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
    read(version as i64, &body)
}

fn read(version: i64, body: &str) -> Result<Operation, StoreError> {
    serde_json::from_str(body)
        .map_err(|error| StoreError::corrupt(format!("the operation of version {version}: {error}")))
}
