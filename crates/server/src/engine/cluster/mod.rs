//! Several servers over one database: which of them has which map in memory.
//!
//! A map is in the memory of one server, its owner, which alone reads and writes it there. Every server answers every
//! request: for a map of another one it asks that one.
//!
//! | concept | file |
//! |---|---|
//! | the server that should have a map | [`placement`] |
//! | what this server knows of the others | [`membership`] |
//! | its row among them, its leases; maps that another server should have go there | [`joining`] |
//! | where a request is answered | [`routing`] |
//! | copies of maps that others own | [`followers`], [`following`] |
//! | maps of a server that does not answer | [`loading_ahead`] |

pub mod followers;
pub mod following;
mod joining;
mod loading_ahead;
pub mod membership;
mod placement;
pub mod routing;
