//! Budget: a hard daily limit, and usage. The maximum cost of a call is on disk before the call, and settled by the
//! model's report. A crash therefore only overestimates the spending.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use super::daily_limits::{Day, Limits, Payer};
use super::port::{Fault, Operation};
use crate::domain::key::KeySeq;
use crate::store::{DayLimit, Job, Spent, Store, StoreError, UsageRow};

const SECONDS_A_DAY: u64 = 86_400;

/// The number by which the server itself pays; keys begin with 1.
const SERVER: i64 = 0;

/// Totals of one operation and model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Calls, including failed ones.
    pub calls: i64,
    /// Input tokens.
    pub input_tokens: i64,
    /// Output tokens.
    pub output_tokens: i64,
    /// Millionths of a US dollar.
    pub microusd: i64,
    /// Questions answered without a call.
    pub cache_hits: i64,
}

/// The budget and its records.
#[derive(Debug)]
pub struct Budget {
    store: Store,
    limits: Limits,
    books: Mutex<Books>,
}

#[derive(Debug, Default)]
struct Books {
    today: i64,
    day: Day,
    day_of_key: BTreeMap<KeySeq, Day>,
    ever: BTreeMap<(String, String), Totals>,
    /// Cache hits not yet written; they are stored with the next call.
    unwritten_hits: BTreeMap<(String, String), i64>,
}

/// A reserved call that is not yet settled.
#[derive(Debug)]
pub struct Reservation {
    day: i64,
    operation: Operation,
    model: Arc<str>,
    microusd: i64,
    key: Option<KeySeq>,
}

impl Budget {
    /// Loads the records from disk.
    pub async fn open(store: Store, limits: Limits) -> Result<Self, StoreError> {
        let today = today();
        let mut books = Books { today, ..Books::default() };
        for row in store.usage_since(today).await? {
            books.day.calls += row.calls;
            books.day.microusd += row.cost_microusd;
        }
        for (key, calls, microusd) in store.usage_of_keys(today).await? {
            books.day_of_key.insert(KeySeq(key), Day { calls, microusd });
        }
        for row in store.usage_since(i64::MIN).await? {
            books.ever.insert((row.operation.clone(), row.model.clone()), totals(&row));
        }
        Ok(Self { store, limits, books: Mutex::new(books) })
    }

    /// Reserves the maximum cost of a call before the call.
    pub async fn reserve(
        &self,
        operation: Operation,
        model: &Arc<str>,
        microusd: i64,
        payer: Option<&Payer>,
    ) -> Result<Reservation, Fault> {
        let day = today();
        let payers_key = payer.map(|payer| payer.key);
        let cache_hits = {
            let mut books = self.lock();
            books.turn_to(day);
            let with_this = books.day.and(microusd);
            let of_payer = payer.map(|payer| (payer, books.of(payer.key).and(microusd)));
            if self.limits.broken_by(with_this)
                || of_payer.is_some_and(|(payer, day)| payer.limits.broken_by(day))
            {
                return Err(Fault::Spent);
            }
            books.day = with_this;
            if let Some((payer, day)) = of_payer {
                books.day_of_key.insert(payer.key, day);
            }
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
            key: payers_key,
            ..Spent::default()
        };
        if self.store.is_shared() && !Box::pin(self.is_reserved_among_others(day, microusd, payer)).await? {
            self.undo(&Reservation { day, operation, model: model.clone(), microusd, key: payers_key });
            return Err(Fault::Spent);
        }
        let written = self.store.committer().commit(Job::Spend(spent)).await;
        written.map_err(|error| Fault::Store(error.to_string()))?;
        Ok(Reservation { day, operation, model: model.clone(), microusd, key: payers_key })
    }

    /// Reserves a call in the database, whose day other servers spend as well.
    async fn is_reserved_among_others(
        &self,
        day: i64,
        microusd: i64,
        payer: Option<&Payer>,
    ) -> Result<bool, Fault> {
        let limit =
            |payer: i64, limits: Limits| DayLimit { payer, calls: limits.calls, microusd: limits.microusd };
        let mut payers = vec![limit(SERVER, self.limits)];
        payers.extend(payer.map(|payer| limit(payer.key.0, payer.limits)));
        let reserved = self.store.reserve_for_day(day, microusd, &payers).await;
        reserved.map_err(|error| Fault::Store(error.to_string()))
    }

    /// Takes a reservation back that nothing came of.
    fn undo(&self, reservation: &Reservation) {
        let Reservation { day, operation, model, microusd, key } = reservation;
        let mut books = self.lock();
        if books.today == *day {
            books.day.calls -= 1;
            books.day.microusd -= microusd;
            if let Some(of_key) = key.and_then(|key| books.day_of_key.get_mut(&key)) {
                of_key.calls -= 1;
                of_key.microusd -= microusd;
            }
        }
        let totals = books.ever.entry((operation.as_str().to_owned(), model.to_string())).or_default();
        totals.calls -= 1;
        totals.microusd -= microusd;
    }

    /// Settles a call by its actual usage. Written asynchronously; until then the spending is overestimated.
    pub fn settle(&self, reservation: Reservation, input_tokens: u64, output_tokens: u64, microusd: i64) {
        let Reservation { day, operation, model, microusd: reserved, key } = reservation;
        let (input_tokens, output_tokens) = (input_tokens as i64, output_tokens as i64);
        let too_much = microusd - reserved;
        {
            let mut books = self.lock();
            if books.today == day {
                books.day.microusd += too_much;
                if let Some(of_key) = key.and_then(|key| books.day_of_key.get_mut(&key)) {
                    of_key.microusd += too_much;
                }
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
            key,
            ..Spent::default()
        };
        self.store.committer().submit_alone(Job::Spend(spent));
        if self.store.is_shared() {
            let store = self.store.clone();
            // Until it is done, and if it is not, the day's spending is overestimated.
            tokio::spawn(async move {
                for payer in [Some(SERVER), key.map(|key| key.0)].into_iter().flatten() {
                    if let Err(error) = store.give_back_for_day(day, (0, -too_much), payer).await {
                        tracing::warn!(%error, "a call of a model was not settled");
                    }
                }
            });
        }
    }

    /// Counts a question answered without a call.
    pub fn hit(&self, operation: Operation, model: &str) {
        let key = (operation.as_str().to_owned(), model.to_owned());
        let mut books = self.lock();
        books.ever.entry(key.clone()).or_default().cache_hits += 1;
        *books.unwritten_hits.entry(key).or_default() += 1;
    }

    /// Whether today's budget has no room for another call.
    pub fn is_spent(&self) -> bool {
        let mut books = self.lock();
        books.turn_to(today());
        self.limits.used_up_by(books.day)
    }

    /// Whether a key's own budget of today has no room for another call.
    pub fn is_spent_for(&self, payer: &Payer) -> bool {
        let mut books = self.lock();
        books.turn_to(today());
        payer.limits.used_up_by(books.of(payer.key))
    }

    /// Returns the totals by operation and model since the database was created.
    pub fn usage(&self) -> Vec<(String, String, Totals)> {
        let books = self.lock();
        books.ever.iter().map(|((operation, model), t)| (operation.clone(), model.clone(), *t)).collect()
    }

    /// Returns today's calls and cost in millionths of a dollar, and their limits.
    pub fn today(&self) -> (i64, i64, Limits) {
        let mut books = self.lock();
        books.turn_to(today());
        (books.day.calls, books.day.microusd, self.limits)
    }

    fn lock(&self) -> MutexGuard<'_, Books> {
        // Sums: the last complete assignment is usable after a poisoned lock.
        self.books.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Books {
    fn turn_to(&mut self, day: i64) {
        if day != self.today {
            self.today = day;
            self.day = Day::default();
            self.day_of_key.clear();
        }
    }

    fn of(&self, key: KeySeq) -> Day {
        self.day_of_key.get(&key).copied().unwrap_or_default()
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

/// Returns the days since 1970, UTC.
fn today() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    (since.as_secs() / SECONDS_A_DAY) as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::test_database::postgres_in;

    #[tokio::test(flavor = "multi_thread")]
    #[ignore = "needs REVISIT_TEST_POSTGRES"]
    async fn servers_that_share_a_database_spend_its_budget_once() {
        let folder = tempfile::tempdir().unwrap();
        let database = postgres_in(folder.path()).await;
        let limits = Limits { microusd: Some(1_000), calls: None };
        let model: Arc<str> = "model".into();
        let mut budgets = Vec::new();
        for _ in 0..2 {
            let store = Store::open(&database).await.unwrap();
            budgets.push(Arc::new(Budget::open(store, limits).await.unwrap()));
        }
        let asks = (0..40).map(|number| {
            let (budget, model) = (budgets[number % 2].clone(), model.clone());
            tokio::spawn(async move { budget.reserve(Operation::Describe, &model, 100, None).await })
        });
        let mut reserved = Vec::new();
        for asked in asks.collect::<Vec<_>>() {
            match asked.await.unwrap() {
                Ok(reservation) => reserved.push(reservation),
                Err(fault) => assert!(matches!(fault, Fault::Spent), "{fault:?}"),
            }
        }
        assert_eq!(reserved.len(), 10);
        // What was not spent is there again, for either.
        let last = reserved.pop().unwrap();
        budgets[0].settle(last, 1, 1, 0);
        let mut is_there = false;
        for _ in 0..200 {
            is_there = budgets[1].reserve(Operation::Describe, &model, 100, None).await.is_ok();
            if is_there {
                break;
            }
            tokio::time::sleep(std::time::Duration::from_millis(20)).await;
        }
        assert!(is_there);
        for budget in budgets {
            budget.store.close().await;
        }
    }
}
