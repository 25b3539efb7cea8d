//! Of asking a changed model again.

use serde_json::{Value, json};

use super::parts::{with, without};

/// Returns a job to be counted first.
pub fn judgement_body() -> Value {
    json!({"asks": "texts", "preview": true})
}

/// Returns what a job would take.
pub fn judgement_preview() -> Value {
    let members = json!({"state": "preview", "changed": 0, "unchanged": 0, "left": 12, "replaced": []});
    with(without(judgement(), &["id"]), members)
}

/// Returns a job that is done.
pub fn judgement() -> Value {
    json!({
        "id": "j-1",
        "map_version": 420,
        "state": "done",
        "asks": "texts",
        "questions": 12,
        "calls_max": 22,
        "cost_max_usd": 0.0184,
        "changed": 1,
        "unchanged": 11,
        "gone": 0,
        "failed": 0,
        "left": 0,
        "replaced": [{
            "map_version": 414,
            "operation": "similarity",
            "class": "painting",
            "texts": ["a portrait of a lady with a mysterious smile", "the famous portrait of mona lisa"],
            "before": "3",
            "source_before": "model:small",
            "after": "5",
            "source_after": "model:large"
        }]
    })
}

/// Returns a verdict of a model about two texts.
pub fn model_verdict() -> Value {
    json!({
        "operation": "similarity", "class": "painting", "texts": ["a red boat at sea", "a sailing ship, red"], "level": 4,
        "source": "model:gpt-4o-mini", "reason": "Both are a red vessel under sail."
    })
}

/// Returns the answer to a verdict that was brought.
pub fn model_verdict_answer() -> Value {
    json!({"map_version": 10, "applied": true})
}
