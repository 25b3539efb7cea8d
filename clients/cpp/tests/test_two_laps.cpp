// A robot without map points: poses and plates, as in the README, and nothing that says which keyframes are neighbours.
#include <cmath>
#include <vector>

#include <revisit/revisit.hpp>

#include <nlohmann/json.hpp>

#include "check.hpp"
#include "server.hpp"

using namespace revisit;

struct Plate {
    const char* text;
    double x, z;
};

static const Plate plates[] = {{"901", 2, 1}, {"903", 9, -2}, {"905", 6, -5}, {"907", -1, -2}};
static constexpr int steps = 48;

/// The place after a number of steps around a block of 8 m by 4 m, half a metre each.
static Vector3 place(int step) {
    if (step < 16) return {step / 2.0, 0, 0};
    if (step < 24) return {8, 0, (16 - step) / 2.0};
    if (step < 40) return {8 - (step - 24) / 2.0, 0, -4};
    return {0, 0, (step - 40) / 2.0 - 4};
}

static Keyframe keyframe(int second) {
    Keyframe made;
    made.id = "kf-" + std::to_string(second);
    made.stamp = {second, 0};
    const auto at = place(second % steps);
    made.map_from_camera.translation = at;
    made.bow = {{3, 17, 42}, {1, 1, 1}, ""};
    for (const auto& plate : plates) {
        if (std::hypot(plate.x - at[0], plate.z - at[2]) >= 2.2) continue;
        Detection seen;
        seen.class_name = "door_number";
        seen.confidence = 0.9;
        seen.box = {300, 200, 340, 220};
        seen.position = Vector3{plate.x, 0, plate.z};
        seen.text = plate.text;
        made.detections.push_back(seen);
    }
    return made;
}

static std::string text_of(const Json& json) {
    std::string text;
    json.write(text);
    return text;
}

static void two_laps_past_four_plates_make_four_anchors_and_the_second_laps_loops() {
    Server server;
    Endpoint endpoint;
    endpoint.url = server.url();
    auto client = Client::open(endpoint);
    CHECK_OK(client);
    CHECK_OK(client->put_map("hotel"));
    std::vector<std::pair<int, int>> closed;
    for (int second = 0; second < 2 * steps; ++second) {
        const auto id = "kf-" + std::to_string(second);
        const auto asked = client->call("put_keyframe", {{{"map", "hotel"}, {"keyframe", id}}, {{"query", "loop"}}, {}, *to_json(keyframe(second))});
        CHECK_OK(asked);
        const auto answer = nlohmann::json::parse(text_of(asked->json["loop"]));
        if (answer["verdict"] != "loop") continue;
        const std::string best = answer["best"];
        const nlohmann::json loop = {{"id", "l-" + std::to_string(second)}, {"keyframe", id}, {"candidate", best}};
        CHECK_OK(client->call("confirm_loop", {{{"map", "hotel"}}, {}, {}, loop.dump()}));
        closed.emplace_back(second, std::stoi(best.substr(3)));
    }
    const auto map = client->call("get_map", {{{"map", "hotel"}}, {}, {}, {}});
    CHECK_OK(map);
    CHECK_EQUAL(text_of(map->json["anchors"]), "4");
    CHECK(!closed.empty() && closed.size() <= 4);
    for (const auto& [second, earlier] : closed) {
        CHECK(second >= steps && earlier < steps);
        CHECK(std::abs(second - steps - earlier) <= 4);
    }
}

int main() {
    TEST(two_laps_past_four_plates_make_four_anchors_and_the_second_laps_loops);
}
