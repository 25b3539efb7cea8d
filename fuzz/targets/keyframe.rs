//! Any JSON is a keyframe, with every number finite, or a list of faults; the same body has the same digest.
#![no_main]

use libfuzzer_sys::fuzz_target;
use revisit::api::keyframe;
use revisit::api::decoding::syntax;

fuzz_target!(|bytes: &[u8]| {
    let Ok(body) = syntax::parse(bytes) else { return };
    let id = "kf-1".parse().expect("an id");
    match keyframe::named(body.root(), &id) {
        Ok(sent) => {
            let (weights, at) = (sent.keyframe.bow.weights(), sent.keyframe.map_from_camera.translation_m());
            assert!(at.into_iter().all(f64::is_finite), "{at:?}");
            assert_eq!(weights.len(), sent.keyframe.bow.words().len());
            assert!(sent.keyframe.detections.iter().all(|d| d.box_px.iter().all(|x| x.is_finite())));
            assert!(
                sent.keyframe
                    .map_points
                    .iter()
                    .all(|(_, p)| p.x.is_finite() && p.y.is_finite() && p.z.is_finite())
            );
            let again: serde_json::Value = serde_json::from_slice(bytes).expect("JSON");
            let again = again.to_string();
            let again = syntax::parse(again.as_bytes()).expect("JSON");
            let again = keyframe::named(again.root(), &id);
            assert_eq!(again.map(|sent| sent.digest), Ok(sent.digest));
        }
        Err(faults) => assert!(!faults.is_empty()),
    }
});
