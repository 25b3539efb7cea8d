//! Points that exported operations have brought.

use std::collections::HashSet;

use futures_util::TryStreamExt as _;
use revisit_core::domain::ids::{PointId, SessionSeq};
use revisit_core::domain::session_merge::Renumbering;

use crate::StoreError;
use crate::loading::read;
use crate::map_key::MapKey;
use crate::sql::{self, Connection};

/// The points that exported operations have brought. In a map of which nothing is missing each keyframe brings its own,
/// and each correction is there, so that nothing need be counted.
pub(super) struct Introduced {
    /// Those that a keyframe which is there was sent with.
    sent: HashSet<(SessionSeq, PointId)>,
    brought: HashSet<(SessionSeq, PointId)>,
    are_counted: bool,
}

impl Introduced {
    /// Returns none yet, of a map whose history is whole or not.
    pub(super) async fn of(db: &mut Connection, map: MapKey, is_whole: bool) -> Result<Self, StoreError> {
        // Where a keyframe was deleted, or history was not kept once, what brought a point may not be exported.
        let select = "select next_keyframe > (select count(*) from keyframes k where k.map_key = m.map_key)
            from maps m where map_key = $1";
        let misses: bool = sql::query_scalar(select).bind(map).fetch_one(&mut *db).await?;
        let are_counted = misses || !is_whole;
        let mut sent = HashSet::new();
        if are_counted {
            let select = "select session, sent_points from keyframes where map_key = $1 order by keyframe";
            let mut rows = sql::query(select).bind(map).fetch(db);
            while let Some(row) = rows.try_next().await? {
                let session = row.try_get("session")?;
                sent.extend(read::sent_points(&row)?.into_iter().map(|id| (session, id)));
            }
        }
        Ok(Self { sent, brought: HashSet::new(), are_counted })
    }

    pub(super) fn add(&mut self, session: SessionSeq, points: impl Iterator<Item = PointId>) {
        if self.are_counted {
            self.brought.extend(points.map(|id| (session, id)));
        }
    }

    /// Takes a merge of sessions: points that were brought to one are the other's by now.
    pub(super) fn merge(&mut self, session: SessionSeq, into: SessionSeq, numbers: &Renumbering) {
        let of_session = self.sent.iter().chain(&self.brought).filter(|(of, _)| *of == session);
        let number = numbers.number();
        let moved: Vec<PointId> = of_session.map(|(_, id)| number(*id)).collect();
        self.brought.extend(moved.into_iter().map(|id| (into, id)));
    }

    /// Of the points that a keyframe names, those that nobody else has brought or will bring. It brings them now.
    pub(super) fn left_behind(
        &self,
        session: SessionSeq,
        named: impl Iterator<Item = PointId>,
    ) -> Vec<PointId> {
        let is_left_behind = |id: &PointId| {
            let point = (session, *id);
            self.are_counted && !self.sent.contains(&point) && !self.brought.contains(&point)
        };
        let mut left_behind: Vec<PointId> = named.filter(is_left_behind).collect();
        left_behind.sort_unstable();
        left_behind.dedup();
        left_behind
    }
}
