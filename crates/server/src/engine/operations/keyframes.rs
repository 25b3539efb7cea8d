//! Keyframes: stored and culled.

use std::sync::Arc;

use super::keyframe_reads::report;
use super::named::find;
use super::verdict_record::about;
use crate::domain::anchor::Outcome;
use crate::domain::ids::{KeyframeId, KeyframeSeq, MapId};
use crate::domain::invalid::FieldError;
use crate::domain::keyframe::NewKeyframe;
use crate::domain::report::KeyframeReport;
use crate::domain::request::Digest;
use crate::engine::error::refuse;
use crate::engine::limits::quota::check_keyframe;
use crate::engine::maps::live::{Begun, Decision, LiveMap, State};
use crate::engine::maps::pinned::PinnedMap;
use crate::engine::maps::write_path::Manner;
use crate::engine::tasks::to_its_end;
use crate::engine::vocabulary::{check_global_descriptor, check_vocabulary};
use crate::engine::{QueryAnswer, Result, Service, ServiceError, Stored};
use crate::recognition::anchors::ingest::{ingest, unknown_covisible};
use crate::recognition::anchors::prior_anchors::driven_frame;
use crate::recognition::extensions::changed_signs::{Passage, passages_ended_by};
use crate::recognition::extensions::twins::{Suspects, suspects};
use crate::recognition::map::culling::cull_keyframe;
use crate::recognition::map::index::MapIndex;
use crate::store::NewKeyframeRows;

/// The outcome of a `PUT` under the map's lock.
enum Put {
    Created(KeyframeReport),
    Exists(KeyframeSeq),
}

/// A keyframe that is decided and on its way to the disk.
pub struct PendingKeyframe {
    service: Service,
    live: Arc<LiveMap>,
    keyframe: Arc<NewKeyframe>,
    digest: Digest,
    manner: Manner,
    begun: Begun<Put>,
}

/// The suspects and passages that geometry has to look at once a keyframe is stored.
#[derive(Default)]
struct LeftToVerify {
    /// Views that may be twins of its own (M16).
    suspects: Option<Suspects>,
    /// The passages that it ends (M18).
    passages: Vec<Passage>,
}

/// Maximum attempts of a PUT that begins again because the keyframe that it found was culled before it could be read.
const PUT_AGAIN_MAX: usize = 16;

impl PendingKeyframe {
    /// Waits until it is on disk. If it is new and shows an anchor seen before, a loop check is triggered (§III).
    pub async fn committed(self) -> Result<Stored<KeyframeReport>> {
        let (service, map) = (self.service.clone(), self.live.id.clone());
        let stored = self.stored().await?;
        if stored.created && stored.value.revisits {
            service.trigger_loop_check(&map, &stored.value.keyframe);
        }
        Ok(stored)
    }

    async fn stored(self) -> Result<Stored<KeyframeReport>> {
        let Self { service, live, keyframe, digest, manner, mut begun } = self;
        for _ in 0..PUT_AGAIN_MAX {
            let seq = match begun.committed().await? {
                (Put::Created(mut value), map_version) => {
                    value.map_version = map_version;
                    return Ok(Stored { created: true, value });
                }
                (Put::Exists(seq), _) => seq,
            };
            if let Some(stored) = service.put_again(&live, &keyframe.id, seq, digest).await? {
                return Ok(stored);
            }
            // Culled since it was found: it is not there any more, so this request stores it.
            begun = service.begin_put(&live, keyframe.clone(), digest, manner).await?;
        }
        Err(ServiceError::unavailable(format!("keyframe {} is deleted again and again", keyframe.id)))
    }
}

impl Service {
    /// Stores a keyframe and associates its detections, or finds that this very request had done so.
    pub async fn put_keyframe(
        &self,
        map: &MapId,
        keyframe: NewKeyframe,
        digest: Digest,
    ) -> Result<Stored<KeyframeReport>> {
        let live = self.live(map).await?;
        self.keyframe_begun(live, keyframe, digest, Manner::Prompt).await?.committed().await
    }

    /// Stores a keyframe as [`Self::put_keyframe`] does, and answers the loop query about it, which takes the place of
    /// the one that it may trigger.
    pub async fn put_keyframe_and_query(
        &self,
        map: &MapId,
        keyframe: NewKeyframe,
        digest: Digest,
    ) -> Result<(Stored<KeyframeReport>, QueryAnswer)> {
        let id = keyframe.id.clone();
        let live = self.live(map).await?;
        let stored = self.keyframe_begun(live, keyframe, digest, Manner::Prompt).await?.stored().await?;
        // Listeners are notified of a loop once, not with every retry.
        let answer = if stored.created {
            self.query_and_announce(map, id).await?
        } else {
            self.loop_query(map, about(id)).await?
        };
        Ok((stored, answer))
    }

    /// Returns the first half of [`Self::put_keyframe`]: decided and queued, in the order of calls. Who has many
    /// keyframes begins the next one before the disk has this one, and waits for its turn however long that takes: its
    /// client cannot send more meanwhile.
    pub async fn begin_keyframe(
        &self,
        map: &PinnedMap,
        keyframe: NewKeyframe,
        digest: Digest,
    ) -> Result<PendingKeyframe> {
        let live = self.live_pinned(map).await?;
        self.keyframe_begun(live, keyframe, digest, Manner::Patient).await
    }

    async fn keyframe_begun(
        &self,
        live: Arc<LiveMap>,
        keyframe: NewKeyframe,
        digest: Digest,
        manner: Manner,
    ) -> Result<PendingKeyframe> {
        let keyframe = Arc::new(self.compute_bow(keyframe).await?);
        let begun = self.begin_put(&live, keyframe.clone(), digest, manner).await?;
        Ok(PendingKeyframe { service: self.clone(), live, keyframe, digest, manner, begun })
    }

    /// Decides whether the keyframe is new, and queues it if so. Returns when geometry has looked at what it leaves to verify, so
    /// that the map of a client that sends one keyframe after the other does not depend on how fast it sends them.
    async fn begin_put(
        &self,
        live: &Arc<LiveMap>,
        keyframe: Arc<NewKeyframe>,
        digest: Digest,
        manner: Manner,
    ) -> Result<Begun<Put>> {
        let room = self.room(live.owner).await?;
        let decide = move |index: &mut MapIndex| {
            if let Some(seq) = index.keyframe_seq(&keyframe.id) {
                return Ok(Decision::Unchanged((Put::Exists(seq), LeftToVerify::default())));
            }
            let declared = keyframe.declared().iter().enumerate().map(|(place, (id, _))| (place, id));
            let mut errors = unknown_covisible(index, declared);
            errors.extend(driven_frame(index, &keyframe.session));
            refuse(errors)?;
            check_vocabulary(index, &keyframe)?;
            check_global_descriptor(index, keyframe.global_descriptor.as_ref())?;
            check_keyframe(&room, index, &keyframe)?;
            let ingested = ingest(index, &keyframe);
            let left = LeftToVerify {
                suspects: suspects(index, ingested.keyframe, &keyframe.bow),
                passages: passages_ended_by(index, ingested.keyframe),
            };
            let mut report = report(index, &keyframe.id, ingested.keyframe, &ingested.outcomes);
            report.revisits = ingested.revisits;
            let rows = NewKeyframeRows { keyframe, digest };
            Ok(Decision::Changed((Put::Created(report), left), ingested.decided, Some(rows)))
        };
        let (begun, left) = self.begin(live, manner, decide).await?.split();
        if left.suspects.is_some() || !left.passages.is_empty() {
            let (service, live) = (self.clone(), live.clone());
            let verified = to_its_end(async move { service.verify_what_is_left(&live, left).await });
            // The keyframe is on its way already, and does not depend on it.
            if let Err(error) = verified.await.flatten() {
                tracing::warn!(%error, "twins or signs that changed could not be looked for");
            }
        }
        Ok(begun)
    }

    async fn verify_what_is_left(&self, live: &Arc<LiveMap>, left: LeftToVerify) -> Result<()> {
        if let Some(suspects) = left.suspects {
            self.verify_twins(live, suspects).await?;
        }
        if !left.passages.is_empty() {
            self.judge_signs(live, left.passages).await?;
        }
        Ok(())
    }

    /// Answers a PUT of a keyframe that exists; `None` if it was culled meanwhile.
    async fn put_again(
        &self,
        live: &Arc<LiveMap>,
        id: &KeyframeId,
        seq: KeyframeSeq,
        digest: Digest,
    ) -> Result<Option<Stored<KeyframeReport>>> {
        let Some(row) = self.store.keyframe(live.key, seq).await? else { return Ok(None) };
        if digest != row.digest {
            return Err(ServiceError::Conflict {
                code: "keyframe_exists",
                detail: format!(
                    "keyframe {id} exists and was sent with another body; a keyframe is never changed, only its pose is (POST poses)"
                ),
            });
        }
        let name = id.clone();
        let outcomes: Vec<Outcome> = row.detections.iter().map(|detection| detection.outcome).collect();
        let (map_version, mut value) =
            self.read(live, move |state| Ok(report(&state.index, &name, seq, &outcomes))).await?;
        value.map_version = map_version;
        Ok(Some(Stored { created: false, value }))
    }

    /// Finds the declared covisible keyframes that the map does not have. For bodies with other faults, which never come
    /// before the map: so that a client is told all faults at once.
    pub async fn unknown_covisible(
        &self,
        map: &MapId,
        declared: Vec<(usize, KeyframeId)>,
    ) -> Result<Vec<FieldError>> {
        let live = self.live(map).await?;
        let look = move |state: &State| {
            Ok(unknown_covisible(&state.index, declared.iter().map(|(place, id)| (*place, id))))
        };
        Ok(self.read(&live, look).await?.1)
    }

    /// Culls a keyframe; anchors and covisibility follow.
    pub async fn delete_keyframe(&self, map: &MapId, id: &KeyframeId) -> Result<u64> {
        let live = self.live(map).await?;
        let name = id.clone();
        let (_, seq) = self.read(&live, move |state| find(&state.index, &name)).await?;
        let bow = self.store.bow(live.key, seq).await?.ok_or_else(|| ServiceError::no_keyframe(id))?;
        let name = id.clone();
        let decide = move |index: &mut MapIndex| {
            // Somebody else may have culled it meanwhile, and given its name to another.
            if index.keyframe_seq(&name) != Some(seq) {
                return Err(ServiceError::no_keyframe(&name));
            }
            Ok(Decision::Changed((), cull_keyframe(index, seq, Arc::new(bow)), None))
        };
        let ((), version) = self.begin(&live, Manner::Freeing, decide).await?.committed().await?;
        self.features.forget(live.key, seq).await;
        Ok(version)
    }
}
