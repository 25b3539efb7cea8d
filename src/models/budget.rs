//! The daily budget, a hard stop, and the usage. What a call may cost is on disk before the call is made, and settled
//! by what the model reports: a crash can only make the books too cautious.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use super::port::{Fault, Operation};
use crate::store::{Job, Spent, Store, StoreError, UsageRow};

const SECONDS_A_DAY: u64 = 86_400;

/// US dollars a million tokens are millionths of a dollar a token.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prices {
    /// A million tokens sent.
    pub input_usd: f64,
    /// A million tokens received.
    pub output_usd: f64,
}

impl Prices {
    /// What so many tokens cost, in millionths of a dollar, rounded up.
    pub fn microusd(self, input_tokens: u64, output_tokens: u64) -> i64 {
        (input_tokens as f64 * self.input_usd + output_tokens as f64 * self.output_usd).ceil() as i64
    }
}

/// What a day (UTC) may bring.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Millionths of a US dollar.
    pub microusd: Option<i64>,
    /// Calls.
    pub calls: Option<i64>,
}

/// Sums of one operation and model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Calls, failed ones among them.
    pub calls: i64,
    /// Tokens sent.
    pub input_tokens: i64,
    /// Tokens received.
    pub output_tokens: i64,
    /// Millionths of a US dollar.
    pub microusd: i64,
    /// Questions answered without a call.
    pub cache_hits: i64,
}

/// The books.
#[derive(Debug)]
pub struct Budget {
    store: Store,
    limits: Limits,
    books: Mutex<Books>,
}

#[derive(Debug, Default)]
struct Books {
    today: i64,
    calls_today: i64,
    microusd_today: i64,
    ever: BTreeMap<(String, String), Totals>,
    /// Cache hits not written yet; they travel with the next call.
    unwritten_hits: BTreeMap<(String, String), i64>,
}

/// A call that was entered and not settled yet.
#[derive(Debug)]
pub struct Reservation {
    day: i64,
    operation: Operation,
    model: Arc<str>,
    microusd: i64,
}

impl Budget {
    /// The books as they stand on disk.
    pub async fn open(store: Store, limits: Limits) -> Result<Self, StoreError> {
        let today = today();
        let mut books = Books { today, ..Books::default() };
        for row in store.usage_since(today).await? {
            books.calls_today += row.calls;
            books.microusd_today += row.cost_microusd;
        }
        for row in store.usage_since(i64::MIN).await? {
            books.ever.insert((row.operation.clone(), row.model.clone()), totals(&row));
        }
        Ok(Self { store, limits, books: Mutex::new(books) })
    }

    /// Enters a call before it is made, at the most that it may cost.
    pub async fn reserve(
        &self,
        operation: Operation,
        model: &Arc<str>,
        microusd: i64,
    ) -> Result<Reservation, Fault> {
        let day = today();
        let cache_hits = {
            let mut books = self.lock();
            books.turn_to(day);
            let over = |limit: Option<i64>, sum: i64| limit.is_some_and(|limit| sum > limit);
            if over(self.limits.calls, books.calls_today + 1)
                || over(self.limits.microusd, books.microusd_today + microusd)
            {
                return Err(Fault::Spent);
            }
            books.calls_today += 1;
            books.microusd_today += microusd;
            let key = (operation.as_str().to_owned(), model.to_string());
            let totals = books.ever.entry(key.clone()).or_default();
            totals.calls += 1;
            totals.microusd += microusd;
            books.unwritten_hits.remove(&key).unwrap_or_default()
        };
        let spent = Spent {
            day,
            operation: operation.as_str(),
            model: model.clone(),
            calls: 1,
            cost_microusd: microusd,
            cache_hits,
            ..Spent::default()
        };
        let written = self.store.committer().commit(Job::Spend(spent)).await;
        written.map_err(|error| Fault::Store(error.to_string()))?;
        Ok(Reservation { day, operation, model: model.clone(), microusd })
    }

    /// Settles a call by what it took. Written behind: until then the books are too cautious.
    pub fn settle(&self, reservation: Reservation, input_tokens: u64, output_tokens: u64, microusd: i64) {
        let Reservation { day, operation, model, microusd: reserved } = reservation;
        let (input_tokens, output_tokens) = (input_tokens as i64, output_tokens as i64);
        let too_much = microusd - reserved;
        {
            let mut books = self.lock();
            if books.today == day {
                books.microusd_today += too_much;
            }
            let totals = books.ever.entry((operation.as_str().to_owned(), model.to_string())).or_default();
            totals.microusd += too_much;
            totals.input_tokens += input_tokens;
            totals.output_tokens += output_tokens;
        }
        let spent = Spent {
            day,
            operation: operation.as_str(),
            model,
            input_tokens,
            output_tokens,
            cost_microusd: too_much,
            ..Spent::default()
        };
        self.store.committer().submit_alone(Job::Spend(spent));
    }

    /// A question was answered without a call.
    pub fn hit(&self, operation: Operation, model: &str) {
        let key = (operation.as_str().to_owned(), model.to_owned());
        let mut books = self.lock();
        books.ever.entry(key.clone()).or_default().cache_hits += 1;
        *books.unwritten_hits.entry(key).or_default() += 1;
    }

    /// Is today's budget spent, as far as another call goes?
    pub fn is_spent(&self) -> bool {
        let mut books = self.lock();
        books.turn_to(today());
        self.limits.calls.is_some_and(|limit| books.calls_today >= limit)
            || self.limits.microusd.is_some_and(|limit| books.microusd_today >= limit)
    }

    /// The sums by operation and model, since the database was made.
    pub fn usage(&self) -> Vec<(String, String, Totals)> {
        let books = self.lock();
        books.ever.iter().map(|((operation, model), t)| (operation.clone(), model.clone(), *t)).collect()
    }

    /// Calls and millionths of a dollar of today, and their limits.
    pub fn today(&self) -> (i64, i64, Limits) {
        let mut books = self.lock();
        books.turn_to(today());
        (books.calls_today, books.microusd_today, self.limits)
    }

    fn lock(&self) -> MutexGuard<'_, Books> {
        // Sums: none is worth more than the last whole assignment.
        self.books.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Books {
    fn turn_to(&mut self, day: i64) {
        if day != self.today {
            (self.today, self.calls_today, self.microusd_today) = (day, 0, 0);
        }
    }
}

fn totals(row: &UsageRow) -> Totals {
    Totals {
        calls: row.calls,
        input_tokens: row.input_tokens,
        output_tokens: row.output_tokens,
        microusd: row.cost_microusd,
        cache_hits: row.cache_hits,
    }
}

/// Days since 1970, UTC.
fn today() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    (since.as_secs() / SECONDS_A_DAY) as i64
}
