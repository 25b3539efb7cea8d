//! Reads a map's operations, one after the other, in the order of writing.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap, HashSet, VecDeque};
use std::fs::File;

use revisit_core::domain::change::{Change, Loop, ObservationUpdate};
use revisit_core::domain::ids::{
    AnchorSeq, KeyframeId, KeyframeSeq, LoopId, MapId, PriorId, SessionId, SessionSeq,
};
use revisit_core::domain::map::MapProperties;
use revisit_core::domain::prior::{NewPrior, Prior};
use revisit_core::domain::recorded::{NamedDetection, Recorded};
use revisit_core::domain::request::{ChangedKeyframe, ChangedObservations, MapPatch, NewLoop};
use revisit_core::domain::settings::Settings;
use revisit_core::geometry::Sim3;
use sqlx::sqlite::SqlitePoolOptions;

use super::history::History;
use super::introduced::Introduced;
use super::merges::Merges;
use crate::files::lock::DatabaseLock;
use crate::files::paths::DatabaseFiles;
use crate::files::schema;
use crate::log::entry::Entry;
use crate::log::log_rows;
use crate::map_key::MapKey;
use crate::rows::decode;
use crate::rows::model_rows;
use crate::sql::transaction::Transaction;
use crate::sql::{self, Pool, Row};
use crate::{Store, StoreError};

/// A map's operations, read one after the other.
pub struct Export {
    pub(super) db: Transaction,
    pub(super) map: MapKey,
    pub(super) id: MapId,
    /// By dense number.
    pub(super) sessions: Vec<SessionId>,
    pub(super) vocabulary: Option<Box<str>>,
    pub(super) history: History,
    /// The next keyframe, and the version that it made.
    pub(super) keyframe: Option<(u64, Row)>,
    /// The next version that the log tells of, and its entries.
    said: Option<(u64, Vec<Entry<'static>>)>,
    /// Changes of the version that was reached which are left to be told.
    pub(super) changes: VecDeque<Change>,
    /// The version that was reached.
    version: u64,
    /// The last version whose deletion of an object was told.
    deletion: u64,
    /// Prior anchors that were put: their names, and their classes.
    priors: HashMap<AnchorSeq, PriorId>,
    classes: HashMap<AnchorSeq, Box<str>>,
    /// Verdicts and readings of models, by the version that brought them.
    pub(super) models: VecDeque<(u64, Recorded)>,
    pub(super) properties: MapProperties,
    pub(super) introduced: Introduced,
    pub(super) merges: Merges,
    /// Sessions of which a keyframe was exported.
    pub(super) begun: HashSet<SessionSeq>,
    /// Loops that were exported and not revoked.
    pub(super) loops: HashSet<LoopId>,
    /// Operations that come before all that follow.
    pub(super) pending: VecDeque<Recorded>,
    /// Descriptions of anchors whose detections of that time are gone, by the keyframe that sees them first.
    pub(super) waiting: BTreeMap<KeyframeSeq, Vec<Recorded>>,
    /// Keeps a server from starting on a database that is read as if it could not change.
    _closed: Option<File>,
}

impl Store {
    /// Begins to export a map; `None` if there is no such map.
    pub async fn export(&self, id: &MapId) -> Result<Option<Export>, StoreError> {
        let db = self.snapshot().await?;
        Export::begin(db, id).await.map_err(|error| error.of_map(id))
    }
}

impl Export {
    /// Begins to export a map of a database that nobody, or another process, has open; `None` if there is no such map.
    pub async fn of_database(files: &DatabaseFiles, id: &MapId) -> Result<Option<Self>, StoreError> {
        // Without a log nobody has it open, and it is read as if it could not change; the lock keeps a server from starting
        // meanwhile. A copy, which no server ever had, has no lock.
        let closed = if files.wal().exists() { None } else { DatabaseLock::share(files) };
        let is_closed = closed.is_some() || !files.wal().exists() && !files.lock().exists();
        let options = if is_closed { files.read_only().immutable(true) } else { files.untouched(false) };
        let pool = SqlitePoolOptions::new().max_connections(1).connect_with(options).await?;
        schema::expect_newest(&pool).await?;
        let pool = Pool::Sqlite(pool);
        let db = Transaction::read(&pool).await?;
        let export = Self::begin(db, id).await.map_err(|error| error.of_map(id))?;
        Ok(export.map(|export| Self { _closed: closed, ..export }))
    }

    async fn begin(mut db: Transaction, id: &MapId) -> Result<Option<Self>, StoreError> {
        let select = "select map_key, vocabulary from maps where id = $1 and deleted = 0";
        let Some((map, vocabulary)) = sql::query_as(select).bind(id).fetch_optional(&mut *db).await? else {
            db.commit().await?;
            return Ok(None);
        };
        let select = "select id from sessions where map_key = $1 order by session";
        let sessions = sql::query_scalar(select).bind(map).fetch_all(&mut *db).await?;
        let properties = MapProperties { metric: true, ..MapProperties::default() };
        let history = History::rewind(&mut db, map).await?;
        let mut export = Self {
            map,
            id: id.clone(),
            sessions,
            vocabulary,
            introduced: Introduced::of(&mut db, map, history.is_whole).await?,
            history,
            keyframe: None,
            said: log_rows::after(&mut db, map, 0).await?,
            changes: VecDeque::new(),
            version: 0,
            deletion: 0,
            priors: HashMap::new(),
            classes: HashMap::new(),
            models: model_rows::by_version(&mut db, map).await?.into(),
            properties,
            merges: Merges::default(),
            begun: HashSet::new(),
            loops: HashSet::new(),
            pending: VecDeque::new(),
            waiting: BTreeMap::new(),
            _closed: None,
            db,
        };
        export.keyframe = export.keyframe_after(-1).await?;
        Ok(Some(export))
    }

    /// Returns the transformation of a loop that is still closed, if it has one.
    async fn measured(&mut self, id: &LoopId) -> Result<Option<Sim3>, StoreError> {
        let select = "select * from loops where map_key = $1 and id = $2";
        let query = sql::query(select).bind(self.map).bind(id);
        let row = query.fetch_optional(&mut *self.db).await?;
        let closed = row.map(|row| decode::closed_loop(&row)).transpose()?;
        Ok(closed.and_then(|closed| closed.candidate_from_query))
    }

    /// Reads the next operation; `None` after the last.
    pub async fn next(&mut self) -> Result<Option<Recorded>, StoreError> {
        loop {
            let step = self.step().await.map_err(|error| error.of_map(&self.id))?;
            match step {
                Step::Operation(recorded) => return Ok(Some(*recorded)),
                Step::LeftOut => {}
                Step::End => return Ok(None),
            }
        }
    }

    async fn step(&mut self) -> Result<Step, StoreError> {
        if let Some(recorded) = self.pending.pop_front() {
            return Ok(Step::of(recorded));
        }
        if let Some(change) = self.changes.pop_front() {
            return self.operation(change).await;
        }
        let keyframe = self.keyframe.as_ref().map(|(version, _)| *version);
        let said = self.said.as_ref().map(|(version, _)| *version);
        let models = self.models.front().map(|(version, _)| *version);
        let Some(version) = [keyframe, said, models].into_iter().flatten().min() else {
            return self.last_correction().await;
        };
        self.version = version;
        if let Some((_, entries)) = self.said.take_if(|(said, _)| *said == version) {
            self.said = log_rows::after(&mut self.db, self.map, version).await?;
            self.history.advance(&entries);
            let changes: Vec<Change> =
                entries.into_iter().flat_map(|entry| entry.changes).map(Cow::into_owned).collect();
            return self.reach(changes, keyframe == Some(version)).await;
        }
        if keyframe == Some(version) {
            return self.keyframe().await;
        }
        let said = self.models.pop_front().map(|(_, said)| Box::new(said));
        Ok(said.map_or(Step::LeftOut, Step::Operation))
    }

    /// Returns what a client said of its points and edges, as far as the keyframes are still there.
    async fn observations(&mut self, update: ObservationUpdate) -> Result<Step, StoreError> {
        let ObservationUpdate { session, replaced, removed, keyframes: updates } = update;
        let mut keyframes = Vec::with_capacity(updates.len());
        for update in updates {
            let Some((_, keyframe)) = self.named(update.keyframe).await? else { continue };
            let mut covisible = Vec::with_capacity(update.covisible.len());
            for (other, shared) in update.covisible {
                covisible.extend(self.named(other).await?.map(|(_, id)| (id, shared)));
            }
            keyframes.push(ChangedKeyframe { keyframe, observes: update.observes, covisible });
        }
        if !self.begun.contains(&session)
            || (keyframes.is_empty() && replaced.is_empty() && removed.is_empty())
        {
            return Ok(Step::LeftOut);
        }
        let session = self.session(session)?.clone();
        let changed = ChangedObservations { session, replaced, removed, keyframes };
        Ok(Step::of(Recorded::Observations(changed)))
    }

    async fn operation(&mut self, change: Change) -> Result<Step, StoreError> {
        Ok(match change {
            Change::MapSet(now) => {
                let patch = difference(&self.properties, &now);
                self.properties = *now;
                Step::of(Recorded::Map(patch))
            }
            Change::ObservationsSent(update) => self.observations(*update).await?,
            Change::SessionsMerged(merge) => self.merge(*merge)?,
            Change::MergeRevoked(undo) => self.revoke_merge(undo.session)?,
            Change::LoopAdded(Loop { id, keyframe, candidate, query, .. }) => {
                let (keyframe, candidate) = (self.named(keyframe).await?, self.named(candidate).await?);
                let (Some((_, keyframe)), Some((_, candidate))) = (keyframe, candidate) else {
                    return Ok(Step::LeftOut);
                };
                self.loops.insert(id.clone());
                let candidate_from_query = self.measured(&id).await?;
                Step::of(Recorded::Loop(NewLoop { id, keyframe, candidate, query, candidate_from_query }))
            }
            Change::LoopRemoved(id) if self.loops.remove(&id) => Step::of(Recorded::LoopRevoked(id)),
            Change::DescriptionSet(anchor, text) => {
                let Some((keyframe, of_version, detection)) = self.detection_of(anchor).await? else {
                    return Ok(Step::LeftOut);
                };
                let described = Recorded::Description { detection, text: text.map(Into::into) };
                if of_version <= self.version {
                    return Ok(Step::of(described));
                }
                self.waiting.entry(keyframe).or_default().push(described);
                Step::LeftOut
            }
            Change::AnchorAdded(anchor, class) => {
                self.classes.insert(anchor, class);
                Step::LeftOut
            }
            Change::PriorSet(anchor, prior) => {
                let Prior { id, frame, description, position_in_frame, normal_in_frame, source } = *prior;
                let class = self.classes.remove(&anchor).unwrap_or_default().into();
                self.priors.insert(anchor, id.clone());
                let (description, source) = (description.into(), source.map(Into::into));
                let frame = self.session(frame)?.clone();
                let put =
                    NewPrior { id, class, description, position_in_frame, frame, normal_in_frame, source };
                Step::of(Recorded::Prior(put))
            }
            Change::AnchorRemoved(anchor) => self.anchor_removed(anchor).await?,
            _ => Step::LeftOut,
        })
    }

    /// Takes the deletion of an object. Where its anchors are removed one by one, the first that has a detection tells.
    async fn anchor_removed(&mut self, anchor: AnchorSeq) -> Result<Step, StoreError> {
        if let Some(prior) = self.priors.remove(&anchor) {
            self.pending.push_back(Recorded::PriorDeleted(prior));
        }
        let select = "select k.id, d.detection from detections d
            join keyframes k on k.map_key = d.map_key and k.keyframe = d.keyframe
            where d.map_key = $1 and d.deleted_in = $2 order by d.keyframe, d.detection limit 1";
        let query = sql::query_as(select).bind(self.map).bind(self.version);
        let Some((keyframe, number)) = query.fetch_optional(&mut *self.db).await? else {
            return Ok(Step::LeftOut);
        };
        if self.deletion == self.version {
            return Ok(Step::LeftOut);
        }
        self.deletion = self.version;
        Ok(Step::of(Recorded::AnchorDeleted(NamedDetection { keyframe, number })))
    }

    /// Returns the oldest detection that feeds an anchor, or fed it until it was deleted, with its keyframe and the
    /// version of that.
    async fn detection_of(
        &mut self,
        anchor: AnchorSeq,
    ) -> Result<Option<(KeyframeSeq, u64, NamedDetection)>, StoreError> {
        let select = "select k.keyframe, k.version, k.id, d.detection from detections d
            join keyframes k on k.map_key = d.map_key and k.keyframe = d.keyframe
            where d.map_key = $1 and (d.anchor = $2 or d.deleted_anchor = $2)
            order by d.keyframe, d.detection limit 1";
        let query = sql::query_as(select).bind(self.map).bind(anchor);
        let found = query.fetch_optional(&mut *self.db).await?;
        let named = |(seq, version, keyframe, number)| (seq, version, NamedDetection { keyframe, number });
        Ok(found.map(named))
    }

    /// Returns a keyframe's session and name, if it is still there.
    pub(super) async fn named(
        &mut self,
        keyframe: KeyframeSeq,
    ) -> Result<Option<(SessionSeq, KeyframeId)>, StoreError> {
        let select = "select session, id from keyframes where map_key = $1 and keyframe = $2";
        let query = sql::query_as(select).bind(self.map).bind(keyframe);
        let found = query.fetch_optional(&mut *self.db).await?;
        Ok(found.map(|(session, id)| (self.merges.session_of(keyframe, session), id)))
    }

    pub(super) fn session(&self, session: SessionSeq) -> Result<&SessionId, StoreError> {
        let unknown = || StoreError::corrupt(format!("session number {} is not there", session.0));
        self.sessions.get(session.index()).ok_or_else(unknown)
    }

    pub(super) async fn keyframe_after(&mut self, last: i64) -> Result<Option<(u64, Row)>, StoreError> {
        let select = "select * from keyframes where map_key = $1 and keyframe > $2 order by keyframe limit 1";
        let row = sql::query(select).bind(self.map).bind(last).fetch_optional(&mut *self.db).await?;
        row.map(|row| Ok((row.try_get("version")?, row))).transpose()
    }
}

/// One step of an export.
pub(super) enum Step {
    Operation(Box<Recorded>),
    /// Its subject is deleted.
    LeftOut,
    End,
}

impl Step {
    pub(super) fn of(recorded: Recorded) -> Self {
        Self::Operation(Box::new(recorded))
    }
}

/// Returns the changes that turn one set of properties into another.
fn difference(before: &MapProperties, now: &MapProperties) -> MapPatch {
    let differs = |row: &&revisit_core::domain::settings::Setting| {
        before.settings.get(row.name) != now.settings.get(row.name)
    };
    MapPatch {
        description: (before.description != now.description).then(|| now.description.clone()),
        anchor_classes: (before.anchor_classes != now.anchor_classes).then(|| now.anchor_classes.clone()),
        code_classes: (before.code_classes != now.code_classes).then(|| now.code_classes.clone()),
        metric: (before.metric != now.metric).then_some(now.metric),
        gravity: now.gravity.filter(|_| before.gravity != now.gravity),
        settings: Settings::TABLE
            .iter()
            .filter(differs)
            .filter_map(|row| Some((row.name.to_owned(), now.settings.get(row.name)?)))
            .collect(),
    }
}
