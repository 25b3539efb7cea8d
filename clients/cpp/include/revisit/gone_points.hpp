// Points of a host's map that are gone: fused into another, or culled.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace revisit::detail {

class GonePoints {
public:
    /// What a culled point becomes; no point has this number.
    static constexpr std::int64_t nothing = -1;

    bool empty() const { return becomes_.empty(); }
    std::size_t size() const { return becomes_.size(); }
    bool has(std::int64_t point) const { return becomes_.count(point) != 0; }

    /// Notes that a point was fused into another; false if it was gone already, or is the one that stays.
    bool fuse(std::int64_t old, std::int64_t by) { return end_of(by) != old && becomes_.emplace(old, by).second; }

    /// Notes that a point was culled; false if it was gone already.
    bool cull(std::int64_t point) { return becomes_.emplace(point, nothing).second; }

    /// Returns the point that stays in the end, or `nothing`.
    std::int64_t end_of(std::int64_t point) {
        std::int64_t end = point;
        for (auto next = becomes_.find(end); next != becomes_.end(); next = becomes_.find(end)) end = next->second;
        // Shortened, so that no chain is followed again and again.
        for (auto next = becomes_.find(point); next != becomes_.end() && next->second != end; next = becomes_.find(point)) {
            point = next->second;
            next->second = end;
        }
        return end;
    }

    std::vector<std::int64_t> points() const {
        std::vector<std::int64_t> points;
        points.reserve(becomes_.size());
        for (const auto& one : becomes_) points.push_back(one.first);
        return points;
    }

private:
    std::unordered_map<std::int64_t, std::int64_t> becomes_;
};

}  // namespace revisit::detail
