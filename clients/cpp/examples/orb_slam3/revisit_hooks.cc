// The adapter for ORB-SLAM3, in one file that is compiled as C++17: add it to ORB-SLAM3's own sources.
#include "revisit_hooks.h"

#include <cstdio>
#include <cstdlib>

#include "KeyFrame.h"
#include "Map.h"
#include "MapPoint.h"

#include <revisit/orb_slam3.hpp>

namespace revisit_hooks {

using Adapter = revisit::orb_slam3::Adapter<ORB_SLAM3::KeyFrame, ORB_SLAM3::MapPoint>;

static Adapter* adapter() {
    static const std::unique_ptr<Adapter> one = [] {
        const char* url = std::getenv("REVISIT_URL");
        if (url == nullptr) return std::unique_ptr<Adapter>();
        revisit::orb_slam3::Options<ORB_SLAM3::KeyFrame> options;
        options.sender.endpoint.url = url;
        if (const char* key = std::getenv("REVISIT_KEY")) options.sender.endpoint.key = key;
        if (const char* robot = std::getenv("REVISIT_ROBOT")) options.robot = robot;
        options.sender.map = "orb-slam3";
        options.sender.on_outcome = [](const revisit::Outcome& outcome) {
            if (!outcome.ok()) std::fprintf(stderr, "revisit: %s: %s %s\n", outcome.id.c_str(), outcome.error.field.c_str(), outcome.error.detail.c_str());
        };
        options.sender.on_dropped = [](const revisit::Outcome& outcome) { std::fprintf(stderr, "revisit: %s was dropped\n", outcome.id.c_str()); };
        auto opened = Adapter::open(options);
        if (!opened) {
            std::fprintf(stderr, "revisit: %s %s\n", opened.error().field.c_str(), opened.error().detail.c_str());
            return std::unique_ptr<Adapter>();
        }
        return std::move(*opened);
    }();
    return one.get();
}

// A failed call is reported by the callbacks above; the host goes on without it.
static void go_on(const revisit::Status&) {}

void insert(ORB_SLAM3::KeyFrame* keyframe) {
    if (adapter()) go_on(adapter()->insert(keyframe));
}

bool candidates(ORB_SLAM3::KeyFrame* current, std::vector<ORB_SLAM3::KeyFrame*>& loops, std::vector<ORB_SLAM3::KeyFrame*>& merges, int count) {
    return adapter() && adapter()->candidates(current, loops, merges, count);
}

void closed(ORB_SLAM3::KeyFrame* current, ORB_SLAM3::KeyFrame* matched) {
    if (adapter()) go_on(adapter()->closed(current, matched));
}

void corrected(ORB_SLAM3::Map* map) {
    if (adapter()) go_on(adapter()->corrected(map->GetAllKeyFrames(), map->GetAllMapPoints()));
}

void fused(ORB_SLAM3::MapPoint* old, ORB_SLAM3::MapPoint* by) {
    if (adapter()) adapter()->fused(old, by);
}

void culled(ORB_SLAM3::MapPoint* point) {
    if (adapter()) adapter()->culled(point);
}

void culled(ORB_SLAM3::KeyFrame* keyframe) {
    if (adapter()) go_on(adapter()->culled(keyframe));
}

}  // namespace revisit_hooks
