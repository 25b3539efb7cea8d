//! The majority: the binary descriptor that has each bit as most of a cluster's members have it.

/// Counts, for each bit, how many descriptors have it set.
///
/// Counters stand upright: plane `p` holds digit `p` of 64 counters, so that a word is added to all of them by
/// a few operations instead of 64.
pub(super) struct Majority {
    members: u32,
    /// For each word of the descriptor, its planes.
    planes: Vec<[u64; 32]>,
}

impl Majority {
    /// Of nobody, for descriptors of so many 64-bit words.
    pub fn new(words: usize) -> Self {
        Self { members: 0, planes: vec![[0; 32]; words] }
    }

    /// Adds a member.
    pub fn add(&mut self, descriptor: &[u64]) {
        self.members += 1;
        for (planes, &word) in self.planes.iter_mut().zip(descriptor) {
            let mut carry = word;
            for plane in planes {
                if carry == 0 {
                    break;
                }
                (*plane, carry) = (*plane ^ carry, *plane & carry);
            }
        }
    }

    /// Returns the number of members.
    pub fn members(&self) -> u32 {
        self.members
    }

    /// Returns the majority; a bit that half of them have is set.
    pub fn descriptor(&self) -> impl Iterator<Item = u64> + '_ {
        self.planes.iter().map(|planes| {
            (0..64).fold(0, |word, bit| {
                let digits = planes.iter().rev();
                let count = digits.fold(0, |count: u64, plane| count << 1 | (plane >> bit & 1));
                word | u64::from(2 * count >= u64::from(self.members)) << bit
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bit_goes_with_the_majority_and_a_tie_sets_it() {
        let mut majority = Majority::new(2);
        for descriptor in [[0b1100, 1 << 63], [0b1010, 0], [0b1001, 1 << 63], [0b0001, 0]] {
            majority.add(&descriptor);
        }
        assert_eq!(majority.descriptor().collect::<Vec<_>>(), [0b1001, 1 << 63]);
    }
}
