//! One job of the worker: a model is asked for what an anchor lacks, and its answer becomes a change of the map.

use std::sync::Arc;

use tokio::task::spawn_blocking;

use super::live::{Decision, LiveMap};
use super::{Service, ServiceError};
use crate::model::ids::{AnchorSeq, KeyframeSeq};
use crate::model::judged::{CropRead, CropReading, Finding, ModelVerdict, TranscriptStep};
use crate::models::Models;
use crate::models::dialogue::{Describer, Told};
use crate::models::picture::Picture;
use crate::models::port::Fault;
use crate::recognition::index::MapIndex;
use crate::recognition::lacking::Lack;
use crate::recognition::learning::{Learned, learn_reading, learn_verdict};

/// Who says that a crop is no image.
const DECODER: &str = "revisit";

impl Service {
    /// Asks for what is lacking and keeps the answer; an error if it must be asked for again.
    pub(super) async fn give(&self, live: &Arc<LiveMap>, models: &Models, lack: Lack) -> Result<(), Fault> {
        let payer = self.payer(live.owner);
        let judge = models.judge.paid_by(payer.clone());
        match lack {
            Lack::Reading { anchor, keyframe, detection, class, hint } => {
                let at = (anchor, keyframe, detection);
                self.give_reading(live, models.describer.paid_by(payer), at, &class, hint.as_deref()).await
            }
            Lack::Information { class, text } => {
                let judged = judge.information(&class, &text, None).await;
                let finding = Finding::Information(judged.level);
                let b = "".into();
                let verdict = ModelVerdict { class, a: text, b, finding, source: judged.source.into() };
                self.give_verdict(live, verdict, judged.degraded).await
            }
            Lack::Similarity { class, a, b } => {
                let judged = judge.similarity(&class, &a, &b, None).await;
                let finding = Finding::Similarity(judged.level);
                let verdict = ModelVerdict { class, a, b, finding, source: judged.source.into() };
                self.give_verdict(live, verdict, judged.degraded).await
            }
            Lack::Merge { class, a, b, as_read: [first, second] } => {
                let merged = judge.merge(&class, &first, &second, None).await;
                let finding = Finding::Merge(merged.text.into());
                let verdict = ModelVerdict { class, a, b, finding, source: merged.source.into() };
                self.give_verdict(live, verdict, merged.degraded).await
            }
        }
    }

    async fn give_reading(
        &self,
        live: &Arc<LiveMap>,
        describer: Describer,
        (anchor, keyframe, detection): (AnchorSeq, KeyframeSeq, u16),
        class: &str,
        hint: Option<&str>,
    ) -> Result<(), Fault> {
        let crop = self.store.crop(live.key, keyframe, detection).await;
        // Culled meanwhile: nothing is lacking any more.
        let Some(crop) = crop.map_err(|error| Fault::Store(error.to_string()))? else { return Ok(()) };
        let decoded = spawn_blocking(move || Picture::decode(&crop.bytes)).await;
        let told = match decoded.map_err(|_| Fault::Store("the decoder broke off".to_owned()))? {
            Ok(picture) => describer.describe(Arc::new(picture), class, hint).await?,
            Err(error) => undecodable(error.to_string()),
        };
        let degraded = told.degraded;
        let reading =
            CropReading { text: told.text.into(), source: told.source, described: told.described, degraded };
        let read = CropRead { anchor, keyframe, detection, reading, transcript: told.transcript };
        self.learn(live, move |index| learn_reading(index, read)).await?;
        if degraded { Err(Fault::Away) } else { Ok(()) }
    }

    /// A verdict of the built-in judge in the model's place is not kept: the model is asked again.
    async fn give_verdict(
        &self,
        live: &Arc<LiveMap>,
        verdict: ModelVerdict,
        degraded: bool,
    ) -> Result<(), Fault> {
        if degraded {
            return Err(Fault::Away);
        }
        self.learn(live, move |index| learn_verdict(index, verdict)).await
    }

    /// Checks a verdict against the map as it is now and applies it; what it triggers is asked about.
    pub(super) async fn learn(
        &self,
        live: &Arc<LiveMap>,
        learn: impl FnOnce(&mut MapIndex) -> Option<Learned> + Send + 'static,
    ) -> Result<(), Fault> {
        let decide = move |index: &mut MapIndex| {
            Ok(match learn(index) {
                Some(Learned { decided, triggers }) => Decision::Changed(triggers, decided, None),
                None => Decision::Unchanged(Vec::new()),
            })
        };
        let (triggers, _) = match self.change(live, decide).await {
            Ok(changed) => changed,
            // The map is gone, and the question with it.
            Err(ServiceError::NotFound(_)) => return Ok(()),
            Err(error) => return Err(error.into()),
        };
        self.trigger(&live.id, triggers);
        Ok(())
    }
}

fn undecodable(answer: String) -> Told {
    let step = TranscriptStep { speaker: DECODER.into(), question: "(decoding the crop)".to_owned(), answer };
    Told {
        text: String::new(),
        source: DECODER.into(),
        described: false,
        degraded: false,
        transcript: vec![step],
    }
}
