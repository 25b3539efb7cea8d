//! Gateway to a model: cache, breaker, budget, retries, in this order. A question whose caller has gone is still
//! completed, because it is paid for.

use std::fmt::Write as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::time::Duration;

use backon::{ExponentialBuilder, Retryable as _};
use sha2::{Digest as _, Sha256};
use tokio::sync::Semaphore;
use tracing::Instrument as _;

use super::breaker::Breaker;
use super::budget::Budget;
use super::cache::{AnswerCache, AskedFor, key};
use super::daily_limits::{Payer, Prices};
use super::picture::Picture;
use super::port::{Fault, Model, Question, Reply};
use super::prompts::prompt;
use super::{parse, prompts};

/// Sufficient to distinguish models.
const FINGERPRINT_BYTES: usize = 8;

/// English text has about four characters per token; three is a safe estimate.
const CHARS_PER_TOKEN: usize = 3;

/// Assumed tokens of an image before the model reports them.
const TOKENS_PER_IMAGE: u64 = 1500;

/// A server that requests a longer pause counts as unavailable.
const PAUSE_MAX: Duration = Duration::from_secs(30);

/// Maximum attempts with unusable answers; a third answer would hardly differ.
const UNUSABLE_ANSWERS_MAX: u32 = 2;

/// The parameters of a call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Policy {
    /// Timeout of an answer about texts.
    pub text_timeout: Duration,
    /// Timeout of an answer about an image.
    pub vision_timeout: Duration,
    /// Maximum retries after a transient failure.
    pub retries: usize,
    /// Delay before the first retry; it doubles each time.
    pub retry_delay: Duration,
    /// Maximum tokens of an answer, for the reservation.
    pub max_tokens: u32,
    /// Prices of tokens, by the question's role.
    pub prices: RolePrices,
}

/// Prices by role: a local vision model may be free while the model for texts is paid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RolePrices {
    /// Of questions about texts.
    pub text: Prices,
    /// Of questions about images.
    pub vision: Prices,
    /// Of embeddings.
    pub embeddings: Prices,
}

impl RolePrices {
    /// Returns the prices of a question.
    pub fn of(&self, question: &Question) -> Prices {
        match question {
            Question::Embed { .. } => self.embeddings,
            question if question.needs_eyes() => self.vision,
            _ => self.text,
        }
    }
}

/// State shared by all models.
#[derive(Debug)]
pub struct Shared {
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
    breaker: Arc<Breaker>,
    policy: Policy,
    shared: Arc<Shared>,
    payer: Option<Payer>,
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
    pub fn new(model: Arc<dyn Model>, breaker: Breaker, policy: Policy, shared: Arc<Shared>) -> Self {
        let name = model.name().into();
        let asked_for = AskedFor::default();
        Self { model, name, breaker: Arc::new(breaker), policy, shared, payer: None, asked_for }
    }

    /// Returns a copy for what is asked for now, whose calls are charged to this payer.
    pub fn paid_by(&self, payer: Option<Payer>) -> Self {
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
        hash.iter().take(FINGERPRINT_BYTES).fold(String::new(), |mut name, byte| {
            let _ = write!(name, "{byte:02x}");
            name
        })
    }

    /// Returns the maximum cost of one call, in millionths of a US dollar, with `more_chars` characters beyond the
    /// question.
    pub(super) fn most(&self, question: &Question, more_chars: u64) -> u64 {
        let input = tokens_sent(question) + more_chars / CHARS_PER_TOKEN as u64;
        self.policy.prices.of(question).microusd(input, u64::from(self.policy.max_tokens)).unsigned_abs()
    }

    /// Whether this model can answer such questions.
    pub fn can(&self, question: &Question) -> bool {
        self.model.can(question)
    }

    /// Whether this model can look at images.
    pub fn sees(&self) -> bool {
        let picture = Picture { png: Vec::new(), hash: [0; 32], width: 0, height: 0 };
        self.model.can(&Question::Look {
            picture: Arc::new(picture),
            question: String::new(),
            history: Vec::new(),
            hint: None,
        })
    }

    /// Returns the breaker of the model.
    pub fn breaker(&self) -> &Breaker {
        &self.breaker
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
        let of = (operation.as_str(), self.name.clone());
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
                    tracing::warn!(model = &*self.name, operation = operation.as_str(), %fault, "no answer");
                }
                Err(fault)
            }
        }
    }

    /// Calls the model, with retries after transient failures, and reports the outcome to the breaker.
    async fn call(&self, question: &Question) -> Result<Reply, Fault> {
        if !self.model.can(question) {
            return Err(Fault::Unable);
        }
        let _slot = self.shared.calls.acquire().await.map_err(|_| Fault::Away)?;
        let admission = self.breaker.admit()?;
        let unusable = AtomicU32::new(0);
        let pauses = ExponentialBuilder::default()
            .with_jitter()
            .with_min_delay(self.policy.retry_delay)
            .with_max_delay(PAUSE_MAX)
            .with_max_times(self.policy.retries);
        let answered = (|| self.attempt(question))
            .retry(pauses)
            .when(Fault::is_passing)
            .adjust(|fault, pause| {
                let garbled = matches!(fault, Fault::Garbled(_));
                let seen = unusable.fetch_add(u32::from(garbled), Ordering::Relaxed) + u32::from(garbled);
                pause_after(fault, pause, seen)
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

    /// Returns the maximum tokens of an answer; an embedding is not counted in tokens.
    fn tokens_received_max(&self, question: &Question) -> u64 {
        if matches!(question, Question::Embed { .. }) { 0 } else { u64::from(self.policy.max_tokens) }
    }

    /// Makes one call: reserves, calls, settles, checks.
    async fn attempt(&self, question: &Question) -> Result<Reply, Fault> {
        let budget = &self.shared.budget;
        let (input_max, output_max) = (tokens_sent(question), self.tokens_received_max(question));
        let prices = self.policy.prices.of(question);
        let most = prices.microusd(input_max, output_max);
        let reservation = budget.reserve(question.operation(), &self.name, most, self.payer.as_ref()).await?;
        let limit = if question.needs_eyes() { self.policy.vision_timeout } else { self.policy.text_timeout };
        let answered = match tokio::time::timeout(limit, self.model.answer(question)).await {
            Ok(answered) => answered,
            Err(_) => Err(Fault::TimedOut(limit)),
        };
        match &answered {
            Ok(reply) => {
                let input = reply.input_tokens.unwrap_or(input_max);
                let output =
                    reply.output_tokens.unwrap_or((reply.content.len() / CHARS_PER_TOKEN) as u64 + 1);
                budget.settle(reservation, input, output, prices.microusd(input, output));
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
    let image = if question.needs_eyes() { TOKENS_PER_IMAGE } else { 0 };
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
