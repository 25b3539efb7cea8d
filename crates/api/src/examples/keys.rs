//! Of API keys.

use revisit_core::domain::key::Action;
use serde_json::{Value, json};

use super::parts::{list, second, with};
use crate::key::FIRST_KEY_NOTICE;

/// Returns a key to be made: the administrator's, because a server's first key must be one.
pub fn key_body() -> Value {
    json!({"name": "administrator", "actions": Action::NAMES})
}

fn administrator() -> Value {
    with(key_body(), json!({"id": "key-1", "maps": ["*"], "created": second(1_795_000_000)}))
}

/// Returns a key of robots.
pub fn robots_key() -> Value {
    json!({
        "id": "key-2",
        "name": "cleaning robots, tower",
        "actions": ["read", "write", "query"],
        "maps": ["tower", "tower-*"],
        "created": second(1_795_000_000),
        "expires": second(1_893_456_000),
        "rate_per_s": 200,
        "model_daily_usd": 1.5
    })
}

/// Returns a key that was just made.
pub fn made_key() -> Value {
    let secret = "revisit_0123456789abcdefghijklmnopqrstuvwxyzABCDEFG";
    with(administrator(), json!({"secret": secret, "notice": FIRST_KEY_NOTICE}))
}

/// Keys.
pub fn keys() -> Value {
    list([administrator(), robots_key()])
}
