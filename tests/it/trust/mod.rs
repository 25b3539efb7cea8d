//! Trust: who may do what, how often, how much, and at whose expense.

#[cfg(feature = "llm")]
mod budget;
mod keys;
mod listening;
mod lockout;
mod matrix;
mod quotas;
mod rate;
mod uploads;
