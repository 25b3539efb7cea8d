//! What asking again may cost: an upper bound, before anything is asked.

use std::sync::Arc;

use super::Models;
use super::dialogue::rounds_of;
use super::picture::Picture;
use super::port::{Question, Round};
use crate::domain::judgement::{Estimate, TextFunction, Workload};

impl Models {
    /// Returns the most that a workload may take. Answers that are kept cost nothing, and calls that fail and are made
    /// again are not foreseen.
    pub fn estimate(&self, workload: &Workload) -> Estimate {
        let mut estimate = Estimate::default();
        for (class, count) in &workload.crops {
            let of_one = self.estimate_crop(class);
            estimate.calls += count * of_one.calls;
            estimate.microusd += count * of_one.microusd;
        }
        let Some(judge) = self.judge.model() else { return estimate };
        for (function, count, chars) in &workload.texts {
            let question = empty(*function);
            // A 4 is asked again the other way round.
            let turns = if *function == TextFunction::Similarity { 2 } else { 1 };
            let mean_chars = chars.div_ceil((*count).max(1));
            estimate.calls += count * turns;
            estimate.microusd += count * turns * judge.most(&question, mean_chars);
        }
        estimate
    }

    /// One dialogue of all its rounds, each with all that was said before, and its summary.
    fn estimate_crop(&self, class: &str) -> Estimate {
        let Some(eyes) = &self.describer.eyes else { return Estimate::default() };
        let mut estimate = Estimate::default();
        let mut add = |microusd: u64| {
            estimate.calls += 1;
            estimate.microusd += microusd;
        };
        let rounds = rounds_of(class);
        for round in 0..rounds {
            let history = vec![longest_round(); round];
            add(eyes.most(&look(history.clone()), 0));
            if let Some(tongue) = self.describer.tongue.as_ref().filter(|_| round > 0) {
                add(tongue.most(&Question::NextQuestion { class: class.to_owned(), history }, 0));
            }
        }
        if let Some(tongue) = &self.describer.tongue {
            let history = vec![longest_round(); rounds];
            add(tongue.most(&Question::Summary { class: class.to_owned(), history }, 0));
        }
        estimate
    }
}

/// Longer answers are rare: they are asked for in a few words.
const ROUND_CHARS: usize = 300;

fn longest_round() -> Round {
    Round { question: "x".repeat(ROUND_CHARS), answer: "x".repeat(ROUND_CHARS) }
}

fn look(history: Vec<Round>) -> Question {
    let picture = Picture { png: Vec::new(), hash: [0; 32], width: 0, height: 0 };
    Question::Look { picture: Arc::new(picture), question: "x".repeat(ROUND_CHARS), history, hint: None }
}

fn empty(function: TextFunction) -> Question {
    let [class, a, b] = [const { String::new() }; 3];
    match function {
        TextFunction::Information => Question::Information { class, text: a },
        TextFunction::Merge => Question::Merge { class, a, b },
        TextFunction::Similarity => Question::Similarity { class, a, b },
    }
}
