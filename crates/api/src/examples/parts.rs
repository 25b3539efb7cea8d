//! Parts that several examples have, and examples made of others.

use serde_json::{Value, json};

/// No rotation.
pub(super) const UPRIGHT: [f64; 4] = [0.0, 0.0, 0.0, 1.0];
/// A rotation about z.
pub(super) const TURNED: [f64; 4] = [0.0, 0.0, 0.6, 0.8];

/// Returns a transformation.
pub(super) fn transform([x, y, z]: [f64; 3], [qx, qy, qz, qw]: [f64; 4]) -> Value {
    json!({"translation": {"x": x, "y": y, "z": z}, "rotation": {"x": qx, "y": qy, "z": qz, "w": qw}})
}

/// Returns a whole second.
pub(super) fn second(sec: i64) -> Value {
    json!({"sec": sec, "nanosec": 0})
}

/// Returns a list that has one part.
pub(super) fn list(items: impl Into<Value>) -> Value {
    json!({"items": items.into(), "next_cursor": null})
}

/// Returns a list that has one part, at a version of the map.
pub(super) fn list_at(map_version: u64, items: impl Into<Value>) -> Value {
    with(list(items), json!({"map_version": map_version}))
}

/// Returns an example with these members, which replace its own.
pub(super) fn with(mut example: Value, members: Value) -> Value {
    if let (Value::Object(of), Value::Object(members)) = (&mut example, members) {
        of.extend(members);
    }
    example
}

/// Returns an example without these members.
pub(super) fn without(mut example: Value, names: &[&str]) -> Value {
    if let Value::Object(of) = &mut example {
        of.retain(|name, _| !names.contains(&name.as_str()));
    }
    example
}
