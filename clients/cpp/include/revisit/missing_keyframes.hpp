// Keyframes that the server does not have, and what must not name them: the server would refuse all of it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "keyframe.hpp"
#include "updates.hpp"

namespace revisit {
namespace detail {

/// A set of ids, for several threads.
class MissingKeyframes {
public:
    void note(const std::string& id) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (ids_.size() < max_ids) ids_.insert(id);
    }

    /// Forgets one that the server has after all.
    void clear(const std::string& id) {
        const std::lock_guard<std::mutex> lock(mutex_);
        ids_.erase(id);
    }

    void leave_out_of(std::vector<Covisible>& covisible) const {
        remove_where(covisible, [&](const Covisible& other) { return has(other.keyframe); });
    }

    void leave_out_of(PoseCorrections& corrections) const {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < corrections.keyframes.size(); ++i) {
            if (has(corrections.keyframes[i])) continue;
            if (kept != i) {
                corrections.keyframes[kept] = std::move(corrections.keyframes[i]);
                corrections.poses[kept] = corrections.poses[i];
            }
            ++kept;
        }
        corrections.keyframes.resize(kept);
        corrections.poses.resize(kept);
    }

    void leave_out_of(Observations& observations) const {
        remove_where(observations.keyframes, [&](const KeyframeObservations& one) { return has(one.keyframe); });
        for (auto& keyframe : observations.keyframes) {
            if (keyframe.covisible) leave_out_of(*keyframe.covisible);
        }
    }

private:
    // More of them say that nothing arrives.
    static constexpr std::size_t max_ids = 100'000;

    bool has(const std::string& id) const {
        const std::lock_guard<std::mutex> lock(mutex_);
        return ids_.count(id) != 0;
    }

    template <class T, class F>
    static void remove_where(std::vector<T>& list, F&& is_out) {
        list.erase(std::remove_if(list.begin(), list.end(), is_out), list.end());
    }

    mutable std::mutex mutex_;
    std::unordered_set<std::string> ids_;
};

}  // namespace detail
}  // namespace revisit
