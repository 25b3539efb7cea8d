//! Names of a request: found in the map, or the fault of the request.

use crate::domain::ids::{KeyframeId, KeyframeSeq, SessionId, SessionSeq};
use crate::domain::invalid::FieldError;
use crate::engine::{Result, ServiceError};
use crate::recognition::map::index::MapIndex;

/// Finds a keyframe by its id.
pub(super) fn find(index: &MapIndex, id: &KeyframeId) -> Result<KeyframeSeq> {
    index.keyframe_seq(id).ok_or_else(|| ServiceError::no_keyframe(id))
}

/// Finds the session that a path or a query names.
pub(super) fn find_session(index: &MapIndex, id: &SessionId) -> Result<SessionSeq> {
    let missing = || ServiceError::NotFound(format!("there is no session {id} in this map"));
    index.session(id).ok_or_else(missing)
}

/// Finds the session that a body names.
pub(super) fn session_of_body(index: &MapIndex, id: &SessionId) -> Result<SessionSeq> {
    index.session(id).ok_or_else(|| no_keyframe_of_session("/session", id))
}

/// Returns the error of a session without keyframes.
pub(super) fn no_keyframe_of_session(pointer: &str, id: &SessionId) -> ServiceError {
    FieldError::new(pointer, "no keyframe of this session is in the map").got(id).into()
}

/// Returns the fault of a keyframe that is not there.
pub(super) fn no_keyframe_of_map(pointer: impl Into<String>, id: &KeyframeId) -> FieldError {
    FieldError::new(pointer, "there is no such keyframe in the map").got(id)
}

/// Finds the keyframe of a session that a field of a body names.
pub(super) fn keyframe_of_session(
    index: &MapIndex,
    session: SessionSeq,
    id: &KeyframeId,
    pointer: impl FnOnce() -> String,
) -> Result<KeyframeSeq, FieldError> {
    let known = index.keyframe_seq(id).and_then(|seq| index.keyframe(seq));
    let own = known.filter(|keyframe| keyframe.session == session).map(|keyframe| keyframe.seq);
    own.ok_or_else(|| FieldError::new(pointer(), "there is no such keyframe in this session").got(id))
}
