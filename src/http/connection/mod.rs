//! Connections: accepting, limiting, timing out and rejecting them.

pub mod answer_memory;
pub mod body_completion;
pub mod bound_answers;
pub mod connection_limit;
pub mod io_timeout;
pub mod min_rate_body;
pub mod protocol_errors;
pub mod reject_connection;
pub mod server;
pub mod sockets;
pub mod unread;
