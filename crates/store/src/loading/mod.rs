//! Loading: from rows, and the log on top of them, to the facts of a map.

pub(super) mod deferred;
pub(super) mod load;
pub(super) mod read;
pub(super) mod words_of_map;
