//! The protocol's parts that can be left out, and the limits of a run.

/// Ticks of a lease: 10 s, so that a tick is 5 s.
pub const LEASE: u8 = 2;

/// The protocol, or a variant of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rules {
    /// Whether a write's first statement asks for the owner and the epoch.
    pub epoch_check: bool,
    /// Whether a take-over waits for open write transactions.
    pub take_over_waits: bool,
    /// Whether a node waits for its own open transaction before it loads again in the same epoch.
    pub reload_waits: bool,
    /// Whether the map leaves the memory before its release is sent, or after it has returned.
    pub drop_before_release: bool,
    /// The moment from which a node counts its lease.
    pub lease_from: LeaseFrom,
    /// Ticks by which a node's lease ends before the database's.
    pub margin: u8,
    /// The moment at which a read looks at the node's lease.
    pub read_check: ReadCheck,
}

/// The moment from which a node counts its lease.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeaseFrom {
    /// Before the request was sent.
    Sent,
    /// After the answer arrived.
    Returned,
}

/// The moment at which a read looks at the node's lease.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadCheck {
    /// After the state was read, on the lease under which it was loaded.
    AfterState,
    /// After the state was read, on the lease that the node has by then.
    AfterStateAnyLease,
    /// After the request arrived and before the state is read.
    BeforeState,
    /// Before the request arrived, as by a task that sets a flag now and then.
    BeforeRequest,
    /// Never.
    Missing,
}

impl Rules {
    /// The protocol as it is meant.
    pub const PROTOCOL: Self = Self {
        epoch_check: true,
        take_over_waits: true,
        reload_waits: true,
        drop_before_release: true,
        lease_from: LeaseFrom::Sent,
        margin: 1,
        read_check: ReadCheck::AfterState,
    };

    /// Returns the ticks for which a node answers reads after a lease was granted.
    pub fn valid_ticks(self) -> u8 {
        LEASE - self.margin
    }

    /// Whether the state that a read has taken outlives the memory of its map.
    pub fn read_outlives_memory(self) -> bool {
        self.read_check == ReadCheck::AfterStateAnyLease
    }
}

/// The number of steps of a kind that a run may still take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Limits {
    /// Take-overs, of all maps together.
    pub take_overs: u8,
    /// Write transactions, of all maps together.
    pub writes: u8,
    /// Stops of a node and connections lost in a write.
    pub failures: u8,
}

impl Limits {
    /// A number that is never used up.
    pub const ENDLESS: u8 = u8::MAX;

    /// No limit of any kind.
    pub const NONE: Self = Self { take_overs: Self::ENDLESS, writes: Self::ENDLESS, failures: Self::ENDLESS };
}

/// Takes one off a limit, or returns `None` if it is used up.
pub fn spend(left: &mut u8) -> Option<()> {
    if *left != Limits::ENDLESS {
        *left = left.checked_sub(1)?;
    }
    Some(())
}
