//! Routes: one file per kind of resource; handlers extract, call the service once, and respond.

mod anchors;
mod bulk;
mod events;
mod keyframes;
mod keys;
mod lines;
mod loops;
mod maps;
mod models;
mod releases;
mod service;
mod sessions;

use utoipa::openapi::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::App;

/// Every operation of the API, documented in `frame`.
pub fn api(frame: OpenApi) -> OpenApiRouter<App> {
    OpenApiRouter::with_openapi(frame)
        .routes(routes!(maps::list_maps))
        .routes(routes!(maps::put_map, maps::get_map, maps::patch_map, maps::delete_map))
        .routes(routes!(keyframes::list_keyframes, bulk::put_keyframes))
        .routes(routes!(keyframes::put_keyframe, keyframes::get_keyframe, keyframes::delete_keyframe))
        .routes(routes!(keyframes::list_covisible))
        .routes(routes!(keyframes::get_local_anchor_map))
        .routes(routes!(keyframes::correct_poses))
        .routes(routes!(keyframes::change_observations))
        .routes(routes!(keyframes::get_trajectory))
        .routes(routes!(sessions::list_sessions))
        .routes(routes!(sessions::get_frames))
        .routes(routes!(sessions::merge_sessions, sessions::revoke_merge))
        .routes(routes!(releases::list_releases))
        .routes(routes!(releases::publish_release, releases::get_release, releases::delete_release))
        .routes(routes!(releases::get_changes))
        .routes(routes!(maps::erase))
        .routes(routes!(maps::get_erasure))
        .routes(routes!(maps::export_map))
        .routes(routes!(loops::list_loop_queries, loops::query_loop))
        .routes(routes!(loops::get_loop_query))
        .routes(routes!(loops::locate))
        .routes(routes!(loops::list_loops, loops::confirm_loop))
        .routes(routes!(loops::revoke_loop))
        .routes(routes!(models::bring_model_verdict))
        .routes(routes!(models::judge_again))
        .routes(routes!(models::get_judgement, models::stop_judgement))
        .routes(routes!(anchors::list_anchors))
        .routes(routes!(
            anchors::put_prior_anchor,
            anchors::get_anchor,
            anchors::patch_anchor,
            anchors::delete_anchor
        ))
        .routes(routes!(anchors::get_crop))
        .routes(routes!(anchors::get_transcript))
        .routes(routes!(events::listen))
        .routes(routes!(models::similarity))
        .routes(routes!(models::information))
        .routes(routes!(models::merge_text))
        .routes(routes!(models::get_usage))
        .routes(routes!(keys::list_keys, keys::create_key))
        .routes(routes!(keys::get_own_key))
        .routes(routes!(keys::revoke_key))
        .routes(routes!(service::list_backups, service::take_backup))
        .routes(routes!(service::delete_backup))
        .routes(routes!(service::healthz))
        .routes(routes!(service::readyz))
        .routes(routes!(service::get_version))
        .routes(routes!(service::get_metrics))
        .routes(routes!(service::get_document))
}
