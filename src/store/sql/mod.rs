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

pub(in crate::store) mod cell;
pub(in crate::store) mod connection;
pub(in crate::store) mod query;
pub(in crate::store) mod row;
pub(in crate::store) mod value;

pub(in crate::store) use connection::{Connection, Engine, Pool, Statements};
pub(in crate::store) use query::{Query, query, query_as, query_scalar, statement};
pub(in crate::store) use row::Row;
