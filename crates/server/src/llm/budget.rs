//! Budget: a hard daily limit, and usage. The maximum cost of a call is on disk before the call, and settled by the
//! model's report. A crash therefore only overestimates the spending.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use super::port::Fault;
use crate::domain::key::KeySeq;
use crate::domain::report::UsageLine;
use crate::store::{DayLimit, Job, Spent, Store, StoreError, Totals};

const SECONDS_A_DAY: u64 = 86_400;

/// The number by which the server itself pays; keys begin with 1.
pub(super) const SERVER: i64 = 0;

/// The budget and its records.
#[derive(Debug)]
pub struct Budget {
    store: Store,
    limits: DayLimit,
    books: Mutex<Books>,
}

#[derive(Debug, Default)]
struct Books {
    today: i64,
    /// The spending of each payer today: of the server everything, of a key its own part.
    day: BTreeMap<i64, Totals>,
    /// By operation and model, since the database was created.
    ever: BTreeMap<(String, String), Totals>,
    /// Cache hits of them that are not yet written; they are stored with the next call.
    unwritten_hits: BTreeMap<(String, String), i64>,
}

/// A reserved call that is not yet settled.
#[derive(Debug)]
pub struct Reservation(Spent);

impl Budget {
    /// Loads the records from disk.
    pub async fn open(store: Store, limits: DayLimit) -> Result<Self, StoreError> {
        let today = today();
        let mut books = Books { today, ever: store.usage_since(i64::MIN).await?, ..Books::default() };
        let of_keys = store.usage_of_keys(today).await?;
        let of_server = store.usage_since(today).await?.into_values();
        let of_server = of_server.map(|totals| (SERVER, totals.calls, totals.cost_microusd));
        for (payer, calls, cost_microusd) in of_keys.into_iter().chain(of_server) {
            books.of(payer).add(&Spent { calls, cost_microusd, ..Spent::default() });
        }
        Ok(Self { store, limits, books: Mutex::new(books) })
    }

    /// Reserves the maximum cost of a call before the call.
    pub async fn reserve(
        &self,
        operation: &'static str,
        model: &Arc<str>,
        microusd: i64,
        payer: Option<&DayLimit>,
    ) -> Result<Reservation, Fault> {
        let payers: Vec<DayLimit> = [self.limits].into_iter().chain(payer.copied()).collect();
        let (spent, cache_hits) = {
            let mut books = self.books();
            if payers.iter().any(|payer| payer.excludes(microusd, books.of(payer.payer))) {
                return Err(Fault::Spent);
            }
            let spent = Spent {
                day: books.today,
                operation,
                model: model.clone(),
                calls: 1,
                cost_microusd: microusd,
                key: payer.map(|payer| KeySeq(payer.payer)),
                ..Spent::default()
            };
            books.add(&spent);
            let cache_hits = books.unwritten_hits.remove(&name_of(operation, model)).unwrap_or_default();
            (spent, cache_hits)
        };
        // Other servers spend the same day.
        if self.store.is_shared()
            && !Box::pin(self.store.reserve_for_day(spent.day, microusd, &payers)).await?
        {
            self.books().add(&Spent { calls: -1, cost_microusd: -microusd, ..spent });
            return Err(Fault::Spent);
        }
        self.store.committer().commit(Job::Spend(Spent { cache_hits, ..spent.clone() })).await?;
        Ok(Reservation(spent))
    }

    /// Settles a call by its actual usage. Written asynchronously; until then the spending is overestimated.
    pub fn settle(
        &self,
        Reservation(reserved): Reservation,
        input_tokens: u64,
        output_tokens: u64,
        microusd: i64,
    ) {
        let spent = Spent {
            calls: 0,
            input_tokens: input_tokens as i64,
            output_tokens: output_tokens as i64,
            cost_microusd: microusd - reserved.cost_microusd,
            ..reserved
        };
        self.books().add(&spent);
        self.store.committer().submit_alone(Job::Spend(spent.clone()));
        if self.store.is_shared() {
            let store = self.store.clone();
            // Until it is done, and if it is not, the day's spending is overestimated.
            tokio::spawn(async move {
                for payer in payers_of(&spent) {
                    let given_back = (0, -spent.cost_microusd);
                    if let Err(error) = store.give_back_for_day(spent.day, given_back, payer).await {
                        tracing::warn!(%error, "a call of a model was not settled");
                    }
                }
            });
        }
    }

    /// Counts a question answered without a call.
    pub fn hit(&self, operation: &'static str, model: &str) {
        let name = name_of(operation, model);
        let mut books = self.books();
        books.ever.entry(name.clone()).or_default().cache_hits += 1;
        *books.unwritten_hits.entry(name).or_default() += 1;
    }

    /// Whether today's budget has no room for another call.
    pub fn is_spent(&self) -> bool {
        self.is_spent_for(&self.limits)
    }

    /// Whether a payer's own budget of today has no room for another call.
    pub fn is_spent_for(&self, payer: &DayLimit) -> bool {
        payer.excludes(1, self.books().of(payer.payer))
    }

    /// Returns the totals by operation and model since the database was created.
    pub fn usage(&self) -> Vec<UsageLine> {
        let line = |((operation, model), totals): (&(String, String), &Totals)| UsageLine {
            operation: operation.clone(),
            model: model.clone(),
            calls: totals.calls as u64,
            input_tokens: totals.input_tokens as u64,
            output_tokens: totals.output_tokens as u64,
            microusd: totals.cost_microusd as u64,
            cache_hits: totals.cache_hits as u64,
        };
        self.books().ever.iter().map(line).collect()
    }

    /// Returns today's totals, and their limits.
    pub fn today(&self) -> (Totals, DayLimit) {
        (*self.books().of(SERVER), self.limits)
    }

    /// Locks the books, opened at today.
    fn books(&self) -> MutexGuard<'_, Books> {
        // Sums: the last complete assignment is usable after a poisoned lock.
        let mut books = self.books.lock().unwrap_or_else(PoisonError::into_inner);
        let today = today();
        if books.today != today {
            books.today = today;
            books.day.clear();
        }
        books
    }
}

impl Books {
    /// Returns what a payer spent today.
    fn of(&mut self, payer: i64) -> &mut Totals {
        self.day.entry(payer).or_default()
    }

    /// Adds what was spent, or given back.
    fn add(&mut self, spent: &Spent) {
        if self.today == spent.day {
            payers_of(spent).for_each(|payer| self.of(payer).add(spent));
        }
        self.ever.entry(name_of(spent.operation, &spent.model)).or_default().add(spent);
    }
}

fn name_of(operation: &str, model: &str) -> (String, String) {
    (operation.to_owned(), model.to_owned())
}

fn payers_of(spent: &Spent) -> impl Iterator<Item = i64> + use<> {
    [Some(SERVER), spent.key.map(|key| key.0)].into_iter().flatten()
}

/// Returns the days since 1970, UTC.
fn today() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    (since.as_secs() / SECONDS_A_DAY) as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_database::postgres_in;

    #[tokio::test(flavor = "multi_thread")]
    #[ignore = "needs REVISIT_TEST_POSTGRES"]
    async fn servers_that_share_a_database_spend_its_budget_once() {
        let folder = tempfile::tempdir().unwrap();
        let database = postgres_in(folder.path()).await;
        let limits = DayLimit { payer: SERVER, microusd: Some(1_000), calls: None };
        let model: Arc<str> = "model".into();
        let mut budgets = Vec::new();
        for _ in 0..2 {
            let store = Store::open(&database).await.unwrap();
            budgets.push(Arc::new(Budget::open(store, limits).await.unwrap()));
        }
        let asks = (0..40).map(|number| {
            let (budget, model) = (budgets[number % 2].clone(), model.clone());
            tokio::spawn(async move { budget.reserve("describe", &model, 100, None).await })
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
            is_there = budgets[1].reserve("describe", &model, 100, None).await.is_ok();
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
