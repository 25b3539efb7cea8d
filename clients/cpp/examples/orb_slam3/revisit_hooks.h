// Hooks for ORB-SLAM3, for its own files to include: plain functions, since these are C++14 and the adapter is C++17.
#pragma once

#include <vector>

namespace ORB_SLAM3 {
class KeyFrame;
class Map;
class MapPoint;
}  // namespace ORB_SLAM3

namespace revisit_hooks {

/// Connects to $REVISIT_URL as robot $REVISIT_ROBOT. Without that variable every hook does nothing.
void insert(ORB_SLAM3::KeyFrame* keyframe);
/// Whether Revisit decided; if not, call DetectNBestCandidates.
bool candidates(ORB_SLAM3::KeyFrame* current, std::vector<ORB_SLAM3::KeyFrame*>& loops, std::vector<ORB_SLAM3::KeyFrame*>& merges, int count);
void closed(ORB_SLAM3::KeyFrame* current, ORB_SLAM3::KeyFrame* matched);
void corrected(ORB_SLAM3::Map* map);
void fused(ORB_SLAM3::MapPoint* old, ORB_SLAM3::MapPoint* by);
void culled(ORB_SLAM3::MapPoint* point);
void culled(ORB_SLAM3::KeyFrame* keyframe);

}  // namespace revisit_hooks
