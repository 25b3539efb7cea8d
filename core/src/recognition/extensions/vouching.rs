//! Neighbours vouch: a keyframe in a bare stretch of corridor, or beside nothing but an EXIT sign, returns where its
//! neighbours do (M37).
//!
//! The local anchor map of §V-A ends two steps of covisibility away. Where either is empty, or all that agrees hangs in
//! several places, one that goes a step farther, the neighbours' own, is compared from the same two cameras and by the same
//! rules; or a confirmed loop already joins the neighbours. Either says that the robot is near that place, and not that this
//! view is that one. So geometry on map points must verify it.

use super::distinctiveness::PlaceCounts;
use crate::domain::verdict::{CandidateDecision, Reason, Verify};
use crate::recognition::loops::anchor_map::{LocalAnchorMap, local_anchor_map};
use crate::recognition::loops::centre::Centre;
use crate::recognition::loops::query::Query;
use crate::recognition::map::index::MapIndex;

/// A reason why a candidate that its own anchors leave open may be a loop all the same, and its decision where geometry does
/// not verify it.
#[derive(Clone, Debug)]
pub struct Vouched {
    /// The voucher.
    pub by: Voucher,
    /// The decision without them.
    pub otherwise: (CandidateDecision, Reason),
}

/// A reason to trust geometry where the anchors near leave it open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Voucher {
    /// The anchors around the neighbours of both agree.
    Anchors,
    /// A confirmed loop joins a neighbour of the one, or the one itself, with a neighbour of the other.
    ConfirmedLoop,
}

/// Whether neighbours may vouch for the candidates of a query: geometry can run, and the map's settings have it so.
pub fn may_vouch(index: &MapIndex, query: &Query<'_>, verify: Verify) -> bool {
    index.properties().settings.neighbours_vouch && verify != Verify::Anchors && query.snapshot.is_some()
}

/// Returns the local anchor map of a keyframe's neighbours, as the keyframe itself would see it.
pub fn widened(index: &MapIndex, centre: &Centre, places: &mut PlaceCounts) -> LocalAnchorMap {
    let covisible = index.covisibility().around(&centre.covisible).into_iter().collect();
    local_anchor_map(index, &Centre { covisible, ..centre.clone() }, places)
}
