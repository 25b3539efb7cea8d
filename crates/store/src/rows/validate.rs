//! Validation: rejects rows that decode, but from which no index can be built.
//!
//! [`crate::loading::load`] applies it to every map, so that a damaged map is an error and never a wrong answer. `revisit check`
//! finds the same faults, because it loads every map.

use std::collections::{HashMap, HashSet};

use revisit_core::domain::anchor::Observation;
use revisit_core::domain::change::{Change, Keyframe, MergeCause};
use revisit_core::domain::global_descriptor::{GlobalDescriptor, GlobalForm};
use revisit_core::domain::ids::{AnchorSeq, KeyframeSeq, PointId};
use revisit_core::domain::prior::{Prior, is_unit};
use revisit_core::geometry::{Point3, Pose};

use crate::StoreError;
use crate::rows::session_merge_rows::MergedSession;

/// How far the squared norm of a stored quaternion may be from 1: it was normalised before it was stored.
const MAX_ROTATION_ERROR: f64 = 1e-6;

/// Rows of a map read so far, as far as later rows refer to them.
#[derive(Debug, Default)]
pub(crate) struct Known {
    sessions: usize,
    /// The sessions that became one with another, in that order.
    pub merges: Vec<MergedSession>,
    /// The keyframes that stand.
    pub keyframes: HashSet<KeyframeSeq>,
    /// The form of the global descriptors, once there is one.
    global_form: Option<GlobalForm>,
    /// The anchors that stand.
    pub anchors: HashMap<AnchorSeq, KnownAnchor>,
}

/// An anchor, as far as later rows must agree with it.
#[derive(Debug)]
pub(crate) struct KnownAnchor {
    pub class: Box<str>,
    pub version: u64,
}

impl Known {
    /// Returns what is known of a map when its sessions are read.
    pub fn of_sessions(sessions: usize, merges: Vec<MergedSession>) -> Self {
        Self { sessions, merges, ..Self::default() }
    }
}

/// Rejects sessions that are not numbered from 0 without a gap.
pub(crate) fn sessions(numbers: &[u32]) -> Result<(), StoreError> {
    match numbers.iter().zip(0..).find(|(number, expected)| **number != *expected) {
        Some((number, _)) => fault(format!("{} sessions are numbered up to {number}", numbers.len())),
        None => Ok(()),
    }
}

/// Rejects a keyframe without a session, with a pose that is no rigid transformation, or with points out of order: they
/// are intersected as ascending lists.
pub(crate) fn keyframe(keyframe: &Keyframe, known: &Known) -> Result<(), StoreError> {
    let id = &keyframe.id;
    if keyframe.session.index() >= known.sessions {
        return fault(format!("keyframe {id} belongs to no session"));
    }
    if ![&keyframe.map_from_camera, &keyframe.sent_pose].into_iter().all(is_rigid) {
        return fault(format!("the pose of keyframe {id} is none"));
    }
    if !keyframe.scale.is_finite() || keyframe.scale <= 0.0 {
        return fault(format!("the scale of keyframe {id} is none"));
    }
    if !keyframe.observes.iter().is_sorted_by(|a, b| a < b) {
        return fault(format!("the points of keyframe {id} are not in order"));
    }
    Ok(())
}

fn is_rigid(pose: &Pose) -> bool {
    let norm = pose.rotation_xyzw().iter().map(|part| part * part).sum::<f64>();
    // Not written as `>`, so that a NaN is found, too.
    (norm - 1.0).abs() < MAX_ROTATION_ERROR && pose.translation_m().iter().all(|part| part.is_finite())
}

/// Rejects a global descriptor of no size that is allowed, or of another form than the map's others, and notes its form.
pub(crate) fn global_descriptor(descriptor: &GlobalDescriptor, known: &mut Known) -> Result<(), StoreError> {
    let size = descriptor.data.len();
    if !(1..=GlobalDescriptor::MAX_BYTES).contains(&size) {
        return fault(format!("a global descriptor of {size} bytes"));
    }
    if !descriptor.is_of(known.global_form.get_or_insert_with(|| descriptor.form())) {
        return fault("a global descriptor of another form than those before it".to_owned());
    }
    Ok(())
}

/// Rejects a map point without a session, or with a position that is not finite.
pub(crate) fn point(session: u32, id: PointId, at: &Point3, known: &Known) -> Result<(), StoreError> {
    if session as usize >= known.sessions {
        return fault(format!("map point {id} belongs to no session"));
    }
    if !is_finite(at) {
        return fault(format!("the position of map point {id} is not finite"));
    }
    Ok(())
}

/// Rejects a prior anchor that is not there, or without a frame, or with a number that is not finite.
pub(crate) fn prior(anchor: AnchorSeq, prior: &Prior, known: &Known) -> Result<(), StoreError> {
    let id = &prior.id;
    if !known.anchors.contains_key(&anchor) {
        return fault(format!("prior anchor {id} is not among the anchors"));
    }
    if prior.frame.index() >= known.sessions {
        return fault(format!("prior anchor {id} is in no frame"));
    }
    if !is_finite(&prior.position_in_frame) || prior.normal_in_frame.is_some_and(|normal| !is_unit(&normal)) {
        return fault(format!("prior anchor {id} has a position or a normal that is none"));
    }
    Ok(())
}

/// Rejects a detection that feeds an anchor that is not there or of another class, or of a keyframe that is not there.
pub(crate) fn observation(
    anchor: AnchorSeq,
    class: &str,
    observation: &Observation,
    known: &Known,
) -> Result<(), StoreError> {
    let row = format!("detection {} of keyframe number {}", observation.detection, observation.keyframe.0);
    if !known.keyframes.contains(&observation.keyframe) {
        return fault(format!("{row} belongs to no keyframe"));
    }
    match known.anchors.get(&anchor) {
        None => return fault(format!("{row} feeds an anchor that is not there")),
        Some(of_anchor) if *of_anchor.class != *class => {
            return fault(format!("{row} is of another class than its anchor"));
        }
        Some(_) => {}
    }
    if !observation.confidence.is_finite() || observation.position_as_sent.is_some_and(|at| !is_finite(&at)) {
        return fault(format!("{row} has a number that is not finite"));
    }
    Ok(())
}

/// Rejects merges of anchors or by loops that are not there.
pub(crate) fn merges(loops: &[Change], merges: &[Change], known: &Known) -> Result<(), StoreError> {
    let standing: HashSet<_> = loops
        .iter()
        .filter_map(|change| match change {
            Change::LoopAdded(closed) => Some(&closed.id),
            _ => None,
        })
        .collect();
    for change in merges {
        let Change::Merged(merge) = change else { continue };
        if let Some(gone) = [merge.into, merge.from].iter().find(|anchor| !known.anchors.contains_key(anchor))
        {
            return fault(format!("a merge names anchor {}, which is not there", gone.public()));
        }
        if let MergeCause::Loop(id) = &merge.cause
            && !standing.contains(id)
        {
            return fault(format!("anchors are merged by loop {id}, which is not there"));
        }
    }
    Ok(())
}

/// Rejects a number at or above the one that is given next: it would be given twice.
pub(crate) fn numbers(
    (next_keyframe, next_anchor): (u32, u32),
    loops: &[Change],
    known: &Known,
) -> Result<(), StoreError> {
    let keyframe = known.keyframes.iter().map(|keyframe| keyframe.0).max();
    let of_loops = loops.iter().filter_map(|change| match change {
        Change::LoopAdded(closed) => Some(closed.keyframe.max(closed.candidate).0),
        _ => None,
    });
    let used = [
        ("keyframe", keyframe, next_keyframe),
        ("a loop of keyframe", of_loops.max(), next_keyframe),
        ("anchor", known.anchors.keys().map(|anchor| anchor.0).max(), next_anchor),
    ];
    for (what, largest, next) in used {
        if let Some(number) = largest.filter(|number| *number >= next) {
            return fault(format!("{what} {number} is there, and {next} is given next"));
        }
    }
    Ok(())
}

fn is_finite(at: &Point3) -> bool {
    at.iter().all(|part| part.is_finite())
}

fn fault(what: String) -> Result<(), StoreError> {
    Err(StoreError::corrupt(what))
}
