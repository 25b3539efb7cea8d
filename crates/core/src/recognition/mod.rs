//! The paper, section by section. Pure: values in, values out; no IO, clock, randomness or async.
//!
//! | paper | file | function |
//! |---|---|---|
//! | §III, an anchor seen before triggers loop detection | [`anchors::ingest`] | [`anchors::ingest::ingest`] |
//! | §IV-B, what an anchor is | [`map::index`] | [`map::index::Anchor`], [`map::index::MergedAnchor`] |
//! | §IV-A.3, what a model is asked, and what its answer changes | [`anchors::find_description_tasks`], [`anchors::apply_model_answer`], [`anchors::rejudging`] | [`anchors::find_description_tasks::find_description_tasks`], [`anchors::apply_model_answer::learn_reading`] |
//! | §IV-B, which texts a model is asked to compare | [`anchors::pairs`], [`anchors::near_in_meaning`] | [`anchors::pairs::Embeddings`] |
//! | §IV-C.1, object tracking | [`anchors::association`] | [`anchors::association::associate`] |
//! | §IV-C.2, semantic anchor matching | [`anchors::matching`], [`map::index`] | [`anchors::matching::covisible_merge`], [`map::index::TextIndex`] |
//! | §IV-C.2, merge on a confirmed loop | [`anchors::loop_closure`] | [`anchors::loop_closure::close_loop`], [`anchors::loop_closure::revoke_loop`] |
//! | §V, check 1: covisible keyframes | [`map::covisibility`] | [`map::index::Covisibility`] |
//! | §V, check 2: bag of words | [`map::inverted_file`], [`map::covisible_groups`], [`loops::candidates`] | [`loops::candidates::find_candidates`] |
//! | §V, the funnel: checks 1 to 3 | [`loops::check_loop`], [`loops::screening`] | [`loops::check_loop::check_loop`] |
//! | §V, check 3: the local anchor maps | [`loops::anchor_check`] | [`loops::anchor_check::AnchorCheck`] |
//! | §V-A, local anchor map | [`loops::anchor_map`] | [`loops::anchor_map::local_anchor_map`] |
//! | §V-B, Eq. (1) | [`loops::equation_1`] | `equation_1::x` |
//! | §V-B, Eq. (2) | [`loops::equation_2`], [`loops::assignment`] | `equation_2::similarity`, `equation_2::passes` |
//! | §V-B, the comparison of two local anchor maps | [`loops::comparison`] | [`loops::comparison::compare`] |
//! | §V, the last step: similarity transformation | [`verification`] | [`verification::verify`] |
//! | geometry on one pair of keyframes | [`loops::geometry_check`] | [`loops::geometry_check::check_geometry`] |
//! | §V, the letter's decisions on a candidate | [`loops::letter`] | [`loops::letter::judge_anchors`] |
//! | ours: the sum of evidence (M64) | [`odds`] | [`odds::bet::Bet::sum`] |
//! | §V, the answer | [`loops::decision`] | [`loops::check_loop::verify_and_decide`] |
//! | ours: distinctive weights | [`extensions::distinctiveness`] | [`extensions::distinctiveness::PlaceCounts`] |
//! | ours: other names at one place | [`extensions::contradiction`] | [`extensions::contradiction::contradict`] |
//! | ours: why S is low | [`loops::low_score`] | [`loops::low_score::explain_low_score`] |
//! | ours: whether two sightings may be one place (M6) | [`extensions::sighting`] | [`extensions::sighting::Sighting::may_be_at`] |
//! | ours: what speaks against a loop that a client closes | [`extensions::loop_warning`] | [`extensions::loop_warning::loop_warning`] |
//! | ours: the sightings of one drive past an object | [`extensions::passage`], [`extensions::returning`] | [`extensions::returning::is_tracked`] |
//! | ours: texts beside which different signs hang | [`extensions::company`] | [`extensions::company::Companies::differs`] |
//! | ours: one view in two places (M16) | [`extensions::twins`] | [`extensions::twins::suspects`] |
//! | ours: signs that change (M18) | [`extensions::changed_signs`] | [`extensions::changed_signs::passages_ended_by`] |
//! | ours: sessions aligned to a plan (M55) | [`plans`], [`anchors::prior_anchors`] | [`plans::plan_alignment::plan_alignment`] |
//! | ours: one frame for all sessions, and loops that contradict the rest (M60) | [`frames`] | [`frames::fleet::fleet_frames`] |
//! | ours: odometry where loops tie the way together | [`extensions::way_by_loops`] | [`extensions::way_by_loops::way_by_loops_um`] |
//! | ours: odometry against a transformation (M15) | [`extensions::tracked_path`] | [`extensions::tracked_path::TrackedPath`] |
//! | ours: "where am I?" | [`mod@locate`] | [`locate::locate()`] |
//!
//! Beside the paper: [`loops::query`] is the keyframe that is asked about, [`loops::geometry_snapshot`] and [`loops::features`] are what geometry
//! needs to know of it, [`loops::evidence`] turns figures into a
//! verdict, [`map::recorder`] keeps changes, [`map::correction`] moves poses and points, [`anchors::describing`] takes a description by hand, [`extensions::worst_case`] tells where a model is missed, [`map::culling`] removes,
//! [`map::dense_map`] keeps what has a dense number, [`constants`] lists every number that decides and is no setting.

pub mod anchors;
pub mod constants;
pub mod extensions;
pub mod frames;
pub mod locate;
pub mod loops;
pub mod map;
pub mod odds;
pub mod plans;
pub mod verification;
