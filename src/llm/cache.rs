//! Answer cache: paid answers in memory and SQLite, keyed by exactly the inputs that they depend on.

use std::future::Future;
use std::sync::Arc;

use moka::future::Cache;
use sha2::{Digest as _, Sha256};

use super::port::{Fault, Model, Question};
use super::prompts::{self, prompt};
use crate::store::{Job, Store};

/// Maximum answers in memory.
const IN_MEMORY: u64 = 10_000;

/// The hash of all inputs of an answer.
pub type Key = [u8; 32];

/// Answers by key. Concurrent equal questions share one call; errors are not cached.
#[derive(Clone, Debug)]
pub struct AnswerCache {
    memory: Cache<Key, Arc<str>>,
    store: Store,
}

impl AnswerCache {
    /// Returns a cache over this database.
    pub fn new(store: Store) -> Self {
        Self { memory: Cache::new(IN_MEMORY), store }
    }

    /// Returns the answer from memory, from disk, or by calling the model. A new answer is on disk before it is
    /// returned.
    pub async fn get_or_ask(
        &self,
        key: Key,
        operation: &'static str,
        model: Arc<str>,
        ask: impl Future<Output = Result<String, Fault>>,
    ) -> Result<Arc<str>, Fault> {
        let find = async {
            let kept = self.store.answer(&key).await.map_err(|error| Fault::Store(error.to_string()))?;
            if let Some(answer) = kept {
                return Ok(answer.into());
            }
            let erasures = self.store.erasures_so_far().await;
            let erasures = erasures.map_err(|error| Fault::Store(error.to_string()))?;
            let answer: Arc<str> = ask.await?.into();
            if let Some(erasures) = erasures {
                let job = Job::KeepAnswer { key, operation, model, answer: answer.clone(), erasures };
                let kept = self.store.committer().commit(job).await;
                kept.map_err(|error| Fault::Store(error.to_string()))?;
            }
            Ok(answer)
        };
        self.memory.try_get_with(key, find).await.map_err(|fault: Arc<Fault>| (*fault).clone())
    }
}

/// Returns the key of a question to a model: the operation, the model with its address and parameters, the wording of
/// the prompts, the texts in the order they are sent in, and the image.
pub fn key(model: &dyn Model, question: &Question) -> Key {
    let asked = prompt(question);
    let mut hash = Sha256::new();
    for part in [
        question.operation().as_str(),
        &model.identity(),
        &prompts::VERSION.to_string(),
        &asked.rules,
        &asked.data,
        &asked.schema.map(|(_, schema)| schema.to_string()).unwrap_or_default(),
    ] {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part);
    }
    if let Question::Look { picture, .. } = question {
        hash.update(picture.hash);
    }
    hash.finalize().into()
}
