//! The paper, section by section. Pure: values in, values out; no IO, clock, randomness or async.
//!
//! | paper | file | function |
//! |---|---|---|
//! | §III, an anchor seen before triggers loop detection | [`ingest`] | [`ingest::ingest`] |
//! | §IV-B, what an anchor is | [`index`] | [`index::Anchor`], [`index::Object`] |
//! | §IV-A.3, what a model is asked, and what its answer changes | [`lacking`], [`learning`], [`rejudging`] | [`lacking::lacking`], [`learning::learn_reading`] |
//! | §IV-B, which texts a model is asked to compare | [`pairs`], [`near_in_meaning`] | [`pairs::Embeddings`] |
//! | §IV-C.1, object tracking | [`association`] | [`association::associate`] |
//! | §IV-C.2, semantic anchor matching | [`matching`], [`index`] | [`matching::covisible_merge`], [`index::TextIndex`] |
//! | §IV-C.2, merge on a confirmed loop | [`closing`] | [`closing::close_loop`], [`closing::revoke_loop`] |
//! | §V, check 1: covisible keyframes | [`covisibility`] | [`index::Covisibility`] |
//! | §V, check 2: bag of words | [`inverted_file`], [`places`], [`candidates`] | [`candidates::find_candidates`] |
//! | §V, the funnel: checks 1 to 3 | [`loop_check`], [`screening`] | [`loop_check::screen`] |
//! | §V, check 3: the local anchor maps | [`anchor_check`] | [`anchor_check::AnchorCheck`] |
//! | §V-A, local anchor map | [`anchor_map`] | [`anchor_map::local_anchor_map`] |
//! | §V-B, Eq. (1) and (2) | [`comparison`], [`assignment`] | [`comparison::compare`] |
//! | §V, the last step: similarity transformation | [`verification`] | [`verification::verify`] |
//! | geometry on one pair of keyframes | [`geometry_check`] | [`geometry_check::check_geometry`] |
//! | §V, the answer | [`conclusion`] | [`conclusion::conclude`] |
//! | ours: distinctive weights | [`distinctiveness`] | [`distinctiveness::PlaceCounts`] |
//! | ours: contradiction veto | [`contradiction`] | [`contradiction::contradict`] |
//! | ours: why a differing identifier did not count | [`difference`] | [`difference::find_differing`] |
//! | ours: why S is low | [`low_score`] | [`low_score::explain_low_score`] |
//! | ours: whether two sightings may be one place (M6) | [`sighting`] | [`sighting::Sighting::may_be_at`] |
//! | ours: what speaks against a loop that a client closes | [`loop_warning`] | [`loop_warning::loop_warning`] |
//! | ours: anchors under the transformation | [`alignment`] | [`alignment::Compared::under`] |
//! | ours: the sightings of one drive past an object | [`passage`] | [`passage::is_tracked_only`] |
//! | ours: texts beside which different signs hang | [`company`] | [`company::Companies::weigh`] |
//! | ours: which readings disagree with those around them | [`dispute`] | [`dispute::disputed`] |
//! | ours: what a text without an identifier needs besides | [`witness`] | [`witness::lacks_witness`] |
//! | ours: what returns where its neighbours do | [`vouching`] | [`vouching::widened`] |
//! | ours: geometry proves a view, not a place (M19) | [`rivals`] | [`rivals::find_rivals`] |
//! | ours: one view in two places (M16) | [`twins`] | [`twins::suspects`] |
//! | ours: signs that change (M18) | [`changed_signs`] | [`changed_signs::passages_ended_by`] |
//! | ours: odometry where loops tie the way together | [`way_by_loops`] | [`way_by_loops::way_by_loops_um`] |
//! | ours: odometry against a transformation (M15) | [`tracked_path`] | [`tracked_path::TrackedPath`] |
//!
//! Beside the paper: [`query`] is the keyframe that is asked about, [`sight`] and [`features`] are what geometry
//! needs to know of it, [`evidence`] turns figures into a
//! verdict, [`recorder`] keeps changes, [`correction`] moves poses and points, [`describing`] takes a description by hand, [`standing_in`] tells where a model is missed, [`culling`] removes,
//! [`numbered`] keeps what has a dense number, [`constants`] lists every number that decides and is no setting.

pub mod alignment;
pub mod anchor_check;
pub mod anchor_map;
pub mod assignment;
pub mod association;
pub mod candidates;
pub mod changed_signs;
pub mod closing;
pub mod company;
pub mod comparison;
pub mod conclusion;
pub mod constants;
pub mod contradiction;
pub mod correction;
pub mod covisibility;
pub mod culling;
pub mod describing;
pub mod difference;
pub mod dispute;
pub mod distinctiveness;
pub mod evidence;
pub mod features;
pub mod geometry_check;
pub mod index;
pub mod ingest;
pub mod inverted_file;
pub mod lacking;
pub mod learning;
pub mod loop_check;
pub mod loop_warning;
pub mod low_score;
mod match_sets;
pub mod matching;
mod near_in_meaning;
pub mod numbered;
pub mod pairs;
pub mod passage;
pub mod places;
pub mod query;
pub mod recorder;
pub mod rejudging;
pub mod rivals;
pub mod screening;
pub mod sight;
pub mod sighting;
pub mod standing_in;
pub mod tracked_path;
pub mod twins;
pub mod verification;
pub mod vouching;
pub mod way_by_loops;
pub mod witness;
