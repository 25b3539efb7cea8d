//! An operator describes an anchor by hand: it is matched again, as if it had just been read (§IV-C.2).

use std::collections::BTreeSet;

use super::index::MapIndex;
use super::ingest::{merge_all, tell_description, tell_revisits};
use super::recorder::{Decided, Recorder};
use crate::model::change::Change;
use crate::model::ids::AnchorSeq;

/// Sets an anchor's description, or gives it back to its readings.
pub fn describe(index: &mut MapIndex, anchor: AnchorSeq, description: Option<Box<str>>) -> Decided {
    let mut record = Recorder::new(index);
    record.apply(vec![Change::DescriptionSet(anchor, description)]);
    record.touch(anchor);
    tell_description(&mut record, anchor);
    merge_all(&mut record, anchor, MapIndex::keyframes_of);
    tell_revisits(&mut record, None, &BTreeSet::from([anchor]));
    record.finish()
}
