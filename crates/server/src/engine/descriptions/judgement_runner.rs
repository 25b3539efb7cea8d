//! The runner of jobs that ask models again: batch after batch, in the background.
//!
//! Everything it needs is on disk, so that a restart goes on where it was: which jobs run, and the question each has
//! come to. A batch's answers and the job's position are one transaction, and an answer that was paid for is in the
//! cache before it is used.

use std::collections::HashMap;
use std::sync::Arc;

use futures_util::future::join_all;

use super::description_job::ModelAnswer;
use crate::domain::ids::{JudgementId, MapId};
use crate::domain::judged::Answer;
use crate::domain::judgement::{JobState, Judgement, JudgementProgress, PastQuestion, Tally};
use crate::engine::maps::live::LiveMap;
use crate::engine::{Result, Service};
use crate::llm::Models;
use crate::recognition::anchors::description_tasks::DescriptionTask;
use crate::recognition::anchors::rejudging::{asked_today, rejudge};
use crate::store::MapKey;

/// Times that a question is asked before the job passes it over, while the model answers others.
const TRIES_MAX: u32 = 8;

/// The runner and its state.
pub(in crate::engine) struct JudgementRunner {
    service: Service,
    models: Arc<Models>,
    /// Times that the next question of a map's job was asked in vain.
    tries: HashMap<MapKey, u32>,
}

impl JudgementRunner {
    /// Creates a runner that has asked nothing yet.
    pub fn new(service: Service, models: Arc<Models>) -> Self {
        Self { service, models, tries: HashMap::new() }
    }

    /// Runs jobs until the server stops.
    pub async fn run(mut self) {
        let rejudging = self.service.rejudging.clone();
        while !rejudging.stop.is_cancelled() {
            let jobs = match self.service.store.running_judgements().await {
                Ok(jobs) => jobs,
                Err(error) => {
                    tracing::error!(%error, "the jobs that ask models again cannot be listed");
                    Vec::new()
                }
            };
            self.tries.retain(|map, _| jobs.iter().any(|(_, key, _)| key == map));
            let (mut went, any) = (false, !jobs.is_empty());
            for (map, key, id) in jobs {
                if rejudging.stop.is_cancelled() {
                    return;
                }
                match self.step(&map, key, &id).await {
                    Ok(goes_on) => went |= goes_on,
                    Err(error) => tracing::warn!(%map, judgement = %id, %error, "a judgement waits"),
                }
            }
            if went {
                continue;
            }
            tokio::select! {
                () = rejudging.stop.cancelled() => {}
                () = rejudging.wake.notified() => {}
                // The model may be back, a new day may bring a new budget: nobody announces either.
                () = tokio::time::sleep(self.models.pause), if any => {}
            }
        }
    }

    /// Asks the next questions of a job, and keeps the answers. Returns whether there may be more at once; else the job waits for
    /// something that nobody announces.
    async fn step(&mut self, map: &MapId, key: MapKey, id: &JudgementId) -> Result<bool> {
        if !self.service.is_here(map).await {
            return Ok(false);
        }
        let live = self.service.live_in_background(map).await?;
        if live.key != key || self.service.pressure.is_high() {
            return Ok(false);
        }
        let Some(job) = self.service.store.judgement(key, id).await? else { return Ok(false) };
        if job.state != JobState::Running {
            return Ok(true);
        }
        let questions = self.questions(&live, &job).await?;
        let mut progress = JudgementProgress {
            id: job.id,
            tally: Tally::default(),
            position: None,
            is_over: questions.is_empty(),
        };
        let mut answers = Vec::new();
        let asked = questions.into_iter().map(|(question, lack)| self.ask(&live, question, lack));
        for (question, outcome) in join_all(asked).await {
            match outcome {
                Outcome::Answered(answer) => answers.push(*answer),
                Outcome::Gone => progress.tally.gone += 1,
                // The order of the questions is the job's position: what follows is asked again, out of the cache.
                Outcome::Unanswered if !self.passes_over(&live) => break,
                Outcome::Unanswered => progress.tally.failed += 1,
            }
            progress.position = Some(question);
        }
        if progress.position.is_none() && !progress.is_over {
            return Ok(false);
        }
        self.service.learn(&live, move |index| Ok(Some(rejudge(index, answers, progress)))).await?;
        self.tries.remove(&live.key);
        Ok(true)
    }

    /// Returns the next questions, each as it is asked today.
    async fn questions(
        &self,
        live: &Arc<LiveMap>,
        job: &Judgement,
    ) -> Result<Vec<(PastQuestion, Option<DescriptionTask>)>> {
        let service = &self.service;
        // One question tells whether a model is back.
        let hands = if service.must_wait(live) { 1 } else { self.models.jobs_at_once };
        let of = service.fingerprints(job.asks);
        let left = service.store.questions_left(live.key, &of, job.position.as_ref(), hands).await?;
        if left.is_empty() {
            return Ok(Vec::new());
        }
        let looked = service.look(live, move |state| {
            Ok(left.into_iter().map(|past| (past.clone(), asked_today(&state.index, &past))).collect())
        });
        Ok(looked.await?.1)
    }

    async fn ask(
        &self,
        live: &Arc<LiveMap>,
        question: PastQuestion,
        lack: Option<DescriptionTask>,
    ) -> (PastQuestion, Outcome) {
        let Some(lack) = lack else { return (question, Outcome::Gone) };
        let outcome = match self.service.ask(live, &self.models, lack).await {
            Ok(Some(ModelAnswer { answer, degraded: false })) => Outcome::Answered(Box::new(answer)),
            Ok(None) => Outcome::Gone,
            // Somebody stood in for the model: the verdict that stands is better.
            Ok(Some(ModelAnswer { degraded: true, .. })) | Err(_) => Outcome::Unanswered,
        };
        (question, outcome)
    }

    /// Whether the job goes on without an answer to its next question: not while no model answers at all.
    fn passes_over(&mut self, live: &LiveMap) -> bool {
        if self.service.must_wait(live) {
            return false;
        }
        let tries = self.tries.entry(live.key).or_default();
        *tries += 1;
        *tries >= TRIES_MAX
    }
}

enum Outcome {
    Answered(Box<Answer>),
    /// The map no longer holds what was asked about.
    Gone,
    Unanswered,
}
