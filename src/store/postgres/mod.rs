//! A database that is a PostgreSQL server's, which several of our servers share.
//!
//! | concept | file |
//! |---|---|
//! | connections, pools | [`opening`] |
//! | which server may write to a map | [`leases`] |
//! | the servers that are there | [`nodes`] |
//! | the schema's versions | [`schema`] |

pub(super) mod leases;
pub(super) mod nodes;
pub(super) mod opening;
pub(super) mod schema;
