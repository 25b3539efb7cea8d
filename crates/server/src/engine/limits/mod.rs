//! Limits: how much the engine works on at a time, and what each key may store.

pub(super) mod bounds;
pub(super) mod concurrency_limit;
pub mod load_shedding;
pub(super) mod quota;
mod room;
pub mod shared_turns;
pub(super) mod trigger_queue;
