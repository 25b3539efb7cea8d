//! The block of a keyframe, and the keyframe's number in it.

/// Keyframe ids a block spans. Measured at 100,000 keyframes: half as many make a query a quarter slower, since
/// its lists are shorter; twice as many make it hardly faster and the pause when a block is sealed twice as long.
pub(super) const BLOCK_KEYFRAMES: usize = 8192;

/// Returns the block a keyframe belongs to.
pub(super) fn block_of(keyframe: u32) -> usize {
    keyframe as usize / BLOCK_KEYFRAMES
}

/// Returns a keyframe's number within its block.
pub(super) fn local_in_block(keyframe: u32) -> u16 {
    (keyframe as usize % BLOCK_KEYFRAMES) as u16
}
