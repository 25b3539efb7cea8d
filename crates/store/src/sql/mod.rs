//! One SQL for both engines, SQLite and PostgreSQL.
//!
//! The statements of this program are plain SQL with parameters `$1` and so on, which both engines take as they are. The few
//! that differ are written twice, side by side. `sqlx` speaks to each engine in its own types; this room joins them at the
//! three places where they meet a statement: its values, the connection it goes to, and the rows that come back. (`sqlx::Any`
//! does this, too, but knows no narrower integers and copies every row.)
//!
//! | concept | file |
//! |---|---|
//! | a statement with its values | [`mod@query`] |
//! | values that go into one | [`value`] |
//! | rows that come out of one | [`row`] |
//! | values as they are, of a row that is copied | [`cell`] |
//! | connections and pools of either engine | [`connection`] |
//! | transactions that a full disk cannot confuse | [`transaction`] |

pub(crate) mod cell;
pub(crate) mod connection;
pub(crate) mod query;
pub(crate) mod row;
pub(crate) mod transaction;
pub(crate) mod value;

pub(crate) use connection::{Connection, Engine, Pool, Statements};
pub(crate) use query::{Query, query, query_as, query_scalar, run, statement};
pub(crate) use row::Row;
