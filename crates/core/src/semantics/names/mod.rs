//! Names: what a text calls one object, part by part, and how two of them relate (§IV-A.2, entry *names* of docs/method.md).

pub mod code;
pub mod name;
pub mod numbering;
pub mod patterns;
pub mod relation;
pub mod shape;
pub mod spelling;
