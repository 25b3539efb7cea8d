// What a host's map does after a keyframe was sent: corrections, fused points, merged sessions, loops.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include "gone_points.hpp"
#include "keyframe.hpp"
#include "keyframe_json.hpp"

namespace revisit {

/// Poses and points after the host's own optimisation; one transaction on the server.
struct PoseCorrections {
    std::string session = "default";
    std::vector<std::string> keyframes;
    /// `map_from_camera` of each.
    std::vector<Pose> poses;
    MapPoints map_points;
};

/// What a keyframe observes and is covisible with, now; whatever is absent stays as it was.
struct KeyframeObservations {
    std::string keyframe;
    std::optional<std::vector<std::int64_t>> observes;
    std::optional<std::vector<Covisible>> covisible;
};

/// Points that the host fused or culled, and edges that it added, after their keyframes were sent.
struct Observations {
    std::string session = "default";
    /// Old point, new point.
    std::vector<std::pair<std::int64_t, std::int64_t>> replaced;
    std::vector<std::int64_t> removed;
    std::vector<KeyframeObservations> keyframes;
};

/// Two maps of the host became one: `session` moves into the frame of `into`.
struct SessionMerge {
    std::string session;
    std::string into;
    Similarity into_from_session;
    /// Added to each point number of `session`, or
    std::optional<std::int64_t> point_offset;
    /// its points one by one: old, new.
    std::vector<std::pair<std::int64_t, std::int64_t>> points;
};

/// A loop that the host has closed. The server merges the matched anchors.
struct Loop {
    std::string id;
    std::string keyframe;
    std::string candidate;
    /// The verdict that it rests on, if any.
    std::string query;
};

inline Status check(const PoseCorrections& corrections) noexcept {
    return detail::guarded([&]() -> Status {
        detail::Checker checker;
        bool good = checker.id(corrections.session, "/session") && checker.count(corrections.keyframes.size(), limits::corrections, "/keyframes/ids");
        if (good && corrections.keyframes.size() != corrections.poses.size()) good = checker.refuse("not one for each keyframe", "/keyframes/poses");
        for (std::size_t i = 0; good && i < corrections.poses.size(); ++i)
            good = checker.id(corrections.keyframes[i], "/keyframes/ids/", i) && checker.pose(corrections.poses[i], "/keyframes/poses/", i);
        if (good) detail::check_map_points(checker, corrections.map_points, limits::corrections);
        return checker.status();
    });
}

namespace detail {

inline bool check_gone_points(Checker& checker, const Observations& observations, GonePoints& gone) {
    if (!checker.count(observations.replaced.size(), limits::gone_points, "/replaced")) return false;
    for (std::size_t i = 0; i < observations.replaced.size(); ++i) {
        const auto [old, by] = observations.replaced[i];
        if (old < 0 || by < 0) return checker.refuse("a point's number is not negative", "/replaced/", i);
        if (gone.has(old)) return checker.refuse("this point is replaced twice", "/replaced/", i);
        if (!gone.fuse(old, by)) return checker.refuse("a point is not replaced by itself", "/replaced/", i);
    }
    if (!checker.points(observations.removed, limits::gone_points, 0, "/removed")) return false;
    for (std::size_t i = 0; i < observations.removed.size(); ++i)
        if (!gone.cull(observations.removed[i])) return checker.refuse("this point is gone already", "/removed/", i);
    return true;
}

inline bool check_keyframe_observations(Checker& checker, const KeyframeObservations& keyframe, std::size_t i, const GonePoints& gone) {
    const char* at = "/keyframes/";
    if (!checker.id(keyframe.keyframe, at, i, "/keyframe")) return false;
    if (keyframe.observes) {
        if (!checker.points(*keyframe.observes, limits::map_points, 0, at, i, "/observes")) return false;
        for (std::size_t k = 0; k < keyframe.observes->size(); ++k)
            if (gone.has((*keyframe.observes)[k])) return checker.refuse("this request replaces or removes this point", at, i, "/observes/", k);
    }
    if (!keyframe.covisible) return true;
    if (!checker.count(keyframe.covisible->size(), limits::covisible, at, i, "/covisible")) return false;
    for (std::size_t k = 0; k < keyframe.covisible->size(); ++k) {
        const auto& other = (*keyframe.covisible)[k].keyframe;
        if (!checker.id(other, at, i, "/covisible/", k, "/keyframe")) return false;
        if (other == keyframe.keyframe) return checker.refuse("a keyframe is not declared covisible with itself", at, i, "/covisible/", k, "/keyframe");
    }
    return true;
}

}  // namespace detail

inline Status check(const Observations& observations) noexcept {
    return detail::guarded([&]() -> Status {
        detail::Checker checker;
        detail::GonePoints gone;
        bool good = checker.id(observations.session, "/session") && detail::check_gone_points(checker, observations, gone) &&
                    checker.count(observations.keyframes.size(), limits::changed_keyframes, "/keyframes");
        std::unordered_set<std::string_view> named;
        for (std::size_t i = 0; good && i < observations.keyframes.size(); ++i) {
            good = detail::check_keyframe_observations(checker, observations.keyframes[i], i, gone);
            if (good && !named.insert(observations.keyframes[i].keyframe).second) good = checker.refuse("the keyframe is listed twice", "/keyframes/", i, "/keyframe");
        }
        return checker.status();
    });
}

inline Status check(const SessionMerge& merge) noexcept {
    return detail::guarded([&]() -> Status {
        detail::Checker checker;
        const auto& transform = merge.into_from_session;
        bool good = checker.id(merge.session, "/session") && checker.id(merge.into, "/into");
        if (good && merge.session == merge.into) good = checker.refuse("a session does not merge into itself", "/into");
        good = good && checker.pose({transform.translation, transform.rotation}, "/into_from_session");
        if (good && !(transform.scale > 0 && std::isfinite(transform.scale))) good = checker.refuse("a scale is positive", "/into_from_session/scale");
        if (good && merge.point_offset && !merge.points.empty()) good = checker.refuse("an offset or single ids, not both", "/map_points");
        if (good) checker.count(merge.points.size(), limits::corrections, "/map_points/ids");
        return checker.status();
    });
}

inline Status check(const Loop& loop) noexcept {
    return detail::guarded([&]() -> Status {
        detail::Checker checker;
        if (checker.id(loop.id, "/id") && checker.id(loop.keyframe, "/keyframe") && checker.id(loop.candidate, "/candidate") && !loop.query.empty())
            checker.id(loop.query, "/query");
        return checker.status();
    });
}

namespace detail {

inline void append_pairs(std::string& out, const std::vector<std::pair<std::int64_t, std::int64_t>>& pairs) {
    out += '[';
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        append_integer(out += i > 0 ? ",[" : "[", pairs[i].first);
        append_integer(out += ',', pairs[i].second);
        out += ']';
    }
    out += ']';
}

inline std::string body_of(const PoseCorrections& corrections, const Precision& precision) {
    std::string out;
    ObjectWriter object(out);
    object.text("session", corrections.session);
    if (!corrections.keyframes.empty()) {
        object.name("keyframes") += "{\"ids\":[";
        for (std::size_t i = 0; i < corrections.keyframes.size(); ++i) {
            if (i > 0) out += ',';
            append_string(out, corrections.keyframes[i]);
        }
        out += "],\"poses\":[";
        for (std::size_t i = 0; i < corrections.poses.size(); ++i) {
            if (i > 0) out += ',';
            append_pose(out, corrections.poses[i]);
        }
        out += "]}";
    }
    if (!corrections.map_points.ids.empty()) {
        // No packed form here.
        append_id_list(object.name("map_points") += "{\"ids\":", corrections.map_points.ids);
        append_positions(out += ",\"positions\":", corrections.map_points.positions, precision.position_decimals);
        out += '}';
    }
    object.close();
    return out;
}

inline std::string body_of(const Observations& observations) {
    std::string out;
    ObjectWriter object(out);
    object.text("session", observations.session);
    if (!observations.replaced.empty()) append_pairs(object.name("replaced"), observations.replaced);
    if (!observations.removed.empty()) append_id_list(object.name("removed"), observations.removed);
    if (!observations.keyframes.empty()) {
        object.name("keyframes") += '[';
        for (std::size_t i = 0; i < observations.keyframes.size(); ++i) {
            const auto& keyframe = observations.keyframes[i];
            if (i > 0) out += ',';
            ObjectWriter one(out);
            one.text("keyframe", keyframe.keyframe);
            if (keyframe.observes) append_integers(one, "observes", "observes_i64", *keyframe.observes);
            if (keyframe.covisible) append_covisible(one.name("covisible"), *keyframe.covisible);
            one.close();
        }
        out += ']';
    }
    object.close();
    return out;
}

inline std::string body_of(const SessionMerge& merge) {
    std::string out;
    ObjectWriter object(out);
    object.text("into", merge.into);
    const auto& transform = merge.into_from_session;
    append_pose(object.name("into_from_session"), {transform.translation, transform.rotation});
    if (transform.scale != 1) {
        // Beside the pose's own members.
        out.back() = ',';
        append_number(out += "\"scale\":", transform.scale);
        out += '}';
    }
    if (merge.point_offset) {
        append_integer(object.name("map_points") += "{\"offset\":", *merge.point_offset);
        out += '}';
    } else if (!merge.points.empty()) {
        append_pairs(object.name("map_points") += "{\"ids\":", merge.points);
        out += '}';
    }
    object.close();
    return out;
}

inline std::string body_of(const Loop& loop) {
    std::string out;
    ObjectWriter object(out);
    object.text("id", loop.id);
    object.text("keyframe", loop.keyframe);
    object.text("candidate", loop.candidate);
    if (!loop.query.empty()) object.text("query", loop.query);
    object.close();
    return out;
}

}  // namespace detail
}  // namespace revisit
