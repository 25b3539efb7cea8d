//! Packed little-endian lists: how numbers that are never searched lie in a row.

use crate::StoreError;

/// A number of fixed width.
pub(crate) trait Packed: Sized {
    const BYTES: usize;
    fn put(&self, to: &mut Vec<u8>);
    /// Reads a number.
    ///
    /// # Panics
    /// If `from` has not exactly [`Packed::BYTES`] bytes.
    fn take(from: &[u8]) -> Self;
}

macro_rules! packed {
    ($($number:ty),*) => {
        $(impl Packed for $number {
            const BYTES: usize = size_of::<Self>();

            fn put(&self, to: &mut Vec<u8>) {
                to.extend_from_slice(&self.to_le_bytes());
            }

            fn take(from: &[u8]) -> Self {
                let mut bytes = [0; Self::BYTES];
                bytes.copy_from_slice(from);
                Self::from_le_bytes(bytes)
            }
        })*
    };
}

packed!(u8, u32, i64, f64);

impl<A: Packed, B: Packed> Packed for (A, B) {
    const BYTES: usize = A::BYTES + B::BYTES;

    fn put(&self, to: &mut Vec<u8>) {
        self.0.put(to);
        self.1.put(to);
    }

    fn take(from: &[u8]) -> Self {
        let (a, b) = from.split_at(A::BYTES);
        (A::take(a), B::take(b))
    }
}

impl<T: Packed, const N: usize> Packed for [T; N] {
    const BYTES: usize = N * T::BYTES;

    fn put(&self, to: &mut Vec<u8>) {
        for item in self {
            item.put(to);
        }
    }

    fn take(from: &[u8]) -> Self {
        std::array::from_fn(|item| T::take(&from[item * T::BYTES..(item + 1) * T::BYTES]))
    }
}

pub(crate) fn pack<T: Packed>(list: impl IntoIterator<Item = T>) -> Vec<u8> {
    let list = list.into_iter();
    let mut bytes = Vec::with_capacity(list.size_hint().0 * T::BYTES);
    list.for_each(|item| item.put(&mut bytes));
    bytes
}

pub(crate) fn unpack<T: Packed>(bytes: &[u8]) -> Result<Vec<T>, StoreError> {
    let chunks = bytes.chunks_exact(T::BYTES);
    if !chunks.remainder().is_empty() {
        return Err(StoreError::corrupt("a packed list ends within a number"));
    }
    Ok(chunks.map(T::take).collect())
}

pub(crate) fn unpack_array<T: Packed, const N: usize>(bytes: &[u8]) -> Result<[T; N], StoreError> {
    unpack(bytes)?.try_into().map_err(|_| StoreError::corrupt("a packed list has another length"))
}

/// Unpacks a blob as every kind of list with a fixed width that rows have, for fuzzing: what fits reads back.
///
/// # Panics
/// If a list that was unpacked is packed into other bytes.
pub(crate) fn unpacks(bytes: &[u8]) {
    fn check<T: Packed>(bytes: &[u8]) {
        if let Ok(list) = unpack::<T>(bytes) {
            assert_eq!(pack(list), bytes);
        }
    }
    check::<u32>(bytes);
    check::<i64>(bytes);
    check::<f64>(bytes);
    check::<(u32, u32)>(bytes);
    check::<((f64, f64), (f64, u8))>(bytes);
    check::<(u32, [f64; 7])>(bytes);
    check::<((u32, i64), [f64; 3])>(bytes);
    check::<([u32; 3], [f64; 3])>(bytes);
    let _ = unpack_array::<f64, 7>(bytes);
}
