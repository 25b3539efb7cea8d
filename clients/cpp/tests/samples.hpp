// Keyframes for tests and benchmarks, the same for the same seed.
#pragma once

#include <random>
#include <set>
#include <string>

#include <revisit/revisit.hpp>

namespace samples {

/// A keyframe as an ORB-SLAM makes it: `features` ORB descriptors, 7 of 10 with a map point, 500 words, positions of the new points.
inline revisit::Keyframe keyframe(unsigned seed, std::size_t features = 1000, std::size_t words = 500, std::size_t new_points = 300) {
    std::mt19937 random(seed);
    const auto uniform = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
    revisit::Keyframe keyframe;
    keyframe.id = "robot-7-" + std::to_string(seed);
    keyframe.session = "robot-7";
    keyframe.stamp = revisit::Stamp::of_seconds(1000 + seed / 30.0);
    keyframe.map_from_camera.translation = {seed * 0.1, 0.123456789, -0.5};
    keyframe.camera = revisit::Camera{525, 525, 320, 240, 640, 480};
    std::set<std::uint32_t> ids;
    while (ids.size() < words) ids.insert(static_cast<std::uint32_t>(random() % 1'000'000));
    for (const auto id : ids) {
        keyframe.bow.words.push_back(id);
        keyframe.bow.weights.push_back(uniform(0.0005, 0.004));
    }
    for (std::size_t i = 0; i < features; ++i) {
        for (int k = 0; k < 32; ++k) keyframe.features.descriptors.push_back(static_cast<std::uint8_t>(random()));
        keyframe.features.keypoints.push_back({static_cast<float>(uniform(0, 640)), static_cast<float>(uniform(0, 480)), static_cast<int>(random() % 8), static_cast<float>(uniform(0, 360))});
        keyframe.features.map_points.push_back(i % 10 < 7 ? static_cast<std::int64_t>(seed * 300 + i) : -1);
    }
    for (std::size_t i = 0; i < new_points; ++i) {
        keyframe.map_points.ids.push_back(static_cast<std::int64_t>(seed * 300 + i / 7 * 10 + i % 7));
        keyframe.map_points.positions.push_back({uniform(-10, 10), uniform(-3, 3), uniform(1, 20)});
    }
    return keyframe;
}

/// A keyframe of a door plate, as in the README: `x` metres along the corridor.
inline revisit::Keyframe plate(const std::string& id, double x, std::int64_t sec, const std::string& text) {
    revisit::Keyframe keyframe;
    keyframe.id = id;
    keyframe.session = "robot-7";
    keyframe.stamp = {sec, 0};
    keyframe.map_from_camera.translation = {x, 0, 0};
    keyframe.bow = {{3, 17, 42}, {1, 1, 1}, ""};
    revisit::Detection door;
    door.class_name = "door_number";
    door.confidence = 0.9;
    door.box = {300, 200, 340, 220};
    door.position = revisit::Vector3{x, 0, 2};
    door.text = text;
    keyframe.detections.push_back(door);
    return keyframe;
}

}  // namespace samples
