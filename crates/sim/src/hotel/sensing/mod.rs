//! Sensing: camera, depth, odometry, detector and text recognition, each with its noise.

pub mod camera;
pub mod misreading;
pub mod monocular;
pub mod noise;
pub mod ocr;
pub mod odometry;
pub mod reader;
pub mod sensor;
pub mod tracking;
pub mod triangulation;
