//! The observers of one map point in few bytes: the newest keyframe first, then the differences to older ones.
//!
//! The newest first, so that one more observer is written without reading the others.

use crate::domain::varint;

/// Returns the keyframes of a list, newest first.
pub(super) fn read(mut list: &[u8]) -> impl Iterator<Item = u32> + '_ {
    let mut last = None;
    std::iter::from_fn(move || {
        let number = varint::read(&mut list)? as u32;
        let keyframe = last.map_or(number, |last: u32| last - number);
        last = Some(keyframe);
        Some(keyframe)
    })
}

/// Appends the list with one more keyframe.
pub(super) fn add(list: &[u8], keyframe: u32, written: &mut Vec<u8>) {
    let mut older = list;
    match varint::read(&mut older) {
        None => varint::write(keyframe.into(), written),
        Some(newest) if newest < u64::from(keyframe) => {
            varint::write(keyframe.into(), written);
            varint::write(u64::from(keyframe) - newest, written);
            written.extend_from_slice(older);
        }
        Some(_) => {
            let mut keyframes: Vec<u32> = read(list).collect();
            if let Err(at) = keyframes.binary_search_by(|known| keyframe.cmp(known)) {
                keyframes.insert(at, keyframe);
            }
            write(&keyframes, written);
        }
    }
}

/// Appends the list without a keyframe.
pub(super) fn remove(list: &[u8], keyframe: u32, written: &mut Vec<u8>) {
    let keyframes: Vec<u32> = read(list).filter(|known| *known != keyframe).collect();
    write(&keyframes, written);
}

fn write(keyframes: &[u32], written: &mut Vec<u8>) {
    let mut last = None;
    for keyframe in keyframes {
        let number = last.map_or(*keyframe, |last: u32| last - keyframe);
        varint::write(number.into(), written);
        last = Some(*keyframe);
    }
}
