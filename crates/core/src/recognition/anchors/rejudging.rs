//! Asking again about what a map's verdicts say: a question as it stands now, and what new answers change.

use std::collections::BTreeSet;

use super::apply_model_answer::{Learned, learn_verdict, replace_reading};
use super::description_tasks::DescriptionTask;
use crate::domain::change::Change;
use crate::domain::ids::KeyframeId;
use crate::domain::judged::Answer;
use crate::domain::judgement::{JudgementProgress, PastQuestion, TextFunction};
use crate::recognition::map::index::{MapIndex, MergedAnchor};
use crate::recognition::map::recorder::{Decided, Recorder};

/// Returns a past question as a model is asked today; `None` if the map no longer holds what it is about.
pub fn asked_today(index: &MapIndex, question: &PastQuestion) -> Option<DescriptionTask> {
    let (function, class, a, b) = match question {
        PastQuestion::Texts { function, class, a, b } => (*function, class, a, b),
        PastQuestion::Crop { keyframe, detection } => {
            let at = (*keyframe, *detection);
            let anchor = index.fed_by(at)?;
            return Some(DescriptionTask::Reading {
                anchor,
                keyframe: at.0,
                detection: at.1,
                class: index.anchor(anchor)?.class.clone(),
                hint: index.observation(anchor, at)?.reading.clone(),
            });
        }
    };
    let of_class = index.objects().iter().map(|(_, object)| object);
    let mut of_class = of_class.filter(|object| index.class_of(object) == &**class);
    let says_both = |object: &&MergedAnchor| object.votes.says(a) && object.votes.says(b);
    match function {
        TextFunction::Information => {
            let called = |object: &MergedAnchor| {
                object.description.as_ref().is_some_and(|d| d.text.normalised() == &**a)
            };
            of_class
                .any(called)
                .then(|| DescriptionTask::Information { class: class.clone(), text: a.clone() })
        }
        TextFunction::Merge => {
            let votes = &of_class.find(says_both)?.votes;
            let as_read = [votes.as_read(a)?, votes.as_read(b)?].map(Into::into);
            Some(DescriptionTask::Merge { class: class.clone(), a: a.clone(), b: b.clone(), as_read })
        }
        TextFunction::Similarity => {
            let texts = index.texts();
            let carried = |text: &str| texts.find_normalised(class, text).is_some();
            let asked = (carried(a) && carried(b)) || of_class.any(|object| says_both(&object));
            asked.then(|| DescriptionTask::Similarity { class: class.clone(), a: a.clone(), b: b.clone() })
        }
    }
}

/// Applies new answers and tells how far the job is, all in one decision.
pub fn rejudge(index: &mut MapIndex, answers: Vec<Answer>, mut progress: JudgementProgress) -> Learned {
    let mut decided = Decided::default();
    let mut triggers: BTreeSet<KeyframeId> = BTreeSet::new();
    for answer in answers {
        let says_as_before = as_before(index, &answer);
        let learned = match answer {
            Answer::Reading(read) => replace_reading(index, read),
            Answer::Verdict(verdict) => learn_verdict(index, verdict),
        };
        let Some(learned) = learned else {
            progress.tally.gone += 1;
            continue;
        };
        if says_as_before {
            progress.tally.unchanged += 1;
        } else {
            progress.tally.changed += 1;
        }
        decided.changes.extend(learned.decided.changes);
        decided.events.extend(learned.decided.events);
        triggers.extend(learned.triggers);
    }
    let mut record = Recorder::new(index);
    record.apply(vec![Change::JudgementAdvanced(Box::new(progress))]);
    decided.changes.extend(record.finish().changes);
    Learned { decided, triggers: triggers.into_iter().collect(), read: None }
}

/// Whether an answer says what the map knows already.
fn as_before(index: &MapIndex, answer: &Answer) -> bool {
    match answer {
        Answer::Verdict(verdict) => index.verdicts().says(verdict),
        Answer::Reading(read) => {
            let seen = index.observation(read.anchor, (read.keyframe, read.detection));
            let known = seen.and_then(|seen| seen.crop_reading.as_ref());
            known.is_some_and(|known| known.text == read.reading.text)
        }
    }
}
