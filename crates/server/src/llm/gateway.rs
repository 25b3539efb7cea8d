//! Gateway to a model: cache, breaker, budget, retries, in this order. A question whose caller has gone is still
//! completed, because it is paid for.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use backon::{ExponentialBuilder, Retryable as _};
use sha2::{Digest as _, Sha256};
use tokio::sync::Semaphore;
use tracing::Instrument as _;

use super::breaker::Breaker;
use super::budget::Budget;
use super::cache::{AnswerCache, AskedFor, key};
use super::port::{Fault, Model, Question, Reply, Role};
use super::prompts::prompt;
use super::{parse, prompts};
use crate::config::models::ModelArgs;
use crate::store::DayLimit;

/// English text has about four characters per token; three is a safe estimate.
const CHARS_PER_TOKEN: usize = 3;

/// Assumed tokens of an image before the model reports them.
const TOKENS_PER_IMAGE: u64 = 1500;

/// A server that requests a longer pause counts as unavailable.
const PAUSE_MAX: Duration = Duration::from_secs(30);

/// Maximum attempts with unusable answers; a third answer would hardly differ.
const UNUSABLE_ANSWERS_MAX: u32 = 2;

/// State shared by all models.
#[derive(Debug)]
pub struct Shared {
    /// The timeouts, retries and prices.
    pub args: ModelArgs,
    /// Cached answers.
    pub cache: AnswerCache,
    /// The budget.
    pub budget: Budget,
    /// Concurrent calls.
    pub calls: Semaphore,
    /// Questions that no call could answer since the start.
    pub failures: AtomicU64,
}

/// The gateway to one model; clones share everything.
#[derive(Clone, Debug)]
pub struct Gateway {
    model: Arc<dyn Model>,
    name: Arc<str>,
    pub(super) breaker: Arc<Breaker>,
    shared: Arc<Shared>,
    payer: Option<DayLimit>,
    asked_for: AskedFor,
}

/// An answer, and whether it was cached.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answered {
    /// The answer, as the model wrote it; it has passed [`parse::check`].
    pub content: Arc<str>,
    /// Whether it was answered without a call of its own.
    pub cached: bool,
}

impl Gateway {
    /// Returns the gateway to a model.
    pub fn new(model: Arc<dyn Model>, shared: Arc<Shared>) -> Self {
        let pause = Duration::from_millis(shared.args.model_breaker_pause_ms);
        let breaker = Arc::new(Breaker::new(shared.args.model_breaker_failures, pause));
        Self {
            name: model.name().into(),
            model,
            breaker,
            shared,
            payer: None,
            asked_for: AskedFor::default(),
        }
    }

    /// Returns a copy for what is asked for now, whose calls are charged to this payer.
    pub fn paid_by(&self, payer: Option<DayLimit>) -> Self {
        Self { payer, asked_for: self.shared.cache.now(), ..self.clone() }
    }

    /// Returns `model:<name>`.
    pub fn source(&self) -> Arc<str> {
        format!("model:{}", self.name).into()
    }

    /// Returns the hash of all inputs of the answers beside the question: the model, its parameters, and the prompts.
    /// A different fingerprint means that verdicts may differ.
    pub fn fingerprint(&self) -> String {
        let hash = Sha256::digest(format!("{}\n{}", self.model.identity(), prompts::VERSION));
        // Eight bytes are sufficient to distinguish models.
        format!("{:016x}", u64::from_be_bytes(hash.first_chunk().copied().unwrap_or_default()))
    }

    /// Returns the maximum cost of one call, in millionths of a US dollar, with `more_chars` characters beyond the
    /// question.
    pub(super) fn most(&self, question: &Question, more_chars: u64) -> u64 {
        let input = tokens_sent(question) + more_chars / CHARS_PER_TOKEN as u64;
        self.microusd(question, input, u64::from(self.shared.args.model_max_tokens)).unsigned_abs()
    }

    /// Returns the cost of tokens, in millionths of a US dollar, rounded up.
    fn microusd(&self, question: &Question, input_tokens: u64, output_tokens: u64) -> i64 {
        let args = &self.shared.args;
        let (text_input, text_output) = (args.model_input_usd, args.model_output_usd);
        // US dollars per million tokens equal millionths of a dollar per token.
        let (input_usd, output_usd) = match question.role() {
            Role::Text => (text_input, text_output),
            Role::Vision => (
                args.model_vision_input_usd.unwrap_or(text_input),
                args.model_vision_output_usd.unwrap_or(text_output),
            ),
            Role::Embeddings => (args.model_embeddings_usd, 0.0),
        };
        (input_tokens as f64 * input_usd + output_tokens as f64 * output_usd).ceil() as i64
    }

    /// Whether this model can answer the questions of a role.
    pub fn can(&self, role: Role) -> bool {
        self.model.can(role)
    }

    /// Answers a question. Concurrent equal questions share one call.
    pub async fn ask(&self, question: Question) -> Result<Answered, Fault> {
        let gateway = self.clone();
        // A separate task: if the caller is dropped, and with it the cache's entry, the call still continues.
        let asked = tokio::spawn(async move { gateway.find(question).await }.in_current_span());
        asked.await.unwrap_or_else(|_| Err(Fault::Unreachable("the call broke off".to_owned())))
    }

    async fn find(&self, question: Question) -> Result<Answered, Fault> {
        let called = AtomicBool::new(false);
        let ask = async {
            called.store(true, Ordering::Relaxed);
            self.call(&question).await.map(|reply| reply.content)
        };
        let (key, operation) = (key(&*self.model, &question), question.operation());
        let of = (operation, self.name.clone());
        let found = self.shared.cache.get_or_ask(key, of, self.asked_for, ask).await;
        let cached = !called.load(Ordering::Relaxed);
        match found {
            Ok(content) => {
                if cached {
                    self.shared.budget.hit(operation, &self.name);
                }
                Ok(Answered { content, cached })
            }
            Err(fault) => {
                if !cached {
                    self.shared.failures.fetch_add(1, Ordering::Relaxed);
                    tracing::warn!(model = &*self.name, operation, %fault, "no answer");
                }
                Err(fault)
            }
        }
    }

    /// Calls the model, with retries after transient failures, and reports the outcome to the breaker.
    async fn call(&self, question: &Question) -> Result<Reply, Fault> {
        if !self.model.can(question.role()) {
            return Err(Fault::Unable);
        }
        let _slot = self.shared.calls.acquire().await.map_err(|_| Fault::Away)?;
        let admission = self.breaker.admit()?;
        let mut unusable = 0;
        let pauses = ExponentialBuilder::default()
            .with_jitter()
            .with_min_delay(Duration::from_millis(self.shared.args.model_retry_delay_ms))
            .with_max_delay(PAUSE_MAX)
            .with_max_times(usize::from(self.shared.args.model_retries));
        let answered = (|| self.attempt(question))
            .retry(pauses)
            .when(Fault::is_passing)
            .adjust(|fault, pause| {
                unusable += u32::from(matches!(fault, Fault::Garbled(_)));
                pause_after(fault, pause, unusable)
            })
            .await;
        match &answered {
            Ok(_) => admission.succeeded(),
            // A spent budget does not concern the model's availability.
            Err(Fault::Spent | Fault::Store(_)) => drop(admission),
            // Nor does a text that is too long for it.
            Err(fault) if matches!(question, Question::Embed { .. }) && fault.is_about_the_question() => {
                drop(admission);
            }
            Err(_) => admission.failed(),
        }
        answered
    }

    /// Makes one call: reserves, calls, settles, checks.
    async fn attempt(&self, question: &Question) -> Result<Reply, Fault> {
        let (budget, args) = (&self.shared.budget, &self.shared.args);
        let input_max = tokens_sent(question);
        let most = self.microusd(question, input_max, u64::from(args.model_max_tokens));
        let reservation = budget.reserve(question.operation(), &self.name, most, self.payer.as_ref()).await?;
        let limit = Duration::from_millis(match question.role() {
            Role::Vision => args.model_vision_timeout_ms,
            Role::Text | Role::Embeddings => args.model_text_timeout_ms,
        });
        let answered = tokio::time::timeout(limit, self.model.answer(question)).await;
        let answered = answered.unwrap_or(Err(Fault::TimedOut(limit)));
        match &answered {
            Ok(reply) => {
                let input = reply.input_tokens.unwrap_or(input_max);
                let output =
                    reply.output_tokens.unwrap_or((reply.content.len() / CHARS_PER_TOKEN) as u64 + 1);
                budget.settle(reservation, input, output, self.microusd(question, input, output));
            }
            // The call may have been answered and charged, so the reservation is kept.
            Err(Fault::TimedOut(_) | Fault::Garbled(_)) => budget.settle(reservation, 0, 0, most),
            Err(_) => budget.settle(reservation, 0, 0, 0),
        }
        let reply = answered?;
        parse::check(question, &reply.content)?;
        Ok(reply)
    }
}

/// Returns the delay before a retry: the longer of ours and the server's; `None` if the call is not retried.
fn pause_after(fault: &Fault, pause: Option<Duration>, unusable_answers: u32) -> Option<Duration> {
    match fault {
        Fault::Limited { retry_after: Some(asked) } => {
            pause.filter(|_| *asked <= PAUSE_MAX).map(|pause| pause.max(*asked))
        }
        Fault::Garbled(_) => pause.filter(|_| unusable_answers < UNUSABLE_ANSWERS_MAX),
        _ => pause,
    }
}

fn tokens_sent(question: &Question) -> u64 {
    let asked = prompt(question);
    let image = if question.role() == Role::Vision { TOKENS_PER_IMAGE } else { 0 };
    ((asked.rules.len() + asked.data.len()) / CHARS_PER_TOKEN) as u64 + image
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_server_is_given_the_pause_it_asks_for_unless_it_asks_for_too_much() {
        let seconds = Duration::from_secs;
        let limited = |asked: Option<u64>| Fault::Limited { retry_after: asked.map(seconds) };
        let half = Some(Duration::from_millis(500));
        for (fault, unusable, expected) in [
            (limited(Some(7)), 0, Some(seconds(7))),
            (limited(Some(0)), 0, half),
            (limited(None), 0, half),
            (limited(Some(3600)), 0, None),
            (Fault::Failing(500), 0, half),
            (Fault::Garbled("prose"), 1, half),
            (Fault::Garbled("prose"), 2, None),
        ] {
            assert_eq!(pause_after(&fault, half, unusable), expected, "{fault}");
        }
        assert_eq!(pause_after(&limited(Some(7)), None, 0), None, "no more tries");
    }
}
