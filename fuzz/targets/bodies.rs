//! The other bodies: maps and their settings, poses, loops, queries, anchors, texts, what models said.
#![no_main]

use libfuzzer_sys::fuzz_target;
use revisit::domain::request::{ChangedObservations, LoopQuery, MapPatch, NewLoop, NewMap, NewVerdict, PoseCorrection};
use revisit::api::anchor::AnchorPatchBody;
use revisit::api::session_merge::MergeFields;
use revisit::api::semantics::{OneText, TextPair};
use revisit::api::decoding::{read, syntax};

fuzz_target!(|bytes: &[u8]| {
    let Some((kind, bytes)) = bytes.split_first() else { return };
    let Ok(body) = syntax::parse(bytes) else { return };
    let faults = match kind % 10 {
        _ if *kind >= 0x80 => read::decode::<NewVerdict>(&body).err(),
        0 => read::decode::<NewMap>(&body).err(),
        1 => read::decode::<MapPatch>(&body).err(),
        2 => read::decode::<PoseCorrection>(&body).err(),
        3 => read::decode::<NewLoop>(&body).err(),
        4 => read::decode::<LoopQuery>(&body).err(),
        5 => read::decode::<AnchorPatchBody>(&body).err(),
        6 => read::decode::<TextPair>(&body).err(),
        7 => read::decode::<ChangedObservations>(&body).err(),
        8 => read::decode::<MergeFields>(&body).err(),
        _ => read::decode::<OneText>(&body).err(),
    };
    assert!(faults.is_none_or(|faults| !faults.is_empty()));
});
