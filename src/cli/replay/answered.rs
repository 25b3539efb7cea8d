//! Answered: one query of the recording, with its ground truth, its answer and the reasons.

use serde::Serialize;

use super::score::{Best, Marked};
use crate::api::verdict::{CandidateView, LoopAnswer, ReasonView};
use crate::domain::reason::ReasonCode;
use crate::domain::verdict::Decision;

/// The ground truth of a query.
#[derive(Clone, Debug, Default)]
pub(super) struct Labels {
    /// The keyframes that are a loop; empty: there is none.
    pub truth: Vec<String>,
    /// The keyframes that are neither correct nor wrong.
    pub ignore: Vec<String>,
}

/// A query and its answer, without the parts that no report uses; as JSON, those of a query worth inspecting.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Answered {
    /// The map queried.
    pub map: String,
    /// The keyframe queried.
    pub keyframe: String,
    /// None: the ground truth is unknown, so the query is not scored.
    #[serde(skip)]
    pub labels: Option<Labels>,
    /// The answer, as it counts.
    pub verdict: Decision,
    /// The reason why it is not a loop: the answer's own, or its leading candidate's.
    pub reason: Option<ReasonView>,
    /// The keyframe named best.
    #[serde(skip)]
    best: Option<String>,
    /// Every keyframe that the answer reports as a loop.
    #[serde(skip)]
    loops: Vec<String>,
    /// The candidate that the answer is about: the best, or else the nearest to acceptance.
    #[serde(rename = "best")]
    pub leading: Option<Figures>,
    /// Of the true candidates, the nearest to acceptance.
    pub nearest_true: Option<Figures>,
    /// The keyframe that BoW alone would name, with its score.
    #[serde(skip)]
    bow_best: Option<(String, f64)>,
    /// The reason code of each rejected candidate.
    #[serde(skip)]
    pub candidate_reasons: Vec<ReasonCode>,
}

/// The figures of a candidate, on one line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Figures {
    /// The candidate.
    pub keyframe: String,
    /// S of Eq. (2).
    pub similarity: Option<f64>,
    /// BoW score.
    pub bow_score: f64,
    /// Inliers of the geometry.
    pub inliers: Option<u64>,
    /// The check that rejected it.
    pub reason: Option<ReasonView>,
}

impl Answered {
    pub fn new(map: &str, keyframe: &str, labels: Option<Labels>, answer: &LoopAnswer) -> Self {
        let leading = answer.leading();
        let true_ones = answer.candidates.iter().filter(|candidate| {
            let labels = labels.as_ref();
            labels.is_some_and(|labels| labels.truth.contains(&candidate.keyframe))
        });
        // A return that is closed already counts as the loop that it stands for.
        let repeated = answer.repeated().filter(|_| answer.verdict.0 == Decision::NoLoop);
        let repeated = repeated.map(|candidate| candidate.keyframe.clone());
        Self {
            map: map.to_owned(),
            keyframe: keyframe.to_owned(),
            verdict: if repeated.is_some() { Decision::Loop } else { answer.verdict.0 },
            reason: answer.reason.clone().or_else(|| leading.and_then(|candidate| candidate.reason.clone())),
            best: answer.best.clone().or_else(|| repeated.clone()),
            loops: answer.loops.iter().cloned().chain(repeated).collect(),
            leading: leading.map(Figures::of),
            nearest_true: true_ones.max_by(|a, b| a.nearness(b)).map(Figures::of),
            bow_best: bow_best(&answer.candidates),
            candidate_reasons: answer
                .candidates
                .iter()
                .filter_map(|candidate| Some(candidate.reason.as_ref()?.code.0))
                .collect(),
            labels,
        }
    }

    /// Returns the service's answer, if it is to be scored.
    pub fn service(&self) -> Option<Marked> {
        let accepted = self.verdict == Decision::Loop;
        let best = self.best.as_deref().map(|best| (best, 1.0));
        let mut marked = self.mark(best)?;
        if !accepted {
            marked.best = None;
        } else if marked.best.is_none() {
            // A loop without a keyframe is wrong, whatever the ground truth.
            marked.best = Some(Best { correct: false, score: 1.0 });
        }
        Some(marked)
    }

    /// Returns the answer of BoW alone, if it is to be scored.
    pub fn bow_alone(&self) -> Option<Marked> {
        let best = self.bow_best.as_ref();
        self.mark(best.map(|(keyframe, score)| (keyframe.as_str(), *score)))
    }

    /// Whether the ground truth contains a loop.
    pub fn has_truth(&self) -> bool {
        let labels = self.labels.as_ref();
        labels.is_some_and(|labels| !labels.truth.is_empty())
    }

    /// Whether the best is neither correct nor wrong.
    pub fn is_ignored(&self) -> bool {
        self.labels.is_some() && self.service().is_none()
    }

    /// Whether a loop was reported that is not true.
    pub fn is_false_loop(&self) -> bool {
        let best = self.service().and_then(|marked| marked.best);
        best.is_some_and(|best| !best.correct)
    }

    /// Whether any reported loop is not true, even if the best is not scored.
    pub fn has_wrong_loop(&self) -> bool {
        let labels = self.labels.as_ref();
        let best = self.best.iter().filter(|_| self.verdict == Decision::Loop);
        labels.is_some_and(|labels| {
            let known = |id: &String| labels.truth.contains(id) || labels.ignore.contains(id);
            !self.loops.iter().chain(best).all(known)
        })
    }

    /// Whether a true loop was reported.
    pub fn is_right(&self) -> bool {
        let best = self.service().and_then(|marked| marked.best);
        best.is_some_and(|best| best.correct)
    }

    /// Whether there is a true loop that was not reported.
    pub fn is_missed(&self) -> bool {
        self.has_truth() && self.verdict != Decision::Loop
    }

    fn mark(&self, best: Option<(&str, f64)>) -> Option<Marked> {
        let labels = self.labels.as_ref()?;
        let among = |ids: &[String], best: &str| ids.iter().any(|id| id == best);
        if best.is_some_and(|(best, _)| among(&labels.ignore, best)) {
            return None;
        }
        Some(Marked {
            has_truth: !labels.truth.is_empty(),
            best: best.map(|(best, score)| Best { correct: among(&labels.truth, best), score }),
        })
    }
}

impl Figures {
    fn of(candidate: &CandidateView) -> Self {
        Self {
            keyframe: candidate.keyframe.clone(),
            similarity: candidate.similarity(),
            bow_score: candidate.bow_score(),
            inliers: candidate.inliers(),
            reason: candidate.reason.clone(),
        }
    }
}

/// Returns the highest score, and the smallest id among equals. A keyframe that shares no word is not a BoW candidate.
fn bow_best(candidates: &[CandidateView]) -> Option<(String, f64)> {
    candidates
        .iter()
        .filter(|candidate| candidate.bow_score() > 0.0)
        .max_by(|a, b| {
            let by_score = a.bow_score().total_cmp(&b.bow_score());
            by_score.then_with(|| b.keyframe.cmp(&a.keyframe))
        })
        .map(|candidate| (candidate.keyframe.clone(), candidate.bow_score()))
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn answered(truth: &[&str], ignore: &[&str], answer: Value) -> Answered {
        let ids = |ids: &[&str]| ids.iter().map(|id| (*id).to_owned()).collect();
        let labels = Labels { truth: ids(truth), ignore: ids(ignore) };
        let answer = serde_json::from_value(answer).expect("a loop answer");
        Answered::new("m", "q", Some(labels), &answer)
    }

    fn answer(verdict: &str, best: Option<&str>, bow: &[(&str, f64)]) -> Value {
        let candidates: Vec<Value> = bow
            .iter()
            .map(|(id, score)| {
                json!({"keyframe": id, "verdict": "rejected", "geometry": {"status": "skipped"},
                    "bow": {"score": score, "common_words": 1, "reference_score": 0.0},
                    "reason": {"code": "no_anchors", "detail": ""}})
            })
            .collect();
        json!({"id": "q-1", "map_version": 1, "verdict": verdict, "best": best, "loops": [], "degraded": false,
            "excluded_covisible": 0, "closed": [], "candidates": candidates})
    }

    /// (has a true loop, accepted and whether it is right) of a scored query.
    fn outcome(marked: Option<Marked>) -> Option<(bool, Option<bool>)> {
        marked.map(|marked| (marked.has_truth, marked.best.map(|best| best.correct)))
    }

    #[test]
    fn a_loop_is_right_if_its_best_is_true() {
        let check = |truth: &[&str], ignore: &[&str], verdict, best, expected| {
            let query = answered(truth, ignore, answer(verdict, best, &[]));
            assert_eq!(outcome(query.service()), expected, "{verdict} {best:?}");
        };
        check(&["a", "b"], &[], "loop", Some("b"), Some((true, Some(true))));
        check(&["a", "b"], &[], "loop", Some("c"), Some((true, Some(false))));
        check(&[], &[], "loop", Some("c"), Some((false, Some(false))));
        check(&["a"], &[], "no_loop", None, Some((true, None)));
        check(&["a"], &[], "undecided", Some("a"), Some((true, None)));
        check(&[], &[], "undecided", None, Some((false, None)));
        // Neither correct nor wrong, and no true loop missed either.
        check(&["a"], &["c"], "loop", Some("c"), None);
        check(&[], &["c"], "loop", Some("c"), None);
        check(&["a"], &["c"], "loop", Some("a"), Some((true, Some(true))));
        check(&["a"], &["c"], "loop", None, Some((true, Some(false))));
    }

    #[test]
    fn a_wrong_loop_is_told_beside_a_right_best_and_where_nothing_is_scored() {
        let wrong = |truth: &[&str], ignore: &[&str], best: &str, loops: &[&str]| {
            let mut said = answer("loop", Some(best), &[]);
            said["loops"] = json!(loops);
            answered(truth, ignore, said).has_wrong_loop()
        };
        assert!(!wrong(&["a"], &["i"], "a", &["a", "i"]));
        assert!(wrong(&["a"], &[], "a", &["a", "b"]));
        assert!(wrong(&[], &["i"], "i", &["i", "b"]), "not scored, and wrong all the same");
        assert!(wrong(&[], &[], "b", &["b"]));
        let mut said = answer("loop", Some("b"), &[]);
        said["loops"] = json!(["b"]);
        let said = serde_json::from_value(said);
        let unlabelled = Answered::new("m", "q", None, &said.expect("an answer"));
        assert!(!unlabelled.has_wrong_loop(), "nobody knows");
    }

    #[test]
    fn an_unlabelled_query_is_not_scored() {
        let answer = serde_json::from_value(answer("loop", Some("a"), &[("a", 0.5)]));
        let query = Answered::new("m", "q", None, &answer.expect("an answer"));
        assert!(query.service().is_none() && query.bow_alone().is_none());
        assert!(!query.is_ignored() && !query.is_false_loop() && !query.is_missed());
    }

    #[test]
    fn bow_alone_takes_the_highest_score_and_of_equal_ones_the_smallest_id() {
        let check = |bow: &[(&str, f64)], expected| {
            let query = answered(&["a"], &["i"], answer("no_loop", None, bow));
            assert_eq!(outcome(query.bow_alone()), expected, "{bow:?}");
        };
        check(&[("b", 0.2), ("a", 0.3)], Some((true, Some(true))));
        check(&[("b", 0.3), ("a", 0.2)], Some((true, Some(false))));
        check(&[("b", 0.3), ("a", 0.3)], Some((true, Some(true))));
        check(&[("a", 0.0)], Some((true, None)));
        check(&[], Some((true, None)));
        check(&[("i", 0.9), ("a", 0.3)], None);
    }

    #[test]
    fn an_answer_is_explained_by_its_own_reason_or_by_its_leading_candidate() {
        let mut said = answer("undecided", None, &[("c", 0.4), ("a", 0.2), ("b", 0.1)]);
        let query = answered(&["a", "b"], &[], said.clone());
        assert_eq!(query.leading.expect("a candidate").keyframe, "c");
        assert_eq!(query.nearest_true.expect("a candidate").keyframe, "a");
        assert_eq!(query.reason.expect("a reason").code.0, ReasonCode::NoAnchors);
        assert_eq!(query.candidate_reasons, [ReasonCode::NoAnchors; 3]);
        said["candidates"][1]["verdict"] = json!("undecided");
        let query = answered(&["b"], &[], said.clone());
        assert_eq!(query.leading.expect("a candidate").keyframe, "a");
        said["reason"] = json!({"code": "empty_bow", "detail": ""});
        let query = answered(&["a"], &[], said);
        assert_eq!(query.reason.expect("a reason").code.0, ReasonCode::EmptyBow);
    }
}
