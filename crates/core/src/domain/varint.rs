//! Numbers in as few bytes as they need: seven bits a byte, the lowest first (LEB128).

const BITS: u32 = 7;
const MORE: u8 = 1 << BITS;

/// Appends a number.
pub fn write(mut number: u64, bytes: &mut Vec<u8>) {
    while number >= u64::from(MORE) {
        bytes.push(number as u8 | MORE);
        number >>= BITS;
    }
    bytes.push(number as u8);
}

/// Takes a number from the front; `None` at the end of the bytes.
pub fn read(bytes: &mut &[u8]) -> Option<u64> {
    let (mut number, mut shift) = (0, 0);
    loop {
        let (byte, rest) = bytes.split_first()?;
        *bytes = rest;
        number |= u64::from(byte & !MORE).checked_shl(shift)?;
        if byte & MORE == 0 {
            return Some(number);
        }
        shift += BITS;
    }
}

/// Maps differences of either sign to small numbers: 0, -1, 1, -2 become 0, 1, 2, 3.
pub fn zigzag(difference: i64) -> u64 {
    (difference << 1 ^ difference >> 63) as u64
}

/// Returns the difference that [`zigzag`] mapped to this number.
pub fn unzigzag(number: u64) -> i64 {
    (number >> 1) as i64 ^ -((number & 1) as i64)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn numbers_come_back_one_by_one(numbers in prop::collection::vec((any::<u64>(), 0..64_u32), 0..20)) {
            let numbers: Vec<u64> = numbers.into_iter().map(|(number, shift)| number >> shift).collect();
            let mut bytes = Vec::new();
            for number in &numbers {
                write(*number, &mut bytes);
            }
            let mut rest = &*bytes;
            for number in &numbers {
                prop_assert_eq!(read(&mut rest), Some(*number));
                prop_assert_eq!(zigzag(unzigzag(*number)), *number);
            }
            prop_assert_eq!(read(&mut rest), None);
        }
    }
}
