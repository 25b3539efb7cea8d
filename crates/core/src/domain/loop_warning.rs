//! Loop warning: what speaks against a loop that a client confirms. The client decides; the warning says so once.

use crate::named::named;

/// The reason why a confirmed loop may be wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoopWarning {
    /// The kind of evidence.
    pub code: LoopWarningCode,
    /// One sentence for a person.
    pub detail: String,
}

named! {
    /// The reason why a loop that a client confirms may be wrong.
    LoopWarningCode {
        /// Sure identifiers around the two keyframes contradict each other, and outweigh the signs that agree.
        AnchorsContradict = "anchors_contradict",
        /// A loop query about the two, at this version of the map, would not answer `loop`.
        NotSupported = "not_supported",
        /// The two are covisible without this loop: the present place, or a loop confirmed before.
        AlreadyCovisible = "already_covisible",
    }
}
