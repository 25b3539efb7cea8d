//! API keys: permissions, their cache, and protection against locking everybody out.

pub mod access;
pub mod keyring;
pub mod lockout;
mod making;
