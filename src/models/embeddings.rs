//! Embeddings of texts: made by a model, kept on disk like every answer, and at hand in memory while pairs are chosen.

use std::sync::Arc;
use std::time::Duration;

use moka::sync::Cache;

use super::budget::Payer;
use super::gateway::Gateway;
use super::parse;
use super::port::{Fault, Question};
use crate::recognition::pairs;
use crate::semantics::Embedding;

/// Bytes of embeddings at hand; each is a byte a component.
const BYTES_AT_HAND: u64 = 64 << 20;

/// A text whose embedding could not be made is left out for so long.
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
    /// The embeddings that this model makes.
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

    /// Has the model failed too often? Then words choose the pairs until it is back.
    pub fn is_away(&self) -> bool {
        self.model.breaker().is_open()
    }

    /// Takes the embedding of a text at hand, at somebody's expense.
    pub async fn take(&self, text: &str, payer: Option<Payer>) -> Result<(), Fault> {
        match self.ask(text, payer).await {
            Ok(embedding) => {
                self.failed.invalidate(text);
                self.at_hand.insert(text.into(), Arc::new(embedding));
                Ok(())
            }
            // Says nothing about the text.
            Err(fault @ (Fault::Away | Fault::Spent | Fault::Store(_))) => Err(fault),
            Err(fault) => {
                self.failed.insert(text.into(), ());
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
