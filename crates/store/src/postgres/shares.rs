//! Shares: a key's rate and a day's budget of models, among servers.

use std::collections::HashMap;
use std::time::Duration;

use crate::rows::model_rows::Totals;
use crate::sql;
use crate::{Store, StoreError};

/// Time for which a rate that a server told counts.
const RATES_LAST: Duration = Duration::from_secs(3);

/// A limit on a day's calls of models and their cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DayLimit {
    /// The payer: 0 is the server, else a key.
    pub payer: i64,
    /// The most calls of the day.
    pub calls: Option<i64>,
    /// The most that they cost, in millionths of a US dollar.
    pub microusd: Option<i64>,
}

impl DayLimit {
    /// Whether one more call of this cost, in millionths of a US dollar, would exceed the limits on a day that has come to these sums.
    pub fn excludes(&self, microusd: i64, day: &Totals) -> bool {
        let over = |limit: Option<i64>, sum: i64| limit.is_some_and(|limit| sum > limit);
        over(self.calls, day.calls + 1) || over(self.microusd, day.cost_microusd + microusd)
    }
}

/// The requests of a key at other servers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Elsewhere {
    /// Requests a second.
    pub requests: u32,
    /// Servers that admit any.
    pub servers: u32,
}

impl Store {
    /// Whether several servers may share this database, and so rates and budgets.
    pub fn is_shared(&self) -> bool {
        self.leases.is_some()
    }

    /// Reserves a call and its cost for everybody who pays for it; false if a limit would be exceeded, and then nothing is reserved.
    pub async fn reserve_for_day(
        &self,
        day: i64,
        microusd: i64,
        payers: &[DayLimit],
    ) -> Result<bool, StoreError> {
        for (number, limit) in payers.iter().enumerate() {
            let is_reserved = self.reserve_of(day, microusd, limit).await;
            if !matches!(is_reserved, Ok(true)) {
                for reserved in &payers[..number] {
                    self.give_back_for_day(day, (1, microusd), reserved.payer).await?;
                }
                return is_reserved;
            }
        }
        Ok(true)
    }

    async fn reserve_of(&self, day: i64, microusd: i64, limit: &DayLimit) -> Result<bool, StoreError> {
        // A day begins with what was spent before anything was reserved in this table.
        let begin = "insert into model_days (day, payer, calls, cost_microusd)
            select $1, $2, coalesce(sum(calls), 0), coalesce(sum(cost_microusd), 0) from
            (select calls, cost_microusd from model_usage where day = $1 and $2 = 0
                union all select calls, cost_microusd from key_usage where day = $1 and key = $2) as spent
            on conflict do nothing";
        sql::query(begin).bind(day).bind(limit.payer).execute(&self.readers).await?;
        let update = "update model_days set calls = calls + 1, cost_microusd = cost_microusd + $3
            where day = $1 and payer = $2 and calls < $4 and cost_microusd + $3 <= $5";
        let query = sql::query(update).bind(day).bind(limit.payer).bind(microusd);
        let query = query.bind(limit.calls.unwrap_or(i64::MAX)).bind(limit.microusd.unwrap_or(i64::MAX));
        Ok(query.execute(&self.readers).await? > 0)
    }

    /// Gives back calls, and what was reserved and not spent.
    pub async fn give_back_for_day(
        &self,
        day: i64,
        (calls, microusd): (i64, i64),
        payer: i64,
    ) -> Result<(), StoreError> {
        let update = "update model_days set calls = calls - $3, cost_microusd = cost_microusd - $4
            where day = $1 and payer = $2";
        sql::query(update).bind(day).bind(payer).bind(calls).bind(microusd).execute(&self.readers).await?;
        Ok(())
    }

    /// Says how many requests a second this server admitted of each key, and returns what the others say.
    pub async fn share_rates(&self, admitted: &[(i64, u32)]) -> Result<HashMap<i64, Elsewhere>, StoreError> {
        let Some(leases) = &self.leases else { return Ok(HashMap::new()) };
        let upsert = "insert into key_rates (key, node, requests, expires)
            values ($1, $2, $3, clock_timestamp() + make_interval(secs => $4))
            on conflict (key, node) do update set requests = excluded.requests, expires = excluded.expires";
        for (key, requests) in admitted {
            let query = sql::query(upsert).bind(*key).bind(leases.node()).bind(i64::from(*requests));
            query.bind(RATES_LAST.as_secs_f64()).execute(&self.readers).await?;
        }
        let sweep = "delete from key_rates where expires < clock_timestamp()";
        sql::query(sweep).execute(&self.readers).await?;
        let select = "select key, cast(sum(requests) as bigint), count(*) from key_rates
            where node <> $1 and expires > clock_timestamp() group by key";
        let rows: Vec<(i64, i64, i64)> =
            sql::query_as(select).bind(leases.node()).fetch_all(&self.readers).await?;
        let elsewhere = |(key, requests, servers): (i64, i64, i64)| {
            let bounded = |number: i64| u32::try_from(number).unwrap_or(u32::MAX);
            (key, Elsewhere { requests: bounded(requests), servers: bounded(servers) })
        };
        Ok(rows.into_iter().map(elsewhere).collect())
    }
}
