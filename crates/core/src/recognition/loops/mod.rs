//! Loops (§V): from a query to its verdict.

pub mod anchor_check;
pub mod anchor_map;
pub mod assignment;
pub mod candidates;
pub mod centre;
pub mod check_loop;
pub mod comparison;
pub mod decision;
pub mod equation_1;
pub mod equation_2;
pub mod evidence;
pub mod features;
pub(in crate::recognition) mod fusion;
pub mod geometry_check;
pub mod geometry_snapshot;
pub mod letter;
pub mod low_score;
pub mod points_now;
pub mod query;
pub mod screening;
pub(in crate::recognition) mod similar_pairs;
pub mod wanted_features;
