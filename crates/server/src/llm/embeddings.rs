//! Embeddings of texts: computed by a model, cached on disk like every answer, and held in memory while pairs are
//! selected.

use std::sync::Arc;
use std::time::Duration;

use moka::sync::Cache;

use super::gateway::Gateway;
use super::parse;
use super::port::{Fault, Question};
use crate::recognition::anchors::pairs;
use crate::semantics::Embedding;
use crate::store::DayLimit;

/// Maximum bytes of embeddings in memory; each component takes a byte.
const BYTES_AT_HAND: u64 = 64 << 20;

/// Time for which a text that the model rejects is skipped.
const LEFT_OUT: Duration = Duration::from_hours(1);

/// Maximum texts skipped at a time.
const LEFT_OUT_MAX: u64 = 100_000;

/// The embeddings of one model.
#[derive(Clone, Debug)]
pub struct Embeddings {
    model: Gateway,
    at_hand: Cache<Arc<str>, Arc<Embedding>>,
    failed: Cache<Arc<str>, ()>,
}

impl Embeddings {
    /// Returns the embeddings of this model.
    pub fn new(model: Gateway) -> Self {
        // A text has at most a few thousand characters, and an embedding about as many components.
        let bytes = |text: &str, embedding: &Embedding| (text.len() + embedding.components().len()) as u32;
        let at_hand = Cache::builder()
            .weigher(move |text: &Arc<str>, embedding: &Arc<Embedding>| bytes(text, embedding))
            .max_capacity(BYTES_AT_HAND)
            .build();
        let failed = Cache::builder().max_capacity(LEFT_OUT_MAX).time_to_live(LEFT_OUT).build();
        Self { model, at_hand, failed }
    }

    /// Returns the time for which the unavailable model is not called; meanwhile words select the pairs.
    pub fn away_for(&self) -> Option<Duration> {
        self.model.breaker.closed_for().filter(|left| !left.is_zero())
    }

    /// Loads the embedding of a text into memory, charged to the payer.
    pub async fn take(&self, text: &str, payer: Option<DayLimit>) -> Result<(), Fault> {
        let asked = self.model.paid_by(payer).ask(Question::Embed { text: text.to_owned() }).await;
        let told = asked.and_then(|answered| parse::embedding(&answered.content)).map(|embedding| {
            self.at_hand.insert(text.into(), Arc::new(embedding));
            self.at_hand.run_pending_tasks();
        });
        let is_left_out = match &told {
            // If other texts fill the memory, words select the pairs: otherwise it would be requested again and again.
            Ok(()) => !self.at_hand.contains_key(text),
            Err(fault) => fault.is_about_the_question(),
        };
        if is_left_out {
            self.failed.insert(text.into(), ());
        } else if told.is_ok() {
            self.failed.invalidate(text);
        }
        told
    }
}

impl pairs::Embeddings for Embeddings {
    fn of(&self, text: &str) -> pairs::Embedded {
        match self.at_hand.get(text) {
            Some(embedding) => pairs::Embedded::As(embedding),
            None if self.failed.contains_key(text) => pairs::Embedded::Failed,
            None => pairs::Embedded::NotYet,
        }
    }
}
