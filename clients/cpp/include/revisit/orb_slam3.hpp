// ORB-SLAM3: what it knows of a keyframe goes to Revisit, and Revisit's candidates go to its own verification.
//
// The one call to change is in `LoopClosing::NewDetectCommonRegions`: `mpKeyFrameDB->DetectNBestCandidates(...)` is made only if
// `candidates(...)` with the same arguments returns false. docs/integrate.md has all hooks, examples/orb_slam3 a file with them.
//
// Templates over the host's own classes: nothing of ORB-SLAM3 is needed to compile this, nor contained in it. Poses may be Sophus
// (version 1.0) or OpenCV matrices (0.3, 0.4).
#pragma once

#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "host.hpp"
#include "point_changes.hpp"

namespace revisit::orb_slam3 {

template <class KeyFrame>
struct Options {
    SenderOptions sender;
    /// The robot's run. Each map of the Atlas is a session `<robot>.m<map>`, and a keyframe is `<session>-<mnId>`.
    std::string robot = "robot";
    /// Longest wait of the loop closing thread for a verdict. Tracking and mapping do not wait for that thread.
    std::chrono::milliseconds longest_wait{200};
    /// Size of the image; 0 takes the undistorted image's right and lower bound.
    int image_width = 0, image_height = 0;
    /// Features of a fisheye camera beyond this angle from the axis are left out of the pinhole, where a pixel's error grows with
    /// 1/cos^2: at 70 degrees to the 8.5-fold.
    double max_ray_angle_rad = 1.2217;
    /// Neighbours of a new keyframe whose observations are sent again if they changed.
    int neighbours = 10;
    /// The signs that a keyframe sees: door numbers, plates. Without them Revisit cannot tell rooms that look alike apart.
    std::function<std::vector<Detection>(KeyFrame&)> detections;
    Question question{Question::Verify::anchors, 0, false};
};

/// Figures of an adapter.
struct Stats {
    std::uint64_t keyframes = 0;
    /// Calls of `candidates` that a verdict answered, and those left to the host.
    std::uint64_t answered = 0, left_to_host = 0;
    std::uint64_t offered = 0;
    /// Candidates that the host would have been offered, but their signs differ.
    std::uint64_t rejected = 0;
};

/// Connects one System. Every method may be called from any of the host's threads, and none throws.
template <class KeyFrame, class MapPoint>
class Adapter {
public:
    static Result<std::unique_ptr<Adapter>> open(Options<KeyFrame> options) noexcept {
        return revisit::detail::guarded([&]() -> Result<std::unique_ptr<Adapter>> {
            std::unique_ptr<Adapter> adapter(new Adapter(std::move(options)));
            auto sender_options = adapter->options_.sender;
            host::listen(sender_options, adapter->verdicts_);
            auto sender = Sender::open(std::move(sender_options));
            if (!sender) return sender.error();
            adapter->sender_ = std::move(*sender);
            return adapter;
        });
    }

    /// Sends a new keyframe, and what became of its neighbours. From `LoopClosing::InsertKeyFrame`, in the thread of local mapping.
    Status insert(KeyFrame* keyframe) noexcept {
        return revisit::detail::guarded([&]() -> Status {
            const std::string session = session_of(keyframe->GetMap()->GetId());
            const std::string id = session + "-" + std::to_string(keyframe->mnId);
            auto sent = keyframe_of(*keyframe, id, session);
            {
                const std::lock_guard<std::mutex> lock(mutex_);
                known_[keyframe->mnId] = {keyframe, id, host::fingerprint(sent.second)};
                by_id_[id] = keyframe;
                ++stats_.keyframes;
            }
            const Status status = sender_->send(std::move(sent.first), options_.question);
            if (!status) return status;
            return update(keyframe->GetBestCovisibilityKeyFrames(options_.neighbours), session);
        });
    }

    /// Offers candidates to `NewDetectCommonRegions`: those with a verdict `loop` first, then undecided ones; rejected ones are not offered.
    /// False if no verdict came in time: then `mpKeyFrameDB->DetectNBestCandidates` decides, as before.
    bool candidates(KeyFrame* current, std::vector<KeyFrame*>& loops, std::vector<KeyFrame*>& merges, int count) noexcept {
        std::optional<Verdict> verdict;
        const Status offered = revisit::detail::guarded([&]() -> Status {
            // Without a server there is nothing to wait for.
            if (!sender_->stats().unreachable) verdict = verdicts_.wait(id_of(current), options_.longest_wait);
            if (verdict) offer(*verdict, current, loops, merges, count);
            return Status();
        });
        const bool is_answered = offered && verdict;
        const std::lock_guard<std::mutex> lock(mutex_);
        ++(is_answered ? stats_.answered : stats_.left_to_host);
        return is_answered;
    }

    /// States that the host has closed a loop, or merged two maps by it. After `CorrectLoop`, `MergeLocal` or `MergeLocal2`.
    Status closed(KeyFrame* current, KeyFrame* matched) noexcept {
        return revisit::detail::guarded([&]() -> Status {
            return sender_->confirm({loop_id(current, matched), id_of(current), id_of(matched), ""});
        });
    }

    /// Takes back a loop that turned out wrong.
    Status reopened(KeyFrame* current, KeyFrame* matched) noexcept {
        return revisit::detail::guarded([&]() -> Status { return sender_->revoke(loop_id(current, matched)); });
    }

    /// Sends poses and positions after an optimisation: after `CorrectLoop`, and at the end of `RunGlobalBundleAdjustment`.
    template <class KeyFrames, class MapPointList>
    Status corrected(const KeyFrames& keyframes, const MapPointList& points) noexcept {
        return revisit::detail::guarded([&]() -> Status {
            std::unordered_map<std::string, PoseCorrections> sessions;
            for (KeyFrame* keyframe : keyframes) {
                if (keyframe == nullptr || keyframe->isBad()) continue;
                const std::string id = id_of(keyframe);
                if (id.empty()) continue;
                auto& corrections = sessions[session_of(keyframe->GetMap()->GetId())];
                corrections.keyframes.push_back(id);
                corrections.poses.push_back(host::pose_from(keyframe->GetPoseInverse()));
            }
            for (MapPoint* point : points) {
                if (point == nullptr || point->isBad()) continue;
                auto& moved = sessions[session_of(point->GetMap()->GetId())].map_points;
                moved.ids.push_back(static_cast<std::int64_t>(point->mnId));
                moved.positions.push_back(host::position_from(point->GetWorldPos()));
            }
            Status status;
            for (auto& [session, corrections] : sessions) {
                corrections.session = session;
                if (auto one = send_in_parts(corrections); !one) status = one;
            }
            return status;
        });
    }

    /// Notes that a point was fused into another. From `MapPoint::Replace`. Sent with the next keyframe.
    void fused(MapPoint* old, MapPoint* by) noexcept {
        (void)revisit::detail::guarded([&]() -> Status {
            const std::string session = session_of(old->GetMap()->GetId());
            const std::lock_guard<std::mutex> lock(mutex_);
            waiting_[session].fused(static_cast<std::int64_t>(old->mnId), static_cast<std::int64_t>(by->mnId));
            return Status();
        });
    }

    /// Notes that a point was culled. From `MapPoint::SetBadFlag`. Sent with the next keyframe.
    void culled(MapPoint* point) noexcept {
        (void)revisit::detail::guarded([&]() -> Status {
            const std::string session = session_of(point->GetMap()->GetId());
            const std::lock_guard<std::mutex> lock(mutex_);
            waiting_[session].culled(static_cast<std::int64_t>(point->mnId));
            return Status();
        });
    }

    /// Removes a keyframe that was culled. From `KeyFrame::SetBadFlag`, where it erases itself from the map.
    Status culled(KeyFrame* keyframe) noexcept {
        return revisit::detail::guarded([&]() -> Status {
            const std::string id = id_of(keyframe);
            if (id.empty()) return Status();
            {
                const std::lock_guard<std::mutex> lock(mutex_);
                known_.erase(keyframe->mnId);
                by_id_.erase(id);
            }
            return sender_->remove(id);
        });
    }

    /// Sends that a map of the Atlas became part of another. `from` is the one whose keyframes changed their map: the current map
    /// in `MergeLocal`, the matched one in `MergeLocal2`.
    Status merged(unsigned long from_map, unsigned long into_map, const Similarity& into_from_session) noexcept {
        return revisit::detail::guarded([&]() -> Status {
            // Points are numbered across the whole Atlas: none changes its number.
            return sender_->merge({session_of(from_map), session_of(into_map), into_from_session, 0, {}});
        });
    }

    /// Forgets the host's keyframes, before it deletes them. From `LoopClosing::ResetIfRequested`.
    void forget() noexcept {
        const std::lock_guard<std::mutex> lock(mutex_);
        known_.clear();
        by_id_.clear();
        waiting_.clear();
    }

    Stats stats() const noexcept {
        const std::lock_guard<std::mutex> lock(mutex_);
        return stats_;
    }

    Sender& sender() noexcept { return *sender_; }

    /// The id under which a keyframe was sent; empty if it was not.
    std::string id_of(KeyFrame* keyframe) const {
        const std::lock_guard<std::mutex> lock(mutex_);
        const auto found = known_.find(keyframe->mnId);
        return found == known_.end() ? std::string() : found->second.id;
    }

    /// `g2oScw` of a query, as `CorrectLoop` and `MergeLocal` want it, for a host that takes Revisit's own verified transform.
    template <class G2oSim3>
    static G2oSim3 g2o_scw(KeyFrame* candidate, const Similarity& candidate_from_query) {
        return host::similarity_to<G2oSim3>(query_from_map(host::pose_from(candidate->GetPoseInverse()), candidate_from_query));
    }

    /// What a keyframe's body is made of, and all points that it observes. Public for tests.
    std::pair<Keyframe, std::vector<std::int64_t>> keyframe_of(KeyFrame& host, const std::string& id, const std::string& session) const {
        Keyframe keyframe;
        keyframe.id = id;
        keyframe.session = session;
        keyframe.stamp = Stamp::of_seconds(host.mTimeStamp);
        keyframe.map_from_camera = host::pose_from(host.GetPoseInverse());
        keyframe.camera = Camera{host.fx, host.fy, host.cx, host.cy, options_.image_width > 0 ? options_.image_width : std::max(1, static_cast<int>(host.mnMaxX)),
                                 options_.image_height > 0 ? options_.image_height : std::max(1, static_cast<int>(host.mnMaxY))};
        keyframe.bow = host::bow_from(host.mBowVec);
        // Once its IMU is initialised, the map's z axis points up.
        if (host.GetMap()->isImuInitialized()) keyframe.gravity = rotate(inverse(keyframe.map_from_camera.rotation), {0, 0, -1});
        auto matches = host.GetMapPointMatches();
        const auto kept = fill_keypoints(host, keyframe.features);
        host::copy_descriptors(host.mDescriptors, kept, keyframe.features);
        std::vector<std::int64_t> points(matches.size(), -1);
        std::vector<std::pair<unsigned long, MapPoint*>> made_by;
        for (std::size_t i = 0; i < matches.size(); ++i) {
            MapPoint* point = matches[i];
            if (point == nullptr || point->isBad()) continue;
            points[i] = static_cast<std::int64_t>(point->mnId);
            made_by.emplace_back(static_cast<unsigned long>(point->mnFirstKFid), point);
        }
        {
            // The positions of others were sent with the keyframe that made them.
            const std::lock_guard<std::mutex> lock(mutex_);
            const auto is_sent = [&](const auto& one) { return one.first != host.mnId && known_.count(one.first) != 0; };
            made_by.erase(std::remove_if(made_by.begin(), made_by.end(), is_sent), made_by.end());
        }
        for (const auto& one : made_by) {
            keyframe.map_points.ids.push_back(static_cast<std::int64_t>(one.second->mnId));
            keyframe.map_points.positions.push_back(host::position_from(one.second->GetWorldPos()));
        }
        // Both cameras of a rig may see a point; a list has it once.
        host::drop_repeated(keyframe.map_points);
        std::vector<bool> is_kept(points.size(), false);
        for (const std::size_t i : kept) {
            const std::int64_t point = i < points.size() ? points[i] : -1;
            keyframe.features.map_points.push_back(point);
            if (i < points.size()) is_kept[i] = true;
        }
        // Seen by the right camera of a rig, or too far from a fisheye's axis: covisible all the same.
        for (std::size_t i = 0; i < points.size(); ++i)
            if (points[i] >= 0 && !is_kept[i]) keyframe.observes.push_back(points[i]);
        if (options_.detections) keyframe.detections = options_.detections(host);
        auto observed = host::observed_of(points);
        return {std::move(keyframe), std::move(observed)};
    }

private:
    struct Known {
        KeyFrame* keyframe = nullptr;
        std::string id;
        std::uint64_t points = 0;
    };

    // `GeometricCamera::GetType()` of a Kannala-Brandt camera.
    static constexpr unsigned fisheye = 1;

    explicit Adapter(Options<KeyFrame> options) : options_(std::move(options)) {}

    std::string session_of(unsigned long map) const { return options_.robot + ".m" + std::to_string(map); }
    std::string loop_id(KeyFrame* current, KeyFrame* matched) const {
        return options_.robot + "-loop-" + std::to_string(current->mnId) + "-" + std::to_string(matched->mnId);
    }

    /// Fills the keypoints of the left camera as an undistorted pinhole's; returns which features they are.
    std::vector<std::size_t> fill_keypoints(KeyFrame& host, Features& features) const {
        std::vector<std::size_t> kept;
        if (host.mpCamera == nullptr || host.mpCamera->GetType() != fisheye) {
            for (std::size_t i = 0; i < host.mvKeysUn.size(); ++i) {
                features.keypoints.push_back(host::keypoint_from(host.mvKeysUn[i], host.mvKeysUn[i].pt.x, host.mvKeysUn[i].pt.y));
                kept.push_back(i);
            }
            return kept;
        }
        // `mvKeysUn` of a fisheye is not undistorted. Descriptors of a rig are those of the left camera, then those of the right one.
        for (std::size_t i = 0; i < host.mvKeys.size(); ++i) {
            const auto ray = host.mpCamera->unproject(host.mvKeys[i].pt);
            const double angle = std::atan2(std::hypot(static_cast<double>(ray.x), static_cast<double>(ray.y)), static_cast<double>(ray.z));
            // False for what is not a number too.
            if (!(angle <= options_.max_ray_angle_rad)) continue;
            features.keypoints.push_back(host::keypoint_from(host.mvKeys[i], host.fx * static_cast<double>(ray.x) / ray.z + host.cx, host.fy * static_cast<double>(ray.y) / ray.z + host.cy));
            kept.push_back(i);
        }
        return kept;
    }

    /// Sends what fusing and culling did to keyframes that were sent before.
    template <class KeyFrames>
    Status update(const KeyFrames& neighbours, const std::string& session) {
        std::vector<KeyframeObservations> changed;
        std::vector<unsigned long> numbers;
        for (KeyFrame* neighbour : neighbours) {
            if (neighbour == nullptr || neighbour->isBad() || session_of(neighbour->GetMap()->GetId()) != session) continue;
            std::vector<std::int64_t> points;
            for (MapPoint* point : neighbour->GetMapPointMatches())
                if (point != nullptr && !point->isBad()) points.push_back(static_cast<std::int64_t>(point->mnId));
            points = host::observed_of(std::move(points));
            const std::uint64_t print = host::fingerprint(points);
            const std::lock_guard<std::mutex> lock(mutex_);
            const auto known = known_.find(neighbour->mnId);
            if (known == known_.end() || known->second.points == print) continue;
            known->second.points = print;
            changed.push_back({known->second.id, std::move(points), std::nullopt});
            numbers.push_back(neighbour->mnId);
        }
        host::PointChanges changes, refused;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            std::swap(changes, waiting_[session]);
        }
        const Status status = host::send_changes(*sender_, session, std::move(changes), std::move(changed), refused);
        if (status) return status;
        // With the next keyframe again.
        const std::lock_guard<std::mutex> lock(mutex_);
        waiting_[session].put_back(std::move(refused));
        for (const unsigned long number : numbers)
            if (const auto known = known_.find(number); known != known_.end()) known->second.points = 0;
        return status;
    }

    /// Sends corrections within the bound of one request.
    Status send_in_parts(PoseCorrections& corrections) {
        Status status;
        const std::size_t count = std::max(corrections.keyframes.size(), corrections.map_points.ids.size());
        for (std::size_t from = 0; from < count; from += limits::corrections) {
            const auto part = [&](auto& all) {
                using All = std::decay_t<decltype(all)>;
                const auto begin = all.begin() + static_cast<std::ptrdiff_t>(std::min(from, all.size()));
                return All(begin, begin + static_cast<std::ptrdiff_t>(std::min(limits::corrections, static_cast<std::size_t>(all.end() - begin))));
            };
            PoseCorrections one{corrections.session, part(corrections.keyframes), part(corrections.poses), {part(corrections.map_points.ids), part(corrections.map_points.positions)}};
            if (auto sent = sender_->correct(std::move(one)); !sent) status = sent;
        }
        return status;
    }

    void offer(const Verdict& verdict, KeyFrame* current, std::vector<KeyFrame*>& loops, std::vector<KeyFrame*>& merges, int count) {
        std::vector<KeyFrame*> found;
        std::uint64_t rejected = 0, offered = 0;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            for (const Decision decision : {Decision::loop, Decision::undecided}) {
                for (const auto& candidate : verdict.candidates) {
                    // One that is not known is another robot's, or was culled.
                    const auto known = by_id_.find(candidate.keyframe);
                    if (candidate.decision == decision && known != by_id_.end() && known->second != current) found.push_back(known->second);
                }
            }
        }
        loops.clear();
        merges.clear();
        // Without the lock: the host's own locks are taken here.
        for (KeyFrame* candidate : found) {
            if (candidate->isBad()) continue;
            const bool is_loop = candidate->GetMap() == current->GetMap();
            if (!is_loop && candidate->GetMap()->IsBad()) continue;
            auto& list = is_loop ? loops : merges;
            if (list.size() >= static_cast<std::size_t>(std::max(count, 0))) continue;
            list.push_back(candidate);
            ++offered;
        }
        for (const auto& candidate : verdict.candidates) rejected += candidate.decision == Decision::rejected ? 1 : 0;
        const std::lock_guard<std::mutex> lock(mutex_);
        stats_.offered += offered;
        stats_.rejected += rejected;
    }

    Options<KeyFrame> options_;
    // Before the sender, whose thread uses it to the end.
    host::Verdicts verdicts_;

    // Never held over a call of the host or of the sender, nor while waiting.
    mutable std::mutex mutex_;
    std::unordered_map<unsigned long, Known> known_;
    std::unordered_map<std::string, KeyFrame*> by_id_;
    std::unordered_map<std::string, host::PointChanges> waiting_;
    Stats stats_;

    std::unique_ptr<Sender> sender_;
};

}  // namespace revisit::orb_slam3
