// The client against the real server: what is packed is what is listed, loops are found, confirmed and revoked.
#include <random>

#include <revisit/revisit.hpp>

#include <nlohmann/json.hpp>

#include "check.hpp"
#include "samples.hpp"
#include "server.hpp"

using namespace revisit;

static Client client_of(const Server& server) {
    Endpoint endpoint;
    endpoint.url = server.url();
    auto client = Client::open(endpoint);
    CHECK_OK(client);
    return std::move(*client);
}

/// The same body with every column as a list.
static std::string unpacked(const Keyframe& keyframe) {
    auto json = nlohmann::json::parse(*to_json(keyframe));
    json["bow"] = {{"words", keyframe.bow.words}, {"weights", keyframe.bow.weights}};
    nlohmann::json keypoints = nlohmann::json::array();
    for (const auto& at : keyframe.features.keypoints)
        keypoints.push_back({static_cast<float>(detail::rounded(at.u, 2)), static_cast<float>(detail::rounded(at.v, 2)), at.octave, static_cast<float>(detail::rounded(at.angle_deg, 2))});
    auto& features = json["features"];
    features.erase("keypoints_f32");
    features["keypoints"] = keypoints;
    features.erase("map_points_i64");
    features["map_points"] = keyframe.features.map_points;
    json["map_points"].erase("ids_i64");
    json["map_points"]["ids"] = keyframe.map_points.ids;
    return json.dump();
}

static void packed_columns_make_the_same_facts_as_lists() {
    Server server;
    auto client = client_of(server);
    CHECK_OK(client.put_map("tower"));
    for (unsigned seed = 1; seed <= 3; ++seed) {
        const auto keyframe = samples::keyframe(seed * 100);
        const auto first = client.put_keyframe("tower", keyframe);
        CHECK_OK(first);
        CHECK_EQUAL(first->status, 201);
        CHECK(!first->is_replayed);
        const auto again = client.call("put_keyframe", {{{"map", "tower"}, {"keyframe", keyframe.id}}, {}, {}, unpacked(keyframe)});
        CHECK_OK(again);
        CHECK_EQUAL(again->status, 200);
        CHECK(again->is_replayed);
    }
}

// The client writes units where they are shorter: the server must make the same vector of them as of the weights themselves.
static void weights_in_units_make_the_same_vector() {
    Server server;
    auto client = client_of(server);
    CHECK_OK(client.put_map("tower"));
    std::mt19937 chance(77);
    for (unsigned round = 0; round < 100; ++round) {
        Keyframe keyframe = samples::plate("k-" + std::to_string(round), 0, round, "1");
        keyframe.bow = {};
        const std::size_t words = 1 + chance() % (round % 10 == 0 ? 5'000 : 300);
        for (std::size_t i = 0; i < words; ++i) {
            keyframe.bow.words.push_back(static_cast<std::uint32_t>((i * 104'729) % 1'000'003));
            const double exponent = std::uniform_real_distribution<double>(round % 3 == 0 ? -12 : -3, 0)(chance);
            // Repeated weights too, whose order decides who gets what is left over.
            keyframe.bow.weights.push_back(chance() % 9 == 0 ? 0 : round % 2 == 0 ? std::pow(10, exponent) : static_cast<double>(1 + chance() % 3) / 7);
        }
        CHECK_OK(client.put_keyframe("tower", keyframe));
        auto json = nlohmann::json::parse(*to_json(keyframe));
        json["bow"] = {{"words", keyframe.bow.words}, {"weights", keyframe.bow.weights}};
        const auto again = client.call("put_keyframe", {{{"map", "tower"}, {"keyframe", keyframe.id}}, {}, {}, json.dump()});
        CHECK_OK(again);
        CHECK(again->is_replayed);
    }
}

static void a_loop_is_found_confirmed_and_revoked() {
    Server server;
    auto client = client_of(server);
    CHECK_OK(client.put_map("hotel"));
    CHECK_OK(client.put_keyframe("hotel", samples::plate("kf-1", 0, 1, "901")));
    CHECK_OK(client.put_keyframe("hotel", samples::plate("kf-2", 5, 90, "Room 901")));
    CHECK_OK(client.put_keyframe("hotel", samples::plate("kf-3", 15, 120, "910")));
    const auto loop = client.query_loop("hotel", "kf-2", {Question::Verify::anchors, 0, true});
    CHECK_OK(loop);
    CHECK(loop->decision == Decision::loop);
    CHECK_EQUAL(loop->best, "kf-1");
    CHECK_EQUAL(loop->find("kf-1")->anchor_similarity, 1.0);
    const auto other = client.query_loop("hotel", "kf-3");
    CHECK_OK(other);
    CHECK(other->decision == Decision::no_loop);
    CHECK(other->find("kf-1")->decision == Decision::rejected);
    CHECK_EQUAL(other->find("kf-1")->reason, "contradiction");

    const auto confirmed = client.confirm_loop("hotel", {"l-1", "kf-2", "kf-1", loop->id});
    CHECK_OK(confirmed);
    CHECK_EQUAL(confirmed->json["merged"].items().size(), 1u);
    CHECK_EQUAL(client.query_loop("hotel", "kf-2")->reason, "already_closed");
    CHECK_OK(client.revoke_loop("hotel", "l-1"));
    CHECK(client.query_loop("hotel", "kf-2")->decision == Decision::loop);

    PoseCorrections corrections{"robot-7", {"kf-2"}, {Pose{{0.1, 0, 0}, {}}}, {}};
    CHECK_OK(client.correct_poses("hotel", corrections));
    const auto moved = client.call("get_keyframe", {{{"map", "hotel"}, {"keyframe", "kf-2"}}, {}, {}, {}});
    CHECK_OK(moved);
    CHECK_EQUAL(moved->json["pose"]["translation"]["x"].number(), 0.1);
    CHECK_OK(client.delete_keyframe("hotel", "kf-3"));
    CHECK_EQUAL(client.call("get_map", {{{"map", "hotel"}}, {}, {}, {}})->json["keyframes"].integer(), 2);
}

// What `check` lets through the server must take: its limits are the server's.
static void what_the_check_accepts_the_server_accepts() {
    Server server;
    auto client = client_of(server);
    CHECK_OK(client.put_map("limits"));
    const std::function<void(Keyframe&)> extremes[] = {
        [](Keyframe& k) { k.id = std::string(128, 'a'); },
        [](Keyframe& k) { k.id = "..."; },
        [](Keyframe& k) { k.stamp = {limits::first_sec, 999'999'999}; },
        [](Keyframe& k) { k.stamp = {limits::last_sec, 0}; },
        [](Keyframe& k) { k.map_from_camera.translation = {1e9, -1e9, 0}; },
        [](Keyframe& k) { k.map_from_camera.rotation = {0, 0, 0, 1.0099}; },
        [](Keyframe& k) { k.bow.words.clear(), k.bow.weights.clear(); },
        [](Keyframe& k) { k.bow.weights.back() = 1e30; },
        [](Keyframe& k) { k.features.keypoints[0] = {-1e6f, 1e6f, 63, 360}; },
        [](Keyframe& k) { k.features.keypoints[0].angle_deg = std::nanf(""); },
        [](Keyframe& k) { k.features = {512, std::vector<std::uint8_t>(512), {{1, 2, 0, 0}}, {}}; },
        [](Keyframe& k) { k.gravity = Vector3{0, 0.9995, 0}; },
        [](Keyframe& k) { k.height_m = -1e5; },
        [](Keyframe& k) { k.camera = Camera{0.001, 1e6, -1e6, 1e6, 1, 1'000'000}; },
        [](Keyframe& k) { k.observes = {0, std::numeric_limits<std::int64_t>::max()}; },
        [](Keyframe& k) { k.detections = samples::plate("a", 1, 0, "9").detections, k.detections[0].is_range_assumed = true; },
        [](Keyframe& k) { k.detections = samples::plate("a", 1, 0, std::string(4096, 'x')).detections; },
    };
    unsigned seed = 1;
    for (const auto& extreme : extremes) {
        auto keyframe = samples::keyframe(seed++, 40, 20, 10);
        extreme(keyframe);
        CHECK_OK(check(keyframe));
        CHECK_OK(client.put_keyframe("limits", keyframe));
    }
}

static void a_problem_is_an_error_with_its_faults() {
    Server server;
    auto client = client_of(server);
    const auto answer = client.call("put_keyframe", {{{"map", "none"}, {"keyframe", "k"}}, {}, {}, "{\"pose\":3}"});
    CHECK(!answer);
    CHECK(answer.error().code == Code::problem);
    CHECK(answer.error().status >= 400);
    CHECK(!answer.error().detail.empty());
    CHECK_EQUAL(client.call("get_map", {{{"map", ".."}}, {}, {}, {}}).error().field, "/map");
    CHECK_EQUAL(client.call("get_map", {}).error().field, "/map");
    CHECK_EQUAL(client.call("no_such", {}).error().field, "/operation");
    server.kill_now();
    CHECK(client.call("readyz", {}).error().code == Code::unreachable);
}

int main() {
    TEST(packed_columns_make_the_same_facts_as_lists);
    TEST(weights_in_units_make_the_same_vector);
    TEST(a_loop_is_found_confirmed_and_revoked);
    TEST(what_the_check_accepts_the_server_accepts);
    TEST(a_problem_is_an_error_with_its_faults);
}
