//! Buildings: small simulated buildings of many kinds, whose robots close every loop that they are told.
//!
//! The hotel ([`crate::hotel`]) is one building, seen in detail. Here each *kind* of building has one property that deceives
//! place recognition: another way to number doors, notices at each door, a billboard that every floor sees, a wing that is the
//! mirror image of another. Half of the kinds are for tuning, half only for reporting ([`kind::Kind::TUNING`],
//! [`kind::Kind::HELD_OUT`]). A world has 150 to 400 keyframes and plays in seconds.
//!
//! | concept | file |
//! |---|---|
//! | kinds, and what each one has | [`kind`] |
//! | ways to number doors | [`naming`] |
//! | notices, brands, pictures, pointers | [`texts`] |
//! | corridors, rooms, signs and looks | [`world`] |
//! | where the robots drive | [`route`] |
//! | odometry that drifts | [`motion`] |
//! | what a reader makes of a sign | [`reader`] |
//! | what a keyframe sees, and the body that its client sends | [`sight`] |
//! | which keyframes are one place | [`truth`] |
//! | a world played against a server, or recorded | [`play`] |
//! | scores, reliability of confidences, tables | [`score`], [`reliability`], [`tables`] |
//!
//! Not simulated: images, lighting, people, doors that open, and readers that depend on the viewing angle. Signs have no size,
//! and walls hide only what is in another room or corridor.

pub mod kind;
pub mod motion;
pub mod naming;
pub mod play;
pub mod reader;
pub mod reliability;
pub mod route;
pub mod score;
pub mod sight;
pub mod tables;
pub mod texts;
pub mod truth;
pub mod world;
