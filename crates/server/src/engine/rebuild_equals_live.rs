//! The law of the house: an index built from the store equals the live one, after any requests.

mod exported;
mod one_verdict;
mod requests;
mod sending;

use super::{Service, ServiceError, ServiceOptions};
use crate::domain::ids::{AnchorSeq, MapId};
use crate::domain::map::MapProperties;
use crate::engine::cluster::following::Effort;
use crate::integrity::rebuild::rebuild;
use crate::recognition::map::index::MapIndex;
use crate::store::{News, Node, Order};
use proptest::prelude::*;
use requests::{Request, any_request};
use sending::send;

/// Opens a service on a database of its own, with the map that requests are made to.
async fn service_with_map(folder: &tempfile::TempDir) -> (Service, MapId) {
    let service = open(folder).await;
    let map: MapId = "hotel".parse().unwrap();
    let mut properties = MapProperties { metric: true, ..MapProperties::default() };
    properties.settings.covisibility_min_shared_points = 3;
    service.put_map(map.clone(), properties, None).await.unwrap();
    (service, map)
}

async fn open(folder: &tempfile::TempDir) -> Service {
    let database = crate::test_database::address_in(folder.path()).await;
    crate::store::use_small_sizes();
    Service::open(ServiceOptions::for_tests(database)).await.unwrap()
}

/// Has another server follow the map, where several share a database; as its owner, this one knows.
async fn followed(service: &Service, map: &MapId) -> Option<Service> {
    let node = service.store.leases()?.node().to_owned();
    let copies = service.following();
    service.live(map).await.unwrap();
    copies.live(map).await.unwrap();
    service.store.renew(&Node::new(&node, "http://localhost".to_owned())).await.unwrap();
    Some(copies)
}

async fn holds_after(requests: Vec<Request>) {
    let folder = tempfile::tempdir().unwrap();
    let (service, map) = service_with_map(&folder).await;
    let copies = followed(&service, &map).await;
    for request in requests {
        let shown = format!("{request:?}");
        match send(&service, &map, request).await {
            Err(ServiceError::Internal(error)) => panic!("{shown}: {error}"),
            Err(ServiceError::Unavailable { detail, .. }) => panic!("{shown}: {detail}"),
            Ok(()) | Err(_) => {}
        }
        if let Some(copies) = &copies {
            copies.reach_with(&map, 0, Effort::All).await.unwrap();
        }
    }
    let live = service.live(&map).await.unwrap();
    let loaded = rebuild(&service.store, &map, Order::Forwards).await.unwrap().unwrap();
    let backwards = rebuild(&service.store, &map, Order::Backwards).await.unwrap().unwrap();
    {
        let state = live.state().unwrap();
        assert_eq!(loaded.facts.version, state.version);
        pretty(&loaded.index, &state.index);
        // What `revisit check` builds to find out whether a database holds the law.
        pretty(&backwards.index, &state.index);
        // What lists of maps show, without an index.
        assert_eq!(loaded.facts.figures, state.index.figures());
        assert_eq!(loaded.facts.learned, state.index.learned());
    }
    if let Some(copies) = copies {
        copies.reach_with(&map, loaded.facts.version, Effort::All).await.unwrap();
        let copy = copies.live(&map).await.unwrap();
        // What is taken over twice counts once.
        let (rewrites, _) = copy.standing.followed_since().unwrap();
        let before = loaded.facts.version - 1;
        if let News::Changes(versions) = copies.store.news(copy.key, before, rewrites).await.unwrap() {
            copy.take_over(&versions).unwrap();
        }
        pretty(&copy.state().unwrap().index, &loaded.index);
        drop(copy);
        // The copy becomes the owner's.
        let before = service.stats().loads.promoted;
        live.throw_away();
        let promoted = service.live_in_background(&map).await.unwrap();
        assert_eq!((service.stats().loads.promoted, copies.registry.has(&map)), (before + 1, false));
        pretty(&promoted.state().unwrap().index, &loaded.index);
    }
    let listed = service.get_map(&map).await.unwrap();
    assert_eq!((listed.version, &listed.properties), (loaded.facts.version, loaded.index.properties()));
    assert_eq!(listed.vocabulary.as_deref(), loaded.index.vocabulary());
    drop(live);
    service.close().await;
}

/// A difference of two whole indexes is unreadable; this names the part that differs.
fn pretty(loaded: &MapIndex, live: &MapIndex) {
    assert_eq!(loaded.properties(), live.properties());
    assert_eq!(loaded.sessions(), live.sessions());
    assert_eq!(loaded.keyframes().collect::<Vec<_>>(), live.keyframes().collect::<Vec<_>>());
    assert_eq!(loaded.loops(), live.loops());
    assert_eq!(loaded.points(), live.points());
    assert_eq!(loaded.globals(), live.globals());
    assert_eq!(loaded.bytes(), live.bytes());
    assert_eq!(loaded.covisibility_lists(), live.covisibility_lists());
    for seq in (0..live.next_anchor().0).map(AnchorSeq) {
        assert_eq!(loaded.anchor(seq), live.anchor(seq));
    }
    assert_eq!(loaded.readings(), live.readings());
    assert_eq!(loaded.verdicts(), live.verdicts());
    assert_eq!(loaded.model_away(), live.model_away());
    assert_eq!(loaded.objects(), live.objects());
    assert_eq!(loaded.texts(), live.texts());
    assert!(loaded == live, "another part of the index differs");
}

/// 64 random sequences, or as many as `PROPTEST_CASES` says. A failing one becomes a test here, not a file beside the sources.
fn config() -> ProptestConfig {
    let said = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    let cases = if std::env::var_os("PROPTEST_CASES").is_some() { said.cases } else { 64 };
    ProptestConfig { cases, ..said }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn a_rebuilt_index_equals_the_live_one(requests in prop::collection::vec(any_request(), 1..40)) {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(holds_after(requests));
    }
}

/// A case that random requests found once: the rows of a large change are loaded as they were before it, and a detection as after it, so that
/// the detection seems to hold a point that goes.
#[tokio::test]
async fn a_session_that_merges_back_with_other_numbers_takes_no_position_from_before() {
    let sees_3 =
        requests::Seen { class: 0, text: None, confidence: 3, points: vec![3], position: None, crop: false };
    Box::pin(holds_after(vec![
        Request::Plates(0),
        Request::Put {
            name: 12,
            session: 0,
            words: vec![11, 19],
            points: vec![11, 4, 10, 0, 3],
            covisible: None,
            detections: vec![sees_3],
        },
        Request::Merge { session: 0, numbers: Some(Err(vec![(1, 8), (3, 2)])), turned: false },
        Request::Merge { session: 1, numbers: Some(Ok(2)), turned: false },
    ]))
    .await;
}
