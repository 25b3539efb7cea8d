//! Cost estimate of a re-evaluation: an upper bound, without any call.

use std::sync::Arc;

use super::Models;
use super::dialogue::rounds_of;
use super::port::{Question, Round};
use crate::domain::judgement::{Estimate, TextFunction, Workload};

impl Models {
    /// Returns the maximum cost of a workload. Cached answers cost nothing; retries of failed calls are not included.
    pub fn estimate(&self, workload: &Workload) -> Estimate {
        let mut estimate = Estimate::default();
        for (class, count) in &workload.crops {
            let of_one = self.estimate_crop(class);
            estimate.calls += count * of_one.calls;
            estimate.microusd += count * of_one.microusd;
        }
        let Some(judge) = &self.judge.model else { return estimate };
        for (function, count, chars) in &workload.texts {
            let [class, a, b] = Default::default();
            let question = Question::Texts { function: *function, class, a, b };
            // A 4 is asked again in reverse order.
            let turns = if *function == TextFunction::Similarity { 2 } else { 1 };
            let mean_chars = chars.div_ceil((*count).max(1));
            estimate.calls += count * turns;
            estimate.microusd += count * turns * judge.most(&question, mean_chars);
        }
        estimate
    }

    /// Estimates a dialogue with all rounds, each with the history before it, and its summary.
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

/// Longer answers are rare, because the prompts ask for a few words.
const ROUND_CHARS: usize = 300;

fn longest_round() -> Round {
    Round { question: "x".repeat(ROUND_CHARS), answer: "x".repeat(ROUND_CHARS) }
}

fn look(history: Vec<Round>) -> Question {
    Question::Look { picture: Arc::default(), question: "x".repeat(ROUND_CHARS), history, hint: None }
}
