//! Of the service itself.

use serde_json::{Value, json};

use super::parts::{list, second, with};
use crate::usage::Usage;

/// Usage.
pub fn usage() -> Value {
    json!(Usage::without_models())
}

/// Returns a backup to be taken.
pub fn backup_body() -> Value {
    json!({"id": "before-the-upgrade"})
}

fn backup() -> Value {
    json!({
        "id": "before-the-upgrade",
        "created": second(1_793_000_000),
        "bytes": 73_400_320,
        "sha256": "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
        "schema": 2,
        "maps": 3,
        "keyframes": 12_041,
        "anchors": 310
    })
}

/// A backup was taken.
pub fn backup_taken() -> Value {
    with(backup(), json!({"removed": ["b-1792000000"]}))
}

/// Backups.
pub fn backups() -> Value {
    list([backup()])
}

/// The process is alive.
pub fn health() -> Value {
    json!({"status": "alive"})
}

/// The server is ready.
pub fn ready() -> Value {
    json!({"status": "ready"})
}

/// Returns a version.
pub fn version() -> Value {
    json!({"name": "revisit", "version": "0.1.0", "sqlite": "3.51.3", "vocabulary": null})
}

/// Returns the beginning of the API document.
pub fn document() -> Value {
    json!({"openapi": "3.1.0", "info": {"title": "Revisit", "version": "0.1.0"}, "paths": {}})
}
