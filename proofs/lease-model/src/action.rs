//! The names of all steps.

use crate::state::MAPS;

/// One step of the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Action {
    /// Time passes on every clock.
    Tick,
    /// A step of one node, by its index.
    OfNode(usize, NodeStep),
    /// A step of one node on one map, by their indices.
    OfMap(usize, usize, MapStep),
}

/// A step of a node that concerns all its maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NodeStep {
    /// A renewal is sent and executed, for some of the maps in memory.
    Renew([bool; MAPS]),
    /// Its result arrives.
    ReceiveRenewal,
    /// The node stops and starts again with nothing in memory.
    Crash,
}

/// A step of a node, or of the database on its behalf, on one map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MapStep {
    /// A take-over is sent, committed, and its result arrives.
    TakeOver,
    /// A take-over on which the node has given up is committed.
    LateTakeOver,
    /// A renewal on which the node has given up is executed.
    LateRenewal,
    /// The map's version is read into memory.
    Load,
    /// After a write in doubt the node asks for its row once more.
    Reload,
    /// A write is decided, and its first statement executed.
    BeginWrite,
    /// The database commits a write.
    Commit,
    /// The result of a commit arrives, and the client is answered.
    Acknowledge,
    /// A write fails, and the node knows it.
    RollBack,
    /// The connection of a write is lost.
    LoseConnection,
    /// The database commits a transaction that was left behind.
    CommitOrphan,
    /// The database rolls back a transaction that was left behind.
    RollBackOrphan,
    /// A hand-over begins: no further write is decided.
    Leave,
    /// The hand-over's release is sent.
    SendRelease,
    /// The database executes a release.
    ExecuteRelease,
    /// The map leaves the memory after its release has returned, which the protocol forbids.
    ForgetReleased,
    /// A read begins.
    BeginRead,
    /// A read is answered.
    AnswerRead,
}

impl MapStep {
    /// All of them.
    pub const ALL: [Self; 18] = [
        Self::TakeOver,
        Self::LateTakeOver,
        Self::LateRenewal,
        Self::Load,
        Self::Reload,
        Self::BeginWrite,
        Self::Commit,
        Self::Acknowledge,
        Self::RollBack,
        Self::LoseConnection,
        Self::CommitOrphan,
        Self::RollBackOrphan,
        Self::Leave,
        Self::SendRelease,
        Self::ExecuteRelease,
        Self::ForgetReleased,
        Self::BeginRead,
        Self::AnswerRead,
    ];
}
