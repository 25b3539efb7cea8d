//! The shape that a vocabulary declares, and its bounds.

/// The largest k.
pub(super) const BRANCHING_MAX: u64 = 65_536;
/// The largest L, and the deepest tree.
pub(super) const LEVELS_MAX: u64 = 64;
/// The most nodes.
pub(super) const NODES_MAX: usize = 1 << 26;
/// The longest descriptor, as the service accepts them.
pub(super) const DESCRIPTOR_BYTES_MAX: usize = 512;

/// Shape that a vocabulary declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// k: how many children a node was meant to have.
    pub branching: u32,
    /// L: how many levels below the root it was meant to have. Groups count from it, whatever the tree's real depth.
    pub levels: u32,
    /// Bytes of one descriptor, a multiple of 8.
    pub descriptor_bytes: usize,
}
