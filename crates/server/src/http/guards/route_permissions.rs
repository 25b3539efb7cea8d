//! The permission that each operation needs, as the API document declares it.
//!
//! The documented permissions are the enforced ones. An operation without a `security` member is denied to every
//! caller, and so is an undocumented route: an omission admits no request.

use std::collections::HashMap;

use axum::http::Method;
use serde_json::Value;

use crate::domain::key::Action;

/// The name of the security scheme in the API document.
pub const SCHEME: &str = "key";

/// The permission that an operation needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Permission {
    /// None: every caller is allowed.
    Nothing,
    /// A key, whatever it may do.
    AnyKey,
    /// A key with this action.
    Action(Action),
    /// Not declared: every caller is denied.
    Undeclared,
}

/// The permission of each operation, by its method and the pattern of its route.
#[derive(Debug, Default)]
pub struct RoutePermissions(HashMap<(Method, String), Permission>);

impl RoutePermissions {
    /// Reads them from the API document.
    pub fn of(document: &Value) -> Self {
        let paths = document["paths"].as_object().into_iter().flatten();
        let operations = paths.flat_map(|(path, item)| {
            item.as_object().into_iter().flatten().filter_map(move |(method, operation)| {
                let method = Method::from_bytes(method.to_uppercase().as_bytes()).ok()?;
                Some(((method, path.clone()), declared(operation)))
            })
        });
        Self(operations.collect())
    }

    /// Returns the permission of an operation. If the route documents only other methods, fails with these, formatted
    /// for `allow`.
    pub fn find(&self, method: &Method, route: &str) -> Result<Permission, String> {
        // The router handles HEAD like GET.
        let asked = if method == Method::HEAD { &Method::GET } else { method };
        if let Some(permission) = self.0.get(&(asked.clone(), route.to_owned())) {
            return Ok(*permission);
        }
        let mut allowed: Vec<&str> =
            self.0.keys().filter(|(_, path)| path == route).map(|(method, _)| method.as_str()).collect();
        if allowed.is_empty() {
            return Ok(Permission::Undeclared);
        }
        if allowed.contains(&"GET") {
            allowed.push("HEAD");
        }
        allowed.sort_unstable();
        Err(allowed.join(","))
    }
}

/// Reads the permission that an operation of the document declares.
fn declared(operation: &Value) -> Permission {
    let Some(requirement) = operation["security"].get(0).and_then(Value::as_object) else {
        return Permission::Undeclared;
    };
    if requirement.is_empty() {
        return Permission::Nothing;
    }
    match requirement.get(SCHEME).and_then(Value::as_array).map(Vec::as_slice) {
        Some([]) => Permission::AnyKey,
        Some([action, ..]) => {
            let action = action.as_str().and_then(Action::from_name);
            action.map_or(Permission::Undeclared, Permission::Action)
        }
        None => Permission::Undeclared,
    }
}
