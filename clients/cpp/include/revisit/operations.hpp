// Operations of the API document, by id. `check` compares this table with openapi/openapi.yaml.
#pragma once

#include <string_view>

namespace revisit::detail {

struct Operation {
    std::string_view id;
    const char* method;
    /// With `{names}` for the parts that the caller gives.
    const char* path;
};

constexpr Operation operations[] = {
    {"bring_model_verdict", "POST", "/v1/maps/{map}/model-verdicts"},
    {"change_observations", "POST", "/v1/maps/{map}/observations"},
    {"confirm_loop", "POST", "/v1/maps/{map}/loops"},
    {"correct_poses", "POST", "/v1/maps/{map}/poses"},
    {"create_key", "POST", "/v1/keys"},
    {"delete_anchor", "DELETE", "/v1/maps/{map}/anchors/{anchor}"},
    {"delete_backup", "DELETE", "/v1/backups/{id}"},
    {"delete_keyframe", "DELETE", "/v1/maps/{map}/keyframes/{keyframe}"},
    {"delete_map", "DELETE", "/v1/maps/{map}"},
    {"delete_release", "DELETE", "/v1/maps/{map}/releases/{release}"},
    {"erase", "POST", "/v1/maps/{map}/erase"},
    {"export_map", "GET", "/v1/maps/{map}/export"},
    {"get_anchor", "GET", "/v1/maps/{map}/anchors/{anchor}"},
    {"get_changes", "GET", "/v1/maps/{map}/changes"},
    {"get_crop", "GET", "/v1/maps/{map}/anchors/{anchor}/crop"},
    {"get_document", "GET", "/openapi.json"},
    {"get_erasure", "GET", "/v1/maps/{map}/erase/{erasure}"},
    {"get_frames", "GET", "/v1/maps/{map}/frames"},
    {"get_judgement", "GET", "/v1/maps/{map}/judgements/{id}"},
    {"get_keyframe", "GET", "/v1/maps/{map}/keyframes/{keyframe}"},
    {"get_local_anchor_map", "GET", "/v1/maps/{map}/keyframes/{keyframe}/local-anchor-map"},
    {"get_loop_query", "GET", "/v1/maps/{map}/loop-queries/{query}"},
    {"get_map", "GET", "/v1/maps/{map}"},
    {"get_metrics", "GET", "/metrics"},
    {"get_own_key", "GET", "/v1/keys/me"},
    {"get_release", "GET", "/v1/maps/{map}/releases/{release}"},
    {"get_trajectory", "GET", "/v1/maps/{map}/trajectory"},
    {"get_transcript", "GET", "/v1/maps/{map}/anchors/{anchor}/transcript"},
    {"get_usage", "GET", "/v1/usage"},
    {"get_version", "GET", "/version"},
    {"healthz", "GET", "/healthz"},
    {"information", "POST", "/v1/semantics/information"},
    {"judge_again", "POST", "/v1/maps/{map}/judgements"},
    {"list_anchors", "GET", "/v1/maps/{map}/anchors"},
    {"list_backups", "GET", "/v1/backups"},
    {"list_covisible", "GET", "/v1/maps/{map}/keyframes/{keyframe}/covisible"},
    {"list_keyframes", "GET", "/v1/maps/{map}/keyframes"},
    {"list_keys", "GET", "/v1/keys"},
    {"list_loop_queries", "GET", "/v1/maps/{map}/loop-queries"},
    {"list_loops", "GET", "/v1/maps/{map}/loops"},
    {"list_maps", "GET", "/v1/maps"},
    {"list_releases", "GET", "/v1/maps/{map}/releases"},
    {"list_sessions", "GET", "/v1/maps/{map}/sessions"},
    {"listen", "GET", "/v1/maps/{map}/events"},
    {"locate", "POST", "/v1/locate"},
    {"merge_sessions", "POST", "/v1/maps/{map}/sessions/{session}/merge"},
    {"merge_text", "POST", "/v1/semantics/merge"},
    {"patch_anchor", "PATCH", "/v1/maps/{map}/anchors/{anchor}"},
    {"patch_map", "PATCH", "/v1/maps/{map}"},
    {"publish_release", "PUT", "/v1/maps/{map}/releases/{release}"},
    {"put_keyframe", "PUT", "/v1/maps/{map}/keyframes/{keyframe}"},
    {"put_keyframes", "POST", "/v1/maps/{map}/keyframes"},
    {"put_map", "PUT", "/v1/maps/{map}"},
    {"put_prior_anchor", "PUT", "/v1/maps/{map}/anchors/{anchor}"},
    {"query_loop", "POST", "/v1/maps/{map}/loop-queries"},
    {"readyz", "GET", "/readyz"},
    {"revoke_key", "DELETE", "/v1/keys/{id}"},
    {"revoke_loop", "DELETE", "/v1/maps/{map}/loops/{loop}"},
    {"revoke_merge", "DELETE", "/v1/maps/{map}/sessions/{session}/merge"},
    {"similarity", "POST", "/v1/semantics/similarity"},
    {"stop_judgement", "DELETE", "/v1/maps/{map}/judgements/{id}"},
    {"take_backup", "POST", "/v1/backups"},
};

inline const Operation* find_operation(std::string_view id) noexcept {
    for (const auto& operation : operations)
        if (operation.id == id) return &operation;
    return nullptr;
}

}  // namespace revisit::detail
