//! Loop warning: what speaks against a loop that a client confirms. The client decides; the warning says so once.

/// Why a confirmed loop may be none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoopWarning {
    /// Which kind.
    pub code: LoopWarningCode,
    /// One sentence for a person.
    pub detail: String,
}

/// The kinds of warnings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoopWarningCode {
    /// Sure identifiers around the two keyframes contradict each other, and outweigh what agrees.
    AnchorsContradict,
    /// A loop query about the two, at this version of the map, would not answer `loop`.
    NotSupported,
    /// The two are covisible without this loop: the present place, or a loop confirmed before.
    AlreadyCovisible,
}
