// Changes of observations and merges, against the real server: what is fused is covisible and no loop, what is culled is gone, a fault
// is named.
#include <numeric>

#include <revisit/revisit.hpp>

#include "check.hpp"
#include "samples.hpp"
#include "server.hpp"

using namespace revisit;

using Points = std::vector<std::int64_t>;

static Client client_of(const Server& server) {
    Endpoint endpoint;
    endpoint.url = server.url();
    auto client = Client::open(endpoint);
    CHECK_OK(client);
    CHECK_OK(client->put_map("m"));
    return std::move(*client);
}

static Points range(std::int64_t from, std::int64_t to) {
    Points points(static_cast<std::size_t>(to - from));
    std::iota(points.begin(), points.end(), from);
    return points;
}

/// A keyframe that sees these points, the first three of them on a plate.
static Keyframe seeing(const std::string& id, std::int64_t sec, const Points& points, const std::string& plate) {
    auto keyframe = samples::plate(id, 0, sec, plate);
    keyframe.observes = points;
    for (const auto point : points) {
        keyframe.map_points.ids.push_back(point);
        keyframe.map_points.positions.push_back({static_cast<double>(point % 100) * 0.1, 0.3, 3.0});
    }
    keyframe.detections[0].position.reset();
    keyframe.detections[0].map_points = {points[0], points[1], points[2]};
    return keyframe;
}

static std::string text_of(const Json& json) {
    std::string text;
    json.write(text);
    return text;
}

static std::string covisible_with(Client& client, const std::string& keyframe) {
    const auto answer = client.call("list_covisible", {{{"map", "m"}, {"keyframe", keyframe}}, {}, {}, {}});
    CHECK_OK(answer);
    return text_of(answer->json["items"]);
}

static std::string observed_by(Client& client, const std::string& keyframe) {
    const auto answer = client.call("get_keyframe", {{{"map", "m"}, {"keyframe", keyframe}}, {}, {}, {}});
    CHECK_OK(answer);
    return text_of(answer->json["observes"]);
}

static void what_is_fused_is_covisible_and_no_loop() {
    Server server;
    auto client = client_of(server);
    // Tracking took the points of the second for new ones: the same wall, and the same plate.
    CHECK_OK(client.put_keyframe("m", seeing("kf-1", 1, range(0, 20), "901")));
    const auto second = seeing("kf-2", 2, range(100, 120), "901");
    CHECK_OK(client.put_keyframe("m", second));
    const Question question{Question::Verify::anchors, 0, false};
    const auto before = client.query_loop("m", "kf-2", question);
    CHECK_OK(before);
    CHECK(before->decision == Decision::loop);
    CHECK_EQUAL(before->best, "kf-1");
    CHECK_EQUAL(covisible_with(client, "kf-2"), "[]");
    Observations fused;
    fused.session = "robot-7";
    for (std::int64_t point = 100; point < 120; ++point) fused.replaced.emplace_back(point, point - 100);
    const auto changed = client.change_observations("m", fused);
    CHECK_OK(changed);
    CHECK_EQUAL(changed->json["keyframes"].integer(), 1);
    CHECK_EQUAL(changed->json["map_points"].integer(), 20);
    CHECK_EQUAL(changed->json["anchors_merged"].integer(), 1);
    CHECK_EQUAL(covisible_with(client, "kf-2"), R"([{"keyframe":"kf-1","shared":20}])");
    const auto after = client.query_loop("m", "kf-2", question);
    CHECK_OK(after);
    CHECK(after->decision == Decision::no_loop);
    CHECK(after->candidates.empty());
    // A retry of the keyframe is still one, and a second change changes nothing.
    const auto again = client.put_keyframe("m", second);
    CHECK_OK(again);
    CHECK(again->is_replayed);
    CHECK_EQUAL(client.change_observations("m", fused)->json["map_points"].integer(), 0);
}

// Two maps of the host became one: by the client, whose answer is read, and once more by the sender's queue.
static void merged_sessions_are_one_and_can_be_parted() {
    Server server;
    auto client = client_of(server);
    CHECK_OK(client.put_keyframe("m", seeing("kf-1", 1, range(0, 20), "901")));
    auto second = seeing("kf-2", 2, range(100, 120), "901");
    second.session = "robot-8";
    CHECK_OK(client.put_keyframe("m", second));
    SessionMerge merge{"robot-8", "robot-7", {2, {1, 0, 0}, {}}, {}, {}};
    for (std::int64_t point = 100; point < 120; ++point) merge.points.emplace_back(point, point - 100);
    const auto merged = client.merge_sessions("m", merge);
    CHECK_OK(merged);
    CHECK_EQUAL(merged->json["keyframes"].integer(), 1);
    CHECK_EQUAL(merged->json["map_points"].integer(), 20);
    CHECK_EQUAL(covisible_with(client, "kf-2"), R"([{"keyframe":"kf-1","shared":20}])");
    const auto moved = client.call("get_keyframe", {{{"map", "m"}, {"keyframe", "kf-2"}}, {}, {}, {}});
    CHECK_OK(moved);
    CHECK_EQUAL(moved->json["session"].text(), "robot-7");
    CHECK_OK(client.call("revoke_merge", {{{"map", "m"}, {"session", "robot-8"}}, {}, {}, {}}));
    CHECK_EQUAL(covisible_with(client, "kf-2"), "[]");
    SenderOptions options;
    options.endpoint.url = server.url();
    options.map = "m";
    auto sender = Sender::open(options);
    CHECK_OK(sender);
    merge.points.clear();
    merge.point_offset = 1000;
    CHECK_OK((*sender)->merge(merge));
    CHECK((*sender)->flush(std::chrono::seconds(60)));
    CHECK_EQUAL(observed_by(client, "kf-2").substr(0, 11), "[1100,1101,");
    // A faulty one names its field.
    merge.into = "robot-8";
    CHECK(!client.merge_sessions("m", merge));
}

static void what_is_culled_is_observed_no_more() {
    Server server;
    auto client = client_of(server);
    CHECK_OK(client.put_keyframe("m", seeing("kf-1", 1, range(0, 20), "901")));
    CHECK_OK(client.put_keyframe("m", seeing("kf-2", 2, range(0, 20), "901")));
    CHECK_OK(client.put_keyframe("m", seeing("kf-3", 3, range(500, 520), "901")));
    CHECK_EQUAL(covisible_with(client, "kf-1"), R"([{"keyframe":"kf-2","shared":20}])");
    // Fourteen are not enough to be covisible; an edge that is declared counts as declared.
    Observations culled{"robot-7", {}, {5, 6}, {{"kf-2", range(7, 16), {}}, {"kf-1", {}, std::vector<Covisible>{{"kf-3", 31}}}}};
    CHECK_OK(client.change_observations("m", culled));
    CHECK_EQUAL(observed_by(client, "kf-1"), "[0,1,2,3,4,7,8,9,10,11,12,13,14,15,16,17,18,19]");
    CHECK_EQUAL(observed_by(client, "kf-2"), "[7,8,9,10,11,12,13,14,15]");
    CHECK_EQUAL(covisible_with(client, "kf-1"), R"([{"keyframe":"kf-3","shared":31}])");
    // Numbers so large that they are packed, and a keyframe that observes nothing any more.
    Points large;
    for (std::int64_t i = 0; i < 20; ++i) large.push_back(std::numeric_limits<std::int64_t>::max() - i);
    const Observations listed{"robot-7", {}, {}, {{"kf-2", large, {}}, {"kf-3", Points{}, {}}}};
    CHECK(detail::body_of(listed).find("observes_i64") != std::string::npos);
    CHECK_OK(client.change_observations("m", listed));
    CHECK(observed_by(client, "kf-2").find("9223372036854775807") != std::string::npos);
    CHECK_EQUAL(observed_by(client, "kf-3"), "[]");
}

static void a_fault_is_named_by_client_and_server_alike() {
    Server server;
    auto client = client_of(server);
    CHECK_OK(client.put_keyframe("m", seeing("kf-1", 1, range(0, 20), "901")));
    const Observations faulty[] = {
        {"robot-7", {{1, 2}, {1, 3}}, {}, {}},
        {"robot-7", {{1, 2}, {2, 4}, {4, 1}}, {}, {}},
        {"robot-7", {{7, 7}}, {}, {}},
        {"robot-7", {{1, 2}}, {1}, {}},
        {"robot-7", {}, {30, 30}, {}},
        {"robot-7", {{1, 2}}, {}, {{"kf-1", Points{3, 1}, {}}}},
        {"robot-7", {}, {}, {{"kf-1", {}, {}}, {"kf-1", {}, {}}}},
        {"robot-7", {}, {}, {{"kf-1", {}, std::vector<Covisible>{{"kf-1", 1}}}}},
    };
    for (const auto& one : faulty) {
        const auto status = check(one);
        CHECK(!status);
        const auto answer = client.call("change_observations", {{{"map", "m"}}, {}, {}, detail::body_of(one)});
        CHECK(!answer);
        CHECK_EQUAL(answer.error().status, 422);
        CHECK_EQUAL(status.error().field, answer.error().field);
        CHECK_EQUAL(client.change_observations("m", one).error().field, status.error().field);
    }
    // What the server alone knows.
    const auto unknown = client.change_observations("m", {"robot-7", {}, {3}, {{"kf-9", Points{1}, {}}}});
    CHECK_EQUAL(unknown.error().field, "/keyframes/0/keyframe");
    CHECK_EQUAL(client.change_observations("m", {"robot-9", {}, {3}, {}}).error().field, "/session");
    CHECK(observed_by(client, "kf-1").find(",3,") != std::string::npos);
}

// As many as the check lets through, and one more.
static void the_limits_are_the_servers() {
    Server server;
    auto client = client_of(server);
    CHECK_OK(client.put_keyframe("m", seeing("kf-1", 1, range(0, 20), "901")));
    Observations most{"robot-7", {}, range(20'000, 30'000), {{"kf-1", range(40'000, 140'000), {}}}};
    for (std::int64_t i = 0; i < 10'000; ++i) most.replaced.emplace_back(i, i + 1);
    CHECK_OK(client.change_observations("m", most));
    Observations more = most;
    more.replaced.emplace_back(10'000, 10'001);
    const auto refused = client.call("change_observations", {{{"map", "m"}}, {}, {}, detail::body_of(more)});
    CHECK(!refused);
    CHECK_EQUAL(check(more).error().field, refused.error().field);
    more = most;
    more.removed.push_back(30'000);
    CHECK_EQUAL(check(more).error().field, "/removed");
    more = most;
    more.keyframes[0].observes->push_back(140'000);
    CHECK_EQUAL(check(more).error().field, "/keyframes/0/observes");
    more.keyframes.resize(1'001);
    CHECK_EQUAL(check(more).error().field, "/keyframes");
}

int main() {
    TEST(what_is_fused_is_covisible_and_no_loop);
    TEST(merged_sessions_are_one_and_can_be_parted);
    TEST(what_is_culled_is_observed_no_more);
    TEST(a_fault_is_named_by_client_and_server_alike);
    TEST(the_limits_are_the_servers);
}
