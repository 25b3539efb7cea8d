//! Hotel: the paper's experiment (§VI-A), simulated, with a SLAM client that talks to a real server over HTTP.
//!
//! | concept | file |
//! |---|---|
//! | the floor from above | [`building::floor_plan`] |
//! | what a camera may recognise, and how it looks | [`building::furnishing`], [`building::texture`] |
//! | what can be read | [`building::signs`] |
//! | a floor with everything on it | [`building::world`] |
//! | where the robot goes | [`route`] |
//! | what its camera and detector see | [`sensing::camera`], [`sensing::sensor`], [`sensing::reader`], [`sensing::ocr`], [`sensing::tracking`] |
//! | what it believes of its way | [`sensing::odometry`], [`robot::pose_graph`], [`robot::scale_graph`] |
//! | all that on one tour | [`sequence`] |
//! | the same without depth | [`sensing::monocular`], [`sensing::triangulation`] |
//! | door numbers that change | [`building::renumbering`] |
//! | what is true | [`scoring::truth`] |
//! | the robot as a client | [`robot::client`], [`robot::slam_map`], [`robot::message`] |
//! | which loops it closes, and what ORB-SLAM3 asks before | [`robot::loop_closing`], [`robot::common_regions`] |
//! | methods, troubles, worlds, floors that are alike | [`method`], [`sensing::noise`], [`scenario`], [`building::storeys`] |
//! | one method through one world | [`run`] |
//! | how it did | [`scoring::score`], [`scoring::absolute_pose_error`], [`scoring::results`], [`scoring::curve`] |
//! | for a person | [`scoring::tables`], [`figures`], [`scoring::explain`], [`scoring::tum`], [`scoring::paper`] |
//! | a tour for `revisit replay` | [`recording`] |
//! | randomness, and which worlds may be looked at | [`rng`], [`seeds`] |
//! | is it realistic? | [`building::realism`] |
//!
//! # How real is it?
//!
//! A simulation that is easier than the world proves nothing. These figures are measured by [`building::realism::measure`] on a tour
//! through SE1, and a test holds them in range:
//!
//! | figure | here | held against |
//! |---|---|---|
//! | features of an image | about 330 of at most 400 | ORB-SLAM3 extracts 1,000 and more; fewer make the task harder |
//! | two views of one point | 12 to 40 bits of 256 apart | E. Rublee et al., ICCV 2011: inliers of ORB peak at 30 to 50 |
//! | bag-of-words score of one place on two visits | about 0.23 | in the recording `euroc` true loops and others are told apart best at 0.12 (`revisit replay`) |
//! | the same between twin rooms | about 0.15 | above that: by words a twin room is a loop, as the paper's Figure 1 shows |
//! | between a room and the corridor | about 0.07 | below that |
//! | Sim3 between twin rooms | verified for at least 70 % of the same views, with about 100 inliers | ORB-SLAM3 closed a false loop in each of the paper's rooms (precision 16.7 %: one in six) |
//! | drift | the paper's Table III, sequence by sequence | ORB-SLAM3 with loop closing off |
//!
//! What it leaves out: images themselves (features are simulated, so blur, lighting and people are not), lens distortion, a
//! robot that loses track, and rooms whose furniture has moved between visits.

pub mod building;
pub mod figures;
pub mod method;
pub mod recording;
pub mod rng;
pub mod robot;
pub mod route;
pub mod run;
pub mod scenario;
pub mod scoring;
pub mod seeds;
pub mod sensing;
pub mod sequence;
