//! Everything that a step can depend on: rows of the database, nodes, and what is on its way between them.

use crate::rules::Limits;

/// Most nodes of a run. Unused ones stay as they began.
pub const NODES: usize = 3;
/// Most maps of a run.
pub const MAPS: usize = 2;

/// The whole system at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct State {
    /// The database's row of each map.
    pub rows: [Row; MAPS],
    /// The servers.
    pub nodes: [Node; NODES],
    /// Steps that a bounded run may still take.
    pub limits: Limits,
    /// The first property that was violated; nothing follows it.
    pub fault: Option<Fault>,
    /// Whether steps leave a trace in `succession`.
    pub watched: bool,
    /// The take-overs that were seen, in a watched run.
    pub succession: Succession,
}

/// A row of `map_owners` with the map's version, and the newest version that any client knows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Row {
    /// Index of the node that owns the map.
    pub owner: Option<u8>,
    /// Number of take-overs so far.
    pub epoch: u8,
    /// Ticks of the database's clock until the lease expires.
    pub expires: u8,
    /// Number of committed writes.
    pub version: u8,
    /// Newest version that was acknowledged to a client, or returned by a read.
    pub known: u8,
    /// The node that stopped as its owner, or released it, since it was last taken over; in a watched run.
    pub former: Option<(u8, Parting)>,
}

/// The way in which an owner parted from a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Parting {
    /// It stopped.
    Stopped,
    /// It handed the map over.
    Released,
}

/// One server.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Node {
    /// Its part in each map.
    pub holdings: [Holding; MAPS],
    /// A renewal that the database has executed and whose result is on its way.
    pub renewal: Option<Renewal>,
}

/// The part of one node in one map: its memory, and its transactions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Holding {
    /// State of the map in the node's memory.
    pub memory: Memory,
    /// Epoch under which it was taken over.
    pub epoch: u8,
    /// Version in memory, where it is loaded.
    pub version: u8,
    /// Ticks of the node's clock for which reads may be answered.
    pub valid: u8,
    /// Progress of a hand-over.
    pub leaving: Leaving,
    /// Whether a read is under way; `steps::reads` keeps only those that could turn out wrong.
    pub read: bool,
    /// The write transaction under way.
    pub write: Option<Write>,
    /// A transaction left behind by a stop or a lost connection, open in the database.
    pub orphan: Option<Write>,
    /// Epoch of a release that the database has not executed yet.
    pub release: Option<u8>,
}

/// State of a map in a node's memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Memory {
    /// Neither facts nor a lease.
    #[default]
    Absent,
    /// Taken over, and not loaded yet.
    Taken,
    /// Loaded: writes are decided and reads answered.
    Loaded,
    /// Dropped because the fate of a write is unknown; the lease is kept.
    InDoubt,
}

/// Progress of a hand-over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Leaving {
    /// None.
    #[default]
    No,
    /// No further write is decided.
    Draining,
    /// The release is sent and the map still in memory, which the protocol forbids.
    Released,
}

/// A write transaction whose first statement has found the node to be the owner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Write {
    /// Whether the database has committed it, and only the node does not know yet.
    pub committed: bool,
    /// Epoch of the node's lease.
    pub epoch: u8,
    /// While open, the version in memory on which it was decided; committed, its own version.
    pub version: u8,
}

/// Result of a renewal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Renewal {
    /// Ticks for which it is good, counted since before it was sent.
    pub valid: u8,
    /// Of each map that it named: the epoch, and whether the row was returned.
    pub rows: [Option<(u8, bool)>; MAPS],
}

/// A violated property.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Fault {
    /// A write was decided on a version that was not the newest when it committed.
    LostUpdate,
    /// A write committed under an epoch that was not the newest.
    OldEpoch,
    /// A read returned less than was known before it began.
    StaleRead,
}

/// Take-overs that were seen in a watched run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Succession {
    /// Another node took over a map whose owner had stopped.
    pub after_death: bool,
    /// Another node took over a map that its owner had released.
    pub after_release: bool,
}

impl State {
    /// Creates the system before any step: no map has an owner.
    pub fn new(limits: Limits, watched: bool) -> Self {
        Self {
            rows: [Row::default(); MAPS],
            nodes: [Node::default(); NODES],
            limits,
            fault: None,
            watched,
            succession: Succession::default(),
        }
    }

    /// Returns a node's part in a map.
    pub fn holding(&self, node: usize, map: usize) -> &Holding {
        &self.nodes[node].holdings[map]
    }

    /// Returns a node's part in a map, to be changed.
    pub fn holding_mut(&mut self, node: usize, map: usize) -> &mut Holding {
        &mut self.nodes[node].holdings[map]
    }

    /// Whether the row names this node and this epoch.
    pub fn is_owner(&self, node: usize, map: usize, epoch: u8) -> bool {
        let row = &self.rows[map];
        row.owner == Some(node as u8) && row.epoch == epoch
    }

    /// Whether any transaction holds the map's row `for key share`.
    pub fn is_shared(&self, map: usize) -> bool {
        self.nodes.iter().any(|node| node.holdings[map].is_open())
    }
}

impl Holding {
    /// Whether it has a transaction open in the database.
    fn is_open(&self) -> bool {
        self.orphan.is_some() || self.write.is_some_and(|write| !write.committed)
    }

    /// Leaves the write under way to the database: open, it may still commit; committed, its result is lost.
    pub fn abandon_write(&mut self) {
        if let Some(write) = self.write.take()
            && !write.committed
        {
            // Where transactions end before the next is begun, there is never a second one. Otherwise the older one is kept.
            self.orphan.get_or_insert(write);
        }
    }

    /// Removes the map from memory, with its lease. `read_stays` if the state that a read has taken outlives the memory.
    pub fn drop_memory(&mut self, read_stays: bool) {
        self.abandon_write();
        *self = Self {
            read: self.read && read_stays,
            orphan: self.orphan,
            release: self.release,
            ..Self::default()
        };
    }
}
