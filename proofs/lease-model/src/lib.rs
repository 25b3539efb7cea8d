//! A model of the leases by which several servers over one PostgreSQL own maps.
//!
//! Every step of a server, of the database and of the clock is an [`Action`](action::Action); a checker takes all of them in every
//! order. Properties: two writes never commit the same version, no write is accepted under an epoch that is not the newest, and
//! a read returns at least the newest version that was known before it began.
//!
//! | module | holds |
//! |---|---|
//! | [`state`] | the table `map_owners`, and the memory, transactions and requests of each node |
//! | [`rules`] | the parts of the protocol that can be left out, and the limits of a run |
//! | [`action`] | the names of all steps |
//! | [`steps`] | the protocol: one function for each step |
//! | [`fold`] | states that behave alike become one, so that time, epochs and versions need no limit |
//! | [`cluster`] | the model that the checker runs |
//! | [`account`] | a counterexample in sentences |
//! | [`history`] | histories of the real servers, judged by a search: a second opinion for `proofs/cluster` |
//! | [`cases`] | the runs of `proofs/lease`, and the outcome that each must have |

pub mod account;
pub mod action;
pub mod cases;
pub mod cluster;
pub mod fold;
pub mod history;
pub mod rules;
pub mod state;
pub mod steps;
