//! Sets that a reverse map keeps by key: none of them is empty.

use std::collections::BTreeSet;

/// Removes a value from the set of a key; returns whether that was the last one, so that the key is to go.
pub(super) fn remove_last<T: Ord>(set: Option<&mut BTreeSet<T>>, value: &T) -> bool {
    set.is_some_and(|set| set.remove(value) && set.is_empty())
}
