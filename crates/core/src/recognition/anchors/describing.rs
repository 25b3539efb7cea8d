//! An operator describes an anchor by hand: it is matched again, as if it had just been read (§IV-C.2).

use std::collections::BTreeSet;

use super::ingest::{merge_all, tell_description, tell_revisits};
use crate::domain::change::Change;
use crate::domain::ids::AnchorSeq;
use crate::recognition::map::index::MapIndex;
use crate::recognition::map::recorder::{Decided, Recorder};

/// Sets an anchor's description, or gives it back to its readings.
pub fn describe(index: &mut MapIndex, anchor: AnchorSeq, description: Option<Box<str>>) -> Decided {
    let mut record = Recorder::new(index);
    let object = record.index().object_of(anchor);
    // Whoever describes a sign says that it hangs there.
    let members = object.filter(|_| description.is_some()).map(|object| object.members.clone());
    let hangs = members.into_iter().flatten().flat_map(|member| {
        let is_retired = record.index().changed_signs().is_retired(member);
        let returned = is_retired.then_some(Change::SignReturned(member));
        [Change::MissesWithdrawn(member)].into_iter().chain(returned)
    });
    let changes = hangs.chain([Change::DescriptionSet(anchor, description)]).collect();
    record.apply(changes);
    record.touch([anchor]);
    tell_description(&mut record, anchor);
    merge_all(&mut record, anchor, MapIndex::keyframes_of);
    tell_revisits(&mut record, None, &BTreeSet::from([anchor]));
    record.finish()
}
