// stella_vslam: what it knows of a keyframe goes to Revisit, and verified loops come back by `system::request_loop_closure`.
//
// A request that stella_vslam rejects is never finished there: it is tried again every 5 ms for ever, and blocks every later one.
// `resolve` is the guard, in place of one call in `global_optimization_module::run`. docs/integrate.md has all hooks. C++17, while
// stella_vslam compiles as C++14: include this in a file of your own, with functions that its files call.
//
// Templates over the host's own classes: nothing of stella_vslam is needed to compile this.
#pragma once

#include <chrono>
#include <cmath>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "host.hpp"
#include "point_changes.hpp"

namespace revisit::stella_vslam {

template <class Keyframe>
struct Options {
    SenderOptions sender;
    /// The robot's run: a keyframe is `<session>-<id_>`.
    std::string session = "robot";
    /// The pinhole of the undistorted keypoints. For a fisheye or equirectangular camera, any pinhole that looks along its axis.
    Camera camera;
    /// Whether keypoints are those of `camera` (a perspective model), or are made from the bearings.
    bool is_perspective = true;
    /// Bearings beyond this angle from the axis are left out of the pinhole, where a pixel's error grows with 1/cos^2.
    double max_ray_angle_rad = 1.2217;
    unsigned neighbours = 10;
    /// Keyframes between two loops that are closed, as the host's own detector leaves between them. Sooner, it works at the last one still.
    unsigned loops_apart = 10;
    /// How long `allows` waits for a verdict.
    std::chrono::milliseconds longest_wait{200};
    /// `[&](unsigned a, unsigned b) { return slam->request_loop_closure(a, b); }`
    std::function<bool(unsigned, unsigned)> request_loop_closure;
    /// The signs that a keyframe sees: door numbers, plates.
    std::function<std::vector<Detection>(Keyframe&)> detections;
    Question question;
};

struct Stats {
    std::uint64_t keyframes = 0;
    std::uint64_t requested = 0, closed = 0, rejected = 0;
    /// Verified loops that were not requested, since the host could not have closed them.
    std::uint64_t left_out = 0;
};

/// Connects one system. Every method may be called from any of the host's threads, and none throws.
template <class Keyframe>
class Adapter {
public:
    using Shared = std::shared_ptr<Keyframe>;

    static Result<std::unique_ptr<Adapter>> open(Options<Keyframe> options) noexcept {
        return revisit::detail::guarded([&]() -> Result<std::unique_ptr<Adapter>> {
            std::unique_ptr<Adapter> adapter(new Adapter(std::move(options)));
            auto sender_options = adapter->options_.sender;
            sender_options.on_verdict = [raw = adapter.get(), next = sender_options.on_verdict](const Verdict& verdict) {
                raw->consider(verdict);
                if (next) next(verdict);
            };
            host::listen(sender_options, adapter->verdicts_);
            auto sender = Sender::open(std::move(sender_options));
            if (!sender) return sender.error();
            adapter->sender_ = std::move(*sender);
            return adapter;
        });
    }

    /// Sends a new keyframe, and what became of its neighbours. From `global_optimization_module::queue_keyframe`.
    Status insert(const Shared& keyframe) noexcept {
        return revisit::detail::guarded([&]() -> Status {
            auto sent = keyframe_of(*keyframe);
            {
                const std::lock_guard<std::mutex> lock(mutex_);
                known_[keyframe->id_] = {keyframe, host::fingerprint(sent.second)};
                ++stats_.keyframes;
            }
            const Status status = sender_->send(std::move(sent.first), options_.question);
            request_next();
            if (!status) return status;
            return update(keyframe->graph_node_->get_top_n_covisibilities(options_.neighbours));
        });
    }

    /// The guard, in `global_optimization_module::run`, in place of `loop_closure(get_loop_closure_request())`:
    /// `resolve(get_loop_closure_request(), [&](const auto& request) { return loop_closure(request); }, [&] { finish_loop_closure_request(); })`.
    /// A rejected request is finished, and its pair is not requested again; so is one that the host's own detector closed meanwhile.
    /// What was closed is confirmed: the host may close the loop with another keyframe than was requested.
    template <class Request, class Close, class Finish>
    bool resolve(const Request& request, Close&& close, Finish&& finish) {
        const Request made = request;
        const auto query = std::max(made.keyfrm1_id_, made.keyfrm2_id_), candidate = std::min(made.keyfrm1_id_, made.keyfrm2_id_);
        std::set<unsigned> before;
        (void)revisit::detail::guarded([&]() -> Status {
            before = loops_of(query);
            return Status();
        });
        const bool was_closed = before.count(candidate) != 0;
        const bool is_closed = !was_closed && close(made);
        if (!is_closed) finish();
        (void)revisit::detail::guarded([&]() -> Status {
            auto closed = loops_of(query);
            for (const unsigned known : before) closed.erase(known);
            if (was_closed || (is_closed && closed.empty())) closed.insert(candidate);
            {
                const std::lock_guard<std::mutex> lock(mutex_);
                ++(is_closed || was_closed ? stats_.closed : stats_.rejected);
                is_requested_ = false;
            }
            if (is_closed || was_closed)
                for (const unsigned with : closed) confirm(query, with);
            request_next();
            return Status();
        });
        return is_closed;
    }

    /// Whether the host may close a loop between these two, by its own detector: asked before it verifies a candidate, and with no lock
    /// that tracking or mapping wait for. Without a verdict in time the host decides, as it did.
    bool allows(const Shared& query, const Shared& candidate) noexcept {
        bool is_allowed = true;
        (void)revisit::detail::guarded([&]() -> Status {
            if (sender_->stats().unreachable) return Status();
            const auto verdict = verdicts_.wait(id_of(query->id_), options_.longest_wait);
            if (!verdict) return Status();
            if (const auto* listed = verdict->find(id_of(candidate->id_))) {
                is_allowed = listed->decision != Decision::no_loop;
                return Status();
            }
            // Of a place the best keyframe alone is listed.
            is_allowed = false;
            for (const auto& neighbour : candidate->graph_node_->get_top_n_covisibilities(options_.neighbours)) {
                const auto* listed = neighbour ? verdict->find(id_of(neighbour->id_)) : nullptr;
                is_allowed = is_allowed || (listed != nullptr && listed->decision != Decision::no_loop);
            }
            return Status();
        });
        return is_allowed;
    }

    /// Confirms a loop that the host's own detector closed: at the end of `correct_loop`.
    void closed(unsigned query, unsigned candidate) noexcept {
        (void)revisit::detail::guarded([&]() -> Status {
            confirm(std::max(query, candidate), std::min(query, candidate));
            return Status();
        });
    }

    /// Takes back a loop that turned out wrong.
    Status reopened(unsigned query, unsigned candidate) noexcept {
        return revisit::detail::guarded([&]() -> Status { return sender_->revoke(loop_id(std::max(query, candidate), std::min(query, candidate))); });
    }

    /// Sends poses and positions after an optimisation: at the end of `loop_bundle_adjuster::optimize`.
    template <class Keyframes, class Landmarks>
    Status corrected(const Keyframes& keyframes, const Landmarks& landmarks) noexcept {
        return revisit::detail::guarded([&]() -> Status {
            PoseCorrections corrections;
            corrections.session = options_.session;
            Status status;
            const auto send = [&] {
                if (corrections.keyframes.empty() && corrections.map_points.ids.empty()) return;
                PoseCorrections next;
                next.session = options_.session;
                std::swap(next, corrections);
                if (auto one = sender_->correct(std::move(next)); !one) status = one;
            };
            for (const auto& keyframe : keyframes) {
                if (!keyframe || keyframe->will_be_erased() || !is_known(keyframe->id_)) continue;
                corrections.keyframes.push_back(id_of(keyframe->id_));
                corrections.poses.push_back(host::pose_from(keyframe->get_pose_wc()));
                if (corrections.keyframes.size() == limits::corrections) send();
            }
            for (const auto& landmark : landmarks) {
                if (!landmark || landmark->will_be_erased()) continue;
                corrections.map_points.ids.push_back(landmark->id_);
                corrections.map_points.positions.push_back(host::position_from(landmark->get_pos_in_world()));
                if (corrections.map_points.ids.size() == limits::corrections) send();
            }
            send();
            return status;
        });
    }

    /// Notes that a landmark was fused into another. From `landmark::replace`. Sent with the next keyframe.
    void fused(unsigned old, unsigned by) noexcept {
        (void)revisit::detail::guarded([&]() -> Status {
            const std::lock_guard<std::mutex> lock(mutex_);
            waiting_.fused(old, by);
            return Status();
        });
    }

    /// Notes that a landmark was removed. From `landmark::prepare_for_erasing`. Sent with the next keyframe.
    void culled_landmark(unsigned landmark) noexcept {
        (void)revisit::detail::guarded([&]() -> Status {
            const std::lock_guard<std::mutex> lock(mutex_);
            waiting_.culled(landmark);
            return Status();
        });
    }

    /// Removes a keyframe that was removed from the map. From `keyframe::prepare_for_erasing`.
    Status culled_keyframe(unsigned keyframe) noexcept {
        return revisit::detail::guarded([&]() -> Status {
            {
                const std::lock_guard<std::mutex> lock(mutex_);
                if (known_.erase(keyframe) == 0) return Status();
            }
            return sender_->remove(id_of(keyframe));
        });
    }

    Stats stats() const noexcept {
        const std::lock_guard<std::mutex> lock(mutex_);
        return stats_;
    }

    Sender& sender() noexcept { return *sender_; }

    std::string id_of(unsigned keyframe) const { return options_.session + "-" + std::to_string(keyframe); }

    /// What a keyframe's body is made of, and all landmarks that it observes. Public for tests.
    std::pair<revisit::Keyframe, std::vector<std::int64_t>> keyframe_of(Keyframe& host) const {
        revisit::Keyframe keyframe;
        keyframe.id = id_of(host.id_);
        keyframe.session = options_.session;
        keyframe.stamp = Stamp::of_seconds(host.timestamp_);
        keyframe.map_from_camera = host::pose_from(host.get_pose_wc());
        keyframe.camera = options_.camera;
        keyframe.bow = host::bow_from(host.bow_vec_);
        const auto kept = fill_keypoints(host, keyframe.features);
        host::copy_descriptors(host.frm_obs_.descriptors_, kept, keyframe.features);
        const auto landmarks = host.get_landmarks();
        std::vector<std::int64_t> points(landmarks.size(), -1);
        std::vector<std::size_t> made;
        for (std::size_t i = 0; i < landmarks.size(); ++i)
            if (landmarks[i] && !landmarks[i]->will_be_erased()) points[i] = landmarks[i]->id_;
        {
            // The positions of others were sent with the keyframe that made them.
            const std::lock_guard<std::mutex> lock(mutex_);
            for (std::size_t i = 0; i < points.size(); ++i)
                if (points[i] >= 0 && (landmarks[i]->first_keyfrm_id_ == host.id_ || known_.count(landmarks[i]->first_keyfrm_id_) == 0)) made.push_back(i);
        }
        for (const std::size_t i : made) {
            keyframe.map_points.ids.push_back(points[i]);
            keyframe.map_points.positions.push_back(host::position_from(landmarks[i]->get_pos_in_world()));
        }
        host::drop_repeated(keyframe.map_points);
        std::vector<bool> is_kept(points.size(), false);
        for (const std::size_t i : kept) {
            keyframe.features.map_points.push_back(i < points.size() ? points[i] : -1);
            if (i < points.size()) is_kept[i] = true;
        }
        for (std::size_t i = 0; i < points.size(); ++i)
            if (points[i] >= 0 && !is_kept[i]) keyframe.observes.push_back(points[i]);
        if (options_.detections) keyframe.detections = options_.detections(host);
        auto observed = host::observed_of(std::move(points));
        return {std::move(keyframe), std::move(observed)};
    }

private:
    struct Known {
        std::weak_ptr<Keyframe> keyframe;
        std::uint64_t points = 0;
    };

    using Pair = std::pair<unsigned, unsigned>;

    // The host closes one loop at a time, and a new one makes older ones stale.
    static constexpr std::size_t max_waiting_loops = 16;
    // Pairs that were requested once; a host that has this many has other faults.
    static constexpr std::size_t max_tried = 10'000;

    explicit Adapter(Options<Keyframe> options) : options_(std::move(options)) {}

    std::string loop_id(unsigned query, unsigned candidate) const {
        return options_.session + "-loop-" + std::to_string(query) + "-" + std::to_string(candidate);
    }

    /// The keyframes that a keyframe has a loop edge with.
    std::set<unsigned> loops_of(unsigned keyframe) const {
        Shared host;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            if (const auto known = known_.find(keyframe); known != known_.end()) host = known->second.keyframe.lock();
        }
        std::set<unsigned> loops;
        if (host)
            for (const auto& other : host->graph_node_->get_loop_edges()) loops.insert(other->id_);
        return loops;
    }

    void confirm(unsigned query, unsigned candidate) {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            if (tried_.size() < max_tried) tried_.insert({query, candidate});
            last_closed_ = std::max(query, last_closed_.value_or(0));
        }
        (void)sender_->confirm({loop_id(query, candidate), id_of(query), id_of(candidate), ""});
    }

    bool is_known(unsigned keyframe) const {
        const std::lock_guard<std::mutex> lock(mutex_);
        return known_.count(keyframe) != 0;
    }

    /// The host's number of an id that this adapter made.
    bool number_of(const std::string& id, unsigned& number) const {
        const std::string prefix = options_.session + "-";
        if (id.compare(0, prefix.size(), prefix) != 0) return false;
        const auto read = std::from_chars(id.data() + prefix.size(), id.data() + id.size(), number);
        return read.ec == std::errc() && read.ptr == id.data() + id.size();
    }

    std::vector<std::size_t> fill_keypoints(Keyframe& host, Features& features) const {
        const auto& observation = host.frm_obs_;
        const auto& camera = options_.camera;
        std::vector<std::size_t> kept;
        for (std::size_t i = 0; i < observation.undist_keypts_.size(); ++i) {
            const auto& keypoint = observation.undist_keypts_[i];
            if (options_.is_perspective) {
                features.keypoints.push_back(host::keypoint_from(keypoint, keypoint.pt.x, keypoint.pt.y));
            } else {
                const Vector3 ray = host::position_from(observation.bearings_[i]);
                if (!(std::atan2(std::hypot(ray[0], ray[1]), ray[2]) <= options_.max_ray_angle_rad)) continue;
                features.keypoints.push_back(host::keypoint_from(keypoint, camera.fx * ray[0] / ray[2] + camera.cx, camera.fy * ray[1] / ray[2] + camera.cy));
            }
            kept.push_back(i);
        }
        return kept;
    }

    template <class Keyframes>
    Status update(const Keyframes& neighbours) {
        std::vector<KeyframeObservations> changed;
        std::vector<unsigned> numbers;
        for (const auto& neighbour : neighbours) {
            if (!neighbour || neighbour->will_be_erased()) continue;
            std::vector<std::int64_t> points;
            for (const auto& landmark : neighbour->get_landmarks())
                if (landmark && !landmark->will_be_erased()) points.push_back(landmark->id_);
            points = host::observed_of(std::move(points));
            const std::uint64_t print = host::fingerprint(points);
            const std::lock_guard<std::mutex> lock(mutex_);
            const auto known = known_.find(neighbour->id_);
            if (known == known_.end() || known->second.points == print) continue;
            known->second.points = print;
            changed.push_back({id_of(neighbour->id_), std::move(points), std::nullopt});
            numbers.push_back(neighbour->id_);
        }
        host::PointChanges changes, refused;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            std::swap(changes, waiting_);
        }
        const Status status = host::send_changes(*sender_, options_.session, std::move(changes), std::move(changed), refused);
        if (status) return status;
        // With the next keyframe again.
        const std::lock_guard<std::mutex> lock(mutex_);
        waiting_.put_back(std::move(refused));
        for (const unsigned number : numbers)
            if (const auto known = known_.find(number); known != known_.end()) known->second.points = 0;
        return status;
    }

    /// Takes a verified loop from a verdict. In the sender's thread.
    void consider(const Verdict& verdict) {
        unsigned query = 0, candidate = 0;
        const Candidate* best = verdict.find(verdict.best);
        if (verdict.decision != Decision::loop || best == nullptr || !number_of(verdict.keyframe, query) || !number_of(best->keyframe, candidate)) return;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            if (best->geometry != "verified") {
                ++stats_.left_out;
                return;
            }
            if (loops_.size() == max_waiting_loops) loops_.pop_front();
            loops_.emplace_back(query, candidate);
        }
        request_next();
    }

    /// Requests the next loop that the host can close, unless one is being closed.
    void request_next() {
        if (!options_.request_loop_closure) return;
        while (true) {
            Pair pair;
            Shared query, candidate;
            {
                const std::lock_guard<std::mutex> lock(mutex_);
                if (is_requested_ || loops_.empty()) return;
                pair = loops_.back();
                loops_.pop_back();
                const bool is_too_soon = last_closed_ && pair.first < *last_closed_ + options_.loops_apart;
                if (is_too_soon || tried_.count(pair) != 0 || tried_.size() == max_tried) {
                    ++stats_.left_out;
                    continue;
                }
                const auto find = [&](unsigned id) {
                    const auto known = known_.find(id);
                    return known == known_.end() ? Shared() : known->second.keyframe.lock();
                };
                query = find(pair.first);
                candidate = find(pair.second);
                // Before the request: the host may have resolved it before the call returns.
                is_requested_ = true;
            }
            // What the host would reject, or close in part: it cannot join two spanning trees.
            const bool can_close = query && candidate && !query->will_be_erased() && !candidate->will_be_erased() &&
                                   query->graph_node_->get_spanning_root() == candidate->graph_node_->get_spanning_root() &&
                                   query->graph_node_->get_loop_edges().count(candidate) == 0;
            const bool is_taken = can_close && options_.request_loop_closure(pair.first, pair.second);
            const std::lock_guard<std::mutex> lock(mutex_);
            if (is_taken) {
                tried_.insert(pair);
                ++stats_.requested;
                return;
            }
            is_requested_ = false;
            if (can_close) {
                // Another request, not ours, is being closed: the next keyframe tries again.
                loops_.push_back(pair);
                return;
            }
            ++stats_.left_out;
        }
    }

    Options<Keyframe> options_;

    // Never held over a call of the host or of the sender.
    mutable std::mutex mutex_;
    std::unordered_map<unsigned, Known> known_;
    host::PointChanges waiting_;
    std::deque<Pair> loops_;
    std::set<Pair> tried_;
    std::optional<unsigned> last_closed_;
    host::Verdicts verdicts_;
    bool is_requested_ = false;
    Stats stats_;

    std::unique_ptr<Sender> sender_;
};

}  // namespace revisit::stella_vslam
