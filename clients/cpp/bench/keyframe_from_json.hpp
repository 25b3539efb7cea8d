// A keyframe's body in the API's own form as the client's keyframe: for programs of proofs, whose bodies are made elsewhere.
#pragma once

#include <nlohmann/json.hpp>
#include <revisit/revisit.hpp>

inline revisit::Vector3 vector_from(const nlohmann::json& json) { return {json["x"], json["y"], json["z"]}; }

inline revisit::Pose pose_from(const nlohmann::json& json) {
    const auto& q = json["rotation"];
    return {vector_from(json["translation"]), {q["x"], q["y"], q["z"], q["w"]}};
}

inline revisit::Detection detection_from(const nlohmann::json& json) {
    revisit::Detection detection;
    detection.class_name = json["class"];
    detection.confidence = json["confidence"];
    detection.box = json["box"].get<std::array<double, 4>>();
    if (json.contains("map_points")) detection.map_points = json["map_points"].get<std::vector<std::int64_t>>();
    if (json.contains("position")) detection.position = json["position"].get<revisit::Vector3>();
    detection.text = json.value("text", "");
    return detection;
}

inline revisit::Keyframe keyframe_from(const std::string& id, const nlohmann::json& json) {
    revisit::Keyframe keyframe;
    keyframe.id = id;
    keyframe.session = json["session"];
    keyframe.stamp = {json["stamp"]["sec"], json["stamp"]["nanosec"]};
    keyframe.map_from_camera = pose_from(json["pose"]);
    const auto& camera = json["camera"];
    keyframe.camera = revisit::Camera{camera["fx"], camera["fy"], camera["cx"], camera["cy"], camera["width"], camera["height"]};
    keyframe.bow = {json["bow"]["words"].get<std::vector<std::uint32_t>>(), json["bow"]["weights"].get<std::vector<double>>(), ""};
    keyframe.map_points = {json["map_points"]["ids"].get<std::vector<std::int64_t>>(), json["map_points"]["positions"].get<std::vector<revisit::Vector3>>()};
    keyframe.observes = json["observes"].get<std::vector<std::int64_t>>();
    for (const auto& one : json.value("detections", nlohmann::json::array())) keyframe.detections.push_back(detection_from(one));
    return keyframe;
}
