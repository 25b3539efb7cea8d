//! One id stands for one verdict, whichever models are configured: all that a verdict depends on is in its id.

use super::Service;
use super::requests::{Request, any_request, keyframe_id};
use super::sending::send;
use super::{config, service_with_map};
use crate::config::models::ModelArgs;
use crate::domain::request::{LoopQuery, Subject};
use crate::domain::roles::Roles;
use crate::domain::verdict::{ReasonCode, Verify};
use crate::engine::service::Parts;
use crate::llm::Models;
use crate::llm::port::Model;
use crate::llm::silent::Silent;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Returns the service as it would answer with models in these roles. No worker runs, so that the map stays as it is.
async fn with_roles(service: &Service, roles: Roles) -> Service {
    if roles.is_none() {
        return service.clone();
    }
    let silent = |sees: bool, wanted: bool| wanted.then(|| Arc::new(Silent { sees }) as Arc<dyn Model>);
    let models = [silent(false, roles.text), silent(true, roles.vision), None];
    let models = Models::with(models, None, &ModelArgs::of(&[""; 0]).unwrap(), &service.store).await.unwrap();
    assert_eq!(models.roles(), roles);
    Service(Arc::new(Parts { models: Some(Arc::new(models)), ..Parts::clone(service) }))
}

async fn one_id_is_one_verdict_after(requests: Vec<Request>) {
    let folder = tempfile::tempdir().unwrap();
    let (service, map) = service_with_map(&folder).await;
    for request in requests {
        let _ = send(&service, &map, request).await;
    }
    let mut verdicts = BTreeMap::new();
    for (vision, text) in [(false, false), (true, false), (false, true), (true, true)] {
        let service = with_roles(&service, Roles { vision, text }).await;
        for name in 0..14 {
            let subject = Subject::Stored(keyframe_id(name));
            let query = LoopQuery {
                subject,
                release: None,
                verify: Verify::Auto,
                max_wait_ms: 0,
                seed: 0,
                again: false,
            };
            let Ok(answer) = service.loop_query(&map, query).await else { continue };
            for candidate in &answer.verdict.candidates {
                let class = candidate.reason.as_ref().map(|reason| reason.code.words().class);
                assert!(class.is_none_or(|class| candidate.decision.fits(class)), "{candidate:?}");
            }
            let waits = answer.verdict.candidates.iter().filter_map(|c| Some(c.reason.as_ref()?.code));
            assert!(vision || waits.into_iter().all(|code| code != ReasonCode::LlmPending));
            let known = verdicts.entry(answer.id).or_insert_with(|| answer.verdict.clone());
            assert_eq!(*known, answer.verdict, "vision: {vision}, text: {text}");
        }
    }
    service.close().await;
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn one_id_is_one_verdict_under_any_configuration(requests in prop::collection::vec(any_request(), 1..40)) {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(one_id_is_one_verdict_after(requests));
    }
}
