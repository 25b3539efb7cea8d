//! Common regions: what ORB-SLAM3 asks of a loop before it closes it (C. Campos et al., "ORB-SLAM3", IEEE T-RO 37, 2021,
//! §VI; the numbers are those of the published program, v1.0).
//!
//! The paper's method is built into ORB-SLAM3 (§III), and it is what bag of words and Sim3 are compared with, so the robots of
//! both arms ask the same. The server proposes keyframes with a transformation, which stand for ORB-SLAM3's candidates of bag
//! of words after RANSAC. For each of them:
//!
//! 1. The map points of the candidate and of the keyframes around it are projected into the query ([`projection`]): 50 must
//!    have a feature that looks like them.
//! 2. The transformation is refined on them, 20 must stay, and the points are projected again, in a smaller radius: 80.
//! 3. Three neighbours of the query must each find 30 of the points where the transformation has them. If fewer do, the
//!    keyframes that follow are asked, with 30, then 50 after refinement, then 100; two that fail in a row end it
//!    ([`confirmation`]).
//!
//! | what differs from ORB-SLAM3 | here |
//! |---|---|
//! | candidates | what the server verifies, with 20 inliers of which 12 are beyond doubt, instead of 15 of RANSAC among three by words |
//! | search | in a circle around a point, instead of a square of that half side |
//! | keyframes that follow | the refined transformation is projected and kept; the program projects the one before refinement |
//! | small maps | loops from the first keyframe on, instead of the twelfth |
//! | a map point's descriptor and viewing direction | the first ones, instead of the median and the mean |
//! | refinement | ours, with its narrower robust kernel; points are seen in the candidate where they project |
//! | after a loop | no local bundle adjustment, no fusion of points, and a loop at every tenth keyframe at most |

pub mod confirmation;
pub mod projection;
pub mod refinement;
pub mod window;

#[cfg(test)]
mod tests;
