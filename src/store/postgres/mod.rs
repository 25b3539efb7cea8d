//! A database that is a PostgreSQL server's, which several of our servers share.
//!
//! | concept | file |
//! |---|---|
//! | connections, pools | [`opening`] |
//! | the schema's versions | [`schema`] |

pub(super) mod opening;
pub(super) mod schema;
