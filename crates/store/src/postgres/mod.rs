//! A database that is a PostgreSQL server's, which several of our servers share.
//!
//! | concept | file |
//! |---|---|
//! | connections, pools | [`super::opening::postgres`] |
//! | which server may write to a map | [`leases`] |
//! | the servers that are there | [`nodes`] |
//! | what a map's newest versions changed | [`change_log`] |
//! | the servers that follow a map | [`followers`], [`followed`] |
//! | keys' rates and budgets of models, across servers | [`shares`] |
//! | the schema's versions | [`schema`] |

pub(super) mod change_log;
mod followed;
mod followers;
mod key_list;
pub(super) mod leases;
pub(super) mod nodes;
pub(super) mod schema;
pub(super) mod shares;
