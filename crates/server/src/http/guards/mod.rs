//! Guards: layers that admit or reject a request before its handler.

pub mod access;
pub mod admission;
pub mod body_memory;
pub mod loopback_guard;
pub mod route_permissions;
pub mod stream_limit;
