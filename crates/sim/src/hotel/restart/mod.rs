//! Restart: a robot wakes up somewhere on one of three floors that look alike, and asks where it is.
//!
//! | concept | file |
//! |---|---|
//! | the floors as maps, and the restarts on them | [`world`] |
//! | questions and answers | [`asking`] |
//! | which answers are right, and the table | [`score`] |

pub mod asking;
pub mod score;
pub mod world;
