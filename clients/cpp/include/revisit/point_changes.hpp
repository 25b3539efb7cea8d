// Points that a host fused and culled since they were last sent, and the requests that say so.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "gone_points.hpp"
#include "sender.hpp"

namespace revisit::host {

/// Collects what a host does to its points. What comes out is what the server takes: each point once, without chains.
class PointChanges {
public:
    /// Notes that a point was fused into another. What was gone before stays as it went.
    void fused(std::int64_t old, std::int64_t by) {
        if (gone_.size() < max_gone) gone_.fuse(old, by);
    }

    void culled(std::int64_t point) {
        if (gone_.size() < max_gone) gone_.cull(point);
    }

    /// Puts back what could not be sent; it is older than what was noted since.
    void put_back(PointChanges older) {
        PointChanges newer = std::exchange(*this, std::move(older));
        for (const std::int64_t point : newer.gone_.points()) {
            const std::int64_t end = newer.gone_.end_of(point);
            if (end == Gone::nothing) culled(point);
            else fused(point, end);
        }
    }

    /// Returns the requests for all of it, and for keyframes that observe other points now. Their order does not matter.
    std::vector<Observations> requests(const std::string& session, std::vector<KeyframeObservations> keyframes) {
        Observations all;
        for (const std::int64_t point : gone_.points()) {
            const std::int64_t end = gone_.end_of(point);
            if (end == Gone::nothing) all.removed.push_back(point);
            else all.replaced.emplace_back(point, end);
        }
        std::sort(all.replaced.begin(), all.replaced.end());
        std::sort(all.removed.begin(), all.removed.end());
        for (auto& keyframe : keyframes)
            if (keyframe.observes) follow(*keyframe.observes);
        std::vector<Observations> requests;
        for (std::size_t i = 0; i * limits::gone_points < std::max(all.replaced.size(), all.removed.size()) || i * limits::changed_keyframes < keyframes.size(); ++i)
            requests.push_back({session, part(all.replaced, i, limits::gone_points), part(all.removed, i, limits::gone_points), part(keyframes, i, limits::changed_keyframes)});
        return requests;
    }

private:
    using Gone = revisit::detail::GonePoints;
    // Of 60 bytes each. More wait only where the sender's queue is full, and then keyframes are lost as well.
    static constexpr std::size_t max_gone = 1'000'000;

    /// A point may be fused while a keyframe's points are read.
    void follow(std::vector<std::int64_t>& points) {
        if (gone_.empty()) return;
        for (auto& point : points) point = gone_.end_of(point);
        points.erase(std::remove(points.begin(), points.end(), Gone::nothing), points.end());
        std::sort(points.begin(), points.end());
        points.erase(std::unique(points.begin(), points.end()), points.end());
    }

    template <class T>
    static std::vector<T> part(std::vector<T>& all, std::size_t number, std::size_t size) {
        const std::size_t begin = std::min(number * size, all.size()), end = std::min(begin + size, all.size());
        const auto at = [&](std::size_t i) { return std::make_move_iterator(all.begin() + static_cast<std::ptrdiff_t>(i)); };
        return std::vector<T>(at(begin), at(end));
    }

    Gone gone_;
};

/// Sends changes of a session's points, and keyframes that observe other points now. What a full queue refuses is put in `refused`.
inline Status send_changes(Sender& sender, const std::string& session, PointChanges changes, std::vector<KeyframeObservations> keyframes, PointChanges& refused) {
    for (auto& request : changes.requests(session, std::move(keyframes))) {
        if (Status status = sender.update(std::move(request)); !status) {
            // What was sent of it changes nothing when it is sent again.
            refused = std::move(changes);
            return status;
        }
    }
    return Status();
}

}  // namespace revisit::host
