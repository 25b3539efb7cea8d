//! Odds: a loop is a bet on a place against its rivals, and the sum of its evidence is shown (M64).
//!
//! The rivals of a place are the other places of the map, a place unlike any, and a copy of this place that nobody has
//! mapped. A copy shows the same looks, pictures, notices and brands over any length of drive; only names and codes tell it
//! apart. So everything that a copy shares proves no more, together, than that there is no copy.
//!
//! | step | file |
//! |---|---|
//! | whole numbers that are added in any order | [`log_odds`] |
//! | the weights, with their sources | [`weights`] |
//! | what the robot read on its way here | [`drive`] |
//! | names that are read alike, or exclude each other | [`names`] |
//! | what is known of a candidate before geometry | [`bet`] |
//! | the sum of its evidence | [`sum`] |
//! | other places of the map that are as likely | [`rivals`] |
//! | the same for a camera that knows of no way | [`place`] |
//! | the decision, and its reason | [`conclusion`] |
//! | the answer in one sentence | [`why`] |

pub mod bet;
pub mod conclusion;
pub mod drive;
mod exclusions;
pub mod log_odds;
pub mod names;
pub mod place;
pub mod rivals;
pub mod sum;
pub mod weights;
pub mod why;
