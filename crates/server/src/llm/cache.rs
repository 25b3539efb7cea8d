//! Answer cache: paid answers in memory and SQLite, keyed by exactly the inputs that they depend on.

use std::future::Future;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

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
    /// Erasures of this server so far.
    erasures: Arc<AtomicU64>,
}

/// When something was asked for, as erasures are counted: a question may be one of several, and be sent only when what it speaks of
/// is erased.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AskedFor(u64);

impl AnswerCache {
    /// Returns a cache over this database.
    pub fn new(store: Store) -> Self {
        Self { memory: Cache::new(IN_MEMORY), store, erasures: Arc::default() }
    }

    /// Returns the moment of something that is asked for now.
    pub fn now(&self) -> AskedFor {
        AskedFor(self.erasures.load(Ordering::Acquire))
    }

    /// Has nothing be kept that was asked for before: it may speak of what is erased now.
    pub fn note_erasure(&self) {
        self.erasures.fetch_add(1, Ordering::AcqRel);
    }

    /// Returns the answer from memory, from disk, or by calling the model. A new answer is on disk before it is
    /// returned.
    pub async fn get_or_ask(
        &self,
        key: Key,
        (operation, model): (&'static str, Arc<str>),
        asked_for: AskedFor,
        ask: impl Future<Output = Result<String, Fault>>,
    ) -> Result<Arc<str>, Fault> {
        let find = async {
            if let Some(answer) = self.store.answer(&key).await? {
                return Ok(answer.into());
            }
            let erasures = self.store.erasures_so_far().await?;
            let answer: Arc<str> = ask.await?.into();
            if let Some(erasures) = erasures.filter(|_| asked_for == self.now()) {
                let job = Job::KeepAnswer { key, operation, model, answer: answer.clone(), erasures };
                self.store.committer().commit(job).await?;
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
        question.operation(),
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
