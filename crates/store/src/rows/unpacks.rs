//! Unpacking of any bytes, for fuzzing.

use crate::columns::blob;
use crate::columns::column;
use crate::columns::keypoints;
use crate::log::entry::Entry;
use crate::rows::point_blocks;

/// Unpacks a blob as everything that rows have: what fits reads back, and nothing panics.
///
/// # Panics
/// If something that was unpacked is packed into other bytes.
pub fn unpacks(bytes: &[u8]) {
    blob::unpacks(bytes);
    point_blocks::unpacks(bytes);
    let _ = (column::integers_of::<u32>(bytes), column::floats_of(bytes), keypoints::keypoints_of(bytes));
    if let Ok(entry) = Entry::of(bytes) {
        assert!(entry.to_bytes().is_ok(), "{entry:?}");
    }
}
