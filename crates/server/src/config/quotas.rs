//! Quotas: the maximum size of a map.

use clap::Args;

/// Maximum size of one map. Writes that exceed it are rejected with 507; reads and deletes still work.
#[derive(Args, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Quotas {
    /// Maximum keyframes of a map; unlimited by default
    #[arg(long, env = "REVISIT_MAP_MAX_KEYFRAMES", value_name = "N")]
    pub map_max_keyframes: Option<u64>,
    /// Maximum anchors of a map, merged ones counted once; unlimited by default. The keyframe that reaches it may
    /// still add all of its detections
    #[arg(long, env = "REVISIT_MAP_MAX_ANCHORS", value_name = "N")]
    pub map_max_anchors: Option<u64>,
    /// Maximum bytes of a map's facts on disk; unlimited by default. Counts keyframes with their words, features,
    /// detections, texts and crops, map points, and loops with their merges. Corrections of existing data still work
    /// above it. A release is published while the map, its releases and this one fit
    #[arg(long, env = "REVISIT_MAP_MAX_BYTES", value_name = "BYTES")]
    pub map_max_bytes: Option<u64>,
}
