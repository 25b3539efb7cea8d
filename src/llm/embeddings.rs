//! Embeddings of texts: made by a model, kept on disk like every answer, and at hand in memory while pairs are chosen.

use std::sync::Arc;
use std::time::Duration;

use moka::sync::Cache;

use super::budget::Payer;
use super::gateway::Gateway;
use super::parse;
use super::port::{Fault, Question};
use crate::recognition::anchors::pairs;
use crate::semantics::Embedding;

/// Bytes of embeddings at hand; each is a byte a component.
const BYTES_AT_HAND: u64 = 64 << 20;

/// A text that the model does not take is left out for so long.
const LEFT_OUT: Duration = Duration::from_hours(1);

/// Most texts that are left out at a time.
const LEFT_OUT_MAX: u64 = 100_000;

/// The embeddings of one model.
#[derive(Clone, Debug)]
pub struct Embeddings {
    model: Gateway,
    at_hand: Cache<Arc<str>, Arc<Embedding>>,
    failed: Cache<Arc<str>, ()>,
}

impl Embeddings {
    /// Returns the embeddings that this model makes.
    pub fn new(model: Gateway) -> Self {
        // A text has at most a few thousand characters, and an embedding as many components.
        let bytes = |text: &str, embedding: &Embedding| (text.len() + embedding.components().len()) as u32;
        let at_hand = Cache::builder()
            .weigher(move |text: &Arc<str>, embedding: &Arc<Embedding>| bytes(text, embedding))
            .max_capacity(BYTES_AT_HAND)
            .build();
        let failed = Cache::builder().max_capacity(LEFT_OUT_MAX).time_to_live(LEFT_OUT).build();
        Self { model, at_hand, failed }
    }

    /// Returns the time for which the model is left alone because it failed too often; meanwhile words choose the pairs.
    pub fn away_for(&self) -> Option<Duration> {
        self.model.breaker().closed_for().filter(|left| !left.is_zero())
    }

    /// Takes the embedding of a text at hand, at somebody's expense.
    pub async fn take(&self, text: &str, payer: Option<Payer>) -> Result<(), Fault> {
        match self.ask(text, payer).await {
            Ok(embedding) => {
                self.at_hand.insert(text.into(), Arc::new(embedding));
                // Where all places are taken by others, words choose: else it would be asked for again and again.
                self.at_hand.run_pending_tasks();
                if self.at_hand.contains_key(text) {
                    self.failed.invalidate(text);
                } else {
                    self.failed.insert(text.into(), ());
                }
                Ok(())
            }
            Err(fault) => {
                if fault.is_about_the_question() {
                    self.failed.insert(text.into(), ());
                }
                Err(fault)
            }
        }
    }

    async fn ask(&self, text: &str, payer: Option<Payer>) -> Result<Embedding, Fault> {
        let answered = self.model.paid_by(payer).ask(Question::Embed { text: text.to_owned() }).await?;
        parse::embedding(&answered.content)
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
