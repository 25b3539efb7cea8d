//! The paper, section by section. Pure: values in, values out; no IO, clock, randomness or async.
//!
//! | paper | file | function |
//! |---|---|---|
//! | §III, an anchor seen before triggers loop detection | [`ingest`] | [`ingest::ingest`] |
//! | §IV-B, what an anchor is | [`index`] | [`index::Anchor`], [`index::Object`] |
//! | §IV-C.1, object tracking | [`association`] | [`association::associate`] |
//! | §IV-C.2, semantic anchor matching | [`matching`], [`index`] | [`matching::covisible_merge`], [`index::TextIndex`] |
//! | §IV-C.2, merge on a confirmed loop | [`closing`] | [`closing::close_loop`], [`closing::revoke_loop`] |
//! | §V, check 1: covisible keyframes | [`covisibility`] | [`covisibility::Covisibility`] |
//! | §V, check 2: bag of words | [`inverted_file`], [`places`], [`candidates`] | [`candidates::find_candidates`] |
//! | §V, check 3: the funnel | [`loop_check`] | [`loop_check::check_loop`] |
//! | §V-A, local anchor map | [`anchor_map`] | [`anchor_map::local_anchor_map`] |
//! | §V-B, Eq. (1) and (2) | [`comparison`], [`assignment`] | [`comparison::compare`] |
//! | ours: distinctive weights | [`distinctiveness`] | [`distinctiveness::PlaceCounts`] |
//! | ours: contradiction veto | [`contradiction`] | [`contradiction::contradictions`] |
//!
//! Beside the paper: [`query`] is the keyframe that is asked about, [`evidence`] turns figures into a
//! verdict, [`recorder`] keeps changes, [`correction`] moves poses and points, [`culling`] removes.
//!
//! Not here yet: the similarity transformation, the last step of §V.

pub mod anchor_map;
pub mod assignment;
pub mod association;
pub mod candidates;
pub mod closing;
pub mod comparison;
pub mod contradiction;
pub mod correction;
pub mod covisibility;
pub mod culling;
pub mod distinctiveness;
pub mod evidence;
pub mod index;
pub mod ingest;
pub mod inverted_file;
pub mod loop_check;
pub mod matching;
pub mod places;
pub mod query;
pub mod recorder;
