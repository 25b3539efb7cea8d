//! The robot: a SLAM client with its own pose graph.

pub mod client;
pub mod common_regions;
pub mod loop_closing;
pub mod message;
pub mod pose_graph;
pub mod slam_map;
