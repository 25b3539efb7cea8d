//! One job of the worker: a model is asked for what an anchor lacks, and its answer becomes a change of the map.

use std::sync::Arc;

use tokio::task::spawn_blocking;

use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::domain::judge_answer::{Judged, Merged};
use crate::domain::judged::{Answer, CropRead, CropReading, Finding, ModelVerdict, TranscriptStep};
use crate::domain::judgement::{PastQuestion, TextFunction};
use crate::engine::maps::live::{Decision, LiveMap};
use crate::engine::{Result, Service, ServiceError};
use crate::llm::Models;
use crate::llm::dialogue::{Described, Describer};
use crate::llm::judge::Judge;
use crate::llm::picture::Picture;
use crate::llm::port::Fault;
use crate::recognition::anchors::apply_model_answer::{Learned, learn_away, learn_reading, learn_verdict};
use crate::recognition::anchors::description_tasks::DescriptionTask;
use crate::recognition::anchors::rejudging::asked_today;
use crate::recognition::map::index::MapIndex;

/// Who says that a crop is no image.
const DECODER: &str = "revisit";

/// What came of a question.
pub(in crate::engine) struct ModelAnswer {
    pub answer: Answer,
    /// Whether somebody stood in for a model that did not answer.
    pub degraded: bool,
}

impl Service {
    /// Asks for what is lacking and keeps the answer; an error if it must be asked for again.
    pub(in crate::engine) async fn give(
        &self,
        live: &Arc<LiveMap>,
        models: &Models,
        lack: DescriptionTask,
    ) -> Result<(), Fault> {
        // It was found in the map as it was before: an erasure may have come between.
        if let Some(question) = about_texts(&lack) {
            let look = self.look(live, move |state| Ok(asked_today(&state.index, &question).is_some()));
            if !look.await?.1 {
                return Ok(());
            }
        }
        let Some(ModelAnswer { answer, degraded }) = self.ask(live, models, lack).await? else {
            return Ok(());
        };
        let learned = match answer {
            // A reader's word is better than none until the model is back.
            Answer::Reading(read) => self.learn(live, move |index| Ok(learn_reading(index, read))).await,
            // A verdict of the built-in judge in the model's place is not kept.
            Answer::Verdict(_) if degraded => return Err(Fault::Away),
            Answer::Verdict(verdict) => {
                self.learn(live, move |index| Ok(learn_verdict(index, verdict))).await
            }
        };
        match learned {
            // The map is gone, and the question with it.
            Ok(_) | Err(ServiceError::NotFound(_)) => {}
            Err(error) => return Err(error.into()),
        }
        if degraded { Err(Fault::Away) } else { Ok(()) }
    }

    /// Asks a model, at the expense of the map's owner; `None` if the question is about a crop that is gone, or its
    /// answer changes no map.
    pub(in crate::engine) async fn ask(
        &self,
        live: &Arc<LiveMap>,
        models: &Models,
        lack: DescriptionTask,
    ) -> Result<Option<ModelAnswer>, Fault> {
        if live.is_over() {
            // What it lacked may be erased by now, and its answer would be kept.
            return Err(Fault::Store("the map was thrown away, and is loaded anew".to_owned()));
        }
        let payer = self.payer(live.owner);
        let judge = Judge { patience: None, ..models.judge.paid_by(payer) };
        let fingerprint: Arc<str> = models.fingerprints().texts.unwrap_or_default().into();
        let (class, a, b, finding, source, reason, degraded) = match lack {
            DescriptionTask::Embedding { text } => {
                if let Some(embeddings) = &models.embeddings {
                    embeddings.take(&text, payer).await?;
                }
                return Ok(None);
            }
            DescriptionTask::Reading { anchor, keyframe, detection, class, hint } => {
                let at = (anchor, keyframe, detection);
                let describer = models.describer.paid_by(payer);
                return self.ask_about_crop(live, describer, at, &class, hint.as_deref()).await;
            }
            DescriptionTask::Information { class, text } => {
                let Judged { level, source, reason, degraded, .. } = judge.information(&class, &text).await;
                (class, text, "".into(), Finding::Information(level), source, reason, degraded)
            }
            DescriptionTask::Similarity { class, a, b } => {
                let Judged { level, source, reason, degraded, .. } = judge.similarity(&class, &a, &b).await;
                (class, a, b, Finding::Similarity(level), source, reason, degraded)
            }
            DescriptionTask::Merge { class, a, b, as_read: [first, second] } => {
                let Merged { text, source, degraded, .. } = judge.merge(&class, &first, &second).await;
                (class, a, b, Finding::Merge(text.into()), source, String::new(), degraded)
            }
        };
        let (source, reason) = (source.into(), reason.into());
        let verdict = ModelVerdict { class, a, b, finding, source, reason, fingerprint };
        Ok(Some(ModelAnswer { answer: Answer::Verdict(verdict), degraded }))
    }

    async fn ask_about_crop(
        &self,
        live: &Arc<LiveMap>,
        describer: Describer,
        (anchor, keyframe, detection): (AnchorSeq, KeyframeSeq, u16),
        class: &str,
        hint: Option<&str>,
    ) -> Result<Option<ModelAnswer>, Fault> {
        // Culled meanwhile: nothing is lacking any more.
        let Some(crop) = self.store.crop(live.key, keyframe, detection).await? else { return Ok(None) };
        let decoded = spawn_blocking(move || Picture::decode(&crop.bytes)).await;
        let (reading, transcript) =
            match decoded.map_err(|_| Fault::Store("the decoder broke off".to_owned()))? {
                Ok(picture) => describer.describe(Arc::new(picture), class, hint).await?,
                Err(error) => undecodable(error.to_string()),
            };
        let degraded = reading.degraded;
        let fingerprint = describer.fingerprint().unwrap_or_default().into();
        let read = CropRead { anchor, keyframe, detection, reading, transcript, fingerprint };
        Ok(Some(ModelAnswer { answer: Answer::Reading(read), degraded }))
    }

    /// Checks what a model said against the map as it is now and applies it; what it triggers is asked about, and twins of what
    /// was read are looked for. Returns the map's version, and whether that changed anything.
    pub(in crate::engine) async fn learn(
        &self,
        live: &Arc<LiveMap>,
        learn: impl FnOnce(&mut MapIndex) -> Result<Option<Learned>> + Send + 'static,
    ) -> Result<(u64, bool)> {
        let decide = move |index: &mut MapIndex| {
            Ok(match learn(index)? {
                Some(Learned { decided, triggers, read }) => {
                    Decision::Changed(Some((triggers, read)), decided, None)
                }
                None => Decision::Unchanged(None),
            })
        };
        let (learned, version) = self.change(live, decide).await?;
        let Some((triggers, read)) = learned else { return Ok((version, false)) };
        self.trigger(&live.id, triggers);
        if let Some(keyframe) = read {
            self.look_for_twins(live, keyframe).await;
        }
        Ok((version, true))
    }

    /// Has a map that was just taken wait for no model, if this server has none. A server that alone has the database tells all maps
    /// when it starts.
    pub(in crate::engine) async fn wait_for_no_model(&self, live: &Arc<LiveMap>) {
        let is_told = self.models.is_some() || !self.store.is_shared() || self.follows || live.is_release();
        if is_told || live.glance(|state| state.index.model_away()).is_none_or(|(_, waits)| !waits) {
            return;
        }
        if let Err(error) = self.tell_away(live, false).await {
            tracing::warn!(map = %live.id, %error, "a map still waits for a model that this server has not");
        }
    }

    /// Has a map record whether it waits for a model that is away.
    pub(super) async fn tell_away(&self, live: &Arc<LiveMap>, away: bool) -> Result<()> {
        let decide = move |index: &mut MapIndex| Ok(Decision::of((), learn_away(index, away)));
        self.change(live, decide).await.map(drop)
    }
}

fn undecodable(answer: String) -> Described {
    let step = TranscriptStep { speaker: DECODER.into(), question: "(decoding the crop)".to_owned(), answer };
    let reading = CropReading { text: "".into(), source: DECODER.into(), described: false, degraded: false };
    (reading, vec![step])
}

/// Returns the question of a task, if it is about texts of one class.
fn about_texts(lack: &DescriptionTask) -> Option<PastQuestion> {
    let (function, class, a, b) = match lack {
        DescriptionTask::Information { class, text } => (TextFunction::Information, class, text, ""),
        DescriptionTask::Similarity { class, a, b } => (TextFunction::Similarity, class, a, &**b),
        DescriptionTask::Merge { class, a, b, .. } => (TextFunction::Merge, class, a, &**b),
        DescriptionTask::Reading { .. } | DescriptionTask::Embedding { .. } => return None,
    };
    Some(PastQuestion::Texts { function, class: class.clone(), a: a.clone(), b: b.into() })
}
