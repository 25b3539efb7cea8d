//! An exported map, played again, is the same map; and what is exported of it is the same again.

use proptest::prelude::*;

use super::requests::{Request, any_request};
use super::sending::send;
use super::{config, open, pretty};
use crate::domain::ids::{AnchorSeq, MapId};
use crate::domain::map::MapProperties;
use crate::domain::prior::AnchorKey;
use crate::domain::recorded::{NamedDetection, Recorded};
use crate::domain::request::{MapPatch, NewVerdict};
use crate::engine::{Service, ServiceError};

/// Whether a client can say it, and an export all that it does: what a model says for a second time stands in the place
/// of the first.
fn is_exported(request: &Request) -> bool {
    match request {
        Request::JudgeAgain { .. } | Request::Away(_) | Request::ChangeSign { .. } => false,
        Request::ReadCrop { degraded, .. } => !degraded,
        _ => true,
    }
}

fn any_exported() -> impl Strategy<Value = Vec<Request>> {
    prop::collection::vec(any_request().prop_filter("says what is exported", is_exported), 1..40).prop_map(
        |mut requests| {
            let mut judged = std::collections::HashSet::new();
            requests.retain(|request| match request {
                Request::Judge { class, a, b, finding } => {
                    judged.insert((*class, *a.min(b), *a.max(b), finding / 5))
                }
                _ => true,
            });
            requests
        },
    )
}

async fn exported(service: &Service, map: &MapId) -> Vec<Recorded> {
    let mut export = service.export(map, None).await.unwrap();
    let mut all = Vec::new();
    while let Some(recorded) = export.next().await.unwrap() {
        all.push(recorded);
    }
    all
}

fn properties(patch: MapPatch) -> MapProperties {
    let mut properties = MapProperties {
        description: patch.description.unwrap_or_default(),
        metric: patch.metric.unwrap_or(true),
        gravity: patch.gravity,
        anchor_classes: patch.anchor_classes.unwrap_or_default(),
        code_classes: patch.code_classes.unwrap_or_default(),
        ..MapProperties::default()
    };
    for (name, value) in patch.settings {
        properties.settings.set(&name, value).unwrap();
    }
    properties
}

async fn anchor_of(service: &Service, map: &MapId, named: &NamedDetection) -> AnchorSeq {
    let live = service.live(map).await.unwrap();
    let state = live.state().unwrap();
    let index = &state.index;
    let keyframe = index.keyframe_seq(&named.keyframe).expect("a keyframe that was exported");
    let feeds = |anchor: &AnchorSeq| {
        index.anchor(*anchor).unwrap().observations.contains_key(&(keyframe, named.number))
    };
    let anchor = index.anchors_seen_by(keyframe).find(feeds).expect("a detection that feeds an anchor");
    index.objects().root(anchor).unwrap()
}

async fn play(
    service: &Service,
    map: &MapId,
    recorded: Recorded,
    is_first: bool,
) -> Result<(), ServiceError> {
    match recorded {
        Recorded::Map(patch) if is_first => {
            service.put_map(map.clone(), properties(patch), None).await.map(drop)
        }
        Recorded::Map(patch) => service.patch_map(map, patch).await.map(drop),
        Recorded::Keyframe(keyframe) => service.put_keyframe(map, *keyframe, [0; 32]).await.map(drop),
        Recorded::Poses(correction) => service.correct_poses(map, correction).await.map(drop),
        Recorded::Observations(changed) => service.change_observations(map, changed).await.map(drop),
        Recorded::SessionsMerged(merge) => service.merge_sessions(map, merge).await.map(drop),
        Recorded::MergeRevoked(session) => service.revoke_merge(map, session).await.map(drop),
        Recorded::Loop(closed) => service.confirm_loop(map, closed, None).await.map(drop),
        Recorded::LoopRevoked(id) => service.revoke_loop(map, &id).await.map(drop),
        Recorded::Description { detection, text } => {
            let anchor = anchor_of(service, map, &detection).await;
            service.describe_anchor(map, anchor.into(), None, text).await.map(drop)
        }
        Recorded::AnchorDeleted(detection) => {
            let anchor = anchor_of(service, map, &detection).await;
            service.delete_anchor(map, anchor.into(), None).await.map(drop)
        }
        Recorded::Prior(prior) => service.put_prior(map, prior).await.map(drop),
        Recorded::PriorDeleted(id) => service.delete_anchor(map, AnchorKey::Prior(id), None).await.map(drop),
        Recorded::Judged(verdict) => service.bring_verdict(map, NewVerdict::OfTexts(verdict)).await.map(drop),
        Recorded::CropRead { detection, reading } => {
            service.bring_verdict(map, NewVerdict::OfCrop(detection, reading)).await.map(drop)
        }
    }
}

async fn is_the_same_map_after(requests: Vec<Request>) {
    let (here, there) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (original, copy) = (open(&here).await, open(&there).await);
    let map: MapId = "hotel".parse().unwrap();
    let mut properties = MapProperties { metric: true, ..MapProperties::default() };
    properties.settings.covisibility_min_shared_points = 3;
    original.put_map(map.clone(), properties, None).await.unwrap();
    let deletes = requests.iter().any(|request| matches!(request, Request::Cull(_)));
    for request in requests {
        let _ = send(&original, &map, request).await;
    }
    let mut said = exported(&original, &map).await;
    for (number, recorded) in said.iter().cloned().enumerate() {
        let shown = format!("{recorded:?}");
        play(&copy, &map, recorded, number == 0).await.unwrap_or_else(|error| panic!("{error}: {shown}"));
    }
    let mut again = exported(&copy, &map).await;
    if deletes {
        // What a model said of texts that only deleted keyframes had read is said to nobody.
        for all in [&mut said, &mut again] {
            all.retain(|recorded| !matches!(recorded, Recorded::Judged(_)));
        }
    } else {
        let (live, played) = (original.live(&map).await.unwrap(), copy.live(&map).await.unwrap());
        pretty(&played.state().unwrap().index, &live.state().unwrap().index);
    }
    let differs = said.iter().zip(&again).find(|(one, other)| one != other);
    assert!(differs.is_none(), "{differs:?}");
    assert_eq!(said.len(), again.len());
    original.close().await;
    copy.close().await;
}

/// A merge whose only keyframe was deleted since changes nothing where it is played again, and its revocation would take
/// another merge back.
#[test]
fn a_merge_whose_keyframes_are_deleted_is_not_exported_nor_is_its_revocation() {
    let put = |session| Request::Put {
        name: 0,
        session,
        words: Vec::new(),
        points: Vec::new(),
        covisible: None,
        detections: Vec::new(),
    };
    let merge = || Request::Merge { session: 0, numbers: None, turned: false };
    let twice = |last: Vec<Request>| {
        let mut requests = vec![put(0), merge(), Request::Plates(12), merge()];
        requests.extend(last);
        requests
    };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    runtime.block_on(is_the_same_map_after(twice(vec![Request::Cull(12)])));
    runtime.block_on(is_the_same_map_after(twice(vec![Request::RevokeMerge(0), Request::Cull(12)])));
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn an_exported_map_played_again_is_the_same_map(requests in any_exported()) {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(is_the_same_map_after(requests));
    }
}
