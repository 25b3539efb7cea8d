// What a host does to its points becomes requests that the server takes, and that leave the host's own map.
#include <map>
#include <random>
#include <set>

#include <revisit/point_changes.hpp>

#include "check.hpp"

using namespace revisit;

using Points = std::vector<std::int64_t>;

static std::mt19937 chance(57);
static std::int64_t any(std::int64_t below) { return std::uniform_int_distribution<std::int64_t>(0, below - 1)(chance); }

/// A host's points that are not bad, each with the numbers that were sent for it.
struct Host {
    std::map<std::int64_t, std::set<std::int64_t>> alive;
    std::set<std::int64_t> culled;

    explicit Host(std::int64_t count) {
        for (std::int64_t point = 0; point < count; ++point) alive[point] = {point};
    }
    std::int64_t one() {
        auto at = alive.begin();
        std::advance(at, any(static_cast<std::int64_t>(alive.size())));
        return at->first;
    }
    void fuse(std::int64_t old, std::int64_t by) {
        alive[by].insert(alive[old].begin(), alive[old].end());
        alive.erase(old);
    }
    void cull(std::int64_t point) {
        culled.insert(alive[point].begin(), alive[point].end());
        alive.erase(point);
    }
};

/// Applies a request as the server does, to a keyframe that observed every point.
static void apply(const Observations& request, std::map<std::int64_t, std::int64_t>& now) {
    std::map<std::int64_t, std::int64_t> becomes;
    for (const auto& [old, by] : request.replaced) becomes[old] = by;
    for (const auto point : request.removed) becomes[point] = -1;
    for (auto& one : now)
        for (auto next = becomes.find(one.second); next != becomes.end(); next = becomes.find(one.second)) one.second = next->second;
}

static void any_fusing_and_culling_is_followed() {
    for (int round = 0; round < 200; ++round) {
        constexpr std::int64_t count = 40;
        Host host(count);
        host::PointChanges changes;
        std::map<std::int64_t, std::int64_t> now;
        for (std::int64_t point = 0; point < count; ++point) now[point] = point;
        while (host.alive.size() > 3) {
            const auto point = host.one(), by = host.one();
            if (point != by && any(2) == 0) {
                host.fuse(point, by);
                changes.fused(point, by);
            } else {
                host.cull(point);
                changes.culled(point);
            }
            // Said again, or otherwise: as it went first, it stays.
            if (any(4) == 0) changes.culled(point);
            if (any(4) == 0) changes.fused(point, any(count));
            if (any(8) == 0) {
                host::PointChanges refused;
                std::swap(refused, changes);
                changes.put_back(std::move(refused));
            }
            if (any(6) != 0) continue;
            for (const auto& request : changes.requests("s", {})) {
                CHECK_OK(check(request));
                apply(request, now);
            }
            changes = {};
        }
        for (const auto& request : changes.requests("s", {})) {
            CHECK_OK(check(request));
            apply(request, now);
        }
        for (const auto& [point, sent] : host.alive)
            for (const auto number : sent) CHECK_EQUAL(now[number], point);
        for (const auto point : host.culled) CHECK_EQUAL(now[point], -1);
    }
}

static void a_request_is_within_its_limits_and_its_lists_name_points_that_stay() {
    host::PointChanges changes;
    constexpr std::int64_t many = 25'000;
    for (std::int64_t point = 0; point < many; ++point) changes.fused(point, point + 1);
    for (std::int64_t point = 100'000; point < 100'000 + 12'000; ++point) changes.culled(point);
    std::vector<KeyframeObservations> keyframes;
    for (int i = 0; i < 1'500; ++i) keyframes.push_back({"k-" + std::to_string(i), Points{0, 7, 100'000, 200'000}, {}});
    const auto requests = changes.requests("s", keyframes);
    CHECK_EQUAL(requests.size(), 3u);
    std::size_t replaced = 0, removed = 0, named = 0;
    for (const auto& request : requests) {
        CHECK_OK(check(request));
        replaced += request.replaced.size();
        removed += request.removed.size();
        named += request.keyframes.size();
        for (const auto& keyframe : request.keyframes) CHECK(*keyframe.observes == (Points{many, 200'000}));
    }
    CHECK_EQUAL(replaced, 25'000u);
    CHECK_EQUAL(removed, 12'000u);
    CHECK_EQUAL(named, 1'500u);
    CHECK(host::PointChanges().requests("s", {}).empty());
}

int main() {
    TEST(any_fusing_and_culling_is_followed);
    TEST(a_request_is_within_its_limits_and_its_lists_name_points_that_stay);
}
