// What adapters of all hosts share: conversions of their types, and verdicts that a host's thread may wait for.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <unordered_set>
#include <utility>
#include <vector>

#include "sender.hpp"

namespace revisit::host {

namespace detail {

// The first overload that compiles is taken: `Choice<1>` before `Choice<0>`.
template <int N>
struct Choice : Choice<N - 1> {};
template <>
struct Choice<0> {};

template <class Rigid>
auto pose_from(const Rigid& rigid, Choice<2>) -> decltype(rigid.unit_quaternion(), Pose()) {
    const auto& t = rigid.translation();
    const auto& q = rigid.unit_quaternion();
    return {{static_cast<double>(t(0)), static_cast<double>(t(1)), static_cast<double>(t(2))},
            normalized({static_cast<double>(q.x()), static_cast<double>(q.y()), static_cast<double>(q.z()), static_cast<double>(q.w())})};
}

template <class Entry>
Pose pose_of_entries(Entry&& entry) {
    Pose pose;
    Matrix3 m;
    for (int row = 0; row < 3; ++row) {
        pose.translation[static_cast<std::size_t>(row)] = static_cast<double>(entry(row, 3));
        for (int column = 0; column < 3; ++column) m[static_cast<std::size_t>(3 * row + column)] = static_cast<double>(entry(row, column));
    }
    pose.rotation = quaternion_of(m);
    return pose;
}

template <class Matrix>
auto pose_from(const Matrix& matrix, Choice<1>) -> decltype(matrix.template at<float>(0, 0), Pose()) {
    return pose_of_entries([&](int row, int column) { return matrix.template at<float>(row, column); });
}

template <class Matrix>
auto pose_from(const Matrix& matrix, Choice<0>) -> decltype(matrix(0, 0), Pose()) {
    return pose_of_entries([&](int row, int column) { return matrix(row, column); });
}

template <class Vector>
auto position_from(const Vector& vector, Choice<1>) -> decltype(vector.template at<float>(0), Vector3()) {
    return {vector.template at<float>(0), vector.template at<float>(1), vector.template at<float>(2)};
}

template <class Vector>
auto position_from(const Vector& vector, Choice<0>) -> decltype(vector(0), Vector3()) {
    return {static_cast<double>(vector(0)), static_cast<double>(vector(1)), static_cast<double>(vector(2))};
}

}  // namespace detail

/// A pose of a host: a Sophus SE3, an OpenCV 4x4 of floats, or an Eigen 4x4.
template <class Host>
Pose pose_from(const Host& host) {
    return detail::pose_from(host, detail::Choice<2>());
}

/// A position of a host: an OpenCV column of floats, or an Eigen vector.
template <class Host>
Vector3 position_from(const Host& host) {
    return detail::position_from(host, detail::Choice<1>());
}

/// A `g2o::Sim3`, or what has its members, as ours. Both are x -> scale * (rotation * x) + translation.
template <class G2oSim3>
Similarity similarity_from(const G2oSim3& sim3) {
    const auto& q = sim3.rotation();
    return {sim3.scale(), position_from(sim3.translation()), normalized({q.x(), q.y(), q.z(), q.w()})};
}

/// Ours as a `g2o::Sim3`.
template <class G2oSim3>
G2oSim3 similarity_to(const Similarity& similarity) {
    using Rotation = std::decay_t<decltype(std::declval<const G2oSim3&>().rotation())>;
    using Translation = std::decay_t<decltype(std::declval<const G2oSim3&>().translation())>;
    const auto& q = similarity.rotation;
    const auto& t = similarity.translation;
    return G2oSim3(Rotation(q.w, q.x, q.y, q.z), Translation(t[0], t[1], t[2]), similarity.scale);
}

/// How a session's frame moved when its map became part of another: from a keyframe's pose in the other map, and in its own before.
inline Similarity into_from_session(const Similarity& camera_from_into, const Similarity& camera_from_session) noexcept {
    return inverse(camera_from_into) * camera_from_session;
}

/// Copies a row-major matrix of descriptors, such as `cv::Mat`, for the rows of `kept`.
template <class Matrix>
void copy_descriptors(const Matrix& matrix, const std::vector<std::size_t>& kept, Features& features) {
    const auto bytes = static_cast<std::size_t>(matrix.cols);
    features.descriptor_bytes = matrix.cols;
    features.descriptors.resize(kept.size() * bytes);
    for (std::size_t i = 0; i < kept.size(); ++i) {
        const unsigned char* row = matrix.template ptr<unsigned char>(static_cast<int>(kept[i]));
        std::copy(row, row + bytes, features.descriptors.begin() + static_cast<std::ptrdiff_t>(i * bytes));
    }
}

/// Copies a bag of words that iterates over pairs of word and weight: DBoW2's and FBoW's do.
template <class BowVector>
Bow bow_from(const BowVector& host) {
    Bow bow;
    bow.words.reserve(host.size());
    bow.weights.reserve(host.size());
    for (const auto& entry : host) {
        bow.words.push_back(static_cast<std::uint32_t>(entry.first));
        // FBoW wraps its weight in a class that converts to float.
        bow.weights.push_back(static_cast<double>(static_cast<float>(entry.second)));
    }
    return bow;
}

/// A keypoint of a host in our form; OpenCV's angle is -1 where there is none.
template <class HostKeypoint>
Keypoint keypoint_from(const HostKeypoint& host, double u, double v) {
    Keypoint keypoint;
    keypoint.u = static_cast<float>(u);
    keypoint.v = static_cast<float>(v);
    keypoint.octave = host.octave;
    if (host.angle >= 0) keypoint.angle_deg = host.angle;
    return keypoint;
}

/// Keeps the first position of each point.
inline void drop_repeated(MapPoints& points) {
    std::unordered_set<std::int64_t> seen;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points.ids.size(); ++i) {
        if (!seen.insert(points.ids[i]).second) continue;
        points.ids[kept] = points.ids[i];
        points.positions[kept] = points.positions[i];
        ++kept;
    }
    points.ids.resize(kept);
    points.positions.resize(kept);
}

/// The points of a list with gaps: each once, in order.
inline std::vector<std::int64_t> observed_of(std::vector<std::int64_t> points) {
    points.erase(std::remove_if(points.begin(), points.end(), [](std::int64_t point) { return point < 0; }), points.end());
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return points;
}

/// Tells whether a keyframe's points changed since they were sent, without keeping them.
inline std::uint64_t fingerprint(const std::vector<std::int64_t>& points) noexcept {
    std::uint64_t hash = 14695981039346656037u;
    for (const std::int64_t point : points) hash = (hash ^ static_cast<std::uint64_t>(point)) * 1099511628211u;
    return hash;
}

/// The latest verdicts, for a thread that waits for one of them. The sender's thread brings them.
class Verdicts {
public:
    void bring(const Verdict& verdict) {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            keep(verdict.keyframe, verdict);
        }
        changed_.notify_all();
    }

    /// Notes that there will be none for a keyframe.
    void give_up(const std::string& keyframe) {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            keep(keyframe, std::nullopt);
        }
        changed_.notify_all();
    }

    /// Waits for a keyframe's verdict, for at most `longest`.
    std::optional<Verdict> wait(const std::string& keyframe, std::chrono::milliseconds longest) {
        std::unique_lock<std::mutex> lock(mutex_);
        const auto found = [&] { return std::find_if(latest_.rbegin(), latest_.rend(), [&](const Entry& entry) { return entry.first == keyframe; }); };
        changed_.wait_for(lock, longest, [&] { return found() != latest_.rend(); });
        const auto entry = found();
        return entry == latest_.rend() ? std::nullopt : entry->second;
    }

private:
    using Entry = std::pair<std::string, std::optional<Verdict>>;
    // A host asks about the newest keyframes alone.
    static constexpr std::size_t max_kept = 64;

    void keep(const std::string& keyframe, std::optional<Verdict> verdict) {
        if (latest_.size() == max_kept) latest_.pop_front();
        latest_.emplace_back(keyframe, std::move(verdict));
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Entry> latest_;
};

/// Chains a host's own callbacks behind those that bring verdicts. `verdicts` must outlive the sender.
inline void listen(SenderOptions& options, Verdicts& verdicts) {
    options.on_verdict = [&verdicts, next = options.on_verdict](const Verdict& verdict) {
        verdicts.bring(verdict);
        if (next) next(verdict);
    };
    options.on_outcome = [&verdicts, next = options.on_outcome](const Outcome& outcome) {
        const bool is_about_keyframe = outcome.kind == Outcome::Kind::keyframe || outcome.kind == Outcome::Kind::question;
        if (is_about_keyframe && !outcome.ok()) verdicts.give_up(outcome.id);
        if (next) next(outcome);
    };
    options.on_dropped = [&verdicts, next = options.on_dropped](const Outcome& outcome) {
        if (outcome.kind == Outcome::Kind::keyframe || outcome.kind == Outcome::Kind::question) verdicts.give_up(outcome.id);
        if (next) next(outcome);
    };
}

}  // namespace revisit::host
