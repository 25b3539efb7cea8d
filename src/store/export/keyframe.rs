//! A keyframe as it was sent: its row, with the pose and the positions of that time.

use std::collections::HashSet;

use sqlx::sqlite::SqliteRow;
use sqlx::{Row as _, SqliteConnection};

use super::{Export, Step};
use crate::model::ids::{KeyframeId, KeyframeSeq, PointId, SessionSeq};
use crate::model::keyframe::{Crop, Detection, NewKeyframe};
use crate::model::recorded::Recorded;
use crate::store::job::MapKey;
use crate::store::{StoreError, decode, read};

/// The points that exported operations have brought; nothing where no keyframe was ever deleted, for then each keyframe
/// brings its own.
pub(super) struct Introduced {
    /// Those that a keyframe which is there was sent with.
    sent: HashSet<(SessionSeq, PointId)>,
    brought: HashSet<(SessionSeq, PointId)>,
    were_deleted: bool,
}

impl Introduced {
    pub(super) async fn of(db: &mut SqliteConnection, map: MapKey) -> Result<Self, StoreError> {
        let select = "select next_keyframe > (select count(*) from keyframes k where k.map_key = m.map_key)
            from maps m where map_key = $1";
        let were_deleted = sqlx::query_scalar(select).bind(map).fetch_one(&mut *db).await?;
        let mut this = Self { sent: HashSet::new(), brought: HashSet::new(), were_deleted };
        let select = "select session, sent_points, keyframe from keyframes
            where map_key = $1 and keyframe > $2 order by keyframe limit 256";
        let mut last = -1_i64;
        while were_deleted {
            let rows = sqlx::query(select).bind(map).bind(last).fetch_all(&mut *db).await?;
            let Some(row) = rows.last() else { break };
            last = row.try_get("keyframe")?;
            for row in &rows {
                let session = SessionSeq(row.try_get("session")?);
                this.sent.extend(read::sent_points(row)?.into_iter().map(|id| (session, id)));
            }
        }
        Ok(this)
    }

    pub(super) fn add(&mut self, session: SessionSeq, points: impl Iterator<Item = PointId>) {
        if self.were_deleted {
            self.brought.extend(points.map(|id| (session, id)));
        }
    }

    /// The points that a keyframe observes, and that only deleted keyframes had brought. It brings them now.
    fn left_behind(&mut self, session: SessionSeq, observes: &[PointId]) -> Vec<PointId> {
        if !self.were_deleted {
            return Vec::new();
        }
        let left_behind = |id: &PointId| !self.sent.contains(&(session, *id));
        let candidates: Vec<PointId> = observes.iter().copied().filter(left_behind).collect();
        candidates.into_iter().filter(|id| !self.brought.contains(&(session, *id))).collect()
    }
}

impl Export {
    /// Takes the next keyframe.
    pub(super) async fn keyframe(&mut self) -> Result<Step, StoreError> {
        let Some((_, row)) = self.keyframe.take() else { return Ok(Step::LeftOut) };
        let number: i64 = row.try_get("keyframe")?;
        let sent = self.as_sent(&row).await;
        let sent = sent.map_err(|error| error.of_row(format!("keyframe number {number}")))?;
        self.keyframe = self.keyframe_after(number).await?;
        Ok(Step::of(Recorded::Keyframe(Box::new(sent))))
    }

    async fn as_sent(&mut self, row: &SqliteRow) -> Result<NewKeyframe, StoreError> {
        let (keyframe, bow) = decode::keyframe(row)?;
        let (seq, session) = (keyframe.seq, keyframe.session);
        self.begun.insert(session);
        let select = "select * from keyframe_features where map_key = $1 and keyframe = $2";
        let features = sqlx::query(select).bind(self.map).bind(seq.0).fetch_optional(&mut *self.db).await?;
        let observes: Vec<PointId> = keyframe.observes.iter().collect();
        let mut points = read::sent_points(row)?;
        let left_behind = self.introduced.left_behind(session, &observes);
        points.extend(&left_behind);
        let mut map_points = self.history.points(&mut self.db, session, &points).await?;
        map_points.sort_unstable_by_key(|(id, _)| *id);
        self.introduced.add(session, map_points.iter().map(|(id, _)| *id));
        Ok(NewKeyframe {
            id: keyframe.id,
            session: self.session(session)?.clone(),
            stamp: keyframe.stamp,
            map_from_camera: self.history.pose(seq).unwrap_or(keyframe.map_from_camera),
            camera: keyframe.camera,
            vocabulary: self.vocabulary.clone().filter(|_| !bow.is_empty()),
            bow,
            features: features.as_ref().map(read::features).transpose()?,
            map_points,
            observes,
            covisible: self.declared(&keyframe.declared).await?,
            detections: self.detections(seq).await?,
        })
    }

    async fn declared(
        &mut self,
        declared: &[(KeyframeSeq, u32)],
    ) -> Result<Vec<(KeyframeId, u32)>, StoreError> {
        let mut named = Vec::with_capacity(declared.len());
        for (keyframe, shared) in declared {
            named.extend(self.named(*keyframe).await?.map(|(_, id)| (id, *shared)));
        }
        Ok(named)
    }

    async fn detections(&mut self, keyframe: KeyframeSeq) -> Result<Vec<Detection>, StoreError> {
        let select = "select * from detections where map_key = $1 and keyframe = $2 order by detection";
        let rows = sqlx::query(select).bind(self.map).bind(keyframe.0).fetch_all(&mut *self.db).await?;
        let mut detections = Vec::with_capacity(rows.len());
        for row in &rows {
            let number: u16 = row.try_get("detection")?;
            let mut detection = read::detection(row)?.detection;
            detection.position_in_session =
                self.history.position(keyframe, number).or(detection.position_in_session);
            detections.push(detection);
        }
        if detections.is_empty() {
            return Ok(detections);
        }
        let select = "select detection, bytes from crops where map_key = $1 and keyframe = $2";
        let crops: Vec<(u16, Vec<u8>)> =
            sqlx::query_as(select).bind(self.map).bind(keyframe.0).fetch_all(&mut *self.db).await?;
        for (number, bytes) in crops {
            let unknown = || StoreError::corrupt(format!("the crop of detection {number} is no image"));
            let media_type = Crop::media_type_of(&bytes).ok_or_else(unknown)?;
            if let Some(detection) = detections.get_mut(usize::from(number)) {
                detection.crop = Some(Crop { media_type, bytes });
            }
        }
        Ok(detections)
    }
}
