// The smallest program: two keyframes that read the same plate, and the verdict on the second.
//
//     minimal [http://127.0.0.1:7878]
//
// It writes into a map of its own, `example-minimal`. $REVISIT_KEY is the key of a server that has keys. Exits with 1 unless a
// verdict came.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>

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

/// Whether a server answers. A `Sender` waits for one without an end, as a robot wants it.
static bool answers(const revisit::Endpoint& endpoint) {
    auto client = revisit::Client::open(endpoint);
    const revisit::Result<revisit::Answer> answer = client ? client->call("readyz", {}) : client.error();
    if (answer) return true;
    std::fprintf(stderr, "No server is ready at %s (%s). Start one with: revisit serve\n", endpoint.url.c_str(), answer.error().detail.c_str());
    return false;
}

int main(int count, char** arguments) {
    revisit::SenderOptions options;
    options.endpoint.url = count > 1 ? arguments[1] : "http://127.0.0.1:7878";
    if (const char* key = std::getenv("REVISIT_KEY")) options.endpoint.key = key;
    options.map = "example-minimal";
    if (!answers(options.endpoint)) return 1;
    std::atomic<bool> is_refused{false}, has_verdict{false};
    options.on_verdict = [&](const revisit::Verdict& verdict) {  // In the sender's thread.
        std::printf("%s: %s %s\n", verdict.keyframe.c_str(), verdict.verdict.c_str(), verdict.best.c_str());
        has_verdict = true;
    };
    options.on_outcome = [&](const revisit::Outcome& outcome) {
        if (outcome.ok()) return;
        std::fprintf(stderr, "%s is refused: %s %s\n", outcome.id.c_str(), outcome.error.field.c_str(), outcome.error.detail.c_str());
        is_refused = true;
    };
    auto sender = revisit::Sender::open(options);
    if (!sender) {
        std::fprintf(stderr, "%s: %s\n", sender.error().field.c_str(), sender.error().detail.c_str());
        return 1;
    }
    for (const auto& status : {(*sender)->send(keyframe("kf-1", 0, 1, "901")), (*sender)->send(keyframe("kf-2", 5, 90, "Room 901"), revisit::Question())}) {
        if (status) continue;
        std::fprintf(stderr, "%s: %s\n", status.error().field.c_str(), status.error().detail.c_str());
        return 1;
    }
    const bool is_sent = (*sender)->flush(std::chrono::seconds(10));
    if (!is_sent) std::fprintf(stderr, "The server did not take everything within 10 s.\n");
    return is_sent && has_verdict && !is_refused ? 0 : 1;
}
