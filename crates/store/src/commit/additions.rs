//! Additions: rows that the jobs of a group add, gathered and written with few statements.
//!
//! Each statement is a way to SQLite's thread and back, which costs as much as a row. So what only adds rows waits here;
//! anything else is done after what was gathered before it, and the rows are those of jobs done one by one.

use std::collections::{BTreeMap, HashSet};

use revisit_core::domain::event::Event;
use revisit_core::domain::ids::{AnchorSeq, PointId, SessionId, SessionSeq};
use revisit_core::geometry::Point3;

use crate::StoreError;
use crate::columns::bulk_insert::{RowValues, write_rows};
use crate::columns::clock::micros_now;
use crate::jobs::job::Batch;
use crate::loading::deferred;
use crate::map_key::MapKey;
use crate::rows::keyframe_rows::{self, Arrived, Detected};
use crate::rows::map_rows;
use crate::rows::point_blocks;
use crate::rows::verdict_rows::{self, KeptQuery};
use crate::sql::run;
use crate::sql::{self, Connection};

/// Events of a map are kept up to this number, oldest out first.
const EVENTS_KEPT: u64 = 100_000;

/// Events between two removals of old ones.
const EVENTS_SWEPT_EVERY: u64 = 256;

/// Rows gathered from the jobs of a group, not written yet.
#[derive(Default)]
pub(crate) struct Additions<'j> {
    /// The last batch of each map.
    advanced: BTreeMap<MapKey, &'j Batch>,
    pub(super) sessions: Vec<(MapKey, SessionSeq, &'j SessionId)>,
    pub(super) keyframes: Vec<Arrived<'j>>,
    pub(super) anchors: Vec<(MapKey, AnchorSeq, &'j str)>,
    detections: Vec<Detected<'j>>,
    pub(super) points: Vec<(MapKey, SessionSeq, PointId, Point3)>,
    /// The last version of each anchor.
    pub(super) touched: BTreeMap<(MapKey, AnchorSeq), u64>,
    events: Vec<(MapKey, &'j Event)>,
    queries: Vec<KeptQuery<'j>>,
    /// Maps that have no deferred changes, as far as was asked.
    not_deferring: HashSet<MapKey>,
}

impl<'j> Additions<'j> {
    /// Takes a map's version after a batch, with what follows from its facts.
    pub(crate) fn advance(&mut self, batch: &'j Batch) {
        self.advanced.insert(batch.map, batch);
    }

    /// Takes detections. Their keyframe and the anchors that they name are taken or written before.
    pub(crate) fn detect(&mut self, rows: Vec<Detected<'j>>) {
        self.detections.extend(rows);
    }

    /// Takes events of a map.
    pub(crate) fn tell(&mut self, map: MapKey, events: &'j [Event]) {
        self.events.extend(events.iter().map(|event| (map, event)));
    }

    /// Takes the answer of a loop query.
    pub(crate) fn keep(&mut self, query: KeptQuery<'j>) {
        self.queries.push(query);
    }

    /// Returns whether a map has deferred changes; asked once while nothing but additions is written.
    pub(crate) async fn defers(&mut self, db: &mut Connection, map: MapKey) -> Result<bool, StoreError> {
        if self.not_deferring.contains(&map) {
            return Ok(false);
        }
        let defers = deferred::any(db, map).await?;
        if !defers {
            self.not_deferring.insert(map);
        }
        Ok(defers)
    }

    /// Writes what is gathered: each row after those that it refers to.
    pub(crate) async fn write(self, db: &mut Connection) -> Result<(), StoreError> {
        if !self.advanced.is_empty() {
            map_rows::advance(db, self.advanced.into_values()).await?;
        }
        let sessions = "insert into sessions (map_key, session, id) ";
        write_rows(db, sessions, "", &self.sessions, |row, (map, seq, id)| {
            row.push_bind(*map).push_bind(*seq).push_bind(*id);
        })
        .await?;
        keyframe_rows::add_keyframes(db, &self.keyframes).await?;
        let anchors = "insert into anchors (map_key, anchor, class, version) ";
        write_rows(db, anchors, "", &self.anchors, |row, (map, seq, class)| {
            row.push_bind(*map).push_bind(*seq).push_bind(*class).push_bind(1);
        })
        .await?;
        keyframe_rows::add_detections(db, &self.detections).await?;
        for of_map in self.points.chunk_by(|a, b| a.0 == b.0) {
            let points = of_map.iter().map(|(_, session, id, at)| (*session, *id, Some(*at)));
            point_blocks::change(db, of_map[0].0, points).await?;
        }
        let touched: Vec<_> = self.touched.into_iter().collect();
        let set = "update anchors set version = column3 from (";
        let of = ") as given where anchors.map_key = column1 and anchors.anchor = column2";
        write_rows(db, set, of, &touched, |row, ((map, anchor), version)| {
            row.push_bind(*map).push_bind(*anchor).push_bind(*version);
        })
        .await?;
        add_events(db, &self.events).await?;
        verdict_rows::keep(db, &self.queries).await
    }
}

async fn add_events(db: &mut Connection, events: &[(MapKey, &Event)]) -> Result<(), StoreError> {
    let head = "insert into events (map_key, seq, kind, map_version, anchor, other, keyframe, candidate, loop_id, query, session,
        into_session, detail, told_us) ";
    let now = micros_now();
    let push = |row: &mut RowValues, (map, event): &(MapKey, &Event)| {
        row.push_bind(*map).push_bind(event.seq).push_bind(event.kind).push_bind(event.map_version);
        row.push_bind(event.anchor).push_bind(event.other);
        row.push_bind(event.keyframe.as_ref()).push_bind(event.candidate.as_ref());
        row.push_bind(event.loop_id.as_ref()).push_bind(&event.query);
        row.push_bind(event.session.as_ref()).push_bind(event.into.as_ref());
        row.push_bind(&event.detail).push_bind(now);
    };
    write_rows(db, head, "", events, push).await?;
    for (map, event) in events.iter().filter(|(_, event)| event.seq.is_multiple_of(EVENTS_SWEPT_EVERY)) {
        let sweep = "delete from events where map_key = $1 and seq <= $2";
        run(db, sql::statement(sweep, (map, event.seq.saturating_sub(EVENTS_KEPT)))).await?;
    }
    Ok(())
}
