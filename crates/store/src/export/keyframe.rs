//! A keyframe as it was sent: its row, with the pose and the positions of that time.

use revisit_core::domain::change::Keyframe;
use revisit_core::domain::ids::{KeyframeId, KeyframeSeq, PointId};
use revisit_core::domain::keyframe::{Crop, Detection, NewKeyframe};
use revisit_core::domain::recorded::Recorded;
use revisit_core::domain::request::PoseCorrection;

use super::operation_reader::{Export, Step};
use crate::StoreError;
use crate::loading::read;
use crate::rows::decode;
use crate::sql::{self, Row};

/// The most points of one line; a keyframe that inherits more gives the rest to a correction.
const POINTS_MAX: usize = 100_000;

impl Export {
    /// Takes the next keyframe.
    pub(super) async fn keyframe(&mut self) -> Result<Step, StoreError> {
        let Some((_, row)) = self.keyframe.take() else { return Ok(Step::LeftOut) };
        let number: i64 = row.try_get("keyframe")?;
        let sent = self.as_sent(&row).await;
        let mut sent = sent.map_err(|error| error.of_row(format!("keyframe number {number}")))?;
        self.keyframe = self.keyframe_after(number).await?;
        let more = sent.map_points.split_off(sent.map_points.len().min(POINTS_MAX));
        for map_points in more.chunks(POINTS_MAX) {
            let (session, map_points) = (sent.session.clone(), map_points.to_vec());
            let correction = PoseCorrection { session, keyframes: Vec::new(), map_points };
            self.pending.push_back(Recorded::Poses(correction));
        }
        let seq = row.try_get("keyframe")?;
        self.pending.extend(self.waiting.remove(&seq).into_iter().flatten());
        Ok(Step::of(Recorded::Keyframe(Box::new(sent))))
    }

    async fn as_sent(&mut self, row: &Row) -> Result<NewKeyframe, StoreError> {
        let (mut keyframe, bow) = decode::keyframe(row)?;
        let (seq, session) = (keyframe.seq, keyframe.session);
        if let Some(pose) = self.history.pose(seq) {
            keyframe.move_to(&pose);
        }
        self.begun.insert(session);
        self.merges.add_keyframe(session);
        let select = "select * from keyframe_features where map_key = $1 and keyframe = $2";
        let features = sql::query(select).bind(self.map).bind(seq).fetch_optional(&mut *self.db).await?;
        let observes: Vec<PointId> = keyframe.observes.iter().collect();
        let detections = self.detections(&keyframe).await?;
        let mut points = read::sent_points(row)?;
        let of_detections = detections.iter().flat_map(|detection| detection.map_points.iter());
        points.extend(self.introduced.left_behind(session, observes.iter().chain(of_detections).copied()));
        let mut map_points = self.history.points(&mut self.db, session, &points).await?;
        map_points.sort_unstable_by_key(|(id, _)| *id);
        self.introduced.add(session, map_points.iter().map(|(id, _)| *id));
        Ok(NewKeyframe {
            vocabulary: self.vocabulary.clone().filter(|_| !bow.is_empty()),
            bow,
            global_descriptor: decode::global_descriptor(row)?,
            features: features.as_ref().map(read::features).transpose()?,
            map_points,
            observes,
            covisible: match &keyframe.declared {
                Some(listed) => Some(self.declared(listed).await?),
                None => None,
            },
            detections,
            ..keyframe.without_lists(self.session(session)?.clone())
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

    async fn detections(&mut self, keyframe: &Keyframe) -> Result<Vec<Detection>, StoreError> {
        let select = "select * from detections where map_key = $1 and keyframe = $2 order by detection";
        let rows = sql::query(select).bind(self.map).bind(keyframe.seq).fetch_all(&mut *self.db).await?;
        let mut detections = Vec::with_capacity(rows.len());
        for row in &rows {
            detections.push(read::detection(row)?.detection);
        }
        keyframe.place(&mut detections);
        if detections.is_empty() {
            return Ok(detections);
        }
        let select = "select detection, bytes from crops where map_key = $1 and keyframe = $2";
        let crops: Vec<(u16, Vec<u8>)> =
            sql::query_as(select).bind(self.map).bind(keyframe.seq).fetch_all(&mut *self.db).await?;
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
