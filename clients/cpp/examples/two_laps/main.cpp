// A robot with odometry and a reader of plates, without map points: two laps around a block with four plates.
//
//     two_laps [http://127.0.0.1:7878]
//
// It sends no `covisible`, so the server takes the keyframes near along the drive as neighbours. Each answer `loop` is confirmed,
// which makes the two sights of the plate one. The map is one of its own, `example-two-laps`, made anew. $REVISIT_KEY is the key
// of a server that has keys.
#include <cstdio>
#include <cstdlib>
#include <string>

#include <revisit/revisit.hpp>

struct Plate {
    const char* text;
    revisit::Vector3 position;
};

static const Plate plates[] = {{"901", {4, 0, -1}}, {"903", {9, 0, 4}}, {"905", {4, 0, 9}}, {"907", {-1, 0, 4}}};
static constexpr int side_m = 8;

/// A metre each second, around a block of 8 m by 8 m.
static revisit::Keyframe keyframe(int second) {
    const int side = second / side_m % 4, along = second % side_m;
    const double to = along, back = side_m - along;
    const revisit::Vector3 places[] = {{to, 0, 0}, {side_m, 0, to}, {back, 0, side_m}, {0, 0, back}};
    revisit::Keyframe made;
    made.id = "kf-" + std::to_string(second);
    made.session = "robot-7";
    made.stamp = {second, 0};
    made.map_from_camera.translation = places[side];
    made.bow = {{3, 17, 42}, {1, 1, 1}, ""};
    if (along >= 3 && along <= 5) {
        revisit::Detection plate;
        plate.class_name = "door_number";
        plate.confidence = 0.9;
        plate.box = {300, 200, 340, 220};
        plate.position = plates[side].position;
        plate.text = plates[side].text;
        made.detections.push_back(plate);
    }
    return made;
}

static int failed(const char* what, const revisit::Error& error) {
    std::fprintf(stderr, "%s: %s %s\n", what, error.field.c_str(), error.detail.c_str());
    return 1;
}

int main(int count, char** arguments) {
    const std::string map = "example-two-laps";
    revisit::Endpoint endpoint;
    endpoint.url = count > 1 ? arguments[1] : "http://127.0.0.1:7878";
    if (const char* key = std::getenv("REVISIT_KEY")) endpoint.key = key;
    auto client = revisit::Client::open(endpoint);  // It waits for each answer. A robot's threads use a `Sender`.
    if (!client) return failed("the address", client.error());
    if (const auto ready = client->call("readyz", {}); !ready) {
        std::fprintf(stderr, "No server is ready at %s (%s). Start one with: revisit serve\n", endpoint.url.c_str(), ready.error().detail.c_str());
        return 1;
    }
    const auto deleted = client->call("delete_map", {{{"map", map}}, {}, {}, {}});
    if (!deleted && deleted.error().status != 404) return failed("the last run's map", deleted.error());
    if (const auto made = client->put_map(map); !made) return failed("the map", made.error());

    for (int second = 0; second < 2 * 4 * side_m; ++second) {
        const auto sent = keyframe(second);
        const auto body = revisit::to_json(sent);
        if (!body) return failed(sent.id.c_str(), body.error());
        const auto answer = client->call("put_keyframe", {{{"map", map}, {"keyframe", sent.id}}, {{"query", "loop"}}, {}, *body});
        if (!answer) return failed(sent.id.c_str(), answer.error());
        const auto verdict = revisit::verdict_of(answer->json["loop"]);
        if (!verdict) return failed(sent.id.c_str(), verdict.error());
        if (verdict->decision != revisit::Decision::loop) continue;
        std::printf("%s is at %s: %s\n", sent.id.c_str(), verdict->best.c_str(), verdict->json["why"].text().c_str());
        // Ids hold no characters that JSON escapes.
        const auto loop = R"({"id": "loop-)" + std::to_string(second) + R"(", "keyframe": ")" + sent.id + R"(", "candidate": ")" + verdict->best + R"("})";
        if (const auto closed = client->call("confirm_loop", {{{"map", map}}, {}, {}, loop}); !closed) return failed("the loop", closed.error());
    }
    const auto seen = client->call("get_map", {{{"map", map}}, {}, {}, {}});
    if (!seen) return failed("the map", seen.error());
    std::printf("%.0f keyframes, %.0f signs, %.0f loops\n", seen->json["keyframes"].number(), seen->json["anchors"].number(), seen->json["loops"].number());
    return 0;
}
