//! The tables that hold the rows of maps, for what goes through all of them: deletion and copies.

/// A table with many rows of a map.
pub(crate) struct Table {
    /// Its name.
    pub name: &'static str,
    /// Its primary key after `map_key`.
    pub key: &'static str,
    /// Whether its rows have a rowid, by which they are removed.
    pub has_rowid: bool,
    /// The bytes of a row's blobs, where they may be many.
    pub blobs: Option<&'static str>,
}

const fn without_rowid(name: &'static str, key: &'static str) -> Table {
    Table { name, key, has_rowid: false, blobs: None }
}

const fn with_rowid(name: &'static str, key: &'static str) -> Table {
    Table { name, key, has_rowid: true, blobs: None }
}

const fn with_blobs(name: &'static str, key: &'static str, blobs: &'static str) -> Table {
    Table { name, key, has_rowid: true, blobs: Some(blobs) }
}

/// The tables, children before parents.
pub(crate) const TABLES: &[Table] = &[
    with_rowid("model_readings", "keyframe, detection"),
    with_blobs("crops", "keyframe, detection", "length(bytes)"),
    without_rowid("missed_signs", "anchor, keyframe"),
    without_rowid("retired_signs", "anchor"),
    with_rowid("detections", "keyframe, detection"),
    with_blobs(
        "keyframe_features",
        "keyframe",
        "length(descriptors) + length(keypoints) + length(map_points)",
    ),
    without_rowid("keyframe_points", "keyframe"),
    without_rowid("session_merges", "version"),
    without_rowid("fleet_frames", "version"),
    with_blobs(
        "keyframes",
        "keyframe",
        "length(observes) + length(sent_points) + length(bow_words) + length(bow_weights)",
    ),
    without_rowid("point_blocks", "session, block"),
    without_rowid("sessions", "session"),
    without_rowid("anchor_merges", "into_anchor, from_anchor, loop_id"),
    without_rowid("prior_anchors", "anchor"),
    without_rowid("anchors", "anchor"),
    without_rowid("loops", "id"),
    without_rowid("twins", "keyframe, candidate, anchor, candidate_anchor"),
    without_rowid("events", "seq"),
    with_blobs("loop_queries", "id", "coalesce(length(body), 0)"),
    without_rowid("release_uses", "session"),
    without_rowid("erasures", "number"),
    without_rowid("model_verdicts", "operation, class, a, b"),
    without_rowid("judgements", "id"),
    with_blobs("versions", "version, part", "length(body)"),
];
