//! Quotas: how much one map may hold.

use clap::Args;

/// The most of everything in one map; what comes on top is refused with 507, while reading and deleting go on.
#[derive(Args, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Quotas {
    /// The most keyframes of a map; unlimited unless given
    #[arg(long, env = "REVISIT_MAP_MAX_KEYFRAMES", value_name = "N")]
    pub map_max_keyframes: Option<u64>,
    /// The most anchors of a map, merged ones counted once; unlimited unless given. The keyframe that reaches it may still
    /// bring all of its detections
    #[arg(long, env = "REVISIT_MAP_MAX_ANCHORS", value_name = "N")]
    pub map_max_anchors: Option<u64>,
    /// The most bytes that a map's facts take on disk: keyframes with their words, features, detections, texts and crops,
    /// map points, and loops with what they merge; unlimited unless given. Moving what is there goes on beyond it
    #[arg(long, env = "REVISIT_MAP_MAX_BYTES", value_name = "BYTES")]
    pub map_max_bytes: Option<u64>,
}
