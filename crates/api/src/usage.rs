//! Usage: what language models were asked and what it cost.

use revisit_core::domain::report::{UsageLine, UsageReport};
use revisit_shapes::answer;

/// Calls of language models since the database was made, by operation and model.
#[answer]
#[derive(Default)]
pub struct Usage {
    /// Calls.
    pub calls: u64,
    /// Tokens sent.
    pub input_tokens: u64,
    /// Tokens received.
    pub output_tokens: u64,
    /// Cost in US dollars.
    pub cost_usd: f64,
    /// Questions answered from the cache.
    pub cache_hits: u64,
    /// The same by operation and model.
    pub items: Vec<UsageItem>,
    /// One sentence for a person.
    pub detail: String,
    /// Calls since midnight UTC; with models only.
    pub calls_today: Option<u64>,
    /// Cost since midnight UTC, in US dollars; with models only.
    pub cost_usd_today: Option<f64>,
    /// The most calls of a day; left out without such a limit.
    pub daily_calls: Option<u64>,
    /// The most that a day may cost, in US dollars; left out without such a limit.
    pub daily_usd: Option<f64>,
    /// Whether a model is away, or the day's budget spent. With models only.
    pub away: Option<bool>,
}

/// Calls of one model for one operation.
#[answer(of = UsageLine)]
#[derive(Default)]
pub struct UsageItem {
    /// `similarity`, `information`, `merge`, `describe` or `embed`.
    pub operation: String,
    /// The model's name.
    pub model: String,
    /// Calls.
    pub calls: u64,
    /// Tokens sent.
    pub input_tokens: u64,
    /// Tokens received.
    pub output_tokens: u64,
    /// Cost in US dollars.
    #[from(usd(of.microusd))]
    pub cost_usd: f64,
    /// Questions answered from the cache.
    pub cache_hits: u64,
}

/// Millionths of a dollar as dollars.
fn usd(microusd: u64) -> f64 {
    microusd as f64 / 1e6
}

impl From<UsageReport> for Usage {
    fn from(report: UsageReport) -> Self {
        let sum = |of: fn(&UsageLine) -> u64| report.lines.iter().map(of).sum();
        let (calls, cache_hits): (u64, u64) = (sum(|line| line.calls), sum(|line| line.cache_hits));
        Self {
            calls,
            input_tokens: sum(|line| line.input_tokens),
            output_tokens: sum(|line| line.output_tokens),
            cost_usd: usd(sum(|line| line.microusd)),
            cache_hits,
            detail: if report.away {
                "a model is away or the day's budget is spent: the built-in judge stands in".to_owned()
            } else {
                format!("{calls} calls, and {cache_hits} questions answered without one")
            },
            calls_today: Some(report.calls_today),
            cost_usd_today: Some(usd(report.microusd_today)),
            daily_calls: report.daily_calls,
            daily_usd: report.daily_microusd.map(usd),
            away: Some(report.away),
            items: report.lines.into_iter().map(UsageItem::from).collect(),
        }
    }
}

impl Usage {
    /// Returns the usage of a server that has no model to call.
    pub fn without_models() -> Self {
        let detail = "no language model is configured: the built-in judge answers everything, free of charge";
        Self { detail: detail.to_owned(), ..Self::default() }
    }
}
