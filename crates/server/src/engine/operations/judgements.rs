//! Verdicts of models: those that a client brings, applied as if a model had answered here, and jobs that ask a changed model
//! again: counted beforehand, started, read, stopped.

use super::named::no_keyframe_of_map;
use crate::domain::ids::{JudgementId, MapId};
use crate::domain::judged::{CropRead, CropReading};
use crate::domain::judgement::{Asks, JobState, Judgement, Tally};
use crate::domain::named_detection::NamedDetection;
use crate::domain::report::JudgementReport;
use crate::domain::request::{NewJudgement, NewVerdict};
use crate::engine::maps::live::LiveMap;
use crate::engine::{Result, Service, ServiceError, Stored};
use crate::recognition::anchors::apply_model_answer::{learn_reading, learn_verdict};
use crate::recognition::map::index::MapIndex;
use crate::store::{Fingerprints, Job};

/// A job shows at most this number of the verdicts that it replaced.
const REPLACED_SHOWN: usize = 100;

impl Service {
    /// Applies what a model said elsewhere. Returns the map's version, and whether it changed anything.
    pub async fn bring_verdict(&self, map: &MapId, new: NewVerdict) -> Result<(u64, bool)> {
        let live = self.live(map).await?;
        let learn = move |index: &mut MapIndex| match new {
            NewVerdict::OfTexts(verdict) => Ok(learn_verdict(index, verdict)),
            NewVerdict::OfCrop(named, reading) => {
                Ok(crop_read(index, &named, reading)?.and_then(|read| learn_reading(index, read)))
            }
        };
        self.learn(&live, learn).await
    }

    /// Starts a job that asks again about all that other models or prompts answered, or counts what it would ask.
    /// One job of a map runs at a time. The id of a job that is there already is answered with that job.
    pub async fn judge_again(&self, map: &MapId, new: NewJudgement) -> Result<Stored<JudgementReport>> {
        let live = self.live(map).await?;
        // Two requests at once would both find no job running.
        let _starting = self.starting.lock().await;
        if let Some(id) = new.id.as_ref().filter(|_| !new.preview)
            && let Some(known) = self.store.judgement(live.key, id).await?
        {
            if known.asks != new.asks {
                let detail = format!("judgement {id} was started with another body");
                return Err(ServiceError::Conflict { code: "conflict", detail });
            }
            return Ok(Stored { created: false, value: self.report(&live, known).await? });
        }
        let workload = self.store.workload(live.key, &self.fingerprints(new.asks)).await?;
        let estimate =
            self.models.as_ref().map_or_else(Default::default, |models| models.estimate(&workload));
        let map_version = live.newest_version();
        let questions = workload.questions();
        if new.preview {
            let asks = new.asks;
            let value = JudgementReport { map_version, asks, questions, estimate, ..Default::default() };
            return Ok(Stored { created: false, value });
        }
        let (number, running) = self.store.next_judgement(live.key).await?;
        if let Some(running) = running {
            let detail = format!("judgement {running} of this map is running; wait for it, or stop it");
            return Err(ServiceError::Conflict { code: "conflict", detail });
        }
        let id = match new.id {
            Some(id) => id,
            None => self.free_id(&live, number).await?,
        };
        let state = if questions == 0 { JobState::Done } else { JobState::Running };
        let (asks, since_version, tally, position) = (new.asks, map_version, Tally::default(), None);
        let job = Judgement { id, asks, state, since_version, questions, estimate, tally, position };
        self.disk_takes(false).await?;
        self.store.committer().commit(Job::StartJudgement(live.key, Box::new(job.clone()))).await?;
        self.rejudging.wake();
        Ok(Stored { created: true, value: self.report(&live, job).await? })
    }

    /// Returns a job as it stands.
    pub async fn judgement(&self, map: &MapId, id: &JudgementId) -> Result<JudgementReport> {
        let live = self.live(map).await?;
        let job = self.find_judgement(&live, id).await?;
        self.report(&live, job).await
    }

    /// Stops a job. What it has learned stays; a job that has ended stays as it is.
    pub async fn stop_judgement(&self, map: &MapId, id: &JudgementId) -> Result<JudgementReport> {
        let live = self.live(map).await?;
        self.find_judgement(&live, id).await?;
        self.store.committer().commit(Job::StopJudgement(live.key, id.clone())).await?;
        self.rejudging.wake();
        let job = self.find_judgement(&live, id).await?;
        self.report(&live, job).await
    }

    /// Returns the fingerprints of the models that a job would ask.
    pub(in crate::engine) fn fingerprints(&self, asks: Asks) -> Fingerprints {
        let models = self.models.as_ref();
        models.map_or_else(Fingerprints::default, |models| models.fingerprints().concerned(asks))
    }

    /// Whether no model can be asked about a map now.
    pub(in crate::engine) fn must_wait(&self, live: &LiveMap) -> bool {
        let Some(models) = &self.models else { return true };
        let is_spent = |payer| models.budget().is_spent_for(&payer);
        models.is_away() || self.payer(live.owner).is_some_and(is_spent)
    }

    async fn find_judgement(&self, live: &LiveMap, id: &JudgementId) -> Result<Judgement> {
        let found = self.store.judgement(live.key, id).await?;
        found.ok_or_else(|| ServiceError::NotFound(format!("there is no judgement {id} in this map")))
    }

    /// Finds an id for a job that its client gave none: `j-7`, unless a client took that one.
    async fn free_id(&self, live: &LiveMap, mut number: u64) -> Result<JudgementId> {
        loop {
            let id: JudgementId = format!("j-{number}")
                .parse()
                .map_err(|_| ServiceError::Internal("a number that makes no id".to_owned()))?;
            if self.store.judgement(live.key, &id).await?.is_none() {
                return Ok(id);
            }
            number += 1;
        }
    }

    async fn report(&self, live: &LiveMap, job: Judgement) -> Result<JudgementReport> {
        let replaced = self.store.replaced(live.key, job.since_version, REPLACED_SHOWN).await?;
        Ok(JudgementReport {
            map_version: live.newest_version(),
            waits: job.state == JobState::Running && self.must_wait(live),
            id: Some(job.id),
            asks: job.asks,
            state: Some(job.state),
            questions: job.questions,
            estimate: job.estimate,
            tally: job.tally,
            replaced,
        })
    }
}

/// Returns the reading of a crop with the anchor that its detection feeds; `None` if it feeds none.
fn crop_read(index: &MapIndex, named: &NamedDetection, reading: CropReading) -> Result<Option<CropRead>> {
    let Some(keyframe) = index.keyframe_seq(&named.keyframe) else {
        return Err(no_keyframe_of_map("/keyframe", &named.keyframe).into());
    };
    let at = (keyframe, named.number);
    let feeds = |anchor: &crate::domain::ids::AnchorSeq| {
        index.anchor(*anchor).is_some_and(|anchor| anchor.observations.contains_key(&at))
    };
    let anchor = index.anchors_seen_by(keyframe).find(feeds);
    Ok(anchor.map(|anchor| CropRead {
        anchor,
        keyframe,
        detection: named.number,
        reading,
        transcript: Vec::new(),
        // No model of this server said it: a job that asks again asks for it, too.
        fingerprint: "".into(),
    }))
}
