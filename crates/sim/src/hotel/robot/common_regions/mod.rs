//! Common regions: ORB-SLAM3's conditions for closing a loop (C. Campos et al., "ORB-SLAM3", IEEE T-RO 37, 2021, §VI;
//! the numbers are those of the published program, v1.0).
//!
//! The paper's method extends ORB-SLAM3 (§III), and is compared with bag of words and Sim3, so the robots of both arms
//! apply the same conditions. The server proposes keyframes with a transformation, which correspond to ORB-SLAM3's
//! bag-of-words candidates after RANSAC. For each of them:
//!
//! 1. The map points of the candidate and of the keyframes around it are projected into the query ([`projection`]). 50 must
//!    have a similar feature.
//! 2. The transformation is refined on them, and 20 must remain. The points are projected again with a smaller radius, and
//!    80 must be found.
//! 3. Three neighbours of the query must each find 30 of the points where the transformation predicts them. If
//!    fewer do, the following keyframes are checked: 30 points, then 50 after refinement, then 100. Two consecutive failures
//!    end it ([`confirmation`]).
//!
//! | difference from ORB-SLAM3 | here |
//! |---|---|
//! | candidates | those verified by the server, with 20 inliers of which 12 are certain, instead of 15 of RANSAC among three by words |
//! | search | in a circle around a point, instead of a square with that half side |
//! | following keyframes | the refined transformation is projected and kept; the program projects the one before refinement |
//! | small maps | loops from the first keyframe, instead of the twelfth |
//! | a map point's descriptor and viewing direction | the first ones, instead of the median and the mean |
//! | refinement | ours, with its narrower robust kernel; the candidate's observations are the projected points |
//! | after a loop | no local bundle adjustment, no fusion of points, and at most one loop per ten keyframes |

pub mod confirmation;
pub mod projection;
pub mod refinement;
pub mod window;

#[cfg(test)]
mod tests;
