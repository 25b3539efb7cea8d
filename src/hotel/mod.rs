//! Hotel: the paper's experiment (§VI-A), simulated.

pub mod absolute_pose_error;
pub mod arm;
pub mod camera;
pub mod chance;
pub mod floor_plan;
pub mod furnishing;
pub mod journey;
pub mod message;
pub mod noise;
pub mod odometry;
pub mod paper;
pub mod pose_graph;
pub mod reader;
pub mod robot;
pub mod route;
pub mod scenario;
pub mod score;
pub mod sensor;
pub mod signs;
pub mod texture;
pub mod tracking;
pub mod trial;
pub mod truth;
pub mod world;
