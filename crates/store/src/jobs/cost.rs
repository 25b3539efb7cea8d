//! Cost: about how long a job keeps the writer busy, so that no group keeps other maps waiting for long.

use revisit_core::domain::change::Change;

use crate::jobs::job::{Batch, Job};

/// Microseconds for each KiB of a blob, with the log and its sync.
const KIB_US: u64 = 10;
/// Microseconds for a statement.
const STATEMENT_US: u64 = 25;
/// Microseconds to rewrite a keyframe's row, which holds its words and points.
const KEYFRAME_ROW_US: u64 = 60;
/// Bytes of a pose or point in the log, about.
const VALUE_BYTES: usize = 64;
/// Microseconds for a row of a statement with many rows.
const POINT_ROW_US: u64 = 6;

impl Job {
    /// Returns what it costs, in microseconds of a slow core.
    pub(crate) fn cost_us(&self) -> u64 {
        match self {
            Self::Change(batch) | Self::ChangeStaged { batch, .. } => of_batch(batch),
            Self::Stage { part, .. } => STATEMENT_US + of_bytes(part.len() * VALUE_BYTES),
            Self::CopyRows { block, .. } | Self::AddRows(block) => {
                block.len() as u64 * POINT_ROW_US + of_bytes(block.bytes)
            }
            Self::KeepQuery { body, .. } => 2 * STATEMENT_US + of_bytes(body.len()),
            _ => 2 * STATEMENT_US,
        }
    }
}

/// Returns what a change costs if it is written to its row, in microseconds of a slow core.
pub(crate) fn of_change(change: &Change) -> u64 {
    match change {
        Change::PointSet(..) => POINT_ROW_US,
        Change::PointsForgotten(_, ids) => ids.len() as u64 * POINT_ROW_US,
        Change::PoseSet(..) | Change::KeyframeRemoved(..) | Change::PointsOfKeyframeSet(_) => KEYFRAME_ROW_US,
        Change::Observed(..) | Change::OutcomeSet(..) | Change::GlobalDescriptorSet(..) => 0,
        Change::KeyframeAdded(keyframe, _) => KEYFRAME_ROW_US + of_bytes(keyframe.bytes as usize),
        _ => STATEMENT_US,
    }
}

fn of_batch(batch: &Batch) -> u64 {
    let changes: u64 = batch.changes.iter().map(of_change).sum();
    let detections = batch.new_keyframe.as_ref().map_or(0, |rows| rows.keyframe.detections.len());
    STATEMENT_US * (1 + batch.events.len() + detections) as u64 + changes
}

fn of_bytes(bytes: usize) -> u64 {
    bytes as u64 / 1024 * KIB_US
}
