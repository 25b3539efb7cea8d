// The smallest program: two keyframes that read the same plate, and the verdict on the second.
//
// minimal http://127.0.0.1:7878
#include <chrono>
#include <cstdio>

#include <revisit/revisit.hpp>

static revisit::Keyframe keyframe(const char* id, double x, std::int64_t sec, const char* text) {
    revisit::Keyframe keyframe;
    keyframe.id = id;
    keyframe.session = "robot-7";
    keyframe.stamp = {sec, 0};
    keyframe.map_from_camera.translation = {x, 0, 0};  // Metres; the camera looks along z, x is right, y down.
    keyframe.bow = {{3, 17, 42}, {1, 1, 1}, ""};
    revisit::Detection plate;
    plate.class_name = "door_number";
    plate.confidence = 0.9;
    plate.box = {300, 200, 340, 220};
    plate.position = revisit::Vector3{x, 0, 2};
    plate.text = text;
    keyframe.detections.push_back(plate);
    return keyframe;
}

int main(int count, char** arguments) {
    revisit::SenderOptions options;
    options.endpoint.url = count > 1 ? arguments[1] : "http://127.0.0.1:7878";
    options.map = "hotel";
    options.on_verdict = [](const revisit::Verdict& verdict) {  // In the sender's thread.
        std::printf("%s: %s %s\n", verdict.keyframe.c_str(), verdict.verdict.c_str(), verdict.best.c_str());
    };
    options.on_outcome = [](const revisit::Outcome& outcome) {
        if (!outcome.ok()) std::printf("%s: %s %s\n", outcome.id.c_str(), outcome.error.field.c_str(), outcome.error.detail.c_str());
    };
    auto sender = revisit::Sender::open(options);
    if (!sender) {
        std::printf("%s: %s\n", sender.error().field.c_str(), sender.error().detail.c_str());
        return 1;
    }
    for (const auto& status : {(*sender)->send(keyframe("kf-1", 0, 1, "901")), (*sender)->send(keyframe("kf-2", 5, 90, "Room 901"), revisit::Question())})
        if (!status) std::printf("%s: %s\n", status.error().field.c_str(), status.error().detail.c_str());
    return (*sender)->flush(std::chrono::seconds(10)) ? 0 : 1;
}
