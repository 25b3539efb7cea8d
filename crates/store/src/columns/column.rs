//! Columns: lists of numbers of one kind, in as few bytes as they need and exactly as they were.
//!
//! Integers are kept as steps from one to the next, or as offsets of one width from the least. Floats with a few decimals
//! are kept as integers, others as the narrower float that holds them exactly: the idea of ALP (Afroozeh, Kuffo, Boncz,
//! "ALP: Adaptive Lossless floating-Point Compression", SIGMOD 2024) with one scheme for a column.

use revisit_core::domain::varint;

use crate::StoreError;
use crate::columns::blob::{pack, unpack};

/// Decimals that are tried: a float of 32 bits has no more than six that count.
const DECIMALS_MAX: u8 = 6;

/// Beyond it not every integer is a float of its own.
const EXACT: f64 = 9_007_199_254_740_992.0;

// The first byte of a column.
const STEPS: u8 = 1;
const OFFSETS: u8 = 2;
const DOUBLES: u8 = 3;
const SINGLES: u8 = 4;
const DECIMALS: u8 = 5;

/// Packs integers.
pub(crate) fn integers(list: &[i64]) -> Vec<u8> {
    let (steps, least) = (steps(list), list.iter().copied().min().unwrap_or(0));
    let offset = |number: &i64| number.wrapping_sub(least) as u64;
    let most = list.iter().map(offset).max().unwrap_or(0);
    let width = ((u64::BITS - most.leading_zeros()).div_ceil(u8::BITS) as usize).max(1);
    let mut offsets = vec![OFFSETS];
    varint::write(list.len() as u64, &mut offsets);
    varint::write(varint::zigzag(least), &mut offsets);
    offsets.push(width as u8);
    if offsets.len() + width * list.len() >= steps.len() {
        return steps;
    }
    offsets.reserve_exact(width * list.len());
    for number in list {
        offsets.extend_from_slice(&offset(number).to_le_bytes()[..width]);
    }
    offsets
}

fn steps(list: &[i64]) -> Vec<u8> {
    let (mut bytes, mut last) = (Vec::with_capacity(2 + 2 * list.len()), 0_i64);
    bytes.push(STEPS);
    for number in list {
        varint::write(varint::zigzag(number.wrapping_sub(last)), &mut bytes);
        last = *number;
    }
    bytes
}

/// Unpacks integers, as a type that must hold each of them.
pub(crate) fn integers_of<T: TryFrom<i64>>(bytes: &[u8]) -> Result<Vec<T>, StoreError> {
    let corrupt = || StoreError::corrupt("a column of integers has another length or too large a number");
    let list = match bytes.split_first() {
        Some((&STEPS, steps)) => steps_of(steps),
        Some((&OFFSETS, offsets)) => offsets_of(offsets),
        _ => return Err(StoreError::corrupt("no column of integers")),
    };
    list.ok_or_else(corrupt)
}

fn steps_of<T: TryFrom<i64>>(mut bytes: &[u8]) -> Option<Vec<T>> {
    /// Below it a byte is a number of its own.
    const ONE_BYTE: u8 = 0x80;
    let (mut list, mut last) = (Vec::with_capacity(bytes.len()), 0_i64);
    while !bytes.is_empty() {
        // Most steps take one byte or two: words lie about a thousand apart.
        let step = match *bytes {
            [a, ..] if a < ONE_BYTE => {
                bytes = &bytes[1..];
                u64::from(a)
            }
            [a, b, ..] if b < ONE_BYTE => {
                bytes = &bytes[2..];
                u64::from(a - ONE_BYTE) | u64::from(b) << 7
            }
            _ => varint::read(&mut bytes)?,
        };
        last = last.wrapping_add(varint::unzigzag(step));
        list.push(T::try_from(last).ok()?);
    }
    Some(list)
}

fn offsets_of<T: TryFrom<i64>>(mut bytes: &[u8]) -> Option<Vec<T>> {
    let count = varint::read(&mut bytes)?;
    let least = varint::unzigzag(varint::read(&mut bytes)?);
    let (&width, offsets) = bytes.split_first()?;
    if offsets.len() as u64 != count.checked_mul(width.into())? {
        return None;
    }
    match width {
        1 => offsets_of_width::<1, T>(offsets, least),
        2 => offsets_of_width::<2, T>(offsets, least),
        3 => offsets_of_width::<3, T>(offsets, least),
        4 => offsets_of_width::<4, T>(offsets, least),
        5 => offsets_of_width::<5, T>(offsets, least),
        6 => offsets_of_width::<6, T>(offsets, least),
        7 => offsets_of_width::<7, T>(offsets, least),
        8 => offsets_of_width::<8, T>(offsets, least),
        _ => None,
    }
}

fn offsets_of_width<const WIDTH: usize, T: TryFrom<i64>>(offsets: &[u8], least: i64) -> Option<Vec<T>> {
    let number = |offset: &[u8; WIDTH]| {
        let mut wide = [0; 8];
        wide[..WIDTH].copy_from_slice(offset);
        T::try_from(least.wrapping_add(u64::from_le_bytes(wide) as i64)).ok()
    };
    let (offsets, _) = offsets.as_chunks::<WIDTH>();
    let mut list = Vec::with_capacity(offsets.len());
    for offset in offsets {
        list.push(number(offset)?);
    }
    Some(list)
}

/// Packs floats.
pub(crate) fn floats(list: &[f64]) -> Vec<u8> {
    if let Some((decimals, scaled)) = (0..=DECIMALS_MAX).find_map(|of| Some((of, scaled(list, of)?))) {
        let mut bytes = vec![DECIMALS, decimals];
        bytes.extend(integers(&scaled));
        return bytes;
    }
    let is_single = |number: &f64| f64::from(*number as f32).to_bits() == number.to_bits();
    let (kind, numbers) = if list.iter().all(is_single) {
        (SINGLES, pack(list.iter().map(|number| (*number as f32).to_bits())))
    } else {
        (DOUBLES, pack(list.iter().copied()))
    };
    [vec![kind], numbers].concat()
}

/// Returns the numbers with so many decimals as integers, if they are no other numbers then.
fn scaled(list: &[f64], decimals: u8) -> Option<Vec<i64>> {
    let scale = 10_f64.powi(decimals.into());
    let scaled = |number: &f64| {
        let rounded = (number * scale).round();
        let whole = rounded as i64;
        let is_same = rounded.abs() <= EXACT && (whole as f64 / scale).to_bits() == number.to_bits();
        is_same.then_some(whole)
    };
    list.iter().map(scaled).collect()
}

/// Unpacks floats.
pub(crate) fn floats_of(bytes: &[u8]) -> Result<Vec<f64>, StoreError> {
    match bytes {
        [DECIMALS, decimals, integers @ ..] if *decimals <= DECIMALS_MAX => {
            let scale = 10_f64.powi((*decimals).into());
            Ok(integers_of::<i64>(integers)?.into_iter().map(|whole| whole as f64 / scale).collect())
        }
        [SINGLES, singles @ ..] => {
            Ok(unpack::<u32>(singles)?.into_iter().map(|bits| f64::from(f32::from_bits(bits))).collect())
        }
        [DOUBLES, doubles @ ..] => unpack(doubles),
        _ => Err(StoreError::corrupt("no column of floats")),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[track_caller]
    fn check(list: &[f64], bytes: usize) {
        let packed = floats(list);
        assert_eq!(packed.len(), bytes, "{list:?}");
        let bits = |list: &[f64]| list.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&floats_of(&packed).expect("a column")), bits(list));
    }

    #[test]
    fn floats_take_the_bytes_that_their_decimals_need() {
        check(&[], 3);
        let hundredths: Vec<f64> = (0..100).map(|at| f64::from(at * 7919 % 64_000) / 100.0).collect();
        check(&hundredths, 2 + 4 + 100 * 2);
        check(&[1.0, 2.0, 3.0], 2 + 1 + 3);
        check(&[0.1 + 0.2], 1 + 8);
        check(&[f64::from(0.1_f32), 7.0], 1 + 2 * 4);
        check(&[f64::NAN, -0.0], 1 + 2 * 4);
    }

    #[test]
    fn integers_are_steps_or_offsets_whichever_is_shorter() {
        assert_eq!(integers(&[1_000_000, 1_000_001, 1_000_002]).len(), 1 + 3 + 2);
        let mixed: Vec<i64> = (0..100).map(|at| if at % 2 == 0 { -1 } else { 50_000 + at }).collect();
        assert_eq!(integers(&mixed).len(), 4 + 2 * mixed.len());
    }

    proptest! {
        #[test]
        fn integers_come_back(
            list in prop_oneof![
                prop::collection::vec(prop_oneof![any::<i64>(), -5_i64..5, 0_i64..100_000], 0..50),
                (any::<i64>(), 0_usize..50).prop_map(|(number, times)| vec![number; times]),
            ],
        ) {
            prop_assert_eq!(integers_of::<i64>(&integers(&list)).expect("a column"), list);
        }

        #[test]
        fn floats_come_back_to_the_bit(
            list in prop::collection::vec(prop_oneof![
                any::<f64>(),
                any::<f32>().prop_map(f64::from),
                (-1_000_000_i64..1_000_000, 0..7).prop_map(|(whole, of)| whole as f64 / 10_f64.powi(of)),
            ], 0..50),
        ) {
            let bits = |list: &[f64]| list.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&floats_of(&floats(&list)).expect("a column")), bits(&list));
        }

        #[test]
        fn any_bytes_are_a_column_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..40)) {
            let _ = (integers_of::<u32>(&bytes), integers_of::<i64>(&bytes), floats_of(&bytes));
        }
    }
}
