//! A prior anchor is put (§9 of the contract): a plan shows a sign before any robot has seen it (M55).

use super::ingest::session_of;
use crate::domain::change::Change;
use crate::domain::ids::{AnchorSeq, SessionId, SessionSeq};
use crate::domain::invalid::FieldError;
use crate::domain::prior::{NewPrior, Prior};
use crate::recognition::map::index::MapIndex;
use crate::recognition::map::recorder::{Decided, Recorder};

/// Maximum prior anchors of a map: the doors of a large campus.
pub const MAX_PRIORS: usize = 100_000;

/// Finds the faults that only the map can tell: a class without anchors, or a frame that a robot drives.
pub fn prior_faults(index: &MapIndex, new: &NewPrior) -> Vec<FieldError> {
    let mut faults = Vec::new();
    let properties = index.properties();
    if !properties.anchors_class(&new.class) {
        let detail = "the map makes no anchors of this class";
        let classes = properties.anchor_classes.join(", ");
        faults.push(FieldError::new("/class", detail).got(&new.class).limit(classes));
    }
    let session = index.session(&new.frame);
    if session.is_some_and(|session| is_driven(index, session)) {
        let detail = "a robot drives this session; a plan's frame is a session of its own";
        faults.push(FieldError::new("/frame", detail).got(&new.frame).limit("a session without keyframes"));
    }
    faults
}

/// Returns the fault of a keyframe in a session that is a plan's frame.
pub fn driven_frame(index: &MapIndex, session: &SessionId) -> Option<FieldError> {
    let seq = index.session(session)?;
    index.priors().is_frame(seq).then(|| {
        let detail = "this session is the frame of a plan, and no robot drives it";
        FieldError::new("/session", detail).got(session).limit("a session without prior anchors")
    })
}

/// Whether a session has keyframes. A frame that has prior anchors has none.
fn is_driven(index: &MapIndex, session: SessionSeq) -> bool {
    !index.priors().is_frame(session) && index.keyframes().any(|keyframe| keyframe.session == session)
}

/// Returns a prior anchor as it was sent.
pub fn prior_as_sent(index: &MapIndex, seq: AnchorSeq) -> Option<NewPrior> {
    let anchor = index.anchor(seq)?;
    let prior = anchor.prior.as_ref()?;
    Some(NewPrior {
        id: prior.id.clone(),
        class: anchor.class.to_string(),
        description: prior.description.to_string(),
        position_in_frame: prior.position_in_frame,
        frame: index.sessions().get(prior.frame.index())?.clone(),
        normal_in_frame: prior.normal_in_frame,
        source: prior.source.as_ref().map(ToString::to_string),
    })
}

/// Adds a prior anchor that [`prior_faults`] finds no fault with. No keyframe sees it, so it joins no local anchor map and
/// closes no loop.
pub fn add_prior(index: &mut MapIndex, new: &NewPrior) -> (AnchorSeq, Decided) {
    let mut record = Recorder::new(index);
    let index = record.index();
    let (seq, mut changes) = (index.next_anchor(), Vec::new());
    let frame = session_of(index, &new.frame, &mut changes);
    changes.push(Change::AnchorAdded(seq, new.class.as_str().into()));
    changes.push(Change::PriorSet(
        seq,
        Box::new(Prior {
            id: new.id.clone(),
            frame,
            description: new.description.as_str().into(),
            position_in_frame: new.position_in_frame,
            normal_in_frame: new.normal_in_frame,
            source: new.source.as_deref().map(Into::into),
        }),
    ));
    record.apply(changes);
    (seq, record.finish())
}
