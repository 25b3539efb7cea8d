//! Hotel: the paper's experiment (§VI-A), simulated, with a SLAM client that queries a real server over HTTP.
//!
//! | concept | file |
//! |---|---|
//! | the floor plan | [`building::floor_plan`] |
//! | recognisable points and their appearance | [`building::furnishing`], [`building::texture`] |
//! | signs | [`building::signs`] |
//! | a complete floor | [`building::world`] |
//! | the robot's route | [`route`] |
//! | the output of its camera and detector | [`sensing::camera`], [`sensing::sensor`], [`sensing::reader`], [`sensing::ocr`], [`sensing::tracking`] |
//! | its pose estimates | [`sensing::odometry`], [`robot::pose_graph`] |
//! | all sensor data of a tour | [`sequence`] |
//! | the same without depth | [`sensing::monocular`], [`sensing::triangulation`] |
//! | changing door numbers | [`building::renumbering`] |
//! | ground truth | [`scoring::truth`] |
//! | the robot as a client | [`robot::client`], [`robot::slam_map`], [`robot::message`] |
//! | which loops it closes, and ORB-SLAM3's conditions for them | [`robot::loop_closing`], [`robot::common_regions`] |
//! | methods, noise, worlds, identical-looking floors | [`method`], [`sensing::noise`], [`scenario`], [`building::storeys`] |
//! | a run of one method in one world | [`run`] |
//! | its scores | [`scoring::score`], [`scoring::absolute_pose_error`], [`scoring::results`] |
//! | presentation | [`scoring::tables`], [`figures`], [`scoring::explain`], [`scoring::tum`], [`scoring::paper`] |
//! | a tour for `revisit replay` | [`recording`] |
//! | random numbers, and which worlds are held out | [`rng`], [`seeds`] |
//! | a robot that wakes up and asks where it is | [`restart`] |
//! | realism (a test) | `building/realism.rs` |
//!
//! # Realism
//!
//! A simulation that is easier than reality proves nothing. `building/realism.rs` measures these figures on a
//! tour through SE1, and a test keeps them in range:
//!
//! | figure | here | compared with |
//! |---|---|---|
//! | features of an image | about 330 of at most 400 | ORB-SLAM3 extracts 1,000 and more; fewer make the task harder |
//! | two views of one point | 12 to 40 bits of 256 apart | E. Rublee et al., ICCV 2011: inliers of ORB peak at 30 to 50 |
//! | bag-of-words score of one place on two visits | about 0.23 | in the recording `euroc`, 0.12 separates true loops from others best (`revisit replay`) |
//! | the same between twin rooms | about 0.15 | higher than that: by words a twin room is a loop, as in the paper's Figure 1 |
//! | between a room and the corridor | about 0.07 | lower than that |
//! | Sim3 between twin rooms | verified for at least 70 % of the same views, with about 100 inliers | ORB-SLAM3 closed a false loop in each of the paper's rooms (precision 16.7 %: one in six) |
//! | drift | the paper's Table III, per sequence | ORB-SLAM3 with loop closing off |
//!
//! Not simulated: images themselves (features are simulated, so there is no blur, lighting or people), lens
//! distortion, loss of tracking, and furniture that moves between visits.

pub mod building;
pub mod figures;
pub mod method;
pub mod recording;
pub mod restart;
pub mod rng;
pub mod robot;
pub mod route;
pub mod run;
pub mod scenario;
pub mod scoring;
pub mod seeds;
pub mod sensing;
pub mod sequence;
